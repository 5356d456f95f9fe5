// The ground's gradient at a sample, by a Sobel operator in metres.
//
//        1  0 -1            1  2  1       differences across two cells, the middle one
//   x    2  0 -2       y    0  0  0       weighted double, divided by the metres between
//        1  0 -1           -1 -2 -1       them: exact on every plane
//
// At the border and beside holes a difference is taken to the sample itself, one-sided, and still
// exact on a plane. (The book's listing 9.9 has neither spacing nor a true third component.)
//
// Differences come first and weights after: heights far from zero would drown them. They are those
// of a 32nd of the heights, so that none passes float's range; and they stay rises a cell until
// the normal is made, as slopes may pass it, too.
#ifndef GRADIENT_H
#define GRADIENT_H

#include "common/lanes.h"
#include "terrain/ground.h"

#define PART (1.0f / 32.0f)

inline bool has_sample(const Ground ground, int row, int column)
{
    return row >= 0 && row < ground.grid.rows && column >= 0 && column < ground.grid.columns
        && sample_has_data(ground, row, column);
}

// Add a weighted difference a cell along (row_step, column_step) at one sample.
inline void add_difference(const Ground ground, int row, int column, int row_step, int column_step,
                           float weight, float *sum, float *weights)
{
    const int ahead = has_sample(ground, row + row_step, column + column_step);
    const int behind = has_sample(ground, row - row_step, column - column_step);
    // one-sided differences need the sample itself
    if (ahead + behind == 0 || (ahead + behind == 1 && !has_sample(ground, row, column)))
        return;
    const float difference =
        PART * sample_height(ground, row + ahead * row_step, column + ahead * column_step)
        - PART * sample_height(ground, row - behind * row_step, column - behind * column_step);
    *sum += weight * difference / (ahead + behind);
    *weights += weight;
}

// a 32nd of the rise a cell to the east and to the north
inline float2 sample_rise(const Ground ground, int row, int column)
{
    float east = 0.0f, south = 0.0f, east_weights = 0.0f, south_weights = 0.0f;
    for (int step = -1; step <= 1; ++step) {
        // they add up to 1, so that no sum is larger than a difference
        const float weight = step == 0 ? 0.5f : 0.25f;
        if (row + step >= 0 && row + step < ground.grid.rows)
            add_difference(ground, row + step, column, 0, 1, weight, &east, &east_weights);
        if (column + step >= 0 && column + step < ground.grid.columns)
            add_difference(ground, row, column + step, 1, 0, weight, &south, &south_weights);
    }
    return (float2)(east_weights > 0.0f ? east / east_weights : 0.0f,
                    south_weights > 0.0f ? -south / south_weights : 0.0f);
}

// LANES cells side by side, by their north-western samples
typedef struct {
    Whole row, column;
} Cells;

// Return true where the 4 x 4 samples around all cells have data.
inline bool are_inner(const Ground ground, Cells cells)
{
    const Whole rows = ground.grid.rows, columns = ground.grid.columns;
    if (ANY(cells.row < 1 || cells.row >= rows - 2 || cells.column < 1 || cells.column >= columns - 2))
        return false;
    bool whole = true;
#if MASKED
    for (int lane = 0; lane < LANES; ++lane)
        for (int down = -1; down <= 2; ++down)
            for (int across = -1; across <= 2; ++across)
                whole &= sample_has_data(ground, WHOLE_LANE(cells.row, lane) + down,
                                         WHOLE_LANE(cells.column, lane) + across);
#endif
    return whole;
}

// four samples of a row, from here on
inline float4 four_samples(const Ground ground, int row, int column)
{
#if DETAIL
    return (float4)(sample_height(ground, row, column), sample_height(ground, row, column + 1),
                    sample_height(ground, row, column + 2), sample_height(ground, row, column + 3));
#else
    return vload4(0, ground.heights + sample_index(ground.grid, row, column));
#endif
}

// the 4 x 4 samples around each cell, row by row
typedef struct {
    Real at[16];
} Around;

