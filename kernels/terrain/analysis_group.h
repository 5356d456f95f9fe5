// The analysis of an ordinary full tile by a work-group: GROUP items share its samples.
//
// Every size is a constant here, so rows and columns cost no division, and the five sums fold
// together, one barrier a level for all.
#ifndef ANALYSIS_GROUP_H
#define ANALYSIS_GROUP_H

#define WIDTH (TILE + 1)

// sums of z, x z and y z; lowest and highest sample; whether all have data
typedef struct {
    float z, xz, yz, low, high, whole;
} Share;

inline Share fold_shares(Share own, __local Share *shares)
{
    const int item = get_local_id(0);
    shares[item] = own;
    for (int half_size = GROUP / 2; half_size > 0; half_size /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item < half_size) {
            const Share other = shares[item + half_size];
            own.z += other.z;
            own.xz += other.xz;
            own.yz += other.yz;
            own.low = fmin(own.low, other.low);
            own.high = fmax(own.high, other.high);
            own.whole = fmin(own.whole, other.whole);
            shares[item] = own;
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const Share folded = shares[0];
    barrier(CLK_LOCAL_MEM_FENCE);
    return folded;
}

// phase 1: the mean of the corners
inline float corner_mean(const Samples tile)
{
    return 0.25f * (height_at(tile, 0, 0) + height_at(tile, 0, TILE))
         + 0.25f * (height_at(tile, TILE, 0) + height_at(tile, TILE, TILE));
}

// Find the moments of a full tile whose squares float can hold; false sends others round.
inline bool is_ordinary_tile(Samples *tile, Moments *moments, __local float *scratch)
{
    if (tile->rows != WIDTH || tile->columns != WIDTH)
        return false;
    tile->reference = corner_mean(*tile);
    Share share = {0.0f, 0.0f, 0.0f, INFINITY, -INFINITY, 1.0f};
    for (int i = get_local_id(0); i < WIDTH * WIDTH; i += GROUP) {
        const int row = i / WIDTH, column = i % WIDTH;
        const float height = height_at(*tile, row, column), z = height - tile->reference;
        share.z += z;
        share.xz += (column - 0.5f * TILE) * z;
        share.yz += (row - 0.5f * TILE) * z;
        share.low = fmin(share.low, height);
        share.high = fmax(share.high, height);
#if MASKED
        if (tile->holes[(size_t)row * tile->stride + column])
            share.whole = 0.0f;
#endif
    }
    share = fold_shares(share, (__local Share *)scratch);
    // on a full lattice the mean position is the centre and Sxy = 0;
    // WIDTH rows of S (x - mean)^2 = n (n^2 - 1) / 12
    const float spread = (float)WIDTH * WIDTH * (WIDTH * WIDTH - 1) / 12.0f;
    const Moments m = {WIDTH * WIDTH, 0.0f, 0.0f, share.z / (WIDTH * WIDTH), spread, 0.0f, spread,
                       share.xz, share.yz, share.low, share.high};
    *moments = m;
    const float range = share.high - share.low;
    return share.whole > 0.0f && (range == 0.0f || (range > 1e-15f && range < 1e15f));
}

// phase 4
inline float squared_residuals_of_rows(const Samples tile, const Plane plane,
                                       __local float *scratch)
{
    float sum = 0.0f;
    for (int i = get_local_id(0); i < WIDTH * WIDTH; i += GROUP) {
        const int row = i / WIDTH, column = i % WIDTH;
        const float on_plane = plane.height + plane.slope_x * (column - 0.5f * TILE)
                             + plane.slope_y * (row - 0.5f * TILE);
        const float residual = height_at(tile, row, column) - tile.reference - on_plane;
        sum += residual * residual;
    }
    return group_sum(sum, scratch);
}

#endif
