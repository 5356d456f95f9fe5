// Which nodes of the quadtree a mesh is made of.
//
//   drift, gather   once a ground: how far its nodes' lattices are from all samples, and their ranges
//   visit           from the top: what a node is allowed, and what it costs to keep it whole
//   expand          its children, where it may be worth while to go on
//   choose          from the bottom: is a node cheaper than what it is split into?
//   settle          what is chosen, without what lies below it
//   collect         the leaves
//   split           leaves that nothing holds for: their children stand behind the others
//
// Errors are measured when they are asked for, and remembered.
//
// Built with: TILE, FINER, what ground.h is built with.
#include "terrain/allowance.h"
#include "common/lanes.h"
#include "terrain/lattice.h"

// two triangles: no way to split makes fewer, and four children make eight
#define CHEAPEST_SPLIT 8.0f

// How far the samples of each tile are from the lattice of a level, bilinear between its points.
__kernel void drift(const Grid grid, const int level,
                    __global const float *heights,          // (R, C)
                    __global const uchar *holes,            // (R, C) where MASKED
                    __global const float *detail_heights,   // where DETAIL
                    const int count, __global const int *tiles,     // (count,) to look at
                    __global float *drifts)                 // (P,)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const int index = tiles[i];
    const Ground ground = {grid, heights, holes, detail_heights};
    const Tile tile = tile_at(grid, index);
    const int stride = stride_of(level);
    const float step = 1.0f / stride;
    const int south = tile.row + tile.cells_down, east = tile.column + tile.cells_across;
    float worst = 0.0f, highest = 0.0f;
    for (int above = tile.row / stride * stride; above <= south; above += stride)
        for (int left = tile.column / stride * stride; left <= east; left += stride) {
            // what the tile has of one cell of the lattice
            const int below = above + stride, right = left + stride;
            const float nw = sample_height(ground, above, left);
            const float ne = height_beyond(ground, above, right);
            const float sw = height_beyond(ground, below, left);
            const float se = height_beyond(ground, below, right);
            highest = LARGER(highest, LARGER(LARGER(ABSOLUTE(nw), ABSOLUTE(ne)), LARGER(ABSOLUTE(sw), ABSOLUTE(se))));
            const int first = max(left, tile.column), last = min(left + stride - 1, east);
            for (int row = max(above, tile.row); row <= min(above + stride - 1, south); ++row) {
                const float down = (row - above) * step;
                const float west = nw + (sw - nw) * down, slope = (ne + (se - ne) * down - west) * step;
                for (int column = first; column <= last; ++column) {
                    const float difference = west + slope * (column - left) - sample_height(ground, row, column);
                    const float distance = ABSOLUTE(difference);
                    worst = LARGER(distance, worst);
                }
            }
        }
    // what a dozen roundings may have taken away
    drifts[index] = worst > 0.0f ? worst + 1e-6f * highest : 0.0f;
}

// Drift, range and holes of the nodes of a level: the worst of their tiles.
__kernel void gather(const Grid grid, const Tree tree, const int level,
                     __global const float *drifts,          // (P,)
                     __global float4 *details)              // (N,) drift, minimum, maximum, holes
{
    const int within = get_global_id(0);
    if (within >= tree.rows[level] * tree.columns[level])
        return;
    const Node node = node_at(tree, tree.first[level] + within);
    float4 found = (float4)(0.0f, NAN, NAN, 0.0f);
    for (int child = 0; child < 4; ++child) {
        const Node below = child_of(node, child);
        if (!is_in_tree(tree, below))
            continue;
        const float4 part = details[node_index(tree, below)];
        found.y = fmin(found.y, part.y);
        found.z = fmax(found.z, part.z);
        found.w += part.w;
    }
    if (stride_of(level) > 1)
        for (int row = node.row << level; row < min((node.row + 1) << level, grid.tile_rows); ++row)
            for (int column = node.column << level;
                 column < min((node.column + 1) << level, grid.tile_columns); ++column)
                found.x = fmax(found.x, drifts[row * grid.tile_columns + column]);
    details[tree.first[level] + within] = found;
}

