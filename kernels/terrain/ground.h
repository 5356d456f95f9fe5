// The ground at its samples and between them: bilinear, at whole 1/65536 of a cell.
//
// Samples are those of the grid. Without DETAIL they are stored, (R, C). With it the grid is finer
// than what is stored, and a sample is a sum that is found where it is read:
//
//     o . . o . . o     o  stored heights             3 STEPS_ACROSS a stored cell here,
//     . . . . . . .     .  bilinear between them      and as many STEPS_DOWN
//     o . . o . . o     everywhere plus a sample of the detail, which begins again after its last
//
// terrain_lod/ground/detail.py does the same sums on the host, to the bit.
//
// Built with: MASKED (0 or 1); DETAIL (0 or 1) and, where it is 1, STEPS_ACROSS, STEPS_DOWN,
// DETAIL_ROWS and DETAIL_COLUMNS.
#ifndef GROUND_H
#define GROUND_H

#include "terrain/coordinate.h"

typedef struct {
    Grid grid;
    __global const float *heights;          // (R, C) as stored
    __global const uchar *holes;            // (R, C) where MASKED
    __global const float *detail_heights;   // (DETAIL_ROWS, DETAIL_COLUMNS) where DETAIL
} Ground;

#if DETAIL
// where a sample of the grid lies among those that are stored
typedef struct {
    size_t here;            // the stored sample at it, or north and west of it
    size_t east, south;     // how far on the next ones are; 0 where it lies on their line
    float x, y;             // of the way to them
} Stored;

inline Stored stored_at(const Grid grid, uint row, uint column)
{
    const uint stored_columns = (uint)(grid.columns - 1) / STEPS_ACROSS + 1;
    const uint above = row / STEPS_DOWN, left = column / STEPS_ACROSS;
    const int down = row - above * STEPS_DOWN, across = column - left * STEPS_ACROSS;
    const Stored stored = {(size_t)above * stored_columns + left, across > 0,
                           down > 0 ? stored_columns : 0,
                           across * (1.0f / STEPS_ACROSS), down * (1.0f / STEPS_DOWN)};
    return stored;
}
#endif

// Has a sample data? With detail: all that it lies between.
inline bool sample_has_data(const Ground ground, int row, int column)
{
#if !MASKED
    return true;
#elif DETAIL
    const Stored at = stored_at(ground.grid, row, column);
    __global const uchar *holes = ground.holes + at.here;
    return !(holes[0] | holes[at.east] | holes[at.south] | holes[at.south + at.east]);
#else
    return !ground.holes[sample_index(ground.grid, row, column)];
#endif
}

// Has a cell a surface: data at its four samples?
inline bool cell_has_data(const Ground ground, int row, int column)
{
    return sample_has_data(ground, row, column) & sample_has_data(ground, row, column + 1)
         & sample_has_data(ground, row + 1, column) & sample_has_data(ground, row + 1, column + 1);
}

// a sample's height; 0 where it has no data
inline float sample_height(const Ground ground, int row, int column)
{
#if DETAIL
    if (!sample_has_data(ground, row, column))
        return 0.0f;
    const Stored at = stored_at(ground.grid, row, column);
    __global const float *heights = ground.heights + at.here;
    const float nw = heights[0], ne = heights[at.east];
    const float sw = heights[at.south], se = heights[at.south + at.east];
    const float upper = nw + (ne - nw) * at.x, lower = sw + (se - sw) * at.x;
    const uint wrapped = (uint)row % DETAIL_ROWS * DETAIL_COLUMNS + (uint)column % DETAIL_COLUMNS;
    return upper + (lower - upper) * at.y + ground.detail_heights[wrapped];
#else
    return ground.heights[sample_index(ground.grid, row, column)];
#endif
}

// A height on or beyond the raster's last row and column: there it goes on as it came, point by point about
// the last one, so that a plane stays a plane.
inline float height_beyond(const Ground ground, int row, int column)
{
    const int last_row = ground.grid.rows - 1, last_column = ground.grid.columns - 1;
    if (row <= last_row && column <= last_column)
        return sample_height(ground, row, column);
    float heights[2];
    for (int side = 0; side < 2; ++side) {
        // the last row, and the one opposite to what is beyond
        const int r = row <= last_row ? row : side ? max(2 * last_row - row, 0) : last_row;
        const float last = sample_height(ground, r, min(column, last_column));
        heights[side] = column <= last_column
            ? last : 2.0f * last - sample_height(ground, r, max(2 * last_column - column, 0));
    }
    return row <= last_row ? heights[0] : 2.0f * heights[0] - heights[1];
}

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
