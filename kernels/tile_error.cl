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
// Built with: GROUP work-items a patch, MASKED (0 or 1).
#include "ground.h"
#include "reduce.h"

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
    const int ab = a > b ? a : b;
    return ab > c ? ab : c;
}

// twice the signed area of (corner i, corner j, point)
inline long side_of(const Triangle *t, int i, int j, int x, int y)
{
    return (long)(t->x[j] - t->x[i]) * (y - t->y[i]) - (long)(t->y[j] - t->y[i]) * (x - t->x[i]);
}

inline float triangle_error(const Ground ground, Tile tile, const Triangle *t)
{
    const long area = side_of(t, 0, 1, t->x[2], t->y[2]);
    if (area == 0)
        return 0.0f;
    const long sign = area > 0 ? 1 : -1;
    const float inverse = 1.0f / (float)(sign * area);
    const int bottom = greatest(t->y[0], t->y[1], t->y[2]) >> FIXED_BITS;
    const int left = ceil_cell(least(t->x[0], t->x[1], t->x[2]));
    const int right = greatest(t->x[0], t->x[1], t->x[2]) >> FIXED_BITS;
    float error = 0.0f;
    for (int row = ceil_cell(least(t->y[0], t->y[1], t->y[2])); row <= bottom; ++row) {
        const int y = row << FIXED_BITS;
        // weights of corners 1 and 2, and how they change from one sample to the next
        long weight1 = sign * side_of(t, 2, 0, left << FIXED_BITS, y);
        long weight2 = sign * side_of(t, 0, 1, left << FIXED_BITS, y);
        const long step1 = -sign * (long)(t->y[0] - t->y[2]) * FIXED_ONE;
        const long step2 = -sign * (long)(t->y[1] - t->y[0]) * FIXED_ONE;
        for (int column = left; column <= right; ++column, weight1 += step1, weight2 += step2) {
            if (weight1 < 0 || weight2 < 0 || weight1 + weight2 > sign * area)
                continue;
            const size_t sample = sample_index(ground.grid, tile.row + row, tile.column + column);
#if MASKED
            if (ground.holes[sample])
                continue;
#endif
            // a corner has its own height, to the bit: full resolution has no error at all
            const float z = weight1 == sign * area ? t->z[1]
                          : weight2 == sign * area ? t->z[2]
                          : t->z[0] + (weight1 * inverse) * (t->z[1] - t->z[0])
                                    + (weight2 * inverse) * (t->z[2] - t->z[0]);
            const float difference = z - ground.heights[sample];
            const float size = difference < 0.0f ? -difference : difference;
            error = size > error ? size : error;
        }
    }
    return error;
}

__kernel void tile_error(const Grid grid,
                         __global const float *heights,             // (R, C)
                         __global const uchar *holes,               // (R, C) where MASKED
                         const int patches,
                         __global const uchar *changed,             // (P,) others keep their error
                         __global const uint *point_offsets,        // (P + 1,)
                         __global const uint2 *points,              // (N,)
                         __global const uint *triangle_offsets,     // (P + 1,)
                         __global const int *triangles,             // (M, 3)
                         __global float *point_heights,             // (N,) work space
                         __global float *errors,                    // (P,)
                         __local float *scratch)                    // GROUP
{
    const Ground ground = {grid, heights, holes};
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patches); ++patch) {
        if (!changed[patch])
            continue;
        const Tile tile = tile_at(grid, patch);
        const Ruler across = ruler_of(tile.cells_across), down = ruler_of(tile.cells_down);
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1];
             i += GROUP)
            point_heights[i] = height_between(
                ground, global_coordinate(tile.column, cell_offset(across, points[i].x)),
                global_coordinate(tile.row, cell_offset(down, points[i].y)));
        barrier(CLK_GLOBAL_MEM_FENCE);
        float error = 0.0f;
        for (uint i = triangle_offsets[patch] + get_local_id(0); i < triangle_offsets[patch + 1];
             i += GROUP) {
            Triangle t;
            for (int corner = 0; corner < 3; ++corner) {
                const int point = triangles[3 * i + corner];
                t.x[corner] = cell_offset(across, points[point].x);
                t.y[corner] = cell_offset(down, points[point].y);
                t.z[corner] = point_heights[point];
            }
            const float found = triangle_error(ground, tile, &t);
            error = found > error ? found : error;
        }
        error = group_max(error, scratch);
        if (get_local_id(0) == 0)
            errors[patch] = error;
    }
}
