// The ground between its samples: bilinear, at whole 1/65536 of a cell.
#ifndef GROUND_H
#define GROUND_H

#include "coordinate.h"

typedef struct {
    Grid grid;
    __global const float *heights;  // (R, C)
    __global const uchar *holes;    // (R, C) where MASKED
} Ground;

// a global coordinate along one axis
typedef struct {
    int cell;
    int fraction;   // 0 .. FIXED_ONE - 1
} Coordinate;

inline Coordinate global_coordinate(int first, int offset)
{
    Coordinate coordinate = {first + (offset >> FIXED_BITS), offset & (FIXED_ONE - 1)};
    return coordinate;
}

inline float sample_height(const Ground ground, int row, int column)
{
    return ground.heights[sample_index(ground.grid, row, column)];
}

inline float blend(float a, float b, int fraction)
{
    return a + (b - a) * (fraction * (1.0f / FIXED_ONE));
}

// bilinear between the four samples around
inline float height_between(const Ground ground, Coordinate column, Coordinate row)
{
    const int right = column.cell + (column.fraction > 0), below = row.cell + (row.fraction > 0);
    const float upper = blend(sample_height(ground, row.cell, column.cell),
                              sample_height(ground, row.cell, right), column.fraction);
    const float lower = blend(sample_height(ground, below, column.cell),
                              sample_height(ground, below, right), column.fraction);
    return blend(upper, lower, row.fraction);
}

#endif
