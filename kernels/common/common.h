// What every terrain kernel shares: how tiles lie on the raster.
//
//   sample [row, column], row 0 north          tile (R, C) covers cells R*tile .. and shares its
//   x = column * dx, y = -row * dy             border samples with its neighbours;
//
//       column 0        tile       2*tile
//      row 0 +-----------+-----------+
//            |           |           |         the last tiles may be smaller
//            |  (0, 0)   |  (0, 1)   |
//            |           |           |
//       tile +-----------+-----------+
#ifndef COMMON_H
#define COMMON_H

#include "layout.h"

// two patches must compute the same bits for the same vertex: no fused multiply-add unless asked
#pragma OPENCL FP_CONTRACT OFF

// Library functions are calls on a CPU: these are not. Of a comparison with NaN the second is taken.
inline float larger(float a, float b) { return a > b ? a : b; }
inline float smaller(float a, float b) { return a < b ? a : b; }
inline float absolute(float a) { return a < 0.0f ? -a : a; }

// position of a tile on the raster
typedef struct {
    int row, column;            // its first sample
    int cells_down, cells_across;
} Tile;

// First sample of a row or column of tiles, or the last sample of all; terrain_lod/grid.py says why
// the last tile begins where it does.
inline int tile_row(Grid grid, int index)
{
    return index < grid.tile_rows ? min(index * grid.tile, grid.last_row) : grid.rows - 1;
}

inline int tile_column(Grid grid, int index)
{
    return index < grid.tile_columns ? min(index * grid.tile, grid.last_column)
                                     : grid.columns - 1;
}

inline Tile tile_in(Grid grid, int down, int across)
{
    Tile tile;
    tile.row = tile_row(grid, down);
    tile.column = tile_column(grid, across);
    tile.cells_down = tile_row(grid, down + 1) - tile.row;
    tile.cells_across = tile_column(grid, across + 1) - tile.column;
    return tile;
}

inline Tile tile_at(Grid grid, int index)
{
    return tile_in(grid, index / grid.tile_columns, index % grid.tile_columns);
}

inline int tile_count(Grid grid)
{
    return grid.tile_rows * grid.tile_columns;
}

inline size_t sample_index(Grid grid, int row, int column)
{
    return (size_t)row * grid.columns + column;
}

#endif
