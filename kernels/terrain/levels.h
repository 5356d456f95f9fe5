// The levels of the error ladder. Built with: LEVELS, along u and along v.
#ifndef LEVELS_H
#define LEVELS_H

#include "common/common.h"

// the factor of a level: 1, 3, 5, ...; a tile of fewer cells stops at its cells
inline int factor_of(int level, int cells)
{
    const int factor = 2 * level + 1;
    return factor < cells ? factor : cells;
}

// the level whose factor is the tile's cells
inline int2 full_level(Tile tile)
{
    return min((int2)(tile.cells_across / 2, tile.cells_down / 2), (int2)(LEVELS - 1));
}

// The cheapest level pair whose error is within `error`, or the full one. Triangles go about with the
// product of the factors.
inline int2 cheapest_level(__global const float *errors, float error, int2 full)
{
    int2 best = full;
    int cost = INT_MAX;
    for (int v = 0; v <= full.y; ++v)
        for (int u = 0; u <= full.x; ++u) {
            const int price = (2 * u + 1) * (2 * v + 1);
            if (price < cost && errors[v * LEVELS + u] <= error) {
                cost = price;
                best = (int2)(u, v);
            }
        }
    return best;
}

#endif
