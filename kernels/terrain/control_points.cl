// The control points of all patches: tile corners, displaced, relative to the terrain's origin.
//
// Built with: what ground.h is built with.
#include "terrain/ground.h"

__kernel void control_points(const Grid grid,
                             __global const float *heights,   // (R, C)
                             __global const uchar *holes,     // (R, C) where MASKED
                             __global const float *detail_heights,  // where DETAIL
                             const float fallback,            // height where there is no data
                             __global float4 *points)         // (TR + 1, TC + 1)
{
    const int index = get_global_id(0);
    if (index >= (grid.tile_rows + 1) * (grid.tile_columns + 1))
        return;
    const int row = tile_row(grid, index / (grid.tile_columns + 1));
    const int column = tile_column(grid, index % (grid.tile_columns + 1));
    const Ground ground = {grid, heights, holes, detail_heights};
    const float height = sample_has_data(ground, row, column) ? sample_height(ground, row, column)
                                                              : fallback;
    points[index] = (float4)(column * grid.dx, -row * grid.dy, height, 1.0f);
}
