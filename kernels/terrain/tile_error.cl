// The vertical error of a finished mesh, tile by tile: its triangles against every sample.
//
// Each triangle of a patch is laid over the samples of its tile; samples on an outline belong to all
// triangles around.
//
//     * . . .        * corners, at the heights that the domain stage gives them
//     . \  o  .      o samples: the triangle's height there, minus the sample's
//     .   \   o
//     *----- *
//
// Coarse leaves of a quadtree are measured on a lattice: lattice_error.h.
//
// Built with: PATCHES, a header that says what patches are; TILE cells, GROUP work-items a patch, LANES
// (1 or 8), what PATCHES and ground.h are built with.
#include "common/lanes.h"
#include "common/reduce.h"
#include PATCHES
#include "terrain/lattice_error.h"
#include "terrain/tile_samples.h"

// the samples that a triangle may hold
typedef struct {
    int left, right, top, bottom;
} Box;

inline Box box_of(const float4 a, const float4 b, const float4 c)
{
    const float left = smaller(smaller(a.x, b.x), c.x), top = smaller(smaller(a.y, b.y), c.y);
    const float right = larger(larger(a.x, b.x), c.x), bottom = larger(larger(a.y, b.y), c.y);
    const Box box = {(int)left + (left > (int)left), (int)right,
                     (int)top + (top > (int)top), (int)bottom};
    return box;
}

// How far rounding x and y to floats in the world may move heights: vertices off the samples stand up
// to 2^-23 of their coordinates off their places.
inline float rounding_of_places(float x1, float y1, float z1, float x2, float y2, float z2,
                                float inverse, float cells)
{
    // sides become small first: their products with heights near the end of float32 would overflow
    const float unit = inverse * (1.2e-7f * cells);
    x1 *= unit, y1 *= unit, x2 *= unit, y2 *= unit;
    const float moved = absolute(z1 * y2 - z2 * y1) + absolute(x1 * z2 - x2 * z1);
    const float tallest = larger(larger(absolute(z1), absolute(z2)), absolute(z2 - z1));
    return smaller(moved, tallest);
}

// LANES samples of a row from a column on; behind `last` it is that one again
inline Real row_of_samples(const TileSamples samples, int row, int column, int last)
{
    const size_t first = (size_t)row * samples.stride;
#if LANES == 8 && !MASKED
    if (column + LANES <= samples.readable)
        return vload8(0, samples.heights + first + column);
#endif
    Real heights;
    for (int lane = 0; lane < LANES; ++lane) {
        const size_t i = first + min(column + lane, last);
#if MASKED
        // compares as no error
        SET_LANE(heights, lane, samples.holes[i] ? NAN : samples.heights[i]);
#else
        SET_LANE(heights, lane, samples.heights[i]);
#endif
    }
    return heights;
}

// The largest error of a triangle at the samples that each lane has of it. Of what rounding leaves
// undecided the larger is taken: what is stated is a bound. Corners are in cells from the tile's first
// sample, x east, y south: whole 1/65536, so that differences are exact.
inline Real triangle_errors(const TileSamples samples, const float4 a, const float4 b, const float4 c,
                            float cells)
{
    const float x1 = b.x - a.x, y1 = b.y - a.y, rise1 = b.z - a.z;
    const float x2 = c.x - a.x, y2 = c.y - a.y, rise2 = c.z - a.z;
    const float area = x1 * y2 - x2 * y1;
    // a triangle without an area is in others
    if (area == 0.0f)
        return (Real)0.0f;
    const float inverse = 1.0f / area;
    // of products of sides in weights, and of what is added up then
    const float wide = larger(absolute(x1), absolute(x2)), high = larger(absolute(y1), absolute(y2));
    const float rounding = 1.2e-7f * wide * high * absolute(inverse) + 2.4e-7f;
    const Box box = box_of(a, b, c);
    Real lanes;
    for (int lane = 0; lane < LANES; ++lane)
        SET_LANE(lanes, lane, lane);
    Real error = -1.0f;
    for (int row = box.top; row <= box.bottom; ++row)
        for (int column = box.left; column <= box.right; column += LANES) {
            const Real height = row_of_samples(samples, row, column, box.right);
            // lanes behind the box stay on its last sample, or weigh nothing
            const Real x = column + lanes - a.x;
            const float y = row - a.y;
            const Real share1 = x * y2 - x2 * y, share2 = x1 * y - x * y1;
            const Real weight1 = share1 * inverse, weight2 = share2 * inverse;
            // a corner has its own height, to the bit: full resolution has no error at all; else
            // differences come first, so that heights far from zero cost no digits
            const Real between = (a.z - height) + weight1 * rise1 + weight2 * rise2;
            const Real difference = share1 == area ? b.z - height
                                  : share2 == area ? c.z - height : between;
            const Real lower = SMALLER(weight1, weight2);
            const Real least = SMALLER(lower, 1.0f - weight1 - weight2);
            const Real distance = least >= -rounding ? ABSOLUTE(difference) : (Real)-1.0f;
            error = LARGER(distance, error);
        }
    const Real slack = rounding * error + rounding * absolute(rise1) + rounding * absolute(rise2);
    const float moved = a.w + b.w + c.w > 0.0f
        ? rounding_of_places(x1, y1, rise1, x2, y2, rise2, inverse, cells) : 0.0f;
    // a few roundings more: what is stated bounds what others measure; no error is no error
    const Real bound = (error + slack) * (1.0f + 1e-6f) + moved;
    return error > 0.0f ? bound : (Real)0.0f;
}

