// The vertical error of a finished mesh, tile by tile: its triangles against every sample.
//
// Each triangle of a patch is laid over the samples of its tile, in whole 1/65536 of a cell, so
// that what is inside is decided exactly; samples on an outline belong to all triangles around.
//
//     * . . .        * corners, at the heights that the domain stage gives them
//     . \  o  .      o samples: the triangle's height there, minus the sample's
//     .   \   o
//     *----- *
//
// Built with: TILE cells, GROUP work-items a patch, what ground.h is built with.
#include "tile_samples.h"
#include "reduce.h"

// library functions are calls on a CPU: in the inner loops, these
#define LARGER(a, b) ((a) > (b) ? (a) : (b))
#define ABSOLUTE(a) ((a) < 0.0f ? -(a) : (a))

// corners from the tile's first sample, x east, y south
typedef struct {
    int x[3], y[3];
    float z[3];
} Triangle;

inline int ceil_cell(int coordinate)
{
    return (coordinate + FIXED_ONE - 1) >> FIXED_BITS;
}

inline int least(int a, int b, int c)
{
    const int ab = a < b ? a : b;
    return ab < c ? ab : c;
}

inline int greatest(int a, int b, int c)
{
    const int ab = LARGER(a, b);
    return LARGER(ab, c);
}

// twice the signed area of (corner i, corner j, point)
inline long side_of(const Triangle *t, int i, int j, int x, int y)
{
    return (long)(t->x[j] - t->x[i]) * (y - t->y[i]) - (long)(t->y[j] - t->y[i]) * (x - t->x[i]);
}

// How far rounding x and y to floats may move the triangle's height: vertices off the samples stand
// up to 2^-23 of their coordinates off their places.
inline float rounding_of_places(const Triangle *t, float inverse, float cells)
{
    if (((t->x[0] | t->x[1] | t->x[2] | t->y[0] | t->y[1] | t->y[2]) & (FIXED_ONE - 1)) == 0)
        return 0.0f;
    const float x1 = t->x[1] - t->x[0], y1 = t->y[1] - t->y[0], z1 = t->z[1] - t->z[0];
    const float x2 = t->x[2] - t->x[0], y2 = t->y[2] - t->y[0], z2 = t->z[2] - t->z[0];
    const float rise = ABSOLUTE(z1 * y2 - z2 * y1) + ABSOLUTE(x1 * z2 - x2 * z1);
    const float taller = LARGER(ABSOLUTE(z1), ABSOLUTE(z2)), across = ABSOLUTE(z2 - z1);
    const float tallest = LARGER(taller, across);
    const float moved = rise * inverse * (FIXED_ONE * 1.2e-7f * cells);
    return moved < tallest ? moved : tallest;
}

inline float triangle_error(const TileSamples samples, Tile tile, const Triangle *t)
{
    const long area = side_of(t, 0, 1, t->x[2], t->y[2]);
    if (area == 0)
        return 0.0f;
    const long sign = area > 0 ? 1 : -1, size = sign * area;
    const float inverse = 1.0f / (float)size;
    const float rise1 = t->z[1] - t->z[0], rise2 = t->z[2] - t->z[0];
    const int bottom = greatest(t->y[0], t->y[1], t->y[2]) >> FIXED_BITS;
    const int left = ceil_cell(least(t->x[0], t->x[1], t->x[2]));
    const int right = greatest(t->x[0], t->x[1], t->x[2]) >> FIXED_BITS;
    float error = -1.0f;
    for (int row = ceil_cell(least(t->y[0], t->y[1], t->y[2])); row <= bottom; ++row) {
        TILE_MEMORY const float *heights = samples.heights + (size_t)row * samples.stride;
        const int y = row << FIXED_BITS;
        // weights of corners 1 and 2, and how they change from one sample to the next
        long weight1 = sign * side_of(t, 2, 0, left << FIXED_BITS, y);
        long weight2 = sign * side_of(t, 0, 1, left << FIXED_BITS, y);
        const long step1 = -sign * (long)(t->y[0] - t->y[2]) * FIXED_ONE;
        const long step2 = -sign * (long)(t->y[1] - t->y[0]) * FIXED_ONE;
        for (int column = left; column <= right; ++column, weight1 += step1, weight2 += step2) {
#if MASKED
            if (samples.holes[(size_t)row * samples.stride + column])
                continue;
#endif
            // a corner has its own height, to the bit: full resolution has no error at all; else
            // differences come first, so that heights far from zero cost no digits
            const float height = heights[column];
            const float between = (t->z[0] - height) + (weight1 * inverse) * rise1
                                                     + (weight2 * inverse) * rise2;
            const float difference = weight1 == size ? t->z[1] - height
                                   : weight2 == size ? t->z[2] - height : between;
            // no branches: where a triangle ends cannot be foreseen
            const bool is_inside = (weight1 | weight2 | (size - weight1 - weight2)) >= 0;
            const float distance = is_inside ? ABSOLUTE(difference) : -1.0f;
            error = LARGER(distance, error);
        }
    }
    if (error <= 0.0f)
        return 0.0f;
    // what is stated is a bound: two units in the last place of everything that was added up
    error += 2.4e-7f * (error + ABSOLUTE(rise1) + ABSOLUTE(rise2));
    const float down = tile.row + tile.cells_down, across = tile.column + tile.cells_across;
    // a few roundings more: what is stated bounds what others measure
    return error * (1.0f + 1e-6f) + rounding_of_places(t, inverse, LARGER(down, across));
}