// The triangles of the cheapest pattern within `room`, its edges matching; INFINITY where none is.
inline float own_cost(const Ground ground, const Node node, const Tile tile, float room,
                      __global const int *order, __global float *errors)
{
    const int most_u = min(TILE, tile.cells_across), most_v = min(TILE, tile.cells_down);
    Lattice lattice;
    lattice.across = 0;
    int2 worst = (int2)(-1, -1);
    for (int i = 0; i < TILE * TILE; ++i) {
        const int fu = order[i] % TILE + 1, fv = order[i] / TILE + 1;
        // an inside of one stands for two, but where all is one
        const bool is_whole = fu == 1 && fv == 1;
        if (fu > most_u || fv > most_v || (!is_whole && (fu == 1 || fv == 1)))
            continue;
        __global float *remembered = errors + order[i];
        if (*remembered < 0.0f && -*remembered <= room && lattice.across == 0)
            read_lattice(ground, tile, stride_of(node.level), &lattice);
        if (is_within(remembered, room, &lattice, fu, fv, false, &worst))
            return 2.0f * fu * fv;
    }
    return INFINITY;
}

__kernel void visit(const Grid grid,
                    __global const float *heights,              // (R, C)
                    __global const uchar *holes,                // (R, C) where MASKED
                    __global const float *detail_heights,       // where DETAIL
                    const Tree tree, __global const float4 *details,    // (N,)
                    const View view, const int cull,
                    const float metres, const float pixels,     // INFINITY where not asked for
                    __global const float *weights,              // (N,) that errors count
                    const float share,                          // of what is allowed
                    __global const int *order,                  // (TILE * TILE,)
                    __global float *errors,                     // (N, TILE, TILE) remembered
                    const int first, const int count,
                    __global const int *visited,                // nodes; first .. first + count - 1
                    const uint stamp,
                    __global uint *marks,                       // (N,)
                    __global float *allowed,                    // (N,)
                    __global float *costs,                      // (N,)
                    __global uint *child_counts)                // (count,)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const int index = visited[first + i];
    const Node node = node_at(tree, index);
    const Tile tile = node_tile(grid, node);
    const float4 known = details[index];
    const float error = allowed_of(grid, view, cull, metres, pixels, tile, known, weights[index]);
    child_counts[i] = 0;
    allowed[index] = error;
    costs[index] = 0.0f;
    marks[index] = stamp * 4 + ABSENT;
    if (isnan(error))
        return;
    const float room = error * share - known.x;
    float cost = INFINITY;
    if (known.w == 0.0f && room > 0.0f) {
        const Ground ground = {grid, heights, holes, detail_heights};
        cost = own_cost(ground, node, tile, room, order, errors + (size_t)index * TILE * TILE);
    }
    // tiles can always be meshed in full
    if (node.level == 0)
        cost = fmin(cost, 2.0f * tile.cells_across * tile.cells_down);
    costs[index] = cost;
    const bool is_leaf = node.level == 0 || cost <= CHEAPEST_SPLIT;
    marks[index] = stamp * 4 + (is_leaf ? LEAF : SPLIT);
    for (int child = 0; child < 4 && !is_leaf; ++child)
        child_counts[i] += is_in_tree(tree, child_of(node, child));
}

__kernel void expand(const Tree tree, const int first, const int count,
                     __global int *visited,
                     __global const uint *child_counts,         // (count,)
                     __global const uint *child_offsets)        // (count + 1,)
{
    const int i = get_global_id(0);
    if (i >= count || child_counts[i] == 0)
        return;
    const Node node = node_at(tree, visited[first + i]);
    int target = first + count + child_offsets[i];
    for (int child = 0; child < 4; ++child)
        if (is_in_tree(tree, child_of(node, child)))
            visited[target++] = node_index(tree, child_of(node, child));
}

__kernel void choose(const Tree tree, const int first, const int count,
                     __global const int *visited, const uint stamp,
                     __global uint *marks, __global float *costs)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const int index = visited[first + i];
    if (mark_of(marks, stamp, index) != SPLIT)
        return;
    const Node node = node_at(tree, index);
    float cost = 0.0f;
    for (int child = 0; child < 4; ++child)
        if (is_in_tree(tree, child_of(node, child)))
            cost += costs[node_index(tree, child_of(node, child))];
    if (costs[index] <= cost)
        marks[index] = stamp * 4 + LEAF;
    else
        costs[index] = cost;
}

