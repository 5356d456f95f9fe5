// The ground's gradient at a sample, by a Sobel operator in metres.
//
//        1  0 -1            1  2  1       differences across two cells, the middle one
//   x    2  0 -2       y    0  0  0       weighted double, divided by the metres between
//        1  0 -1           -1 -2 -1       them: exact on every plane
//
// At the border and beside holes a difference is taken to the sample itself, one-sided, and still
// exact on a plane. (The book's listing 9.9 has neither spacing nor a true third component.)
#ifndef GRADIENT_H
#define GRADIENT_H

#include "common.h"

typedef struct {
    Grid grid;
    __global const float *heights;
    __global const uchar *holes;
} Ground;

inline float sample_height(const Ground ground, int row, int column)
{
    return ground.heights[sample_index(ground.grid, row, column)];
}

inline int inside_range(int value, int end)
{
    return value < 0 ? 0 : value >= end ? end - 1 : value;
}

#if MASKED

inline bool has_sample(const Ground ground, int row, int column)
{
    return row >= 0 && row < ground.grid.rows && column >= 0 && column < ground.grid.columns
        && !ground.holes[sample_index(ground.grid, row, column)];
}

// Add a weighted difference a cell along (row_step, column_step) at one sample.
inline void add_difference(const Ground ground, int row, int column, int row_step, int column_step,
                           float weight, float *sum, float *weights)
{
    int ahead = has_sample(ground, row + row_step, column + column_step);
    int behind = has_sample(ground, row - row_step, column - column_step);
    if (!ahead + !behind > 0 && !has_sample(ground, row, column))
        return;
    if (ahead + behind == 0)
        return;
    const float difference =
        sample_height(ground, row + ahead * row_step, column + ahead * column_step)
        - sample_height(ground, row - behind * row_step, column - behind * column_step);
    *sum += weight * difference / (ahead + behind);
    *weights += weight;
}

inline float2 sample_gradient(const Ground ground, int row, int column)
{
    float east = 0.0f, south = 0.0f, east_weights = 0.0f, south_weights = 0.0f;
    for (int step = -1; step <= 1; ++step) {
        const float weight = step == 0 ? 2.0f : 1.0f;
        if (row + step >= 0 && row + step < ground.grid.rows)
            add_difference(ground, row + step, column, 0, 1, weight, &east, &east_weights);
        if (column + step >= 0 && column + step < ground.grid.columns)
            add_difference(ground, row, column + step, 1, 0, weight, &south, &south_weights);
    }
    return (float2)(east_weights > 0.0f ? east / (east_weights * ground.grid.dx) : 0.0f,
                    south_weights > 0.0f ? -south / (south_weights * ground.grid.dy) : 0.0f);
}

#else

// rise a metre to the east and to the north
inline float2 sample_gradient(const Ground ground, int row, int column)
{
    const Grid grid = ground.grid;
    const int above = inside_range(row - 1, grid.rows), below = inside_range(row + 1, grid.rows);
    const int left = inside_range(column - 1, grid.columns);
    const int right = inside_range(column + 1, grid.columns);
    __global const float *north = ground.heights + sample_index(grid, above, 0);
    __global const float *middle = ground.heights + sample_index(grid, row, 0);
    __global const float *south = ground.heights + sample_index(grid, below, 0);
    const float west_to_east = (north[right] - north[left]) + 2.0f * (middle[right] - middle[left])
                             + (south[right] - south[left]);
    const float south_to_north = (north[left] - south[left])
                               + 2.0f * (north[column] - south[column])
                               + (north[right] - south[right]);
    return (float2)(west_to_east / (4 * (right - left) * grid.dx),
                    south_to_north / (4 * (below - above) * grid.dy));
}

#endif

// unit normal of a surface with this gradient
inline float3 normal_of(float2 gradient)
{
    const float x = gradient.x < 0.0f ? -gradient.x : gradient.x;
    const float y = gradient.y < 0.0f ? -gradient.y : gradient.y;
    // squares of very steep gradients overflow
    const float steepest = x > y ? x : y;
    const float scale = steepest > 1e15f ? 1.0f / steepest : 1.0f;
    const float east = -gradient.x * scale, north = -gradient.y * scale;
    const float length = sqrt(east * east + north * north + scale * scale);
    return (float3)(east / length, north / length, scale / length);
}

#endif
