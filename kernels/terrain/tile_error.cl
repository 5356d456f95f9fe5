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

// corners in cells from the tile's first sample, x east, y south: whole 1/65536, so that differences
// are exact; LANES triangles side by side
typedef struct {
    Real x[3], y[3], z[3];
} Triangles;

// the samples that a triangle may hold
typedef struct {
    int left, right, top, bottom;
} Box;

inline Box box_of(const float4 a, const float4 b, const float4 c)
{
    const float left = SMALLER(SMALLER(a.x, b.x), c.x), top = SMALLER(SMALLER(a.y, b.y), c.y);
    const float right = LARGER(LARGER(a.x, b.x), c.x), bottom = LARGER(LARGER(a.y, b.y), c.y);
    const Box box = {(int)left + (left > (int)left), (int)right,
                     (int)top + (top > (int)top), (int)bottom};
    return box;
}

// How far rounding x and y to floats in the world may move heights: vertices off the samples stand up
// to 2^-23 of their coordinates off their places.
inline Real rounding_of_places(Real x1, Real y1, Real z1, Real x2, Real y2, Real z2, Real inverse,
                               float cells)
{
    // sides become small first: their products with heights near the end of float32 would overflow
    const Real unit = inverse * (1.2e-7f * cells);
    x1 *= unit, y1 *= unit, x2 *= unit, y2 *= unit;
    const Real moved = ABSOLUTE(z1 * y2 - z2 * y1) + ABSOLUTE(x1 * z2 - x2 * z1);
    const Real taller = LARGER(ABSOLUTE(z1), ABSOLUTE(z2)), across = ABSOLUTE(z2 - z1);
    const Real tallest = LARGER(taller, across);
    return SMALLER(moved, tallest);
}

// The largest error of each lane's triangle. Of what rounding leaves undecided the larger is taken:
// what is stated is a bound.
inline Real triangle_errors(const TileSamples samples, const Triangles *t, const Box *boxes,
                            Real off_samples, float cells)
{
    const Real x1 = t->x[1] - t->x[0], y1 = t->y[1] - t->y[0], rise1 = t->z[1] - t->z[0];
    const Real x2 = t->x[2] - t->x[0], y2 = t->y[2] - t->y[0], rise2 = t->z[2] - t->z[0];
    const Real area = x1 * y2 - x2 * y1;
    const Real inverse = area == 0.0f ? (Real)0.0f : 1.0f / area;
    // of products of sides in weights, and of what is added up then
    const Real wide = LARGER(ABSOLUTE(x1), ABSOLUTE(x2)), high = LARGER(ABSOLUTE(y1), ABSOLUTE(y2));
    const Real rounding = 1.2e-7f * wide * high * ABSOLUTE(inverse) + 2.4e-7f;
    int rows = 0, columns = 0;
    for (int lane = 0; lane < LANES; ++lane) {
        const int down = boxes[lane].bottom - boxes[lane].top;
        const int across = boxes[lane].right - boxes[lane].left;
        rows = LARGER(rows, down + 1);
        columns = LARGER(columns, across + 1);
    }
    Real error = -1.0f;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            Real x, y, height;
            for (int lane = 0; lane < LANES; ++lane) {
                // lanes whose box ends before stay on its last sample
                const int c = SMALLER(boxes[lane].left + column, boxes[lane].right);
                const int r = SMALLER(boxes[lane].top + row, boxes[lane].bottom);
                const size_t i = (size_t)r * samples.stride + c;
                SET_LANE(x, lane, c);
                SET_LANE(y, lane, r);
#if MASKED
                // compares as no error
                SET_LANE(height, lane, samples.holes[i] ? NAN : samples.heights[i]);
#else
                SET_LANE(height, lane, samples.heights[i]);
#endif
            }
            x -= t->x[0];
            y -= t->y[0];
            const Real share1 = x * y2 - x2 * y, share2 = x1 * y - x * y1;
            const Real weight1 = share1 * inverse, weight2 = share2 * inverse;
            // a corner has its own height, to the bit: full resolution has no error at all; else
            // differences come first, so that heights far from zero cost no digits
            const Real between = (t->z[0] - height) + weight1 * rise1 + weight2 * rise2;
            const Real difference = share1 == area ? t->z[1] - height
                                  : share2 == area ? t->z[2] - height : between;
            const Real lower = SMALLER(weight1, weight2);
            const Real least = SMALLER(lower, 1.0f - weight1 - weight2);
            const Real distance = least >= -rounding ? ABSOLUTE(difference) : (Real)-1.0f;
            error = LARGER(distance, error);
        }
    // a triangle without an area is in others
    error = area == 0.0f ? (Real)0.0f : error;
    const Real slack = rounding * error + rounding * ABSOLUTE(rise1) + rounding * ABSOLUTE(rise2);
    const Real moved = off_samples * rounding_of_places(x1, y1, rise1, x2, y2, rise2, inverse, cells);
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
    for (uint i = first + get_local_id(0) * LANES; i < end; i += GROUP * LANES) {
        Triangles t;
        Box boxes[LANES];
        Real off_samples;
        for (int lane = 0; lane < LANES; ++lane) {
            // the last ones again where there are no more
            __global const int *triangle = triangles + 3 * (size_t)min(i + lane, end - 1);
            const float4 a = corners[triangle[0]], b = corners[triangle[1]];
            const float4 c = corners[triangle[2]];
            boxes[lane] = box_of(a, b, c);
            SET_LANE(t.x[0], lane, a.x); SET_LANE(t.y[0], lane, a.y); SET_LANE(t.z[0], lane, a.z);
            SET_LANE(t.x[1], lane, b.x); SET_LANE(t.y[1], lane, b.y); SET_LANE(t.z[1], lane, b.z);
            SET_LANE(t.x[2], lane, c.x); SET_LANE(t.y[2], lane, c.y); SET_LANE(t.z[2], lane, c.z);
            SET_LANE(off_samples, lane, a.w + b.w + c.w > 0.0f);
        }
        const Real found = triangle_errors(samples, &t, boxes, off_samples, cells);
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
