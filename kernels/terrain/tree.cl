// What is known of the nodes of a quadtree, once a ground.
//
//   drift     how far nodes' lattices are from all samples, block by block
//   gather    drift, range, holes and deviation of nodes: the worst of what they cover
//   lift      weights
//   forget    errors that are remembered of samples that have changed
//
// Built with: TILE, FINER, GROUP, LANES (1 or 8), what ground.h is built with.
#include "common/lanes.h"
#include "common/reduce.h"
#include "terrain/ground.h"
#include "terrain/node.h"

// Drifts of a level are found by blocks, nodes of another level: 32 x 32 of them a node, but none smaller
// than 8 x 8 tiles.
inline int block_level(int level)
{
    return min(level, max(3, level - 5));
}

// the first block of a level; the highest level's are first
inline int first_block(const Tree tree, int level)
{
    int first = 0;
    for (int above = tree.levels - 1; above > level; --above)
        first += tree.rows[block_level(above)] * tree.columns[block_level(above)];
    return first;
}

// Columns side by side: LANES of an item on a CPU, one of each of GROUP items on a GPU. Those behind the last
// are the last.
inline Real row_heights(const Ground ground, int row, int column, int last)
{
#if LANES == 8 && !DETAIL
    if (column + LANES - 1 <= last)
        return vload8(0, ground.heights + sample_index(ground.grid, row, column));
#endif
    Real heights;
    for (int lane = 0; lane < LANES; ++lane)
        SET_LANE(heights, lane, sample_height(ground, row, min(column + lane, last)));
    return heights;
}

// the same on a line of the lattice, linear between its points
inline Real line_heights(const Ground ground, int row, int column, int last, int stride)
{
    const float step = 1.0f / stride;
    const bool inside = row < ground.grid.rows && last + stride < ground.grid.columns;
    Real here, next, on;
    for (int lane = 0; lane < LANES; ++lane) {
        const int own = min(column + lane, last), west = own & -stride;
        SET_LANE(on, lane, (own - west) * step);
        // most often all lanes lie between the same two points
        if (lane == 0 || (own & (stride - 1)) == 0) {
            SET_LANE(here, lane, inside ? sample_height(ground, row, west) : height_beyond(ground, row, west));
            SET_LANE(next, lane, inside ? sample_height(ground, row, west + stride)
                                        : height_beyond(ground, row, west + stride));
        } else {
            SET_LANE(here, lane, LANE(here, lane - 1));
            SET_LANE(next, lane, LANE(next, lane - 1));
        }
    }
    return here + (next - here) * on;
}

__kernel void drift(const Grid grid,
                    __global const float *heights,          // (R, C)
                    __global const uchar *holes,            // (R, C) where MASKED
                    __global const float *detail_heights,   // where DETAIL
                    const Tree tree,
                    const int top, const int left, const int bottom, const int right,   // that changed
                    __global float *drifts)                 // of all blocks
{
    __local float scratch[GROUP];
    const Ground ground = {grid, heights, holes, detail_heights};
    int level = tree.levels - 1;
    while ((int)get_group_id(0) >= first_block(tree, level - 1))
        --level;
    const int within = get_group_id(0) - first_block(tree, level), stride = stride_of(level);
    const int columns = tree.columns[block_level(level)];
    const Node node = {block_level(level), within / columns, within % columns};
    const Tile block = node_tile(grid, node);
    const int south = block.row + block.cells_down, east = block.column + block.cells_across;
    // a point of the lattice is known to samples as far as the next ones
    if (block.row - stride > bottom || south + stride < top || block.column - stride > right
        || east + stride < left)
        return;
    const float step = 1.0f / stride;
    Real worst = 0.0f, highest = 0.0f;
    for (int next = block.column + get_local_id(0) * LANES; next <= east; next += GROUP * LANES) {
        // the last ones are moved back over others
        const int column = max(min(next, east - LANES + 1), block.column);
        Real below = line_heights(ground, block.row & -stride, column, east, stride);
        for (int line = block.row & -stride; line <= south; line += stride) {
            const Real above = below;
            below = line_heights(ground, line + stride, column, east, stride);
            highest = LARGER(highest, LARGER(ABSOLUTE(above), ABSOLUTE(below)));
            for (int row = max(line, block.row); row <= min(line + stride - 1, south); ++row) {
                const Real off = above + (below - above) * ((row - line) * step)
                               - row_heights(ground, row, column, east);
                worst = LARGER(ABSOLUTE(off), worst);
            }
        }
    }
    float drift = 0.0f, height = 0.0f;
    for (int lane = 0; lane < LANES; ++lane) {
        drift = larger(LANE(worst, lane), drift);
        height = larger(LANE(highest, lane), height);
    }
    drift = group_max(drift, scratch);
    height = group_max(height, scratch);
    // what a dozen roundings may have taken away
    if (get_local_id(0) == 0)
        drifts[get_group_id(0)] = drift > 0.0f ? drift + 1e-6f * height : 0.0f;
}

// From what is known of the nodes of a level to three levels above it; from 0 to the tiles themselves, too.
__kernel void gather(const Tree tree, const int level, const int count,
                     __global const float4 *tiles,          // (P,) deviation, minimum, maximum, holes
                     __global const float *drifts,          // of blocks
                     __global float4 *details,              // (N,) drift, minimum, maximum, holes
                     __global float *deviations)            // (N,)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const int index = tree.first[level > 0 ? level + 1 : 0] + i;
    const Node node = node_at(tree, index);
    float4 found = (float4)(0.0f, NAN, NAN, 0.0f);
    float deviation = NAN;
    const int k = node.level - level;
    const int rows = min((node.row + 1) << k, tree.rows[level]);
    const int columns = min((node.column + 1) << k, tree.columns[level]);
    for (int row = node.row << k; row < rows; ++row)
        for (int column = node.column << k; column < columns; ++column) {
            const int below = tree.first[level] + row * tree.columns[level] + column;
            const float4 part = level > 0 ? details[below] : tiles[below];
            deviation = fmax(deviation, level > 0 ? deviations[below] : part.x);
            found.y = fmin(found.y, part.y);
            found.z = fmax(found.z, part.z);
            found.w += part.w;
        }
    if (stride_of(node.level) > 1) {
        const int blocks = block_level(node.level), finer = node.level - blocks;
        const int south = min((node.row + 1) << finer, tree.rows[blocks]);
        const int east = min((node.column + 1) << finer, tree.columns[blocks]);
        __global const float *own = drifts + first_block(tree, node.level);
        for (int row = node.row << finer; row < south; ++row)
            for (int column = node.column << finer; column < east; ++column)
                found.x = fmax(found.x, own[row * tree.columns[blocks] + column]);
    }
    details[index] = found;
    deviations[index] = deviation;
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
                     const int columns, __global ushort *errors, __global ushort *inner_errors)
{
    const int i = get_global_id(0);
    if (i >= rows * columns)
        return;
    const Node node = {level, row + i / columns, column + i % columns};
    const size_t first = (size_t)node_index(tree, node) * TILE * TILE;
    for (int pair = 0; pair < TILE * TILE; ++pair)
        errors[first + pair] = inner_errors[first + pair] = 0;
}
