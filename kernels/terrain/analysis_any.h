// The analysis of any tile: small ones, tiles with holes, heights near the ends of float's range.
//
// Four passes over the samples, each down the columns and then across them. A work-group shares them.
#ifndef ANALYSIS_ANY_H
#define ANALYSIS_ANY_H

// the samples of one tile, and how they are scaled
typedef struct {
    TileSamples at;
    int rows, columns;
    float centre_x, centre_y;       // of the tile, in cells
    float scale, reference;
} Samples;

inline bool has_data(const Samples tile, int row, int column)
{
#if MASKED
    return !tile.at.holes[(size_t)row * tile.at.stride + column];
#else
    return true;
#endif
}

inline float height_at(const Samples tile, int row, int column)
{
    return tile.at.heights[(size_t)row * tile.at.stride + column];
}

inline float scaled_height(const Samples tile, int row, int column)
{
    return height_at(tile, row, column) * tile.scale - tile.reference;
}

#define NO_MOMENTS                                                                                 \
    ((Moments){0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, INFINITY, -INFINITY})

#define FOR_EACH_SAMPLE(tile, column, row)                                                         \
    for (int row = 0; row < tile.rows; ++row)                                                      \
        if (has_data(tile, row, column))

inline Moments range_of_column(const Samples tile, int column)
{
    Moments m = NO_MOMENTS;
    FOR_EACH_SAMPLE(tile, column, row) {
        m.low = fmin(m.low, height_at(tile, row, column));
        m.high = fmax(m.high, height_at(tile, row, column));
    }
    return m;
}

inline Moments sums_of_column(const Samples tile, int column)
{
    Moments m = NO_MOMENTS;
    FOR_EACH_SAMPLE(tile, column, row) {
        m.count += 1.0f;
        m.x += column - tile.centre_x;
        m.y += row - tile.centre_y;
        m.z += scaled_height(tile, row, column);
    }
    return m;
}

inline Moments products_of_column(const Samples tile, int column, const Moments means)
{
    Moments m = NO_MOMENTS;
    const float x = column - tile.centre_x - means.x;
    FOR_EACH_SAMPLE(tile, column, row) {
        const float y = row - tile.centre_y - means.y;
        const float z = scaled_height(tile, row, column) - means.z;
        m.xx += x * x;
        m.xy += x * y;
        m.yy += y * y;
        m.xz += x * z;
        m.yz += y * z;
    }
    return m;
}

inline Moments squares_of_column(const Samples tile, int column, const Plane plane)
{
    Moments m = NO_MOMENTS;
    const float along = plane.height + plane.slope_x * (column - tile.centre_x);
    FOR_EACH_SAMPLE(tile, column, row) {
        const float on_plane = along + plane.slope_y * (row - tile.centre_y);
        const float residual = scaled_height(tile, row, column) - on_plane;
        m.zz += residual * residual;
    }
    return m;
}

inline Moments fold_moments(__local Moments *columns)
{
    for (int half_size = COLUMNS / 2; half_size > 0; half_size /= 2) {
        WAIT_FOR_GROUP();
        for (int i = get_local_id(0); i < half_size; i += GROUP) {
            Moments m = columns[i];
            const Moments other = columns[i + half_size];
            m.count += other.count;
            m.x += other.x;
            m.y += other.y;
            m.z += other.z;
            m.xx += other.xx;
            m.xy += other.xy;
            m.yy += other.yy;
            m.xz += other.xz;
            m.yz += other.yz;
            m.zz += other.zz;
            m.low = fmin(m.low, other.low);
            m.high = fmax(m.high, other.high);
            columns[i] = m;
        }
    }
    WAIT_FOR_GROUP();
    const Moments folded = columns[0];
    WAIT_FOR_GROUP();
    return folded;
}

// what all columns add up to, each of which adds up to of_column
#define ADD_UP(result, columns, tile, of_column)                                                   \
    for (int column = get_local_id(0); column < COLUMNS; column += GROUP)                          \
        columns[column] = column < tile.columns ? of_column : NO_MOMENTS;                          \
    const Moments result = fold_moments(columns)

// phase 3: minimise S (z - height - slope_x x - slope_y y)^2
inline Plane least_squares_plane(const Moments means, const Moments m)
{
    const float determinant = m.xx * m.yy - m.xy * m.xy;
    float slope_x, slope_y;
    if (determinant > 1e-6f * m.xx * m.yy) {
        slope_x = (m.xz * m.yy - m.yz * m.xy) / determinant;
        slope_y = (m.yz * m.xx - m.xz * m.xy) / determinant;
    } else {
        // samples on one line, or one sample: of the planes through them the flattest
        const float spread = fmax(m.xx + m.yy, FLT_MIN);
        slope_x = m.xz / spread;
        slope_y = m.yz / spread;
    }
    const Plane plane = {means.z - slope_x * means.x - slope_y * means.y, slope_x, slope_y};
    return plane;
}

// Every work-item of the group calls this together.
inline void fit_any_tile(const Ground ground, int number, __local Fits *fits,
                         __local TileStore *store, __local Moments *columns)
{
    const Tile cells = tile_at(ground.grid, number);
    Samples tile = {tile_samples(ground, cells, store), cells.cells_down + 1,
                    cells.cells_across + 1, 0.5f * cells.cells_across, 0.5f * cells.cells_down,
                    1.0f, 0.0f};
    // phase 1: the lowest sample, and a power of two that brings the range near 1
    ADD_UP(range, columns, tile, range_of_column(tile, column));
    // halves: the range of float itself does not fit in a float
    const float half_range = 0.5f * range.high - 0.5f * range.low;
    if (half_range > 0.0f && half_range < INFINITY)
        tile.scale = ldexp(1.0f, clamp(-ilogb(half_range), -126, 126));
    tile.reference = isinf(range.low) ? 0.0f : range.low * tile.scale;
    // phase 2, in two passes: means first, then products about them
    ADD_UP(sums, columns, tile, sums_of_column(tile, column));
    const float divisor = fmax(sums.count, 1.0f);
    Moments means = sums;
    means.x /= divisor;
    means.y /= divisor;
    means.z /= divisor;
    ADD_UP(products, columns, tile, products_of_column(tile, column, means));
    Plane plane = least_squares_plane(means, products);
#if CORNERS
    // a corner without data has no normal: such a tile keeps the least-squares plane
    if (sums.count == tile.rows * tile.columns) {
        const int bottom = tile.rows - 1, right = tile.columns - 1;
        const float4 corners = (float4)(height_at(tile, 0, 0), height_at(tile, 0, right),
                                        height_at(tile, bottom, 0), height_at(tile, bottom, right));
        plane = corner_plane(corners * tile.scale, tile.scale, right, bottom, ground.grid, means.z);
    }
#endif
    ADD_UP(residuals, columns, tile, squares_of_column(tile, column, plane));
    if (get_local_id(0) == 0) {
        const Fit found = {plane, residuals.zz, range.low, range.high, sums.count, tile.scale,
                           tile.reference};
        keep_fit(found, tile.rows * tile.columns, fits, 0);
        fits->tile[0] = number;
    }
    WAIT_FOR_GROUP();
}

#endif
