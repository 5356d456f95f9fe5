// How much detail does each tile need? Best-fit plane, standard deviation from it, and range.
//
// After the coplanarity pre-pass of "Practical Rendering and Computation with Direct3D 11",
// section 9.1.2, in its five phases:
//
//   1  read the corners               a height near all others keeps the sums small
//   2  read every sample              sums for the fit; minimum and maximum
//   3  fit the plane                  z = height + slope_x x + slope_y y about the tile's centre
//   4  measure each sample from it    residuals, squared and summed
//   5  take the deviation             sqrt(sum / (N - 1)) normal.z, the perpendicular distance
//
// What its listings get wrong is put right: samples and corners share one scale, tiles share their
// border samples, the plane passes through the mean height, so that residuals do average to zero,
// and the fit is least squares unless CORNERS asks for the book's mean of four corner normals.
// Phase 4 reads the samples again, because the closed form Szz - slope_x^2 Sxx - slope_y^2 Syy
// cancels to nothing on a steep coplanar tile.
//
// A work-group per tile. On a CPU it is one work-item, which walks rows of lanes that the compiler
// turns into vectors (analysis_rows.h); on a GPU each of GROUP items takes every GROUP-th sample
// (analysis_group.h). Tiles that are not ordinary go the long way round (analysis_any.h).
//
// Built with: TILE cells, GROUP items, CORNERS (0 or 1), what ground.h is built with.
#include "terrain/tile_samples.h"
#include "common/reduce.h"

// no two tiles must agree to the bit here
#pragma OPENCL FP_CONTRACT ON

// where a tile's heights are, and how they are scaled to keep their squares within float's range
typedef struct {
    TILE_MEMORY const float *heights;   // of the tile's first sample
    TILE_MEMORY const uchar *holes;
    int stride, rows, columns;      // in samples
    float centre_x, centre_y;       // of the tile, in cells
    float scale;                    // a power of two
    float reference;                // a height of the tile, scaled
} Samples;

// x counts cells east of the tile's centre, y cells south, z scaled height above the reference
typedef struct {
    float count;                    // samples with data
    float x, y, z;                  // means over them
    float xx, xy, yy, xz, yz;       // sums of products about the means
    float low, high;                // heights as they are
} Moments;

typedef struct {
    float height, slope_x, slope_y;
} Plane;

typedef struct {
    Samples tile;
    Moments moments;
    Plane plane;
    float squares;                  // of the residuals, summed
} Fit;

inline float height_at(const Samples tile, int row, int column)
{
    return tile.heights[(size_t)row * tile.stride + column];
}

#if GROUP == 1
#include "terrain/analysis_rows.h"
#else
#include "terrain/analysis_group.h"
#endif
#include "terrain/analysis_any.h"

// the normal of a plane with slopes a cell, in scaled heights, not yet of unit length
inline float3 steep_normal(Grid grid, float slope_x, float slope_y, float scale)
{
    return (float3)(clamp(-slope_x / grid.dx, -MAXFLOAT, MAXFLOAT),
                    clamp(slope_y / grid.dy, -MAXFLOAT, MAXFLOAT), scale);
}

// its length, for its largest component: squares of steep slopes overflow
inline float length_by(float3 normal, float largest)
{
    const float3 part = normal / largest;
    return sqrt(part.x * part.x + part.y * part.y + part.z * part.z);
}

inline float largest_of(float3 normal)
{
    return fmax(fmax(fabs(normal.x), fabs(normal.y)), normal.z);
}

// how much a corner's unit normal points up, compared with others of its tile
inline float upward(const Samples tile, Grid grid, float slope_x, float slope_y)
{
    const float3 normal = steep_normal(grid, slope_x, slope_y, tile.scale);
    const float largest = largest_of(normal);
    return 1.0f / largest / length_by(normal, largest);
}

// phase 3 as the book has it: the mean of the four corners' unit normals, each across its two edges
inline Plane corner_plane(const Samples tile, Grid grid, float height)
{
    const int bottom = tile.rows - 1, right = tile.columns - 1;
    const float nw = height_at(tile, 0, 0) * tile.scale;
    const float ne = height_at(tile, 0, right) * tile.scale;
    const float sw = height_at(tile, bottom, 0) * tile.scale;
    const float se = height_at(tile, bottom, right) * tile.scale;
    const float north = (ne - nw) / right, south = (se - sw) / right;
    const float west = (sw - nw) / bottom, east = (se - ne) / bottom;
    // its slope is that of the corners' normals, by how much each of them points up
    const float4 up = (float4)(upward(tile, grid, north, west), upward(tile, grid, north, east),
                               upward(tile, grid, south, west), upward(tile, grid, south, east));
    const float sum = up.x + up.y + up.z + up.w;
    Plane plane = {height, (north * (up.x + up.y) + south * (up.z + up.w)) / sum,
                   (west * (up.x + up.z) + east * (up.y + up.w)) / sum};
    return plane;
}

