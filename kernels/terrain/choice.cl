// Which nodes of the quadtree a mesh is made of: the cheapest, by what each costs by itself.
//
//       level          from the top: a level at a time, all nodes of it, most of which nobody has come to
//   L-1   . . . +
//    :    . . + .      visit     what a node costs to keep it whole, and what its children must undercut
//  DEPTH  . + . .
//           /|\        descend   the rest below a node, by one group, child after child
//    0     . . .
//
//   choose     from DEPTH up: is a node cheaper than what it is split into?
//   count      leaves, without what lies below other leaves
//   collect    their numbers
//
// A node is only looked at as long as it can still be part of the cheapest mesh: it is told what it must
// undercut, which is what its parent costs less what its siblings cost at least.
//
// Errors are measured when they are asked for, and remembered.
//
// Built with: DEPTH (less than the tree's levels), TILE, FINER, GROUP, what ground.h is built with.
#include "terrain/allowance.h"
#include "terrain/lattice.h"

// two triangles: no way to split makes fewer, and four children make eight
#define LEAST 2.0f
#define CHEAPEST_SPLIT (4 * LEAST)

#define CHOICE_ARGUMENTS                                                                           \
    const Grid grid, __global const float *heights, __global const uchar *holes,                   \
    __global const float *detail_heights, const Tree tree,                                         \
    __global const float4 *details,             /* (N,) */                                         \
    ALLOWANCE_ARGUMENTS                                                                            \
    const float share,                          /* of what is allowed */                           \
    __global const int *order,                  /* (TILE * TILE,) */                               \
    __global ushort *errors,                     /* (N, TILE, TILE) remembered */                   \
    const uint stamp, __global uint *marks, __global float *allowed,    /* (N,) */                 \
    __global float *costs                       /* (N - first[DEPTH],) first what is to be */      \
                                                /* undercut, then what it comes to */

// what an item knows of a mesh that is being chosen
typedef struct {
    Ground ground;
    Tree tree;
    __global const float4 *details;
    Allowance allowance;
    float share;
    __global const int *order;
    __global ushort *errors;
    uint stamp;
    __global uint *marks;
    __global float *allowed;
    __local float *lattice, *scratch;
} Choice;

#define CHOICE                                                                                     \
    {{grid, heights, holes, detail_heights}, tree, details, ALLOWANCE, share, order, errors, stamp, \
     marks, allowed, lattice, scratch}

// The triangles of the cheapest pattern within `room`, its edges matching; INFINITY where there is none, or
// none that makes fewer than `bound`.
inline float own_cost(const Choice *choice, const Node node, const Tile tile, float room, float bound)
{
    const int most_u = min(TILE, tile.cells_across), most_v = min(TILE, tile.cells_down);
    const Lattice lattice = lattice_of(tile, stride_of(node.level), choice->lattice, choice->scratch);
    __global ushort *errors = choice->errors + (size_t)node_index(choice->tree, node) * TILE * TILE;
    bool is_read = false;
    // first where a dome is highest
    int2 worst = (int2)(lattice.across / 2, lattice.down / 2);
    for (int i = 0; i < TILE * TILE; ++i) {
        const int pair = choice->order[i], fu = pair % TILE + 1, fv = pair / TILE + 1;
        // (fu - 1) (fv - 1) never falls, and with it the least of fu fv that is yet to come
        const float least = 1.0f + sqrt((float)((fu - 1) * (fv - 1)));
        if (2.0f * least * least >= bound)
            break;
        // an inside of one stands for two, but where all is one
        const bool is_whole = fu == 1 && fv == 1;
        if (fu > most_u || fv > most_v || (!is_whole && (fu == 1 || fv == 1)))
            continue;
        if (is_within(choice->ground, tile, &lattice, &is_read, errors + pair, room, fu, fv, false,
                      &worst))
            return 2.0f * fu * fv;
    }
    return INFINITY;
}

// Comes to a node; returns what it costs by itself.
inline float look_at(const Choice *choice, const Node node, float bound)
{
    const int index = node_index(choice->tree, node);
    const Tile tile = node_tile(choice->ground.grid, node);
    const float4 known = choice->details[index];
    const float error = held_to(choice->allowance,
                                allowed_of(choice->ground.grid, choice->allowance, tile, known, index),
                                choice->allowed[index]);
#if GROUP > 1
    // all have read what it was held to before
    barrier(CLK_GLOBAL_MEM_FENCE);
#endif
    if (get_local_id(0) == 0) {
        choice->allowed[index] = error;
        choice->marks[index] = choice->stamp * 4 + (isnan(error) ? ABSENT : LEAF);
    }
    if (isnan(error))
        return 0.0f;
    const float room = error * choice->share - known.x;
    float cost = INFINITY;
    if (known.w == 0.0f && room > 0.0f)
        cost = own_cost(choice, node, tile, room, bound);
    // tiles can always be meshed in full
    return node.level > 0 ? cost : fmin(cost, 2.0f * tile.cells_across * tile.cells_down);
}

