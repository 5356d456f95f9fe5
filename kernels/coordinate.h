// Where a point of a patch lies on the raster, in whole 1/65536 of a cell.
//
// The tessellator counts its points from the ends of an edge in steps of 65536 / factor, rounded, so
// at the middle of n segments u is off by up to n / 2 * 1/2, and in a tile of n cells a point by
// n^2 / 4 of these units: 7 at factor 15, 496 at 63. A point so close to a sample is put onto it, by
// a rule that knows no patch:
//
//     sample        cell         sample
//       |<-snap-|            |-snap->|
//       *   <-- u*cells      u*cells --> *
#ifndef COORDINATE_H
#define COORDINATE_H

#include "common.h"

// the most that rounding can move a point of any tile
inline int snap_distance(Grid grid)
{
    return grid.tile * grid.tile / 4 + 1;
}

// from the tile's first sample
inline int cell_offset(int cells, uint along, int snap)
{
    const int offset = (int)along * cells;
    const int fraction = offset & (FIXED_ONE - 1);
    if (fraction <= snap)
        return offset - fraction;
    return fraction >= FIXED_ONE - snap ? offset - fraction + FIXED_ONE : offset;
}

#endif
