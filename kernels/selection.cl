// The hull stage of levels of detail that promise an error: factors from the error ladder.
//
//   allow            the error that each tile is allowed: metres, or pixels of a camera
//   select_inside    the cheapest pair of inside factors whose measured error is within it
//   select_edges     one factor an edge, from the edge's own ladder and both tiles' needs
//   settle_inside    no inside factor of 1 where another is more
//   only_changed     every other tile culled: what a choice changed is measured, nothing else
//   tighten          after the finished mesh has been measured: tiles that exceed get less
//
// Built with: LEVELS of the ladder; EDGE_RULE, EDGES_BY_ERROR, EDGES_MIN or EDGES_MAX.
#include "levels.h"
#include "neighbour.h"
#include "screen.h"

#define EDGES_BY_ERROR 0
#define EDGES_MIN 1
#define EDGES_MAX 2

inline void put_factor(__global float *place, float factor, __global uchar *changed)
{
    *changed |= *place != factor;
    *place = factor;
}

__kernel void allow(const Grid grid, const View view, const int cull,
                    const float metres, const float pixels,     // INFINITY where not asked for
                    __global const float4 *details,             // (P,)
                    __global const float *weights,              // (P,) that errors count
                    __global float *allowed)                    // (P,) NaN where culled
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid))
        return;
    const float minimum = details[patch].y, maximum = details[patch].z;
    const Tile tile = tile_at(grid, patch);
    float error = metres / weights[patch];
    if (!isinf(pixels))
        error = fmin(error, metres_for_pixels(view, tile_box(grid, tile, minimum, maximum),
                                              pixels / weights[patch]));
    // a dozen roundings of differences of heights, here and wherever else it is measured
    error = fmax(error - 1e-6f * (maximum - minimum), 0.0f);
    const bool culled =
        isnan(minimum) || (cull && is_out_of_view(grid, tile, view, minimum, maximum));
    allowed[patch] = culled ? NAN : error;
}

// Full resolution is right by definition; below it the cheapest level pair within `error`.
inline int2 cheapest_levels(__global const float *errors, __global const int *costs, float error,
                            int2 full)
{
    int2 best = full;
    int cost = costs[full.y * LEVELS + full.x];
    for (int v = 0; v <= full.y; ++v)
        for (int u = 0; u <= full.x; ++u) {
            const int index = v * LEVELS + u;
            if (costs[index] < cost && errors[index] <= error) {
                cost = costs[index];
                best = (int2)(u, v);
            }
        }
    return best;
}

__kernel void select_inside(const Grid grid,
                            __global const float *allowed,      // (P,)
                            __global const float *share,        // (P,) of it that the ladder gets
                            __global const float *errors,       // (P, LEVELS, LEVELS)
                            __global const int *costs,          // (LEVELS, LEVELS) triangles
                            __global float *wanted)             // (P, 2) inside factors
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid))
        return;
    const Tile tile = tile_at(grid, patch);
    // the level whose factor is the tile's cells
    const int2 full = (int2)(tile.cells_across / 2, tile.cells_down / 2);
    const int2 level =
        cheapest_levels(errors + (size_t)patch * LEVELS * LEVELS, costs,
                        allowed[patch] * share[patch], min(full, (int2)(LEVELS - 1)));
    const bool culled = isnan(allowed[patch]);
    wanted[patch * INSIDES + 0] = culled ? 0.0f : factor_of(level.x, tile.cells_across);
    wanted[patch * INSIDES + 1] = culled ? 0.0f : factor_of(level.y, tile.cells_down);
}

// the coarsest level of an edge within `error`
inline int edge_level(__global const float *errors, float error, int cells)
{
    int level = 0;
    while (level < LEVELS - 1 && 2 * level + 1 < cells && !(errors[level] <= error))
        ++level;
    return level;
}

// index of a patch's edge among those that run across or down
inline int edge_index(Grid grid, int patch, int edge)
{
    const int row = patch / grid.tile_columns, column = patch % grid.tile_columns;
    return edge % 2 == 0 ? row * (grid.tile_columns + 1) + column + (edge == 2)
                         : (row + (edge == 3)) * grid.tile_columns + column;
}

