// Where a point of a patch lies on the raster, in whole 1/65536 of a cell.
//
// The tessellator rounds u to 1/65536, which leaves the points of factor 15 up to 7 of these units
// off the samples. A point that close to a sample is put onto it, by a rule that knows no patch:
//
//     sample        cell         sample
//       |<-snap-|            |-snap->|
//       *   <-- u*cells      u*cells --> *
#ifndef COORDINATE_H
#define COORDINATE_H

#include "common.h"

// the most that rounding u can move a point of any tile
inline int snap_distance(Grid grid)
{
    return (grid.tile + 1) / 2;
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
