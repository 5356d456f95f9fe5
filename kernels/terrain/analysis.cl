// How much detail does each tile need? Best-fit plane, standard deviation from it, and range.
//
// After the coplanarity pre-pass of "Practical Rendering and Computation with Direct3D 11",
// section 9.1.2, in its five phases:
//
//   1  read a corner              a height near all others keeps the sums small
//   2  read every sample          sums for the fit; minimum and maximum
//   3  fit the plane              z = height + slope_x x + slope_y y about the tile's centre
//   4  measure each sample        residuals from the plane, squared and summed
//   5  take the deviation         sqrt(sum / (N - 1)) normal.z, the perpendicular distance
//
// What its listings get wrong is put right: samples and corners share one scale, tiles share their
// border samples, the plane passes through the mean height, so that residuals do average to zero,
// and the fit is least squares unless CORNERS asks for the book's mean of four corner normals.
// Phase 4 goes over the samples again, because the closed form Szz - slope_x^2 Sxx - slope_y^2 Syy
// cancels to nothing on a steep coplanar tile.
//
// Everything is added up by columns: down each column first, then across them, halves onto halves.
//
//     z z z z z z z z      a column is a lane of a CPU's vector, or a work-item of a GPU: both do
//     z z z z z z z z      the same sums in the same order, and find the same bits
//     | | | | | | | |
//     s s s s s s s s
//     s+s s+s s+s s+s      column k and column k + COLUMNS / 2, and so on
//
// A group fits TILES tiles, and then takes their deviations together. Full tiles with ordinary heights
// go the short way (analysis_lanes.h, analysis_items.h), then others the long way (analysis_any.h).
//
// Built with: TILE cells, GROUP items, LANES (8 on a CPU, else 1), CORNERS (0 or 1), LISTED (0: all
// tiles, a row of them by a row of groups; 1: some), what ground.h is built with.
#include "common/lanes.h"
#include "terrain/tile_samples.h"

// CPU and GPU find the same
#pragma OPENCL FP_CONTRACT OFF

#define WIDTH (TILE + 1)
// the power of two that holds a row of samples
#define COLUMNS (WIDTH > 32 ? 64 : WIDTH > 16 ? 32 : WIDTH > 8 ? 16 : WIDTH > 4 ? 8 : 4)
#define TILES (GROUP == 1 ? LANES : GROUP / COLUMNS)

typedef Real Reals __attribute__((aligned(4)));

// x counts cells east of the tile's centre, y cells south, z scaled height above the reference
typedef struct {
    float height, slope_x, slope_y;
} Plane;

// sums over samples; products are about the means; the range of heights as they are
typedef struct {
    float count, x, y, z;
    float xx, xy, yy, xz, yz, zz;
    float low, high;
} Moments;

// what is known of a tile before its deviation
typedef struct {
    Plane plane;
    float squares;                  // of the residuals, summed
    float low, high;                // heights as they are
    float count;                    // samples with data
    float scale;                    // a power of two, so that float holds squares
    float reference;                // a height of the tile, scaled
} Fit;

// the same of TILES tiles
typedef struct {
    float height[TILES], slope_x[TILES], slope_y[TILES];
    float squares[TILES], low[TILES], high[TILES], count[TILES], scale[TILES], reference[TILES];
    int samples[TILES];             // 0: nothing is known of it
    int tile[TILES];                // its number; -1: there is none
} Fits;

inline void keep_fit(const Fit fit, int samples, __local Fits *fits, int i)
{
    fits->height[i] = fit.plane.height;
    fits->slope_x[i] = fit.plane.slope_x;
    fits->slope_y[i] = fit.plane.slope_y;
    fits->squares[i] = fit.squares;
    fits->low[i] = fit.low;
    fits->high[i] = fit.high;
    fits->count[i] = fit.count;
    fits->scale[i] = fit.scale;
    fits->reference[i] = fit.reference;
    fits->samples[i] = samples;
}

// the i-th tile that a row of groups analyses: of a row of the grid, or of the list
inline int tile_number(const Grid grid, __global const int *tiles, int i)
{
    return LISTED ? tiles[i] : (int)get_group_id(1) * grid.tile_columns + i;
}

inline Tile tile_cells(const Grid grid, __global const int *tiles, int i)
{
    return LISTED ? tile_at(grid, tiles[i]) : tile_in(grid, get_group_id(1), i);
}

// phase 3 as the book has it: the mean of the unit normals of the four corners nw, ne, sw, se, each
// across its two edges
inline Plane corner_plane(const float4 corners, float scale, int cells_across, int cells_down,
                          const Grid grid, float height)
{
    const float north = (corners.y - corners.x) / cells_across;
    const float south = (corners.w - corners.z) / cells_across;
    const float west = (corners.z - corners.x) / cells_down;
    const float east = (corners.w - corners.y) / cells_down;
    // its slope is that of the corners' normals, by how much each of them points up. The largest
    // component first: squares of steep slopes overflow
    const float4 x = clamp((float4)(north, north, south, south) / grid.dx, -MAXFLOAT, MAXFLOAT);
    const float4 y = clamp((float4)(west, east, west, east) / grid.dy, -MAXFLOAT, MAXFLOAT);
    const float4 largest = fmax(fmax(fabs(x), fabs(y)), scale);
    const float4 a = x / largest, b = y / largest, c = scale / largest;
    const float4 up = 1.0f / largest / sqrt(a * a + b * b + c * c);
    const float sum = (up.x + up.y) + (up.z + up.w);
    const Plane plane = {height, (north * (up.x + up.y) + south * (up.z + up.w)) / sum,
                         (west * (up.x + up.z) + east * (up.y + up.w)) / sum};
    return plane;
}

