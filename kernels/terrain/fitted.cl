// Leaves whose heights float: what each is allowed, and which have to ask for less.
//
//   rooms         what each leaf allows, whatever it was chosen for
//   ask, tighten  tiles whose leaf exceeds are asked for less
//
// The heights are found by terrain/floating.cl.
//
// Built with: what ground.h is built with.
#include "terrain/allowance.h"
#include "terrain/node.h"

__kernel void rooms(const Grid grid, const Tree tree,
                    __global const float4 *details,             // (N,)
                    ALLOWANCE_ARGUMENTS
                    const int count, __global const int *leaves,
                    __global const float *edge_factors,         // (P, 4) 0 where a leaf was split
                    __global float *allowed,                    // (P,) 0 where nothing is drawn
                    __global uchar *drawn)                      // (P,)
{
    const int leaf = get_global_id(0);
    if (leaf >= count)
        return;
    allowed[leaf] = 0.0f;
    drawn[leaf] = edge_factors[leaf * EDGES] > 0.0f;
    if (!drawn[leaf])
        return;
    const Allowance allowance = ALLOWANCE;
    const int index = leaves[leaf];
    const float error = allowed_of(grid, allowance, node_tile(grid, node_at(tree, index)), details[index],
                                   index);
    allowed[leaf] = error > 0.0f ? error : 0.0f;
}

__kernel void ask(const Grid grid, const Tree tree, const int count, __global const int *leaves,
                  __global const float *allowed,                // (P,) 0 where nothing is drawn
                  __global const float *measured,               // (P,)
                  const float least, const float most,          // steps of a weight
                  const int reach,                              // tiles around a leaf that go with it
                  __global float *steps,                        // (tiles,) 1 before
                  __global uint *exceeding)                     // (1,) leaves that do
{
    const int leaf = get_global_id(0);
    if (leaf >= count || !(measured[leaf] > allowed[leaf]))
        return;
    atomic_inc(exceeding);
    const float excess = allowed[leaf] > 0.0f ? sqrt(measured[leaf] / allowed[leaf]) : most;
    const int step = as_int(smaller(larger(excess, least), most));
    const Node node = node_at(tree, leaves[leaf]);
    const int k = node.level, top = max((node.row << k) - reach, 0), left = max((node.column << k) - reach, 0);
    const int bottom = min(((node.row + 1) << k) + reach, grid.tile_rows);
    const int right = min(((node.column + 1) << k) + reach, grid.tile_columns);
    for (int row = top; row < bottom; ++row)
        for (int column = left; column < right; ++column)
            // floats above 0 are in the order of their bits
            atomic_max((__global int *)steps + row * grid.tile_columns + column, step);
}

__kernel void tighten(const int tiles, __global const float *steps,
                      __global float *weights)                  // (tiles,) that errors count when leaves
                                                                // are chosen
{
    const int tile = get_global_id(0);
    if (tile < tiles)
        weights[tile] *= steps[tile];
}
