// The samples of one tile, side by side in memory, for loops that go over them again and again.
//
// Without detail they are there already: rows of the raster. Ground with detail is stored nowhere;
// there a work-group finds a tile's samples once and keeps them in local memory meanwhile.
//
// Built with: TILE cells, FINEST (patches are up to 2^FINEST tiles wide; 0 if not given), GROUP work-items, what ground.h
// is built with.
#ifndef TILE_SAMPLES_H
#define TILE_SAMPLES_H

#include "terrain/ground.h"

#ifndef FINEST
#define FINEST 0
#endif

#if DETAIL
#define TILE_MEMORY __local
#define STORE_WIDTH ((TILE << FINEST) + 1)
#define STORE_SIZE (STORE_WIDTH * STORE_WIDTH)
#else
#define TILE_MEMORY __global
#define STORE_SIZE 1
#endif

// what a kernel declares for them
typedef struct {
    float heights[STORE_SIZE];
    uchar holes[STORE_SIZE];
} TileStore;

typedef struct {
    TILE_MEMORY const float *heights;   // of the tile's first sample
    TILE_MEMORY const uchar *holes;     // where MASKED
    int stride;                         // from row to row
    int readable;                       // columns of every row
} TileSamples;

// a group of one has nobody to wait for
#if GROUP == 1
#define WAIT_FOR_GROUP()
#else
#define WAIT_FOR_GROUP() barrier(CLK_LOCAL_MEM_FENCE)
#endif

// Every work-item of the group calls this together.
inline TileSamples tile_samples(const Ground ground, const Tile tile, __local TileStore *store)
{
#if DETAIL
    // the samples of the tile before have all been read
    WAIT_FOR_GROUP();
    for (int row = 0; row <= tile.cells_down; ++row)
        for (int column = get_local_id(0); column <= tile.cells_across; column += GROUP) {
            const int i = row * STORE_WIDTH + column;
            store->heights[i] = sample_height(ground, tile.row + row, tile.column + column);
            store->holes[i] = !sample_has_data(ground, tile.row + row, tile.column + column);
        }
    WAIT_FOR_GROUP();
    const TileSamples samples = {store->heights, store->holes, STORE_WIDTH, STORE_WIDTH};
#else
    const size_t first = sample_index(ground.grid, tile.row, tile.column);
    const TileSamples samples = {ground.heights + first, ground.holes + first,
                                 ground.grid.columns, ground.grid.columns - tile.column};
#endif
    return samples;
}

#endif
