// The analysis of ordinary full tiles on a GPU: a work-item for each column.
//
//     tile    0 0 0 0 0 0 0 0 1 1 1 1 1 1 1 1       GROUP / COLUMNS tiles at once; neighbours in a
//     column  0 1 2 3 4 5 6 .  0 1 2 3 4 5 6 .      row of the raster are read side by side
//
// An item keeps its column's heights in registers: the second pass reads nothing.
#ifndef ANALYSIS_ITEMS_H
#define ANALYSIS_ITEMS_H

#include "common/exchange.h"

#if GROUP < COLUMNS
#error "analysis_items.h: a group needs an item for each column"
#endif

// where items meet
typedef struct {
    float scratch[GROUP];
} Across;

// what all columns of a tile add up to, halves onto halves
inline float sum_across(float value, __local float *scratch)
{
#pragma unroll
    for (int distance = COLUMNS / 2; distance > 0; distance /= 2)
        value += of_item(value, distance, scratch);
    return value;
}

// Fit the tiles of the group that are full and ordinary.
inline void fit_full_tiles(const Ground ground, __global const int *tiles, int first_tile,
                           int number, __local Fits *fits, __local TileStore *store,
                           __local Across *across)
{
    const int item = get_local_id(0), slot = item / COLUMNS, column = item % COLUMNS;
    const Tile cells = tile_cells(ground.grid, tiles, first_tile + min(slot, number - 1));
    const bool full = cells.cells_across == TILE && cells.cells_down == TILE;
    const bool counts = full && column <= TILE && slot < number;
    const float x = column - 0.5f * TILE;
    // phase 2, down the column: below its first sample
    float below[WIDTH], offset = 0.0f, reference = 0.0f, sum = 0.0f, sums = 0.0f, moment = 0.0f;
    float low = INFINITY, high = -INFINITY;
    if (counts) {
        reference = sample_height(ground, cells.row, cells.column);
#pragma unroll
        for (int row = 0; row < WIDTH; ++row)
            below[row] = sample_height(ground, cells.row + row, cells.column + column);
        const float first = below[0];
        offset = first - reference;
#pragma unroll
        for (int row = 0; row < WIDTH; ++row) {
            low = fmin(low, below[row]);
            high = fmax(high, below[row]);
#if MASKED
            if (!sample_has_data(ground, cells.row + row, cells.column + column))
                high = INFINITY;
#endif
            below[row] -= first;
            sum += below[row];
            sums += sum;
        }
        moment = MOMENT(sum, sums);
        sum += WIDTH * offset;
    }
    // and across them
#pragma unroll
    for (int distance = COLUMNS / 2; distance > 0; distance /= 2) {
        low = fmin(low, of_item(low, distance, across->scratch));
        high = fmax(high, of_item(high, distance, across->scratch));
    }
    const float along_x = sum_across(x * sum, across->scratch);
    const float along_y = sum_across(moment, across->scratch);
    sum = sum_across(sum, across->scratch);
    Plane plane = least_squares_plane_of_full(sum, along_x, along_y);
#if CORNERS
    if (full) {
        const int right = cells.column + TILE, bottom = cells.row + TILE;
        const float4 corners = (float4)(sample_height(ground, cells.row, cells.column),
                                        sample_height(ground, cells.row, right),
                                        sample_height(ground, bottom, cells.column),
                                        sample_height(ground, bottom, right));
        plane = corner_plane(corners, 1.0f, TILE, TILE, ground.grid, plane.height);
    }
#endif
    // phase 4
    float squares = 0.0f;
    if (counts) {
        const float along = plane.height + plane.slope_x * x - offset;
#pragma unroll
        for (int row = 0; row < WIDTH; ++row) {
            const float residual = below[row] - (along + plane.slope_y * (row - 0.5f * TILE));
            squares += residual * residual;
        }
    }
    squares = sum_across(squares, across->scratch);
    if (column == 0 && slot < number) {
        const Fit found = {plane, squares, low, high, WIDTH * WIDTH, 1.0f, reference};
        keep_fit(found, full && is_ordinary(low, high) ? WIDTH * WIDTH : 0, fits, slot);
    }
    WAIT_FOR_GROUP();
}

#endif
