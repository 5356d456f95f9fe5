// The insides of leaves: the cheapest pair of factors that holds beside their sides.
//
// A group looks at a leaf together: lattice, sides and the rows of points inside them are read once and
// kept in its memory, and every item takes samples of the lattice, or rows of the strips, in turn.
//
// Built with: TILE, FINER, GROUP, what ground.h is built with.
#define STRIP_MEMORY __local
#include "terrain/lattice.h"
#include "terrain/neighbour.h"
#include "terrain/strip.h"

#define LEAST_INSIDE 2

// the rows of points along the four sides of a leaf, as the tessellator walks
typedef struct {
    Points outer[EDGES], inner[EDGES];
    uchar steps[EDGES][2 * MOST_POINTS];
} Rows;

#if GROUP == 1
#define WAIT()
#else
#define WAIT() barrier(CLK_LOCAL_MEM_FENCE)
#endif

// Puts the points of the sides, at heights as the domain stage finds them.
inline void put_sides(const Ground ground, const Tile tile, __global const uint *offsets,
                      __global const int *places, __local Rows *rows)
{
    for (int side = 0; side < EDGES; ++side) {
        const Frame frame = strip_frame(tile, side);
        __global const int *own = places + offsets[side];
        const int n = offsets[side + 1] - offsets[side] - 1;
        // u = 0 is walked north, v = 1 west
        const bool against = side == 0 || side == 3;
        for (int k = get_local_id(0); k <= n; k += GROUP) {
            const float place = own[against ? n - k : k] * (1.0f / FIXED_ONE);
            const float along = against ? frame.cells - place : place;
            rows->outer[side].along[k] = along;
            rows->outer[side].height[k] = height_at(ground, frame, along, 0.0f);
        }
    }
    WAIT();
}

inline Strip strip_of(const Tile tile, __global const uint *offsets, int side, int fu, int fv)
{
    const bool along_u = side % 2 == 1;
    const Strip strip = {strip_frame(tile, side), offsets[side + 1] - offsets[side] - 1,
                         along_u ? fu : fv,
                         along_u ? (float)tile.cells_down / fv : (float)tile.cells_across / fu};
    return strip;
}

// rows of samples between a side and the inside; there are none where that is one cell away
inline int rows_within(const Strip strip, int stride)
{
    return strip.depth <= 1.0f ? 0 : (int)ceil(strip.depth / stride) - 1;
}

// Do the strips between the sides and an inside of fu x fv segments hold?
inline bool strips_hold(const Ground ground, const Tile tile, __global const uint *offsets, int fu, int fv,
                        int stride, float room, __local Rows *rows, __local float *scratch)
{
    float error = 0.0f;
    int before = 0;
    for (int side = get_local_id(0); side < EDGES; side += GROUP)
        step_rows(offsets[side + 1] - offsets[side] - 1, side % 2 == 1 ? fu : fv, rows->steps[side]);
    for (int side = 0; side < EDGES; ++side) {
        const Strip strip = strip_of(tile, offsets, side, fu, fv);
        for (int i = 1 + get_local_id(0); i < strip.inner; i += GROUP)
            put_point(ground, strip.frame, strip.inner, i, strip.depth, rows->inner + side, i - 1);
    }
    WAIT();
    for (int side = 0; side < EDGES; ++side) {
        const Strip strip = strip_of(tile, offsets, side, fu, fv);
        const int count = rows_within(strip, stride);
        // rows of all sides in turn, so that all items have some
        int row = ((int)get_local_id(0) - before % GROUP + GROUP) % GROUP;
        for (; row < count && error <= room; row += GROUP)
            error = larger(strip_row_error(ground, strip, rows->outer + side, rows->inner + side,
                                           rows->steps[side], (row + 1) * stride, stride), error);
        before += count;
    }
    return group_max(error, scratch) <= room;
}

__kernel void fit_leaves(const Grid grid,
                         __global const float *heights,             // (R, C)
                         __global const uchar *holes,               // (R, C) where MASKED
                         __global const float *detail_heights,      // where DETAIL
                         const Tree tree, __global const float4 *details,       // (N,)
                         __global const int *order,                 // (TILE * TILE,)
                         __global ushort *errors,                    // (N, TILE, TILE) remembered
                         __global ushort *inner_errors,              // (N, TILE, TILE)
                         const uint stamp, __global const uint *marks,
                         __global const float *allowed,             // (N,)
                         const int count, __global const int *leaves,
                         __global const float *shares,              // (P,)
                         __global const uint *side_offsets,         // (P * 4 + 1,)
                         __global const int *side_places,
                         __global uchar *changed,                   // (P,) others stay
                         __global float2 *inside_factors,           // (P,)
                         __global uchar *unmeasured,                // (P,)
                         __global uchar *failed)                    // (P,) to be split
{
    __local float samples[WIDTH * PITCH], scratch[GROUP + 1];
    __local Rows rows;
    const int leaf = get_group_id(0), index = leaves[leaf];
    if (!changed[leaf])
        return;
    const bool is_drawn = mark_of(marks, stamp, index) == LEAF, had_failed = failed[leaf];
    WAIT();
    if (get_local_id(0) == 0) {
        inside_factors[leaf] = (float2)(0.0f);
        changed[leaf] = 0;
        unmeasured[leaf] = 1;
    }
    // those with too many points have failed already
    if (!is_drawn || had_failed)
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
        __global const uint *offsets = side_offsets + leaf * EDGES;
        const Lattice lattice = lattice_of(tile, stride_of(node.level), samples, scratch);
        const size_t first = (size_t)index * TILE * TILE;
        bool is_read = false, found = false;
        int2 worst = (int2)(lattice.across / 2, lattice.down / 2);
        // four sides of a segment each
        if (offsets[EDGES] - offsets[0] == 2 * EDGES
            && is_within(ground, tile, &lattice, &is_read, errors + first, room, 1, 1, false, &worst)) {
            factors = (int2)(1, 1);
            found = true;
        } else {
            put_sides(ground, tile, offsets, side_places, &rows);
        }
        for (int i = 0; i < TILE * TILE && !found; ++i) {
            const int fu = order[i] % TILE + 1, fv = order[i] / TILE + 1;
            if (fu > max(most_u, 2) || fv > max(most_v, 2) || fu < LEAST_INSIDE || fv < LEAST_INSIDE)
                continue;
            if (!is_within(ground, tile, &lattice, &is_read, inner_errors + first + order[i], room, fu, fv,
                           true, &worst))
                continue;
            found = strips_hold(ground, tile, offsets, fu, fv, lattice.stride, room, &rows, scratch);
            if (found)
                factors = (int2)(fu, fv);
        }
        holds |= found;
    }
    if (get_local_id(0) > 0)
        return;
    failed[leaf] = !holds;
    inside_factors[leaf] = (float2)(factors.x, factors.y);
}