// The topmost leaf above a node that is not meant is never taken away, so all can look at once.
__kernel void settle(const Tree tree, const int count, __global const int *visited, const uint stamp,
                     __global uint *marks, __global uint *is_leaf)          // (count,)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const int index = visited[i];
    Node node = node_at(tree, index);
    bool hidden = false;
    while (node.level + 1 < tree.levels && !hidden) {
        node = parent_of(node);
        hidden = mark_of(marks, stamp, node_index(tree, node)) == LEAF;
    }
    is_leaf[i] = !hidden && mark_of(marks, stamp, index) == LEAF;
    if (hidden)
        marks[index] = 0;
}

__kernel void collect(const int count, __global const int *visited, __global const uint *is_leaf,
                      __global const uint *offsets, __global int *leaves, __global int *leaf_of)
{
    const int i = get_global_id(0);
    if (i >= count || !is_leaf[i])
        return;
    leaves[offsets[i]] = visited[i];
    leaf_of[visited[i]] = offsets[i];
}

__kernel void split(const Grid grid, const Tree tree, __global const float4 *details,   // (N,)
                    const View view, const int cull, const float metres, const float pixels,
                    __global const float *weights,              // (N,)
                    const float share, const int count,
                    __global const uint *child_counts,          // (count,) 0 where a leaf stays
                    __global const uint *child_offsets,         // (count + 1,)
                    const uint stamp,
                    __global uint *marks,                       // (N,)
                    __global float *allowed,                    // (N,)
                    __global int *leaf_of,                      // (N,)
                    __global int *leaves,                       // count, and room for the children
                    __global float *shares,
                    __global uchar *changed)
{
    const int leaf = get_global_id(0);
    if (leaf >= count || child_counts[leaf] == 0)
        return;
    const Node node = node_at(tree, leaves[leaf]);
    marks[leaves[leaf]] = stamp * 4 + SPLIT;
    changed[leaf] = 1;
    int target = count + child_offsets[leaf];
    for (int child = 0; child < 4; ++child) {
        const Node below = child_of(node, child);
        if (!is_in_tree(tree, below))
            continue;
        const int index = node_index(tree, below);
        allowed[index] = allowed_of(grid, view, cull, metres, pixels, node_tile(grid, below),
                                    details[index], weights[index]);
        marks[index] = stamp * 4 + (isnan(allowed[index]) ? ABSENT : LEAF);
        leaf_of[index] = target;
        leaves[target] = index;
        shares[target] = share;
        changed[target] = 1;
        ++target;
    }
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

// Where the finished mesh exceeds what a leaf is allowed its pattern is asked for less; in the end a tile is
// meshed in full, and a larger leaf is split.
__kernel void tighten(const Tree tree, const int count, const float least_share,
                      __global const int *leaves, const uint stamp,
                      __global const uint *marks, __global const float *allowed,
                      __global const float *measured,       // (P,)
                      __global float *shares,               // (P,)
                      __global uchar *changed,              // (P,)
                      __global uchar *failed,               // (P,)
                      __global uint *counts)                // (2,) exceeding, and can do better
{
    const int leaf = get_global_id(0);
    if (leaf >= count)
        return;
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

// The weight of a node is the largest of its children's.
__kernel void lift(const Tree tree, const int level, __global float *weights)       // (N,)
{
    const int within = get_global_id(0);
    if (within >= tree.rows[level] * tree.columns[level])
        return;
    const Node node = node_at(tree, tree.first[level] + within);
    float weight = 0.0f;
    for (int child = 0; child < 4; ++child)
        if (is_in_tree(tree, child_of(node, child)))
            weight = fmax(weight, weights[node_index(tree, child_of(node, child))]);
    weights[tree.first[level] + within] = weight;
}

// What is remembered of nodes whose samples have changed is forgotten.
__kernel void forget(const Tree tree, const int level, const int row, const int column, const int rows,
                     const int columns, __global float *errors, __global float *inner_errors)
{
    const int i = get_global_id(0);
    if (i >= rows * columns)
        return;
    const Node node = {level, row + i / columns, column + i % columns};
    const size_t first = (size_t)node_index(tree, node) * TILE * TILE;
    for (int pair = 0; pair < TILE * TILE; ++pair)
        errors[first + pair] = inner_errors[first + pair] = UNMEASURED;
}
