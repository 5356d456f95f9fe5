// The analysis of ordinary full tiles on a CPU: a row is BLOCKS blocks of eight columns.
//
// A row that eight does not divide has its last block moved back over columns that others hold, too;
// what it finds of those is the same. A row of less than eight has lanes without a column: they repeat
// the tile's first sample, and count for nothing. Calls of library functions stop PoCL's compiler from
// keeping lanes in registers: there are none inside the loops. Rows of a large raster lie a power of two
// apart, where a cache has few places: heights are read once, and kept for the second pass.
#ifndef ANALYSIS_LANES_H
#define ANALYSIS_LANES_H

typedef float8 Lanes __attribute__((aligned(4)));     // at any address

#define BLOCKS ((WIDTH + 7) / 8)
#define FIRST_COLUMN(block) (8 * (block) < WIDTH - 8 ? 8 * (block) : WIDTH < 8 ? 0 : WIDTH - 8)
#define LANE_NUMBERS ((Lanes)(0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f))

// x of a block's columns, from the tile's centre
#define BLOCK_X(block) (LANE_NUMBERS + (FIRST_COLUMN(block) - 0.5f * TILE))

// an item alone meets nobody
typedef struct {
    int nothing;
} Across;

// lanes with a column as they are, others as `nothing`
inline Lanes of_columns(Lanes lanes, Lanes nothing)
{
    return WIDTH < 8 ? LANE_NUMBERS < (float)WIDTH ? lanes : nothing : lanes;
}

// A block of a row. With less than eight columns it may reach beyond the tile, but not beyond the raster.
inline Lanes block_at(TILE_MEMORY const float *row, int block, float first, bool reaches_beyond)
{
#if WIDTH < 8
    if (reaches_beyond) {
        Lanes lanes = first;
        for (int column = 0; column < WIDTH; ++column)
            ((float *)&lanes)[column] = row[column];
        return lanes;
    }
#endif
    return of_columns(*(TILE_MEMORY const Lanes *)(row + FIRST_COLUMN(block)), (Lanes)first);
}

// what all columns add up to, halves onto halves
inline float sum_across(const Lanes *blocks)
{
#if WIDTH <= 8 || WIDTH == COLUMNS
    Lanes sums[BLOCKS];
#pragma unroll
    for (int i = 0; i < BLOCKS; ++i)
        sums[i] = of_columns(blocks[i], (Lanes)0.0f);
#pragma unroll
    for (int half_size = BLOCKS / 2; half_size > 0; half_size /= 2)
#pragma unroll
        for (int i = 0; i < half_size; ++i)
            sums[i] += sums[i + half_size];
    const float4 four = sums[0].lo + sums[0].hi;
    const float2 two = four.lo + four.hi;
    return two.x + two.y;
#else
    float columns[COLUMNS];
#pragma unroll
    for (int i = WIDTH; i < COLUMNS; ++i)
        columns[i] = 0.0f;
#pragma unroll
    for (int block = 0; block < BLOCKS; ++block)
        *(Lanes *)(columns + FIRST_COLUMN(block)) = blocks[block];
#pragma unroll
    for (int half_size = COLUMNS / 2; half_size > 0; half_size /= 2)
#pragma unroll
        for (int i = 0; i < half_size; ++i)
            columns[i] += columns[i + half_size];
    return columns[0];
#endif
}

inline float2 range_across(Lanes low, Lanes high)
{
    const float4 low4 = SMALLER(low.lo, low.hi), high4 = LARGER(high.lo, high.hi);
    const float2 low2 = SMALLER(low4.lo, low4.hi), high2 = LARGER(high4.lo, high4.hi);
    return (float2)(SMALLER(low2.x, low2.y), LARGER(high2.x, high2.y));
}

