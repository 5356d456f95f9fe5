// Patches that are the tiles of a grid, one by one, at factors of any partitioning.
#ifndef PATCH_TILES_H
#define PATCH_TILES_H

#include "terrain/ground.h"

#define FINEST 0        // levels at which every sample is looked at, beyond the first

// what kernels are given beside the grid
#define PATCH_ARGUMENTS
#define PATCH_SET {0}

typedef struct {
    int nothing;
} PatchSet;

typedef struct {
    Tile tile;
    int stride;             // between the samples that it is measured at
    Ruler across, down;
} Placing;

// the number that a patch has among tiles, or nodes
inline int number_of(const PatchSet set, int patch)
{
    return patch;
}

inline Placing placing_of(const Grid grid, const PatchSet set, int patch)
{
    const Tile tile = tile_at(grid, patch);
    const Placing placing = {tile, 1, ruler_of(tile.cells_across), ruler_of(tile.cells_down)};
    return placing;
}

// where a point of the pattern lies, in 1/65536 of a cell from the first sample
inline int2 place_of(const Placing placing, uint2 point)
{
    return (int2)(cell_offset(placing.across, point.x), cell_offset(placing.down, point.y));
}

// points of tiles stand on the ground
inline float lifted(const PatchSet set, uint point, float height)
{
    return height;
}

#endif
