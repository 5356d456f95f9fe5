// Semi-uniform adaptive tessellation of triangles and quads: a dyadic lattice whose boundary is moved onto the
// points that both patches at an edge have.
//
//   count    the level of each patch, and how many points and triangles it makes, in closed form
//   (scan)   where each patch's output begins: scan.cl
//   (queue)  the patches of each level: queues.cl
//   fill     one launch a level: all its patches are the same lattice, moved differently
//
//   level 2, its lower edge level 1       the points a and b are as far from two points of level 1:
//           .                             they go to the nearest corner of the patch
//          / \        snapped
//         .---.                           The first 3 * 2^level points are the boundary, walked as
//        / \ / \        .                 tessellation/triangle.h does: u = 0 from v = 1, then v = 0,
//       .---.---.      / \ / \            then w = 0. Those inside follow and stay. Triangles inside
//      / \ / \ / \    .---.---.           come first; those at the rim, which may collapse, last.
//     .-a-.---.-b-.   |\  / \ /|
//                     .a---.---b.
//
// After Dyken, Reimers, Seland, "Semi-uniform adaptive patch tessellation", Computer Graphics Forum
// 28(8), 2009, section 3. Their snap function goes to the nearest point (equation 1): SNAP is
// snap_to_nearest. With SNAP snap points go down level by level, see dyadic_edge.h, so that an edge
// can come and go between two levels. Quads are cut into lattices of squares, and these in two.
//
// Built with: GROUP work-items a patch, SIDES (3 or 4) of it, SNAP.
#include "tessellation/dyadic_edge.h"
#include "common/group_scan.h"
#include "layout.h"

#ifndef GROUP
#error "semi_uniform.cl: define GROUP, the work-items that share a patch"
#endif

typedef struct {
    int edges[SIDES];       // u = 0, v = 0, w = 0; or u = 0, v = 0, u = 1, v = 1
    int patch;              // the largest of them, below 0 where the patch is culled
    int turns;              // a bit an edge: where the middle of level 1 goes
} Levels;

// edge levels as asked for: rounded up, and at most `maximum`; one below 0 or NaN culls
inline Levels levels_of(__global const float *levels, size_t patch, int maximum)
{
    Levels result = {{0, 0, 0}, 0, 0};
    bool drawn = true;
    for (int edge = 0; edge < SIDES; ++edge) {
        const float wanted = levels[SIDES * patch + edge];
        drawn = drawn && wanted >= 0.0f;
        const float most = maximum;
        const float clamped = !(wanted > 0.0f) ? 0.0f : wanted < most ? wanted : most;
        const int whole = (int)clamped;
        result.edges[edge] = whole + (whole < clamped);
        result.patch = max(result.patch, result.edges[edge]);
    }
    if (!drawn)
        result.patch = -1;
    return result;
}

// Returns where on the walk around the boundary its step comes to lie; points inside stay.
inline int snap_point(int point, const Levels levels)
{
    const int steps = 1 << levels.patch, edge = point >> levels.patch;
    if (edge >= SIDES)
        return point;
    const int moved = edge * steps + SNAP(point & (steps - 1), levels.patch, levels.edges[edge],
                                          levels.turns >> edge & 1);
    return moved == SIDES * steps ? 0 : moved;
}

inline uint2 boundary_point(int step, int level)
{
    const uint steps = 1u << level, edge = step >> level, k = step & (steps - 1);
    const uint2 place = edge == 0 ? (uint2)(0, steps - k)
                      : edge == 1 ? (uint2)(k, 0)
#if SIDES == 3
                                  : (uint2)(steps - k, k);
#else
                      : edge == 2 ? (uint2)(steps, k)
                                  : (uint2)(steps - k, steps);
#endif
    return place << (uint)(FIXED_BITS - level);
}

inline bool is_degenerate(__global const int *corners, const Levels levels)
{
    const int a = snap_point(corners[0], levels), b = snap_point(corners[1], levels),
              c = snap_point(corners[2], levels);
    return a == b || b == c || c == a;
}

