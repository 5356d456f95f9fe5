// Which tiles does the eye see best? A weight a tile, for any level of detail.
//
// A far ridge is small, but it stands against the sky, where every edge shows. And where ground
// turns away from the eye, its outline is what is seen of it. Distance knows neither.
//
//     picture     upward ^     . top of the tile           column by column the horizon is the
//                        |   _/ \__ horizon                highest tile centre; a tile whose
//                        | .'      \___                    centre is the horizon stands against
//                        '-------------> column            the sky in full, one whose top does
//                                                          not reach it not at all
//
//     sky     = (top - horizon) / (top - centre), from 0 to 1, at the column where it is largest
//     grazing = 1 - |view . normal|, the tile's plane seen edge on
//     weight  = (1 + (horizon weight - 1) sky) (1 + (silhouette weight - 1) grazing)
//
// A weight is a function of the tile alone, so both sides of an edge know the same.
#include "common/frustum.h"

#if !defined(COLUMNS)
#error "weights.cl: define COLUMNS, those that the horizon is kept in"
#endif

// a tile in the picture: tangents, or distances across where the camera is parallel
typedef struct {
    int first, last;            // columns; empty where first > last
    float centre, top;          // how far up
} Seen;

inline float3 from_eye(const View view, float3 point)
{
    const float x = point.x - view.eye[0], y = point.y - view.eye[1], z = point.z - view.eye[2];
    return (float3)(x * view.axes[0][0] + y * view.axes[0][1] + z * view.axes[0][2],
                    x * view.axes[1][0] + y * view.axes[1][1] + z * view.axes[1][2],
                    x * view.axes[2][0] + y * view.axes[2][1] + z * view.axes[2][2]);
}

inline float3 centre_of(Box box, float height)
{
    return (float3)(0.5f * (box.low.x + box.high.x), 0.5f * (box.low.y + box.high.y), height);
}

// Tiles that reach the near plane, or stand beside the picture, are in no column.
inline Seen look_at_tile(Box box, float height, const View view, float reach)
{
    Seen seen = {0, -1, 0.0f, -INFINITY};
    const float3 centre = from_eye(view, centre_of(box, height));
    float left = INFINITY, right = -INFINITY, nearest = centre.z;
    for (int corner = 0; corner < 4; ++corner) {
        const float3 point =
            from_eye(view, (float3)(corner & 1 ? box.high.x : box.low.x,
                                    corner & 2 ? box.high.y : box.low.y, box.high.z));
        const float scale = view.parallel ? 1.0f : point.z;
        nearest = fmin(nearest, point.z);
        left = fmin(left, point.x / scale);
        right = fmax(right, point.x / scale);
        seen.top = fmax(seen.top, point.y / scale);
    }
    if (!(nearest > view.near) || right < -reach || left > reach)
        return seen;
    seen.centre = centre.y / (view.parallel ? 1.0f : centre.z);
    const float per_column = COLUMNS / (2.0f * reach);
    seen.first = clamp((int)((fmax(left, -reach) + reach) * per_column), 0, COLUMNS - 1);
    seen.last = clamp((int)((fmin(right, reach) + reach) * per_column), 0, COLUMNS - 1);
    return seen;
}

// whole numbers in the order of floats; 0 stands for none
inline uint key_of(float value)
{
    const uint bits = as_uint(value);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

inline float value_of(uint key)
{
    return as_float(key & 0x80000000u ? key & 0x7fffffffu : ~key);
}

__kernel void horizon(const Grid grid, const View view, const float reach,
                      __global const float4 *planes,        // (P,) .w: height at the centre
                      __global const float4 *details,       // (P,)
                      volatile __global uint *keys)         // (COLUMNS,) 0 before
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid) || isnan(details[patch].y))
        return;
    const Box box = tile_box(grid, tile_at(grid, patch), details[patch].y, details[patch].z);
    const Seen seen = look_at_tile(box, planes[patch].w, view, reach);
    for (int column = seen.first; column <= seen.last; ++column)
        atomic_max(keys + column, key_of(seen.centre));
}

inline float share_of_sky(const Seen seen, __global const uint *keys)
{
    float lowest = INFINITY;
    for (int column = seen.first; column <= seen.last; ++column)
        lowest = fmin(lowest, value_of(keys[column]));
    const float relief = fmax(seen.top - seen.centre, 1e-9f);
    return fmin(fmax((seen.top - lowest) / relief, 0.0f), 1.0f);
}

// 1 where the tile's plane is seen edge on, 0 where it is seen from straight above it
inline float grazing(Box box, float4 plane, const View view)
{
    const float3 centre = centre_of(box, plane.w);
    float3 way = (float3)(view.axes[2][0], view.axes[2][1], view.axes[2][2]);
    if (!view.parallel)
        way = centre - (float3)(view.eye[0], view.eye[1], view.eye[2]);
    const float length = fmax(sqrt(way.x * way.x + way.y * way.y + way.z * way.z), 1e-30f);
    const float along = (way.x * plane.x + way.y * plane.y + way.z * plane.z) / length;
    return 1.0f - fmin(fabs(along), 1.0f);
}

__kernel void weigh(const Grid grid, const View view, const float reach,
                    const float horizon_weight, const float silhouette_weight,
                    __global const float4 *planes,      // (P,)
                    __global const float4 *details,     // (P,)
                    __global const uint *keys,          // (COLUMNS,) of the horizon
                    __global float *weights)            // (P,)
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid))
        return;
    float weight = 1.0f;
    if (!isnan(details[patch].y)) {
        const Box box = tile_box(grid, tile_at(grid, patch), details[patch].y, details[patch].z);
        const Seen seen = look_at_tile(box, planes[patch].w, view, reach);
        if (seen.first <= seen.last)
            weight += (horizon_weight - 1.0f) * share_of_sky(seen, keys);
        weight *= 1.0f + (silhouette_weight - 1.0f) * grazing(box, planes[patch], view);
    }
    weights[patch] = weight;
}
