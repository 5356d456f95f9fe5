// Where a point of a patch lies on the raster, in whole 1/65536 of a cell.
//
// The tessellator counts the points of an edge from both of its ends in steps of round(65536 / n),
// so those of n segments are off their true places: by a few units of 1/65536, and in a tile of n
// cells by n times as many, 0.05 m on a 500 m cliff. A ruler undoes that. Its marks are the points
// of n segments, n being the tile's cells; mark k stands on sample k to the bit, and between marks
// it is linear. So n segments reproduce the samples, order is kept, and u and 65536 - u lie
// opposite to each other:
//
//     u       0      step    2 step      32768      .       .      65536
//             |       |        |    ...    |   ...  |       |        |
//     cells   0       1        2          n/2              n - 1     n
//
// A ruler knows nothing but the cells: tiles that share an edge measure it with the same one.
#ifndef COORDINATE_H
#define COORDINATE_H

#include "common/common.h"

typedef struct {
    int cells;
    int step;           // between the marks of u
    int inner;          // mark before the middle
    float per_step;     // 1 / step
    float stretch;      // 65536 / step
    float inner_stretch;    // 65536 / the width of the middle cell, or of those beside the middle
} Ruler;

inline Ruler ruler_of(int cells)
{
    Ruler ruler;
    ruler.cells = cells;
    ruler.step = (FIXED_ONE + cells / 2) / cells;
    ruler.inner = (cells - 1) / 2;
    // an odd number has a cell in the middle, an even one a mark
    const int width = cells % 2 == 1 ? FIXED_ONE - 2 * ruler.inner * ruler.step
                                     : FIXED_ONE / 2 - ruler.inner * ruler.step;
    ruler.per_step = 1.0f / ruler.step;
    ruler.stretch = (float)FIXED_ONE / ruler.step;
    ruler.inner_stretch = (float)FIXED_ONE / width;
    return ruler;
}

// from the tile's first sample
inline int cell_offset(const Ruler ruler, uint along)
{
    const int u = along;
    const bool beyond = u > FIXED_ONE / 2;
    const int from_end = beyond ? FIXED_ONE - u : u;
    // + 0.5: a quotient of whole numbers is never that near to a whole number from below
    const int counted = (int)((from_end + 0.5f) * ruler.per_step);
    const int mark = counted < ruler.inner ? counted : ruler.inner;
    const float stretch = mark < ruler.inner ? ruler.stretch : ruler.inner_stretch;
    const int fraction = (int)((from_end - mark * ruler.step) * stretch + 0.5f);
    const int offset = mark * FIXED_ONE + fraction;
    return beyond ? ruler.cells * FIXED_ONE - offset : offset;
}

#endif
