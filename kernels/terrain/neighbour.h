// The tiles across a patch's edges.
#ifndef NEIGHBOUR_H
#define NEIGHBOUR_H

#include "common/common.h"

// a tile as a patch sees it: itself, or the neighbour across an edge, in the order of the edges
#define OWN 0
#define WEST 1
#define NORTH 2
#define EAST 3
#define SOUTH 4

__constant int ROW_STEP[5] = {0, 0, -1, 0, 1};
__constant int COLUMN_STEP[5] = {0, -1, 0, 1, 0};

// index of a tile's neighbour, clamped onto the tile itself at the border
inline int neighbour(Grid grid, int patch, int side)
{
    const int row = patch / grid.tile_columns + ROW_STEP[side];
    const int column = patch % grid.tile_columns + COLUMN_STEP[side];
    const bool outside = row < 0 || row >= grid.tile_rows
                      || column < 0 || column >= grid.tile_columns;
    return outside ? patch : row * grid.tile_columns + column;
}

// cells along an edge: u = 0 and u = 1 run along v, south
inline int edge_cells(Tile tile, int edge)
{
    return edge % 2 == 0 ? tile.cells_down : tile.cells_across;
}

#endif
