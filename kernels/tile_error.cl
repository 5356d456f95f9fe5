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

// How far rounding x and y to floats may move the triangle's height: vertices off the samples stand
// up to 2^-23 of their coordinates off their places.
inline float rounding_of_places(const Triangle *t, float area, float cells)
{
    if (((t->x[0] | t->x[1] | t->x[2] | t->y[0] | t->y[1] | t->y[2]) & (FIXED_ONE - 1)) == 0)
        return 0.0f;
    const float x1 = t->x[1] - t->x[0], y1 = t->y[1] - t->y[0], z1 = t->z[1] - t->z[0];
    const float x2 = t->x[2] - t->x[0], y2 = t->y[2] - t->y[0], z2 = t->z[2] - t->z[0];
    const float rise = fabs(z1 * y2 - z2 * y1) + fabs(x1 * z2 - x2 * z1);
    const float tallest = fmax(fmax(fabs(z1), fabs(z2)), fabs(z2 - z1));
    return fmin(rise / area * (FIXED_ONE * 1.2e-7f * cells), tallest);
}

inline float triangle_error(const Ground ground, Tile tile, const Triangle *t)
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
        __global const float *heights =
            ground.heights + sample_index(ground.grid, tile.row + row, tile.column);
        const int y = row << FIXED_BITS;
        // weights of corners 1 and 2, and how they change from one sample to the next
        long weight1 = sign * side_of(t, 2, 0, left << FIXED_BITS, y);
        long weight2 = sign * side_of(t, 0, 1, left << FIXED_BITS, y);
        const long step1 = -sign * (long)(t->y[0] - t->y[2]) * FIXED_ONE;
        const long step2 = -sign * (long)(t->y[1] - t->y[0]) * FIXED_ONE;
        for (int column = left; column <= right; ++column, weight1 += step1, weight2 += step2) {
            if (weight1 < 0 || weight2 < 0 || weight1 + weight2 > size)
                continue;
#if MASKED
            if (ground.holes[sample_index(ground.grid, tile.row + row, tile.column + column)])
                continue;
#endif
            // a corner has its own height, to the bit: full resolution has no error at all; else
            // differences come first, so that heights far from zero cost no digits
            const float difference = weight1 == size ? t->z[1] - heights[column]
                                   : weight2 == size ? t->z[2] - heights[column]
                                   : (t->z[0] - heights[column]) + (weight1 * inverse) * rise1
                                                                 + (weight2 * inverse) * rise2;
            const float distance = difference < 0.0f ? -difference : difference;
            error = distance > error ? distance : error;
        }
    }
    if (error < 0.0f)
        return 0.0f;
    const float cells = max(tile.row + tile.cells_down, tile.column + tile.cells_across);
    return error + rounding_of_places(t, (float)size, cells);
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
