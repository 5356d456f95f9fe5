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

// four floats at any address
typedef float4 Samples4 __attribute__((aligned(4)));

// a 32nd of four samples of a row, from here on
inline float4 four_samples(const Ground ground, int row, int column)
{
#if DETAIL
    return PART * (float4)(sample_height(ground, row, column),
                           sample_height(ground, row, column + 1),
                           sample_height(ground, row, column + 2),
                           sample_height(ground, row, column + 3));
#else
    return PART
         * *(__global const Samples4 *)(ground.heights + sample_index(ground.grid, row, column));
#endif
}

// Return true where the 4 x 4 samples around a cell all have data.
inline bool is_inner_cell(const Ground ground, int row, int column)
{
    if (row < 1 || row >= ground.grid.rows - 2 || column < 1 || column >= ground.grid.columns - 2)
        return false;
    bool whole = true;
#if MASKED
    for (int down = -1; down <= 2; ++down)
        for (int across = -1; across <= 2; ++across)
            whole &= sample_has_data(ground, row + down, column + across);
#endif
    return whole;
}

// In an inner cell: the rises at the four samples around, blended, from 4 x 4 samples.
//
//     blending the four operators is one operator with the weights
//
//         fraction x           1 - x   2 - x   1 + x   x       across the differences
//                             -(1 - x)  -x     1 - x   x       along them
//
//     each an eighth of that, so that no sum is larger than a difference
inline float2 inner_rise(const Ground ground, int row, int column, float x, float y)
{
    const float4 a = four_samples(ground, row - 1, column - 1);
    const float4 b = four_samples(ground, row, column - 1);
    const float4 c = four_samples(ground, row + 1, column - 1);
    const float4 d = four_samples(ground, row + 2, column - 1);
    const float eighth = 0.125f;
    const float2 eastward = eighth * (1.0f - y) * (a.zw - a.xy) + eighth * (2.0f - y) * (b.zw - b.xy)
                          + eighth * (1.0f + y) * (c.zw - c.xy) + eighth * y * (d.zw - d.xy);
    const float4 northward = eighth * (1.0f - y) * (a - c) + eighth * y * (b - d);
    const float west_to_east = (1.0f - x) * eastward.x + x * eastward.y;
    const float south_to_north = (1.0f - x) * northward.x + (2.0f - x) * northward.y
                               + (1.0f + x) * northward.z + x * northward.w;
    return (float2)(west_to_east, south_to_north);
}

// unit normal of a surface that rises so, in 32nds, a cell
inline float3 normal_of(const Grid grid, float2 rise)
{
    float up = PART;
    float east = rise.x / grid.dx, north = rise.y / grid.dy;
    if (isinf(east) || isinf(north)) {
        // such steep slopes stay far from zero
        const float small = 0x1p-120f;
        up *= small;
        east = small * rise.x / grid.dx;
        north = small * rise.y / grid.dy;
    }
    // squares of very steep ones overflow
    const float steepest = fmax(fmax(fabs(east), fabs(north)), up);
    const float scale = steepest > 1e15f || up < PART ? 1.0f / steepest : 1.0f;
    east *= scale;
    north *= scale;
    up *= scale;
    const float inverse = 1.0f / sqrt(east * east + north * north + up * up);
    return (float3)(-east * inverse, -north * inverse, up * inverse);
}

#endif
