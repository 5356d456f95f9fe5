// The domain stage: where a point of a patch stands in the world, and the ground's normal there.
//
// A position is a pure function of the point's global coordinate, counted in 1/65536 of a cell over
// the whole raster, never of anything local to a patch. So two patches that share a point give it
// the same bits:
//
//     global column = first column of the tile * 65536 + u in cells of the tile    (coordinate.h)
//
//       tile A, u = 65536         |  split into the cell and a fraction 0 .. 65535:
//       tile B, u = 0             |  both read (cell 15, fraction 0)
//
// Built with: PATCHES, a header that says what patches are; GROUP work-items a patch, what it and
// ground.h are built with.
#include "terrain/gradient.h"
#include PATCHES

inline float cells_along(Coordinate c)
{
    return c.cell + c.fraction * (1.0f / FIXED_ONE);
}

// the rises at the four samples around, bilinear as well; on a sample there is just one
inline float2 rise_between(const Ground ground, Coordinate column, Coordinate row)
{
    if (is_inner_cell(ground, row.cell, column.cell))
        return inner_rise(ground, row.cell, column.cell, column.fraction * (1.0f / FIXED_ONE),
                          row.fraction * (1.0f / FIXED_ONE));
    float2 rise = sample_rise(ground, row.cell, column.cell);
    if (column.fraction > 0) {
        const float2 right = sample_rise(ground, row.cell, column.cell + 1);
        rise.x = blend(rise.x, right.x, column.fraction);
        rise.y = blend(rise.y, right.y, column.fraction);
    }
    if (row.fraction > 0) {
        float2 below = sample_rise(ground, row.cell + 1, column.cell);
        if (column.fraction > 0) {
            const float2 right = sample_rise(ground, row.cell + 1, column.cell + 1);
            below.x = blend(below.x, right.x, column.fraction);
            below.y = blend(below.y, right.y, column.fraction);
        }
        rise.x = blend(rise.x, below.x, row.fraction);
        rise.y = blend(rise.y, below.y, row.fraction);
    }
    return rise;
}

__kernel void domain(const Grid grid,
                     __global const float *heights,         // (R, C)
                     __global const uchar *holes,           // (R, C) where MASKED
                     __global const float *detail_heights,  // where DETAIL
                     PATCH_ARGUMENTS
                     const int patches,
                     __global const uint *point_offsets,    // (P + 1,)
                     __global const uint2 *points,          // (N,) u, v in 16.16
                     __global float *positions,             // (N, 3)
                     __global float *normals)               // (N, 3)
{
    const Ground ground = {grid, heights, holes, detail_heights};
    const PatchSet set = PATCH_SET;
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patches); ++patch) {
        const Placing placing = placing_of(grid, set, patch);
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1];
             i += GROUP) {
            const int2 place = place_of(placing, points[i]);
            const Coordinate column = global_coordinate(placing.tile.column, place.x);
            const Coordinate row = global_coordinate(placing.tile.row, place.y);
            const float3 normal = normal_of(grid, rise_between(ground, column, row));
            positions[3 * i + 0] = cells_along(column) * grid.dx;
            positions[3 * i + 1] = -cells_along(row) * grid.dy;
            positions[3 * i + 2] = lifted(set, i, height_between(ground, column, row));
            normals[3 * i + 0] = normal.x;
            normals[3 * i + 1] = normal.y;
            normals[3 * i + 2] = normal.z;
        }
    }
}
