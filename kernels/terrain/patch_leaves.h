// Patches that are leaves of a quadtree, at whole factors.
//
// At whole factors a point of a pattern is known by its number among the f segments that it divides, and
// its place is one division of whole numbers, the same whichever leaf asks: points that leaves share
// have the same bits. Those of a side are listed: joints.cl.
#ifndef PATCH_LEAVES_H
#define PATCH_LEAVES_H

#include "terrain/ground.h"
#include "terrain/node.h"

// Levels at which every sample is looked at, beyond the first. A lattice's bound leaves little to float within:
// vertices that float have every sample looked at up to 128 cells.
#if LIFTED && !DETAIL
#define FINEST (FINER + (TILE <= 4 ? 3 : TILE <= 8 ? 2 : 1))
#else
#define FINEST FINER
#endif

#define PATCH_ARGUMENTS                                                                            \
    const Tree tree, __global const int *leaves, __global const uint *side_offsets,                \
    __global const int *side_places, __global const float *inside_factors,                         \
    __global const float *lifts,
#define PATCH_SET {tree, leaves, side_offsets, side_places, inside_factors, lifts}

typedef struct {
    Tree tree;
    __global const int *leaves;                 // (P,) nodes
    __global const uint *side_offsets;          // (P * 4 + 1,)
    __global const int *side_places;            // of their points, 1/65536 of a cell
    __global const float *inside_factors;       // (P, 2)
    __global const float *lifts;                // (N,) of points above the ground, where LIFTED
} PatchSet;

typedef struct {
    Tile tile;
    int stride;
    __global const uint *offsets;
    __global const int *places;
    int2 insides;
} Placing;

inline int number_of(const PatchSet set, int patch)
{
    return set.leaves[patch];
}

inline Placing placing_of(const Grid grid, const PatchSet set, int patch)
{
    const Node node = node_at(set.tree, set.leaves[patch]);
    const Placing placing = {node_tile(grid, node), node.level > FINEST ? stride_of(node.level) : 1,
                             set.side_offsets + patch * EDGES, set.side_places,
                             (int2)((int)set.inside_factors[2 * patch],
                                    (int)set.inside_factors[2 * patch + 1])};
    return placing;
}

// which of f segments begins at a coordinate of the domain
inline int point_number(uint along, int f)
{
    return (int)((along * (uint)f + FIXED_ONE / 2) >> FIXED_BITS);
}

inline int inside_place(uint along, int f, int cells)
{
    return (int)(((long)point_number(along, f) * cells * FIXED_ONE + f / 2) / f);
}

inline int side_place(const Placing placing, int side, uint along)
{
    const int first = placing.offsets[side], points = placing.offsets[side + 1] - first;
    return placing.places[first + point_number(along, points - 1)];
}

inline int2 place_of(const Placing placing, uint2 point)
{
    const Tile tile = placing.tile;
    if (point.x == 0)
        return (int2)(0, side_place(placing, 0, point.y));
    if (point.y == 0)
        return (int2)(side_place(placing, 1, point.x), 0);
    if (point.x == FIXED_ONE)
        return (int2)(tile.cells_across * FIXED_ONE, side_place(placing, 2, point.y));
    if (point.y == FIXED_ONE)
        return (int2)(side_place(placing, 3, point.x), tile.cells_down * FIXED_ONE);
    return (int2)(inside_place(point.x, placing.insides.x, tile.cells_across),
                  inside_place(point.y, placing.insides.y, tile.cells_down));
}

// the height of a point of the pattern, by its number and that of the ground there
inline float lifted(const PatchSet set, uint point, float height)
{
#if LIFTED
    return height + set.lifts[point];
#else
    return height;
#endif
}

#endif
