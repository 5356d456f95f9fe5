// The steeper the ground, the more detail.
//
//     lod = 1 + (maximum - 1) * min(slope / steep, 1)
#include "terrain/patch.h"

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    // atan2 keeps the small slopes that acos of a cosine near 1 would lose
    const float3 normal = patch.normal;
    const float run = sqrt(normal.x * normal.x + normal.y * normal.y);
    const float slope = atan2(run, normal.z) * 57.29577951308232f;
    return 1.0f + (parameters[LOD_MAXIMUM] - 1.0f) * fmin(slope / parameters[LOD_STEEP], 1.0f);
}