inline bool has_holes(const TileSamples at)
{
    uchar holes = 0;
#if MASKED
    for (int row = 0; row < WIDTH; ++row)
        for (int column = 0; column < WIDTH; ++column)
            holes |= at.holes[(size_t)row * at.stride + column];
#endif
    return holes;
}

// Fit a full tile; false if its heights are not ordinary.
inline bool fit_full_tile(const TileSamples at, bool reaches_beyond, const Grid grid, Fit *fit)
{
    // phase 2, down the columns: below each column's first sample
    const float reference = at.heights[0];
    Lanes below[WIDTH * BLOCKS], offset[BLOCKS], sum[BLOCKS], sums[BLOCKS];
    Lanes low = reference, high = reference;
#pragma unroll
    for (int block = 0; block < BLOCKS; ++block) {
        offset[block] = block_at(at.heights, block, reference, reaches_beyond);
        sum[block] = sums[block] = 0.0f;
    }
    TILE_MEMORY const float *heights = at.heights;
    for (int row = 0; row < WIDTH; ++row, heights += at.stride) {
#pragma unroll
        for (int block = 0; block < BLOCKS; ++block) {
            const Lanes height = block_at(heights, block, reference, reaches_beyond);
            const Lanes z = height - offset[block];
            below[row * BLOCKS + block] = z;
            low = SMALLER(height, low);
            high = LARGER(height, high);
            sum[block] += z;
            sums[block] += sum[block];
        }
    }
    const float2 range = range_across(low, high);
    if (!is_ordinary(range.x, range.y))
        return false;
    // and across them
    Lanes along[BLOCKS];
#pragma unroll
    for (int block = 0; block < BLOCKS; ++block) {
        offset[block] -= reference;
        sums[block] = MOMENT(sum[block], sums[block]);
        sum[block] += WIDTH * offset[block];
        along[block] = BLOCK_X(block) * sum[block];
    }
    Plane plane = least_squares_plane_of_full(sum_across(sum), sum_across(along),
                                              sum_across(sums));
#if CORNERS
    TILE_MEMORY const float *last = at.heights + (size_t)TILE * at.stride;
    const float4 corners = (float4)(at.heights[0], at.heights[TILE], last[0], last[TILE]);
    plane = corner_plane(corners, 1.0f, TILE, TILE, grid, plane.height);
#endif
    // phase 4
#pragma unroll
    for (int block = 0; block < BLOCKS; ++block) {
        along[block] = plane.height + plane.slope_x * BLOCK_X(block) - offset[block];
        sum[block] = 0.0f;
    }
    float y = -0.5f * TILE;
    for (int row = 0; row < WIDTH; ++row, y += 1.0f) {
        const float down = plane.slope_y * y;
#pragma unroll
        for (int block = 0; block < BLOCKS; ++block) {
            const Lanes residual = below[row * BLOCKS + block] - (along[block] + down);
            sum[block] += residual * residual;
        }
    }
    const Fit found = {plane, sum_across(sum), range.x, range.y, WIDTH * WIDTH, 1.0f, reference};
    *fit = found;
    return true;
}

// Fit the tiles of the group that are full and ordinary.
inline void fit_full_tiles(const Ground ground, __global const int *tiles, int first_tile,
                           int number, __local Fits *fits, __local TileStore *store,
                           __local Across *across)
{
    for (int i = 0; i < number; ++i) {
        const Tile cells = tile_cells(ground.grid, tiles, first_tile + i);
        fits->samples[i] = 0;
        if (cells.cells_across != TILE || cells.cells_down != TILE)
            continue;
        const TileSamples at = tile_samples(ground, cells, store);
        const size_t last = sample_index(ground.grid, cells.row + TILE, cells.column);
        const bool beyond = DETAIL || last + 8 > (size_t)ground.grid.rows * ground.grid.columns;
        Fit found;
        if (!has_holes(at) && fit_full_tile(at, beyond, ground.grid, &found))
            keep_fit(found, WIDTH * WIDTH, fits, i);
    }
}

#endif