// phase 3 on a full lattice, where the mean position is the centre and Sxy = 0
inline Plane least_squares_plane_of_full(float z, float xz, float yz)
{
    // WIDTH rows of S (x - mean)^2 = n (n^2 - 1) / 12
    const float spread = (float)WIDTH * WIDTH * (WIDTH * WIDTH - 1) / 12.0f;
    const Plane plane = {z * (1.0f / (WIDTH * WIDTH)), xz * (1.0f / spread), yz * (1.0f / spread)};
    return plane;
}

// Can float hold the squares of such a tile as they are?
inline bool is_ordinary(float low, float high)
{
    const float range = high - low;
    return range == 0.0f || (range > 1e-15f && range < 1e15f);
}

// S y z down a column of WIDTH, of the sum of its z and of the sum of that sum after every row
#define MOMENT(sum, sums) ((WIDTH - 0.5f * TILE) * (sum) - (sums))

#if GROUP == 1
#include "terrain/analysis_lanes.h"
#else
#include "terrain/analysis_items.h"
#endif
#include "terrain/analysis_any.h"

#define REALS(values, i) (*(__local const Reals *)&(values)[i])

// phase 5, of tiles side by side; a tile without data has no plane: NaN says so
inline void store_fits(__local const Fits *fits, const Grid grid, __global float4 *planes,
                       __global float4 *details)
{
    for (int i = LANES * get_local_id(0); i < TILES; i += LANES * GROUP) {
        const Real scale = REALS(fits->scale, i);
        // the largest component first: squares of steep slopes overflow
        const Real slope_x = REALS(fits->slope_x, i) / grid.dx;
        const Real slope_y = REALS(fits->slope_y, i) / grid.dy;
        const Real east = LARGER(SMALLER(-slope_x, MAXFLOAT), -MAXFLOAT);
        const Real north = LARGER(SMALLER(slope_y, MAXFLOAT), -MAXFLOAT);
        const Real shrink = 1.0f / LARGER(LARGER(ABSOLUTE(east), ABSOLUTE(north)), scale);
        const Real a = east * shrink, b = north * shrink, c = scale * shrink;
        const Real shorten = 1.0f / sqrt(a * a + b * b + c * c);
        const Real x = a * shorten, y = b * shorten, z = c * shorten;
        const Real variance = REALS(fits->squares, i) / LARGER(REALS(fits->count, i) - 1.0f, 1.0f);
        const Real deviation = sqrt(variance) * (shrink * shorten);
        const Real height = (REALS(fits->height, i) + REALS(fits->reference, i)) / scale;
        for (int lane = 0; lane < LANES; ++lane) {
            const int tile = fits->tile[i + lane];
            if (tile < 0)
                continue;
            const float count = fits->count[i + lane], nothing = count > 0.0f ? 0.0f : NAN;
            planes[tile] = (float4)(LANE(x, lane), LANE(y, lane), LANE(z, lane),
                                    LANE(height, lane) + nothing);
            details[tile] = (float4)(LANE(deviation, lane) + nothing, fits->low[i + lane] + nothing,
                                     fits->high[i + lane] + nothing,
                                     fits->samples[i + lane] - count);
        }
    }
}

// Full tiles with ordinary heights; the numbers of others are put on a list.
__kernel void analysis(const Grid grid,
                       __global const float *heights,  // (R, C)
                       __global const uchar *holes,    // (R, C) where MASKED
                       __global const float *detail_heights,  // where DETAIL
                       const int count,                // of tiles in a row of the grid, or in the list
                       __global const int *tiles,      // (count,) where LISTED: others keep theirs
                       __global int *left,             // how many are left, and then their numbers
                       __global float4 *planes,        // (TR, TC) unit normal, height at the centre
                       __global float4 *details)       // (TR, TC) deviation, minimum, maximum, holes
{
    __local TileStore store;
    __local Across across;
    __local Fits fits;
    const Ground ground = {grid, heights, holes, detail_heights};
    // groups share the tiles in runs
    const int run = (count + get_num_groups(0) - 1) / get_num_groups(0);
    const int end = min((int)(get_group_id(0) + 1) * run, count);
    for (int first = get_group_id(0) * run; first < end; first += TILES) {
        const int number = min(TILES, end - first);
        fit_full_tiles(ground, tiles, first, number, &fits, &store, &across);
        for (int i = get_local_id(0); i < TILES; i += GROUP)
            fits.tile[i] = i < number ? tile_number(grid, tiles, first + i) : -1;
        WAIT_FOR_GROUP();
        for (int i = get_local_id(0); i < number; i += GROUP)
            if (fits.samples[i] == 0) {
                left[1 + atomic_inc(left)] = fits.tile[i];
                fits.tile[i] = -1;
            }
        store_fits(&fits, grid, planes, details);
        WAIT_FOR_GROUP();
    }
}

// The tiles that are left. They are few: a kernel of their own leaves the other one its registers.
__kernel void analysis_of_the_rest(const Grid grid, __global const float *heights,
                                   __global const uchar *holes,
                                   __global const float *detail_heights,
                                   __global const int *left, __global float4 *planes,
                                   __global float4 *details)
{
    __local TileStore store;
    __local Moments columns[COLUMNS];
    __local Fits fits;
    const Ground ground = {grid, heights, holes, detail_heights};
    for (int i = get_local_id(0); i < TILES; i += GROUP)
        fits.tile[i] = -1;
    for (int i = get_group_id(0); i < left[0]; i += get_num_groups(0)) {
        fit_any_tile(ground, left[1 + i], &fits, &store, columns);
        store_fits(&fits, grid, planes, details);
        WAIT_FOR_GROUP();
    }
}