// phase 3: minimise S (z - height - slope_x x - slope_y y)^2
inline Plane least_squares_plane(const Moments m)
{
    const float determinant = m.xx * m.yy - m.xy * m.xy;
    float slope_x, slope_y;
    if (determinant > 1e-6f * m.xx * m.yy) {
        slope_x = (m.xz * m.yy - m.yz * m.xy) / determinant;
        slope_y = (m.yz * m.xx - m.xz * m.xy) / determinant;
    } else {
        // samples on one line, or one sample: of the planes through them the flattest
        const float spread = fmax(m.xx + m.yy, FLT_MIN);
        slope_x = m.xz / spread;
        slope_y = m.yz / spread;
    }
    Plane plane = {m.z - slope_x * m.x - slope_y * m.y, slope_x, slope_y};
    return plane;
}

// unit normal of a plane in the world: x east, y north, z up; and what its z is to scaled heights
inline float4 world_normal(const Plane plane, float scale, Grid grid)
{
    const float3 normal = steep_normal(grid, plane.slope_x, plane.slope_y, scale);
    const float largest = largest_of(normal);
    const float length = length_by(normal, largest);
    return (float4)(normal / largest / length, 1.0f / largest / length);
}

inline Samples samples_of(const Ground ground, int index, __local TileStore *store)
{
    const Tile tile = tile_at(ground.grid, index);
    const TileSamples at = tile_samples(ground, tile, store);
    Samples samples = {at.heights, at.holes, at.stride,
                       tile.cells_down + 1, tile.cells_across + 1,
                       0.5f * tile.cells_across, 0.5f * tile.cells_down, 1.0f, 0.0f};
    return samples;
}

// phases 1 to 4 of one tile; every item of the group returns the same
inline Fit fit_tile(Grid grid, Samples tile, __local float *scratch)
{
    Fit fit;
    if (is_ordinary_tile(&tile, &fit.moments, scratch)) {
        fit.plane = CORNERS ? corner_plane(tile, grid, fit.moments.z)
                            : least_squares_plane(fit.moments);
        fit.squares = squared_residuals_of_rows(tile, fit.plane, scratch);
        fit.tile = tile;
        return fit;
    }
    scale_samples(&tile, scratch);
    fit.moments = moments_of_samples(tile, scratch);
    // a corner without data has no normal: such a tile takes the least-squares plane
    const bool has_corners = fit.moments.count == tile.rows * tile.columns;
    fit.plane = CORNERS && has_corners ? corner_plane(tile, grid, fit.moments.z)
                                       : least_squares_plane(fit.moments);
    fit.squares = squared_residuals_of_samples(tile, fit.plane, scratch);
    fit.tile = tile;
    return fit;
}

__kernel void analysis(const Grid grid,
                       __global const float *heights,  // (R, C)
                       __global const uchar *holes,    // (R, C) where MASKED
                       __global const float *detail_heights,  // where DETAIL
                       const int count,
                       __global const int *tiles,      // (count,) to analyse; others keep theirs
                       __global float4 *planes,        // (TR, TC) unit normal, height at the centre
                       __global float4 *details,       // (TR, TC) deviation, minimum, maximum, holes
                       __local float *scratch)         // GROUP * 6
{
    __local TileStore store;
    const Ground ground = {grid, heights, holes, detail_heights};
    // groups share the tiles in runs
    const int run = (count + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int i = first; i < min(first + run, count); ++i) {
        const int index = tiles[i];
        const Fit fit = fit_tile(grid, samples_of(ground, index, &store), scratch);
        if (get_local_id(0) != 0)
            continue;
        // phase 5; a tile without data has no plane: NaN says so
        const float scale = fit.tile.scale, count = fit.moments.count;
        const float4 normal = world_normal(fit.plane, scale, grid);
        const float deviation = sqrt(fit.squares / fmax(count - 1.0f, 1.0f)) * normal.w;
        const float height = (fit.plane.height + fit.tile.reference) / scale;
        const float nothing = count > 0.0f ? 0.0f : NAN;
        planes[index] = (float4)(normal.xyz, height + nothing);
        details[index] = (float4)(deviation + nothing, fit.moments.low + nothing,
                                  fit.moments.high + nothing,
                                  fit.tile.rows * fit.tile.columns - count);
    }
}
