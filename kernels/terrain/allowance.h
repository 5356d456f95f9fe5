// The error that a node of the quadtree may have in a mesh.
#ifndef ALLOWANCE_H
#define ALLOWANCE_H

#include "terrain/node.h"
#include "terrain/screen.h"

#define ALLOWANCE_ARGUMENTS                                                                        \
    const View view, const int cull, const float metres, const float pixels,    /* INFINITY where not */ \
    const int is_weighted,                                                      /* asked for */    \
    __global const float *weights,              /* (N,) that errors count, where so */             \
    const float hysteresis,
#define ALLOWANCE {view, cull, metres, pixels, is_weighted, weights, hysteresis}

typedef struct {
    View view;
    int cull;
    float metres, pixels;
    int is_weighted;
    __global const float *weights;
    float hysteresis;
} Allowance;

inline float weight_of(const Allowance allowance, int index)
{
    return allowance.is_weighted ? allowance.weights[index] : 1.0f;
}

// NaN where a node is out of view, or has no data.
inline float allowed_of(const Grid grid, const Allowance allowance, const Tile tile, float4 known, int index)
{
    const float minimum = known.y, maximum = known.z, weight = weight_of(allowance, index);
    if (isnan(minimum) || (allowance.cull && is_out_of_view(grid, tile, allowance.view, minimum, maximum)))
        return NAN;
    float error = allowance.metres / weight;
    if (!isinf(allowance.pixels))
        error = fmin(error, metres_for_pixels(allowance.view, tile_box(grid, tile, minimum, maximum),
                                              allowance.pixels / weight));
    // a dozen roundings of differences of heights, here and wherever else it is measured
    return fmax(error - 1e-6f * (maximum - minimum), 0.0f);
}

// What a node is held to: what it was held to before, in the last mesh, as long as what it is allowed is within
// a band above that. Else what it is allowed is to stand in the middle of a new band, so that a little more or
// less changes nothing.
inline float held_to(const Allowance allowance, float allowed, float before)
{
    const float band = 1.0f + allowance.hysteresis;
    if (allowance.hysteresis == 0.0f || (before <= allowed && allowed <= before * band))
        return allowance.hysteresis == 0.0f ? allowed : before;
    return allowed / sqrt(band);
}

#endif