inline void put(__global int *target, __global const int *corners, int base, bool clockwise)
{
    target[0] = base + corners[0];
    target[1] = base + corners[clockwise ? 1 : 2];
    target[2] = base + corners[clockwise ? 2 : 1];
}

// Copies the triangles between first and last that have an area, closed up. Each item has a run.
inline void fill_rim(__global int *target, __global const int *triangles, int first, int last,
                     const Levels levels, int base, bool clockwise, __local ulong *sums)
{
    const int run = (last - first + GROUP - 1) / GROUP;
    const int begin = min(last, first + run * (int)get_local_id(0)), end = min(last, begin + run);
    int kept = 0;
    for (int i = begin; i < end; ++i)
        kept += !is_degenerate(triangles + 3 * i, levels);
    target += 3 * (int)sum_before(kept, sums);
    for (int i = begin; i < end; ++i)
        if (!is_degenerate(triangles + 3 * i, levels)) {
            put(target, triangles + 3 * i, base, clockwise);
            target += 3;
        }
}

inline uint points_of(uint steps)
{
    return SIDES == 3 ? (steps + 1) * (steps + 2) / 2 : (steps + 1) * (steps + 1);
}

__kernel void semi_uniform_count(int patches, int maximum, int keep_degenerate,
                                 __global const float *levels,          // (P, SIDES)
                                 __global int *patch_levels,            // (P,)
                                 __global uint *point_counts,           // (P,)
                                 __global uint *triangle_counts)        // (P,)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    const Levels own = levels_of(levels, patch, maximum);
    const uint steps = own.patch < 0 ? 0 : 1u << own.patch;
    // each step of the boundary that collapses takes a triangle with it
    uint collapsed = 0;
    for (int edge = 0; edge < SIDES; ++edge)
        collapsed += steps - (1u << own.edges[edge]);
    patch_levels[patch] = own.patch;
    point_counts[patch] = own.patch < 0 ? 0 : points_of(steps);
    triangle_counts[patch] = own.patch < 0 ? 0 : (SIDES - 2) * steps * steps - (keep_degenerate ? 0 : collapsed);
}

__kernel void semi_uniform_fill(int level, int maximum, int keep_degenerate, int clockwise,
                                int queue_begin, int queue_end,
                                int inner_points, int inner_triangles,
                                __global const uint *queue,             // (P,) patches by level
                                __global const float *levels,           // (P, SIDES)
                                __global const int *turns,              // (P,)
                                __global const uint2 *lattice,          // points inside
                                __global const int *triangles,          // (4^level or twice, 3)
                                __global const uint *point_offsets,     // (P + 1,)
                                __global const uint *triangle_offsets,  // (P + 1,)
                                __global uint2 *points,                 // (N,)
                                __global int *filled)                   // (M, 3)
{
    __local ulong sums[GROUP];
    const int boundary = SIDES << level, all = (SIDES - 2) << 2 * level;
    const int copied = keep_degenerate ? all : inner_triangles;
    for (int place = queue_begin + get_group_id(0); place < queue_end; place += get_num_groups(0)) {
        const uint patch = queue[place];
        Levels own = levels_of(levels, patch, maximum);
        own.turns = turns[patch];
        const int base = point_offsets[patch];
        __global uint2 *own_points = points + base;
        __global int *own_triangles = filled + 3 * (size_t)triangle_offsets[patch];
        for (int i = get_local_id(0); i < boundary; i += GROUP)
            own_points[i] = boundary_point(snap_point(i, own), level);
        for (int i = get_local_id(0); i < inner_points; i += GROUP)
            own_points[boundary + i] = lattice[i];
        for (int i = get_local_id(0); i < copied; i += GROUP)
            put(own_triangles + 3 * i, triangles + 3 * i, base, clockwise);
        fill_rim(own_triangles + 3 * copied, triangles, copied, all, own, base, clockwise, sums);
    }
}
