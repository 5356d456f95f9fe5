// The analysis of an ordinary full tile on a CPU: a row is BLOCKS blocks of eight lanes.
//
//   row 0   z z z z z z z z | z z z z z z z z     lanes of all rows are added up, plain and
//   row 1   z z z z z z z z | z z z z z z z z     weighted by y; what is left to do across
//   ...     | | | | | | | |   | | | | | | | |     lanes is done once a tile
//   sums    s s s s s s s s | s s s s s s s s
//
// A row that eight does not divide has its last block moved back over lanes that are counted
// already, where it weighs nothing; one of less than eight repeats its first sample, weightless too. Calls of library functions stop PoCL's compiler from keeping
// lanes in registers: there are none inside the loops.
#ifndef ANALYSIS_ROWS_H
#define ANALYSIS_ROWS_H

#define WIDTH (TILE + 1)
#define BLOCKS ((WIDTH + 7) / 8)

// eight floats at any address
typedef float8 Lanes __attribute__((aligned(4)));

#define LANE_NUMBERS ((Lanes)(0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f))
#define SMALLER(a, b) ((a) < (b) ? (a) : (b))
#define LARGER(a, b) ((a) > (b) ? (a) : (b))

#define DEFINE_FOLD(name, fold)                                                                    \
    inline float name(Lanes lanes)                                                                 \
    {                                                                                              \
        const float4 four = fold(lanes.lo, lanes.hi);                                              \
        const float2 two = fold(four.lo, four.hi);                                                 \
        return fold(two.x, two.y);                                                                 \
    }

DEFINE_FOLD(sum_of_lanes, ADD)
DEFINE_FOLD(smallest_lane, SMALLER)
DEFINE_FOLD(largest_lane, LARGER)

// first column of a block
inline int block_column(int block)
{
    return WIDTH < 8 ? 0 : SMALLER(8 * block, WIDTH - 8);
}

inline Lanes block_of_row(const Samples tile, int row, int block)
{
    TILE_MEMORY const float *heights = tile.heights + (size_t)row * tile.stride + block_column(block);
#if WIDTH < 8
    Lanes lanes = heights[0];
    for (int lane = 1; lane < WIDTH; ++lane)
        ((float *)&lanes)[lane] = heights[lane];
    return lanes;
#else
    return *(TILE_MEMORY const Lanes *)heights;
#endif
}

// 1 in lanes that no earlier block holds
inline Lanes block_weight(int block)
{
#if WIDTH < 8
    return LANE_NUMBERS < (float)WIDTH ? (Lanes)1.0f : (Lanes)0.0f;
#elif WIDTH % 8 == 0
    return (Lanes)1.0f;
#else
    return LANE_NUMBERS + block_column(block) < (float)(8 * block) ? (Lanes)0.0f : (Lanes)1.0f;
#endif
}

// x of each lane, from the tile's centre
inline Lanes block_x(int block)
{
    return LANE_NUMBERS + (block_column(block) - 0.5f * TILE);
}

// phase 1: the mean of the corners
inline float corner_mean(const Samples tile)
{
    return 0.25f * (height_at(tile, 0, 0) + height_at(tile, 0, TILE))
         + 0.25f * (height_at(tile, TILE, 0) + height_at(tile, TILE, TILE));
}

// phase 2; on a full lattice the mean position is the centre and Sxy = 0: one pass gives all
inline Moments moments_of_rows(const Samples tile)
{
    Lanes sum[BLOCKS] = {0.0f}, moment = 0.0f, low = INFINITY, high = -INFINITY;
    for (int row = 0; row < WIDTH; ++row) {
        Lanes row_sum = 0.0f;
#pragma unroll
        for (int block = 0; block < BLOCKS; ++block) {
            const Lanes height = block_of_row(tile, row, block);
            const Lanes z = (height - tile.reference) * block_weight(block);
            low = SMALLER(height, low);
            high = LARGER(height, high);
            sum[block] += z;
            row_sum += z;
        }
        moment += (row - 0.5f * TILE) * row_sum;
    }
    Lanes total = 0.0f, weighted = 0.0f;
#pragma unroll
    for (int block = 0; block < BLOCKS; ++block) {
        total += sum[block];
        weighted += block_x(block) * sum[block];
    }
    // WIDTH rows of S (x - mean)^2 = n (n^2 - 1) / 12
    const float spread = (float)WIDTH * WIDTH * (WIDTH * WIDTH - 1) / 12.0f;
    const Moments m = {WIDTH * WIDTH, 0.0f, 0.0f, sum_of_lanes(total) / (WIDTH * WIDTH),
                       spread, 0.0f, spread, sum_of_lanes(weighted), sum_of_lanes(moment),
                       smallest_lane(low), largest_lane(high)};
    return m;
}

inline bool is_whole(const Samples tile)
{
    uchar holes = 0;
#if MASKED
    for (int row = 0; row < tile.rows; ++row)
        for (int column = 0; column < tile.columns; ++column)
            holes |= tile.holes[(size_t)row * tile.stride + column];
#endif
    return !holes;
}

// Find the moments of a full tile whose squares float can hold; false sends others round.
inline bool is_ordinary_tile(Samples *tile, Moments *moments, __local float *scratch)
{
    if (tile->rows != WIDTH || tile->columns != WIDTH || !is_whole(*tile))
        return false;
    tile->reference = corner_mean(*tile);
    *moments = moments_of_rows(*tile);
    const float range = moments->high - moments->low;
    return range == 0.0f || (range > 1e-15f && range < 1e15f);
}

// phase 4
inline float squared_residuals_of_rows(const Samples tile, const Plane plane,
                                       __local float *scratch)
{
    Lanes sum = 0.0f, along[BLOCKS];
#pragma unroll
    for (int block = 0; block < BLOCKS; ++block)
        along[block] = plane.slope_x * block_x(block);
    for (int row = 0; row < WIDTH; ++row) {
        const float down = plane.height + plane.slope_y * (row - 0.5f * TILE);
#pragma unroll
        for (int block = 0; block < BLOCKS; ++block) {
            const Lanes z = block_of_row(tile, row, block) - tile.reference;
            const Lanes residual = (z - (along[block] + down)) * block_weight(block);
            sum += residual * residual;
        }
    }
    return sum_of_lanes(sum);
}

#endif
