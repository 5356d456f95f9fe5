// The error that a node of the quadtree may have in a mesh.
#ifndef ALLOWANCE_H
#define ALLOWANCE_H

#include "terrain/screen.h"

// NaN where a node is out of view, or has no data.
inline float allowed_of(const Grid grid, const View view, int cull, float metres, float pixels,
                        const Tile tile, float4 known, float weight)
{
    const float minimum = known.y, maximum = known.z;
    if (isnan(minimum) || (cull && is_out_of_view(grid, tile, view, minimum, maximum)))
        return NAN;
    float error = metres / weight;
    if (!isinf(pixels))
        error = fmin(error, metres_for_pixels(view, tile_box(grid, tile, minimum, maximum),
                                              pixels / weight));
    // a dozen roundings of differences of heights, here and wherever else it is measured
    return fmax(error - 1e-6f * (maximum - minimum), 0.0f);
}

#endif