// the least that the children of a node can come to, each in x, y, z, w
inline float4 least_costs(const Choice *choice, const Node node)
{
    float least[4];
    for (int child = 0; child < 4; ++child) {
        const Node below = child_of(node, child);
        least[child] = 0.0f;
        if (!is_in_tree(choice->tree, below))
            continue;
        const int index = node_index(choice->tree, below);
        const Tile tile = node_tile(choice->ground.grid, below);
        if (!isnan(allowed_of(choice->ground.grid, choice->allowance, tile, choice->details[index], index)))
            least[child] = LEAST;
    }
    return (float4)(least[0], least[1], least[2], least[3]);
}

// Is it worth while to look at the children of a node that costs so much by itself?
inline bool is_worth_splitting(const Node node, float cost, float bound, float4 least)
{
    const float sum = least.x + least.y + least.z + least.w;
    return node.level > 0 && cost > CHEAPEST_SPLIT && sum < fmin(cost, bound);
}

// A node on the way down: what it costs by itself, what its children must undercut, what they have come to
// and how many leaves that is, what the others come to at least, and whose turn it is.
typedef struct {
    Node node;
    float cost, bound, sum, rest;
    float least[4];
    int leaves, next;
} Opened;

inline Opened opened_node(const Node node, float cost, float bound, float4 least)
{
    const Opened opened = {node, cost, fmin(cost, bound), 0.0f,
                           least.x + least.y + least.z + least.w,
                           {least.x, least.y, least.z, least.w}, 0, 0};
    return opened;
}

// Goes on to the next child that is in view; returns whether there is one.
inline bool skip_absent(const Choice *choice, Opened *opened)
{
    for (; opened->next < 4 && opened->least[opened->next] == 0.0f; ++opened->next) {
        const Node below = child_of(opened->node, opened->next);
        if (is_in_tree(choice->tree, below) && get_local_id(0) == 0) {
            choice->marks[node_index(choice->tree, below)] = choice->stamp * 4 + ABSENT;
            choice->allowed[node_index(choice->tree, below)] = NAN;
        }
    }
    return opened->next < 4;
}

// Takes back what was made of all that lies below a node.
inline void forget_below(const Choice *choice, const Node node)
{
#if GROUP > 1
    barrier(CLK_GLOBAL_MEM_FENCE);
#endif
    for (int level = node.level - 1, k = 1; level >= 0; --level, ++k) {
        const int rows = min((node.row + 1) << k, choice->tree.rows[level]) - (node.row << k);
        const int columns = min((node.column + 1) << k, choice->tree.columns[level]) - (node.column << k);
        for (int i = get_local_id(0); i < rows * columns; i += GROUP) {
            const Node below = {level, (node.row << k) + i / columns, (node.column << k) + i % columns};
            choice->marks[node_index(choice->tree, below)] = 0;
        }
    }
}

__kernel void visit(CHOICE_ARGUMENTS, const int level)          // all nodes of a level above DEPTH
{
    __local float lattice[WIDTH * PITCH], scratch[GROUP + 1];
    const Choice choice = CHOICE;
    const int index = tree.first[level] + get_group_id(0), first = tree.first[DEPTH];
    const Node node = node_at(tree, index);
    float bound = INFINITY;
    if (level + 1 < tree.levels) {
        if (mark_of(marks, stamp, node_index(tree, parent_of(node))) != SPLIT)
            return;
        bound = costs[index - first];
    }
#if GROUP > 1
    // all have read what is written now
    barrier(CLK_GLOBAL_MEM_FENCE);
#endif
    const float cost = look_at(&choice, node, bound);
    if (get_local_id(0) > 0)
        return;
    costs[index - first] = cost;
    const float4 least = least_costs(&choice, node);
    if (!is_worth_splitting(node, cost, bound, least))
        return;
    const Opened opened = opened_node(node, cost, bound, least);
    marks[index] = stamp * 4 + SPLIT;
    for (int child = 0; child < 4; ++child)
        if (is_in_tree(tree, child_of(node, child)))
            costs[node_index(tree, child_of(node, child)) - first] =
                opened.bound - (opened.rest - opened.least[child]);
}