#if LANES == 8
#define SIDE_BY_SIDE(rows, s)                                                                       \
    (float8)(rows[0].s, rows[1].s, rows[2].s, rows[3].s, rows[4].s, rows[5].s, rows[6].s, rows[7].s)
#else
#define SIDE_BY_SIDE(rows, s) rows[0].s
#endif

inline Around samples_around(const Ground ground, Cells cells)
{
    Around samples;
#pragma unroll
    for (int down = 0; down < 4; ++down) {
        float4 rows[LANES];
#pragma unroll
        for (int lane = 0; lane < LANES; ++lane)
            rows[lane] = four_samples(ground, WHOLE_LANE(cells.row, lane) - 1 + down,
                                      WHOLE_LANE(cells.column, lane) - 1);
        samples.at[4 * down + 0] = SIDE_BY_SIDE(rows, x);
        samples.at[4 * down + 1] = SIDE_BY_SIDE(rows, y);
        samples.at[4 * down + 2] = SIDE_BY_SIDE(rows, z);
        samples.at[4 * down + 3] = SIDE_BY_SIDE(rows, w);
    }
    return samples;
}

// In inner cells, at (x, y) of each: the rises at the four samples around, blended.
//
//     blending the four operators is one operator with the weights
//
//         fraction x           1 - x   2 - x   1 + x   x       across the differences
//                             -(1 - x)  -x     1 - x   x       along them
//
//     each an eighth of that, so that no sum is larger than a difference
inline Real eastward(const Around *samples, int column, Real y)
{
    Real change[4];
    for (int row = 0; row < 4; ++row)
        change[row] = PART * samples->at[4 * row + column + 2] - PART * samples->at[4 * row + column];
    const float eighth = 0.125f;
    return eighth * (1.0f - y) * change[0] + eighth * (2.0f - y) * change[1]
         + eighth * (1.0f + y) * change[2] + eighth * y * change[3];
}

inline Real northward(const Around *samples, int column, Real y)
{
    Real part[4];
    for (int row = 0; row < 4; ++row)
        part[row] = PART * samples->at[4 * row + column];
    const float eighth = 0.125f;
    return eighth * (1.0f - y) * (part[0] - part[2]) + eighth * y * (part[1] - part[3]);
}

inline Real rise_east(const Around *samples, Real x, Real y)
{
    return (1.0f - x) * eastward(samples, 0, y) + x * eastward(samples, 1, y);
}

inline Real rise_north(const Around *samples, Real x, Real y)
{
    return (1.0f - x) * northward(samples, 0, y) + (2.0f - x) * northward(samples, 1, y)
         + (1.0f + x) * northward(samples, 2, y) + x * northward(samples, 3, y);
}

// unit normals
typedef struct {
    Real x, y, z;
} Normals;

// those of surfaces that rise so, in 32nds, a cell
inline Normals normals_of(const Grid grid, Real rise_east, Real rise_north)
{
    Real east = rise_east / grid.dx, north = rise_north / grid.dy, up = PART;
    const Whole infinite = ABSOLUTE(east) > MAXFLOAT || ABSOLUTE(north) > MAXFLOAT;
    if (ANY(infinite)) {
        // such steep slopes stay far from zero
        const Real small = infinite ? (Real)0x1p-120f : (Real)1.0f;
        up *= small;
        east = small * rise_east / grid.dx;
        north = small * rise_north / grid.dy;
    }
    // squares of very steep ones overflow
    const Real steeper = LARGER(ABSOLUTE(east), ABSOLUTE(north));
    const Real steepest = LARGER(steeper, up);
    const Real scale = steepest > 1e15f || up < PART ? 1.0f / steepest : (Real)1.0f;
    east *= scale;
    north *= scale;
    up *= scale;
    const Real inverse = 1.0f / sqrt(east * east + north * north + up * up);
    const Normals normals = {-east * inverse, -north * inverse, up * inverse};
    return normals;
}

#endif
