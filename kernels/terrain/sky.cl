// How much of the sky does each sample see? 1 on a plain, less in valleys and before walls.
//
// Along each of several directions the horizon is the steepest way up to a few samples, nearby ones
// close together, far ones less so. Light that comes evenly from a sky above horizons of slope t,
// taken by level ground, is the mean over the directions of
//
//     cos^2 (horizon) = 1 / (1 + t^2)
//
//                  * .
//               .     \          t = max (height there - height here) / distance, at least 0
//     here o -----------*---
//
// (Dozier and Frew, "Rapid calculation of terrain parameters for radiation modeling from digital
// elevation data", IEEE Transactions on Geoscience and Remote Sensing 28 (5), 1990.)
//
// The raster stands within a border so wide that no look leaves what is stored; the border is lower
// than any ground. A work-item looks from eight samples of a row at a time: all of them look equally
// far, so that each look is one load.
//
// Built with: DIRECTIONS, LOOKS in each of them.
#pragma OPENCL FP_CONTRACT OFF

__kernel void sky(const int rows,                           // of samples, without the border
                  const int lanes,                          // of eight samples, in a row
                  const int stride,                         // stored samples a row
                  const int first,                          // the north-western sample, as stored
                  __global const float *heights,            // with the border
                  __constant const int *offsets,            // (DIRECTIONS, LOOKS) stored samples
                  __constant const float *nearnesses,       // (DIRECTIONS, LOOKS) 1 / distance
                  __global float *seen)                     // (rows, 8 lanes) shares of the sky
{
    const int row = get_global_id(1), lane = get_global_id(0);
    if (row >= rows || lane >= lanes)
        return;
    __global const float *here = heights + first + (size_t)row * stride + 8 * lane;
    const float8 height = vload8(0, here);
    float8 sum = 0.0f;
    for (int direction = 0; direction < DIRECTIONS; ++direction) {
        float8 slope = 0.0f;
        for (int look = direction * LOOKS; look < (direction + 1) * LOOKS; ++look)
            slope = max(slope, (vload8(0, here + offsets[look]) - height) * nearnesses[look]);
        sum += 1.0f / (1.0f + slope * slope);
    }
    vstore8(sum * (1.0f / DIRECTIONS), (size_t)row * lanes + lane, seen);
}