__kernel void descend(CHOICE_ARGUMENTS,
                      __global uint *leaf_counts)       // (N - first[DEPTH],) of the nodes of DEPTH
{
    __local float lattice[WIDTH * PITCH], scratch[GROUP + 1];
    const Choice choice = CHOICE;
    const int top = get_group_id(0);
    Node node = node_at(tree, tree.first[DEPTH] + top);
    float bound = INFINITY;
    if (DEPTH + 1 < tree.levels) {
        if (mark_of(marks, stamp, node_index(tree, parent_of(node))) != SPLIT)
            return;
        bound = costs[top];
    }
#if GROUP > 1
    // all have read what is written at the end
    barrier(CLK_GLOBAL_MEM_FENCE);
#endif
    // what a node has come to, and with how many leaves
    float cost;
    int leaves, length = 0;
    Opened way[DEPTH + 1];
    do {
        cost = look_at(&choice, node, bound);
        leaves = cost > 0.0f;
        const float4 least = least_costs(&choice, node);
        bool is_done = !is_worth_splitting(node, cost, bound, least);
        if (!is_done)
            way[length++] = opened_node(node, cost, bound, least);
        // up again from all that are done, to the next child of one that is not
        while (length > 0) {
            Opened *opened = way + length - 1;
            if (is_done) {
                opened->sum += cost;
                opened->leaves += leaves;
            }
            const bool is_lost = !(opened->sum + opened->rest < opened->bound);
            if (!is_lost && skip_absent(&choice, opened)) {
                opened->rest -= opened->least[opened->next];
                bound = opened->bound - opened->sum - opened->rest;
                node = child_of(opened->node, opened->next++);
                break;
            }
            if (is_lost)
                forget_below(&choice, opened->node);
            else if (get_local_id(0) == 0)
                marks[node_index(tree, opened->node)] = stamp * 4 + SPLIT;
            cost = is_lost ? opened->cost : opened->sum;
            leaves = is_lost ? 1 : opened->leaves;
            is_done = true;
            --length;
        }
    } while (length > 0);
    if (get_local_id(0) == 0) {
        costs[top] = cost;
        leaf_counts[top] = leaves;
    }
}

// all nodes of a level above DEPTH, from below
__kernel void choose(const Tree tree, const int level, const uint stamp, __global uint *marks,
                     __global float *costs)             // (N - first[DEPTH],)
{
    const int i = get_global_id(0), first = tree.first[DEPTH];
    if (i >= tree.rows[level] * tree.columns[level])
        return;
    const int index = tree.first[level] + i;
    if (mark_of(marks, stamp, index) != SPLIT)
        return;
    const Node node = node_at(tree, index);
    float cost = 0.0f;
    for (int child = 0; child < 4; ++child)
        if (is_in_tree(tree, child_of(node, child)))
            cost += costs[node_index(tree, child_of(node, child)) - first];
    if (costs[index - first] <= cost)
        marks[index] = stamp * 4 + LEAF;
    else
        costs[index - first] = cost;
}

// Leaves of the nodes from DEPTH up, or of DEPTH and below it. The topmost leaf above a node that is not
// meant is never taken away, so all can look at once.
__kernel void count(const Tree tree, const int nodes, const uint stamp, __global uint *marks,
                    __global uint *leaf_counts)         // (nodes,)
{
    const int i = get_global_id(0), index = tree.first[DEPTH] + i;
    if (i >= nodes)
        return;
    const int mark = mark_of(marks, stamp, index);
    Node node = node_at(tree, index);
    const int level = node.level;
    bool hidden = false;
    while (node.level + 1 < tree.levels && !hidden) {
        node = parent_of(node);
        hidden = mark_of(marks, stamp, node_index(tree, node)) == LEAF;
    }
    if (hidden || level > DEPTH || mark == UNSEEN)
        leaf_counts[i] = !hidden && mark == LEAF;
    if (!hidden || mark == UNSEEN)
        return;
    marks[index] = 0;
    for (int k = 1; k <= level && level == DEPTH && mark == SPLIT; ++k) {
        const Node own = node_at(tree, index);
        const int rows = min((own.row + 1) << k, tree.rows[level - k]);
        const int columns = min((own.column + 1) << k, tree.columns[level - k]);
        for (int row = own.row << k; row < rows; ++row)
            for (int column = own.column << k; column < columns; ++column) {
                const Node below = {level - k, row, column};
                marks[node_index(tree, below)] = 0;
            }
    }
}

__kernel void collect(const Tree tree, const int nodes, const uint stamp, __global const uint *marks,
                      __global const uint *offsets,     // (nodes + 1,)
                      __global int *leaves, __global int *leaf_of)          // (N,)
{
    const int i = get_global_id(0);
    if (i >= nodes || offsets[i] == offsets[i + 1])
        return;
    const Node top = node_at(tree, tree.first[DEPTH] + i);
    uint target = offsets[i];
    // the tiles below, and where each lies in its parents; a leaf covers as many as it has
    const int tiles = top.level == DEPTH ? 1 << 2 * DEPTH : 1;
    for (int k = 0; k < tiles;) {
        Node node = top;
        while (mark_of(marks, stamp, node_index(tree, node)) == SPLIT) {
            node = child_of(node, k >> 2 * (node.level - 1) & 3);
            if (!is_in_tree(tree, node))
                break;
        }
        k += top.level == DEPTH ? 1 << 2 * node.level : 1;
        if (is_in_tree(tree, node) && mark_of(marks, stamp, node_index(tree, node)) == LEAF) {
            leaves[target] = node_index(tree, node);
            leaf_of[node_index(tree, node)] = target;
            ++target;
        }
    }
}