// Is a tile meshed in full, on the ground? As many points as samples, each on a sample, and twice as many triangles
// as cells: then, by Pick's theorem, no triangle holds a sample but its corners, and none has an
// error. The same for all items of a group.
inline bool shows_all_samples(const Placing placing, __global const uint2 *points, uint point_count,
                              uint triangle_count, __local float *scratch)
{
    const Tile tile = placing.tile;
    if (point_count != (tile.cells_across + 1) * (tile.cells_down + 1)
        || triangle_count != 2 * tile.cells_across * tile.cells_down)
        return false;
    int off = 0;
    for (uint i = get_local_id(0); i < point_count; i += GROUP)
        off |= place_of(placing, points[i]).x | place_of(placing, points[i]).y;
    return group_max((off & (FIXED_ONE - 1)) != 0, scratch) == 0.0f;
}

// The largest error of triangles first .. end - 1; items share them.
inline float patch_error(const TileSamples samples, __global const int *triangles, uint first,
                         uint end, __global const float4 *corners, float cells)
{
    Real errors = 0.0f;
    for (uint i = first + get_local_id(0); i < end; i += GROUP) {
        __global const int *triangle = triangles + 3 * (size_t)i;
        const Real found = triangle_errors(samples, corners[triangle[0]], corners[triangle[1]],
                                           corners[triangle[2]], cells);
        errors = LARGER(found, errors);
    }
    float error = 0.0f;
    for (int lane = 0; lane < LANES; ++lane)
        error = LARGER(LANE(errors, lane), error);
    return error;
}

__kernel void tile_error(const Grid grid,
                         __global const float *heights,             // (R, C)
                         __global const uchar *holes,               // (R, C) where MASKED
                         __global const float *detail_heights,      // where DETAIL
                         PATCH_ARGUMENTS
                         __global const float4 *details,            // (P,) or (N,) .x: drift
                         const int patches,
                         __global const uchar *changed,             // (P,) others keep their error
                         __global const uint *point_offsets,        // (P + 1,)
                         __global const uint2 *points,              // (N,)
                         __global const uint *triangle_offsets,     // (P + 1,)
                         __global const int *triangles,             // (M, 3)
                         __global float4 *corners,                  // (N,) work space: places in
                                                                    // the tile, and heights
                         __global float *errors,                    // (P,)
                         __local float *scratch)                    // GROUP
{
    __local TileStore store;
    const Ground ground = {grid, heights, holes, detail_heights};
    const PatchSet set = PATCH_SET;
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patches); ++patch) {
        if (!changed[patch])
            continue;
        const Placing placing = placing_of(grid, set, patch);
        const Tile tile = placing.tile;
        const bool is_full = !LIFTED && shows_all_samples(
            placing, points + point_offsets[patch],
            point_offsets[patch + 1] - point_offsets[patch],
            triangle_offsets[patch + 1] - triangle_offsets[patch], scratch);
        if (is_full) {
            if (get_local_id(0) == 0)
                errors[patch] = 0.0f;
            continue;
        }
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1];
             i += GROUP) {
            const int2 offset = place_of(placing, points[i]);
            const float height = lifted(set, i, height_between(ground, global_coordinate(tile.column, offset.x),
                                                               global_coordinate(tile.row, offset.y)));
            const bool is_off = ((offset.x | offset.y) & (FIXED_ONE - 1)) != 0;
            const float scale = 1.0f / FIXED_ONE / placing.stride;
            corners[i] = (float4)(offset.x * scale, offset.y * scale, height, is_off);
        }
        barrier(CLK_GLOBAL_MEM_FENCE);
        const float cells = max(tile.row + tile.cells_down, tile.column + tile.cells_across);
        float error = 0.0f;
        if (placing.stride > 1) {
            error = details[number_of(set, patch)].x + group_max(
                lattice_patch_error(ground, tile, placing.stride, triangles, triangle_offsets[patch],
                                    triangle_offsets[patch + 1], corners, cells), scratch);
            error += 1e-6f * error;
        } else {
            const TileSamples samples = tile_samples(ground, tile, &store);
            error = group_max(
                patch_error(samples, triangles, triangle_offsets[patch], triangle_offsets[patch + 1],
                            corners, cells), scratch);
        }
        if (get_local_id(0) == 0)
            errors[patch] = error;
    }
}
