// What every terrain kernel shares: how tiles lie on the raster.
//
//   sample [row, column], row 0 north          tile (R, C) covers cells R*tile .. and shares its
//   x = column * dx, y = -row * dy             border samples with its neighbours:
//
//       column 0        tile       2*tile
//      row 0 +-----------+-----------+
//            |           |           |         the last row and column of tiles may be smaller
//            |  (0, 0)   |  (0, 1)   |
//            |           |           |
//       tile +-----------+-----------+
#ifndef COMMON_H
#define COMMON_H

#include "layout.h"

// two patches must compute the same bits for the same vertex: no fused multiply-add unless asked
#pragma OPENCL FP_CONTRACT OFF

// position of a tile on the raster
typedef struct {
    int row, column;            // its first sample
    int cells_down, cells_across;
} Tile;

inline int tile_count(Grid grid)
{
    return grid.tile_rows * grid.tile_columns;
}

inline Tile tile_at(Grid grid, int index)
{
    Tile tile;
    tile.row = index / grid.tile_columns * grid.tile;
    tile.column = index % grid.tile_columns * grid.tile;
    tile.cells_down = min(grid.tile, grid.rows - 1 - tile.row);
    tile.cells_across = min(grid.tile, grid.columns - 1 - tile.column);
    return tile;
}

inline size_t sample_index(Grid grid, int row, int column)
{
    return (size_t)row * grid.columns + column;
}

#endif