// Is a tile meshed in full? As many points as samples, each on a sample, and twice as many triangles
// as cells: then, by Pick's theorem, no triangle holds a sample but its corners, and none has an
// error. The same for all items of a group.
inline bool shows_all_samples(Tile tile, Ruler across, Ruler down, __global const uint2 *points,
                              uint point_count, uint triangle_count, __local float *scratch)
{
    if (point_count != (tile.cells_across + 1) * (tile.cells_down + 1)
        || triangle_count != 2 * tile.cells_across * tile.cells_down)
        return false;
    int off = 0;
    for (uint i = get_local_id(0); i < point_count; i += GROUP)
        off |= cell_offset(across, points[i].x) | cell_offset(down, points[i].y);
    return group_max((off & (FIXED_ONE - 1)) != 0, scratch) == 0.0f;
}

__kernel void tile_error(const Grid grid,
                         __global const float *heights,             // (R, C)
                         __global const uchar *holes,               // (R, C) where MASKED
                         __global const float *detail_heights,      // where DETAIL
                         const int patches,
                         __global const uchar *changed,             // (P,) others keep their error
                         __global const uint *point_offsets,        // (P + 1,)
                         __global const uint2 *points,              // (N,)
                         __global const uint *triangle_offsets,     // (P + 1,)
                         __global const int *triangles,             // (M, 3)
                         __global int2 *offsets,                    // (N,) work space: places in
                         __global float *point_heights,             // (N,) the tile, and heights
                         __global float *errors,                    // (P,)
                         __local float *scratch)                    // GROUP
{
    __local TileStore store;
    const Ground ground = {grid, heights, holes, detail_heights};
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patches); ++patch) {
        if (!changed[patch])
            continue;
        const Tile tile = tile_at(grid, patch);
        const Ruler across = ruler_of(tile.cells_across), down = ruler_of(tile.cells_down);
        const bool is_full = shows_all_samples(
            tile, across, down, points + point_offsets[patch],
            point_offsets[patch + 1] - point_offsets[patch],
            triangle_offsets[patch + 1] - triangle_offsets[patch], scratch);
        if (is_full) {
            if (get_local_id(0) == 0)
                errors[patch] = 0.0f;
            continue;
        }
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1];
             i += GROUP) {
            const int2 offset = (int2)(cell_offset(across, points[i].x),
                                       cell_offset(down, points[i].y));
            offsets[i] = offset;
            point_heights[i] = height_between(ground, global_coordinate(tile.column, offset.x),
                                              global_coordinate(tile.row, offset.y));
        }
        barrier(CLK_GLOBAL_MEM_FENCE);
        const TileSamples samples = tile_samples(ground, tile, &store);
        float error = 0.0f;
        for (uint i = triangle_offsets[patch] + get_local_id(0); i < triangle_offsets[patch + 1];
             i += GROUP) {
            Triangle t;
            for (int corner = 0; corner < 3; ++corner) {
                const int point = triangles[3 * i + corner];
                t.x[corner] = offsets[point].x;
                t.y[corner] = offsets[point].y;
                t.z[corner] = point_heights[point];
            }
            const float found = triangle_error(samples, tile, &t);
            error = LARGER(found, error);
        }
        error = group_max(error, scratch);
        if (get_local_id(0) == 0)
            errors[patch] = error;
    }
}