__kernel void select_edges(const Grid grid,
                           __global const float *allowed,           // (P,)
                           __global const float *share,             // (P,)
                           __global const float4 *details,          // (P,)
                           __global const float *across_errors,     // ((TR + 1) * TC, LEVELS)
                           __global const float *down_errors,       // (TR * (TC + 1), LEVELS)
                           __global const float *wanted,            // (P, 2) inside factors
                           __global float *edge_factors,            // (P, 4)
                           __global uchar *changed)                 // (P,) has any factor?
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid))
        return;
    const Tile tile = tile_at(grid, patch);
    changed[patch] = 0;
    for (int edge = 0; edge < EDGES; ++edge) {
        const int other = neighbour(grid, patch, edge + 1);
        const int cells = edge_cells(tile, edge);
        // fmin and fmax pass over the NaN of a culled neighbour; such an edge is the patch's own
        const float error = fmin(allowed[patch] * share[patch], allowed[other] * share[other]);
        __global const float *errors =
            (edge % 2 == 0 ? down_errors : across_errors) + edge_index(grid, patch, edge) * LEVELS;
        const int along = edge % 2 == 0;
        const float own_factor = wanted[patch * INSIDES + along];
        const float other_factor = isnan(allowed[other]) ? own_factor
                                                         : wanted[other * INSIDES + along];
#if EDGE_RULE == EDGES_BY_ERROR
        float factor = factor_of(edge_level(errors, error, cells), cells);
#elif EDGE_RULE == EDGES_MIN
        float factor = fmin(own_factor, other_factor);
#else
        float factor = fmax(own_factor, other_factor);
#endif
        // tiles with holes are meshed in full, their edges too; so is what must be exact
        if (details[patch].w > 0.0f || details[other].w > 0.0f || error == 0.0f)
            factor = cells;
        put_factor(edge_factors + patch * EDGES + edge,
                   isnan(allowed[patch]) ? 0.0f : factor, changed + patch);
    }
}

// Of an inside factor of 1 beside a larger one the tessellator makes three segments, two of them
// without a width: a step between edge and inside would become an upright wall. Three segments
// cost the same.
__kernel void settle_inside(const int patches,
                            __global const float *wanted,           // (P, 2)
                            __global const float *edge_factors,     // (P, 4)
                            __global float *inside_factors,         // (P, 2)
                            __global uchar *changed)                // (P,)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    __global const float *edge = edge_factors + patch * EDGES;
    const float along_u = wanted[patch * INSIDES], along_v = wanted[patch * INSIDES + 1];
    const bool is_single = along_u <= 1.0f && along_v <= 1.0f && edge[0] <= 1.0f
                        && edge[1] <= 1.0f && edge[2] <= 1.0f && edge[3] <= 1.0f;
    put_factor(inside_factors + patch * INSIDES,
               is_single ? along_u : fmax(along_u, 3.0f), changed + patch);
    put_factor(inside_factors + patch * INSIDES + 1,
               is_single ? along_v : fmax(along_v, 3.0f), changed + patch);
}

__kernel void only_changed(const int count,
                           __global const uchar *changed,           // (P,)
                           __global const float *edge_factors,      // (P, 4)
                           __global float *kept_factors)            // (P, 4) 0 culls a patch
{
    const int index = get_global_id(0);
    if (index < count)
        kept_factors[index] = changed[index / EDGES] ? edge_factors[index] : 0.0f;
}

// Where the finished mesh exceeds what is allowed, give the ladder a smaller share of it; in the
// end none at all, which is full resolution.
__kernel void tighten(const int patches, const float least_share,
                      __global const float *allowed,        // (P,)
                      __global const float *measured,       // (P,)
                      __global float *share,                // (P,)
                      __global uint *counts)                // (2,) exceeding, and can do better
{
    const int patch = get_global_id(0);
    if (patch >= patches || !(measured[patch] > allowed[patch]))
        return;
    atomic_inc(counts);
    if (share[patch] == 0.0f)
        return;
    atomic_inc(counts + 1);
    const float excess = allowed[patch] / measured[patch];
    const float next = share[patch] * fmin(fmax(excess, 0.5f), 0.85f);
    share[patch] = next < least_share ? 0.0f : next;
}
