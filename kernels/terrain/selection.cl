// The hull stage of levels of detail that promise an error: factors from the error ladder.
//
//   allow            the error that each tile is allowed: metres, or pixels of a camera
//   select_edges     one factor an edge, from the edge's own ladder and both tiles' needs
//   fit_inside       the cheapest pair of inside factors that holds beside these edges: fit.h
//   only_changed     every other tile culled: what a choice changed is measured, nothing else
//   tighten          after the finished mesh has been measured: tiles that exceed get less
//
// Built with: LEVELS of the ladder; EDGE_RULE, EDGES_BY_ERROR, EDGES_MIN or EDGES_MAX; what ground.h
// is built with.
#include "terrain/fit.h"
#include "terrain/neighbour.h"
#include "terrain/screen.h"

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

// The factor along u or v that the ladder has a tile meshed with, if its edges were to match: of the
// cheapest pair within `error`, or full resolution, which is right by definition.
inline float matched_factor(Grid grid, int patch, bool along_u, __global const float *errors,
                            float error)
{
    const Tile tile = tile_at(grid, patch);
    const int2 level = cheapest_level(errors + (size_t)patch * LEVELS * LEVELS, error,
                                      full_level(tile));
    return along_u ? factor_of(level.x, tile.cells_across) : factor_of(level.y, tile.cells_down);
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

__kernel void select_edges(const Grid grid, const float edge_share,
                           __global const float *allowed,           // (P,)
                           __global const float *share,             // (P,)
                           __global const float4 *details,          // (P,)
                           __global const float *across_errors,     // ((TR + 1) * TC, LEVELS)
                           __global const float *down_errors,       // (TR * (TC + 1), LEVELS)
                           __global const float *errors,            // (P, LEVELS, LEVELS)
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
#if EDGE_RULE == EDGES_BY_ERROR
        __global const float *along_edge = (edge % 2 == 0 ? down_errors : across_errors)
                                         + (size_t)edge_index(grid, patch, edge) * LEVELS;
        float factor = factor_of(edge_level(along_edge, edge_share * error, cells), cells);
#else
        // a culled neighbour has no say
        const int asked = isnan(allowed[other]) ? patch : other;
        const float own_factor = matched_factor(grid, patch, edge % 2 == 1, errors,
                                                allowed[patch] * share[patch]);
        const float other_factor = matched_factor(grid, asked, edge % 2 == 1, errors,
                                                  allowed[asked] * share[asked]);
        float factor = EDGE_RULE == EDGES_MIN ? fmin(own_factor, other_factor)
                                              : fmax(own_factor, other_factor);
#endif
        // tiles with holes are meshed in full, their edges too; so is what must be exact
        if (details[patch].w > 0.0f || details[other].w > 0.0f || error == 0.0f)
            factor = cells;
        put_factor(edge_factors + patch * EDGES + edge,
                   isnan(allowed[patch]) ? 0.0f : factor, changed + patch);
    }
}

__kernel void fit_inside(const Grid grid,
                         __global const float *heights,             // (R, C)
                         __global const uchar *holes,               // (R, C) where MASKED
                         __global const float *detail_heights,      // where DETAIL
                         __global const float *allowed,             // (P,)
                         __global const float *share,               // (P,)
                         __global const float *measured,            // (P,)
                         __global const float *errors,              // (P, LEVELS, LEVELS)
                         __global const float *inner_errors,        // (P, LEVELS, LEVELS)
                         __global const int *order,                 // (LEVELS * LEVELS,) pairs
                         __global const float *edge_factors,        // (P, 4)
                         __global uchar *changed,                   // (P,)
                         __global float *inside_factors)            // (P, 2)
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid))
        return;
    // what was measured beside these edges and holds stays
    if (!changed[patch] && !(measured[patch] > allowed[patch]))
        return;
    const Ground ground = {grid, heights, holes, detail_heights};
    __global const float *edges = edge_factors + patch * EDGES;
    const size_t ladder = (size_t)patch * LEVELS * LEVELS;
    const float error = allowed[patch] * share[patch];
    const bool is_single = edges[0] <= 1.0f && edges[1] <= 1.0f && edges[2] <= 1.0f
                        && edges[3] <= 1.0f && errors[ladder] <= error;
    int2 factors = (int2)(1, 1);
    if (isnan(error))
        factors = (int2)(0, 0);
    else if (!is_single)
        factors = fitting_inside(ground, tile_at(grid, patch), inner_errors + ladder, order, edges,
                                 error);
    put_factor(inside_factors + patch * INSIDES, factors.x, changed + patch);
    put_factor(inside_factors + patch * INSIDES + 1, factors.y, changed + patch);
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
