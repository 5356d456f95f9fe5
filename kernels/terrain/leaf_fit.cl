// The insides of leaves: the cheapest pair of factors that holds beside their sides.
//
// Built with: TILE, FINER, what ground.h is built with.
#include "terrain/lattice.h"
#include "terrain/neighbour.h"
#include "terrain/strip.h"

#define LEAST_INSIDE 2

typedef struct {
    Points points[EDGES];       // along each side, as the tessellator walks
    int segments[EDGES];
} Sides;

// heights of vertices as the domain stage finds them
inline float side_height(const Ground ground, const Frame frame, float along)
{
    return height_at(ground, frame, along, 0.0f);
}

inline void read_sides(const Ground ground, const Tile tile, int leaf, __global const uint *offsets,
                       __global const int *places, Sides *sides)
{
    for (int side = 0; side < EDGES; ++side) {
        const Frame frame = strip_frame(tile, side);
        __global const int *own = places + offsets[leaf * EDGES + side];
        const int n = offsets[leaf * EDGES + side + 1] - offsets[leaf * EDGES + side] - 1;
        // u = 0 is walked north, v = 1 west
        const bool against = side == 0 || side == 3;
        sides->segments[side] = n;
        for (int k = 0; k <= n; ++k) {
            const float place = own[against ? n - k : k] * (1.0f / FIXED_ONE);
            const float along = against ? frame.cells - place : place;
            sides->points[side].along[k] = along;
            sides->points[side].height[k] = side_height(ground, frame, along);
        }
    }
}

__kernel void fit_leaves(const Grid grid,
                         __global const float *heights,             // (R, C)
                         __global const uchar *holes,               // (R, C) where MASKED
                         __global const float *detail_heights,      // where DETAIL
                         const Tree tree, __global const float4 *details,       // (N,)
                         __global const int *order,                 // (TILE * TILE,)
                         __global float *errors,                    // (N, TILE, TILE) remembered
                         __global float *inner_errors,              // (N, TILE, TILE)
                         const uint stamp, __global const uint *marks,
                         __global const float *allowed,             // (N,)
                         const int count, __global const int *leaves,
                         __global const float *shares,              // (P,)
                         __global const uint *side_offsets,         // (P * 4 + 1,)
                         __global const int *side_places,
                         __global const uchar *changed,             // (P,) others stay
                         __global float *inside_factors,            // (P, 2)
                         __global uchar *unmeasured,                // (P,)
                         __global uchar *failed)                    // (P,) to be split
{
    const int leaf = get_global_id(0);
    if (leaf >= count || !changed[leaf])
        return;
    const int index = leaves[leaf];
    inside_factors[2 * leaf] = inside_factors[2 * leaf + 1] = 0.0f;
    unmeasured[leaf] = 1;
    // those with too many points have failed already
    if (mark_of(marks, stamp, index) != LEAF || failed[leaf])
        return;
    const Ground ground = {grid, heights, holes, detail_heights};
    const Node node = node_at(tree, index);
    const Tile tile = node_tile(grid, node);
    const float4 known = details[index];
    const int most_u = min(TILE, tile.cells_across), most_v = min(TILE, tile.cells_down);
    const float room = shares[leaf] > 0.0f ? allowed[index] * shares[leaf] - known.x : 0.0f;
    int2 factors = (int2)(max(most_u, LEAST_INSIDE), max(most_v, LEAST_INSIDE));
    bool holds = node.level == 0;
    if (known.w == 0.0f && room > 0.0f) {
        Sides sides;
        Lattice lattice;
        read_lattice(ground, tile, stride_of(node.level), &lattice);
        read_sides(ground, tile, leaf, side_offsets, side_places, &sides);
        int2 worst = (int2)(-1, -1);
        const bool is_single = sides.segments[0] == 1 && sides.segments[1] == 1
                            && sides.segments[2] == 1 && sides.segments[3] == 1;
        if (is_single && is_within(errors + (size_t)index * TILE * TILE, room, &lattice, 1, 1, false,
                                   &worst)) {
            factors = (int2)(1, 1);
            holds = true;
        } else {
            for (int i = 0; i < TILE * TILE; ++i) {
                const int fu = order[i] % TILE + 1, fv = order[i] / TILE + 1;
                if (fu > max(most_u, 2) || fv > max(most_v, 2) || fu < LEAST_INSIDE || fv < LEAST_INSIDE)
                    continue;
                if (!is_within(inner_errors + (size_t)index * TILE * TILE + order[i], room, &lattice,
                               fu, fv, true, &worst))
                    continue;
                bool all = true;
                for (int side = 0; side < EDGES && all; ++side) {
                    const bool along_u = side % 2 == 1;
                    const Strip strip = {strip_frame(tile, side), sides.segments[side],
                                         along_u ? fu : fv,
                                         along_u ? (float)tile.cells_down / fv
                                                 : (float)tile.cells_across / fu};
                    all = strip.depth <= 1.0f
                       || side_strip_error(ground, strip, &sides.points[side], lattice.stride, room) <= room;
                }
                if (all) {
                    factors = (int2)(fu, fv);
                    holds = true;
                    break;
                }
            }
        }
    }
    failed[leaf] = !holds;
    inside_factors[2 * leaf] = factors.x;
    inside_factors[2 * leaf + 1] = factors.y;
}
