// What a camera can see of a tile.
#ifndef FRUSTUM_H
#define FRUSTUM_H

#include "common/common.h"

// relative to the terrain's origin and base
typedef struct {
    float3 low, high;
} Box;

inline Box tile_box(Grid grid, Tile tile, float minimum, float maximum)
{
    Box box;
    box.low = (float3)(tile.column * grid.dx, -(tile.row + tile.cells_down) * grid.dy, minimum);
    box.high = (float3)((tile.column + tile.cells_across) * grid.dx, -tile.row * grid.dy, maximum);
    return box;
}

// Return true where the box is outside one plane for certain. Rounding is on the patch's side:
// each product and sum below is right to within a few 2^-24 of its largest term.
inline bool outside_frustum(const View view, float3 low, float3 high)
{
    bool outside = false;
    for (int i = 0; i < FRUSTUM_PLANES; ++i) {
        const float x = view.planes[i][0] * (view.planes[i][0] > 0.0f ? high.x : low.x);
        const float y = view.planes[i][1] * (view.planes[i][1] > 0.0f ? high.y : low.y);
        const float z = view.planes[i][2] * (view.planes[i][2] > 0.0f ? high.z : low.z);
        const float w = view.planes[i][3];
        const float slack = 1e-6f * (fabs(x) + fabs(y) + fabs(z) + fabs(w));
        outside |= x + y + z + w < -slack;
    }
    return outside;
}

// Is a tile out of view, between these heights?
inline bool is_out_of_view(Grid grid, Tile tile, const View view, float minimum, float maximum)
{
    const Box box = tile_box(grid, tile, minimum, maximum);
    return outside_frustum(view, box.low, box.high);
}

#endif
