// The analysis of any tile: small ones, tiles with holes, heights near the ends of float's range.
// Three passes over the samples, each shared by the work-group.
#ifndef ANALYSIS_ANY_H
#define ANALYSIS_ANY_H

inline bool has_data(const Samples tile, int row, int column)
{
#if MASKED
    return !tile.holes[(size_t)row * tile.stride + column];
#else
    return true;
#endif
}

// every GROUP-th sample that has data
#define FOR_EACH_SAMPLE(tile, row, column)                                                         \
    for (int i = get_local_id(0), row, column; i < tile.rows * tile.columns; i += GROUP)           \
        if (row = i / tile.columns, column = i % tile.columns, has_data(tile, row, column))

inline float scaled_height(const Samples tile, int row, int column)
{
    return height_at(tile, row, column) * tile.scale - tile.reference;
}

// phase 1: the lowest sample, and a power of two that brings the range near 1
inline void scale_samples(Samples *tile, __local float *scratch)
{
    const Samples samples = *tile;
    float low = INFINITY, high = -INFINITY;
    FOR_EACH_SAMPLE(samples, row, column) {
        const float height = height_at(samples, row, column);
        low = fmin(low, height);
        high = fmax(high, height);
    }
    low = group_min(low, scratch);
    high = group_max(high, scratch);
    // halves: the range of float itself does not fit in a float
    const float half_range = 0.5f * high - 0.5f * low;
    if (half_range > 0.0f && half_range < INFINITY)
        tile->scale = ldexp(1.0f, clamp(-ilogb(half_range), -126, 126));
    tile->reference = isinf(low) ? 0.0f : low * tile->scale;
}

// phase 2, in two passes: means first, then products about them
inline Moments moments_of_samples(const Samples tile, __local float *scratch)
{
    Moments m = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, INFINITY, -INFINITY};
    FOR_EACH_SAMPLE(tile, row, column) {
        const float height = height_at(tile, row, column);
        m.count += 1.0f;
        m.x += column - tile.centre_x;
        m.y += row - tile.centre_y;
        m.z += scaled_height(tile, row, column);
        m.low = fmin(m.low, height);
        m.high = fmax(m.high, height);
    }
    m.count = group_sum(m.count, scratch);
    const float divisor = fmax(m.count, 1.0f);
    m.x = group_sum(m.x, scratch) / divisor;
    m.y = group_sum(m.y, scratch) / divisor;
    m.z = group_sum(m.z, scratch) / divisor;
    m.low = group_min(m.low, scratch);
    m.high = group_max(m.high, scratch);

    FOR_EACH_SAMPLE(tile, row, column) {
        const float x = column - tile.centre_x - m.x;
        const float y = row - tile.centre_y - m.y;
        const float z = scaled_height(tile, row, column) - m.z;
        m.xx += x * x;
        m.xy += x * y;
        m.yy += y * y;
        m.xz += x * z;
        m.yz += y * z;
    }
    m.xx = group_sum(m.xx, scratch);
    m.xy = group_sum(m.xy, scratch);
    m.yy = group_sum(m.yy, scratch);
    m.xz = group_sum(m.xz, scratch);
    m.yz = group_sum(m.yz, scratch);
    return m;
}

// phase 4
inline float squared_residuals_of_samples(const Samples tile, const Plane plane,
                                          __local float *scratch)
{
    float sum = 0.0f;
    FOR_EACH_SAMPLE(tile, row, column) {
        const float on_plane = plane.height + plane.slope_x * (column - tile.centre_x)
                             + plane.slope_y * (row - tile.centre_y);
        const float residual = scaled_height(tile, row, column) - on_plane;
        sum += residual * residual;
    }
    return group_sum(sum, scratch);
}

#endif
