// The control points of all patches: tile corners, displaced, relative to the terrain's origin.
//
// Built with: MASKED (0 or 1).
#include "common.h"

__kernel void control_points(const Grid grid,
                             __global const float *heights,   // (R, C)
                             __global const uchar *holes,     // (R, C) where MASKED
                             const float fallback,            // height where there is no data
                             __global float4 *points)         // (TR + 1, TC + 1)
{
    const int index = get_global_id(0);
    if (index >= (grid.tile_rows + 1) * (grid.tile_columns + 1))
        return;
    const int row = tile_row(grid, index / (grid.tile_columns + 1));
    const int column = tile_column(grid, index % (grid.tile_columns + 1));
    const size_t sample = sample_index(grid, row, column);
#if MASKED
    const float height = holes[sample] ? fallback : heights[sample];
#else
    const float height = heights[sample];
#endif
    points[index] = (float4)(column * grid.dx, -row * grid.dy, height, 1.0f);
}
