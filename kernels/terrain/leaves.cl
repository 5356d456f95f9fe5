// The leaves of a mesh: those that nothing holds for are split, those that exceed are asked for less.
//
//   begin                   of leaves that are new nothing is known
//   count_children, split   the children of leaves stand behind the others
//   tighten                 what exceeds
//   describe                what a mesh tells of its patches
//
// Built with: TILE, FINER.
#include "terrain/allowance.h"

__kernel void begin(const int first, const int count, const float share,
                    __global float *shares, __global uchar *changed,        // (P,)
                    __global uchar *unmeasured, __global uchar *failed,     // (P,)
                    __global uint4 *keys, __global int4 *factors,           // (P,) of the four sides
                    __global float2 *inside_factors,                        // (P,)
                    __global float *measured)                               // (P,)
{
    const int leaf = first + get_global_id(0);
    if (leaf >= first + count)
        return;
    shares[leaf] = share;
    changed[leaf] = unmeasured[leaf] = 1;
    failed[leaf] = 0;
    keys[leaf] = (uint4)(0);
    factors[leaf] = (int4)(0);
    inside_factors[leaf] = (float2)(0.0f);
    measured[leaf] = 0.0f;
}

// How many children the leaves have that are to be split.
__kernel void count_children(const Tree tree, const int count, __global const int *leaves,
                             __global const uchar *failed, __global uint *child_counts)
{
    const int leaf = get_global_id(0);
    if (leaf >= count)
        return;
    const Node node = node_at(tree, leaves[leaf]);
    child_counts[leaf] = 0;
    for (int child = 0; child < 4 && failed[leaf]; ++child)
        child_counts[leaf] += is_in_tree(tree, child_of(node, child));
}

__kernel void split(const Grid grid, const Tree tree, __global const float4 *details,   // (N,)
                    ALLOWANCE_ARGUMENTS
                    const int count,
                    __global const uint *child_counts,          // (count,) 0 where a leaf stays
                    __global const uint *child_offsets,         // (count + 1,)
                    const uint stamp,
                    __global uint *marks,                       // (N,)
                    __global float *allowed,                    // (N,)
                    __global int *leaf_of,                      // (N,)
                    __global int *leaves,                       // count, and room for the children
                    __global uchar *changed, __global uchar *failed)
{
    const int leaf = get_global_id(0);
    if (leaf >= count || child_counts[leaf] == 0)
        return;
    const Allowance allowance = ALLOWANCE;
    const Node node = node_at(tree, leaves[leaf]);
    marks[leaves[leaf]] = stamp * 4 + SPLIT;
    changed[leaf] = 1;
    failed[leaf] = 0;
    int target = count + child_offsets[leaf];
    for (int child = 0; child < 4; ++child) {
        const Node below = child_of(node, child);
        if (!is_in_tree(tree, below))
            continue;
        const int index = node_index(tree, below);
        const float error = allowed_of(grid, allowance, node_tile(grid, below), details[index], index);
        allowed[index] = held_to(allowance, error, allowed[index]);
        marks[index] = stamp * 4 + (isnan(allowed[index]) ? ABSENT : LEAF);
        leaf_of[index] = target;
        leaves[target] = index;
        ++target;
    }
}

// Where the finished mesh exceeds what a leaf is allowed its pattern is asked for less; in the end a tile is
// meshed in full, and a larger leaf is split.
__kernel void tighten(const Tree tree, const int count, const float least_share,
                      __global const int *leaves, const uint stamp,
                      __global const uint *marks, __global const float *allowed,
                      __global const float *measured,       // (P,)
                      __global float *shares,               // (P,)
                      __global uchar *changed,              // (P,)
                      __global uchar *unmeasured,           // (P,)
                      __global uchar *failed,               // (P,)
                      __global uint *counts)                // (2,) exceeding, and can do better
{
    const int leaf = get_global_id(0);
    if (leaf >= count)
        return;
    unmeasured[leaf] = 0;
    const int index = leaves[leaf];
    const float most = allowed[index];
    if (mark_of(marks, stamp, index) != LEAF || !(measured[leaf] > most))
        return;
    atomic_inc(counts);
    if (shares[leaf] == 0.0f)
        return;
    atomic_inc(counts + 1);
    const float excess = most / measured[leaf];
    const float next = shares[leaf] * fmin(fmax(excess, 0.5f), 0.85f);
    shares[leaf] = next < least_share ? 0.0f : next;
    changed[leaf] = 1;
    failed[leaf] = shares[leaf] == 0.0f && node_at(tree, index).level > 0;
}


// What a mesh tells of its patches; nothing of leaves that were split.
__kernel void describe(const Grid grid, const Tree tree, const int is_weighted,
                       __global const float *weights,       // (N,)
                       const int count, __global const int *leaves,
                       const uint stamp, __global const uint *marks, __global const float *allowed,
                       __global const float *measured,      // (P,)
                       __global const float *deviations,    // (N,)
                       __global int4 *areas,                // (P,) first row and column, rows, columns
                       __global float4 *known)              // (P,) measured, allowed, deviation
{
    const int leaf = get_global_id(0);
    if (leaf >= count)
        return;
    const int index = leaves[leaf];
    areas[leaf] = (int4)(0);
    known[leaf] = (float4)(0.0f);
    if (mark_of(marks, stamp, index) != LEAF)
        return;
    const Tile tile = node_tile(grid, node_at(tree, index));
    const float weight = is_weighted ? weights[index] : 1.0f;
    areas[leaf] = (int4)(tile.row, tile.column, tile.cells_down, tile.cells_across);
    known[leaf] = (float4)(measured[leaf], allowed[index] * weight, deviations[index], 0.0f);
}
