// Inside factors that keep an error beside edges that are given.
//
// Edges with factors of their own leave the inner part of a tile as the ladder measured it. What
// they change is the strip of triangles between each edge and the lattice, and that is measured here:
//
//     *---------*---------*      outer points, on the edge        at sample row b, a rung between
//      \      / | \     /  \     . . . samples of row b           both rows of points is at one
//     . \. ./ . | . \./. . .\.                                    place and has one height; between
//         *-----*----*           inner points, at depth d         two rungs the strip is straight
//
// Insides are tried in the order of the triangles that they make, until none of the four strips exceeds
// the error. When the lattice is one cell away no samples are between: at odd factors up to the cells
// there always is an inside that holds, if the edges do.
#ifndef FIT_H
#define FIT_H

#include "terrain/levels.h"
#include "terrain/strip.h"

// The largest error of a strip's samples between its two rows of points; beyond `enough` it is not sought.
inline float strip_error(const Ground ground, const Strip strip, float enough)
{
    Points outer, inner;
    uchar steps[2 * MOST_POINTS];
    for (int i = 0; i <= strip.outer; ++i)
        put_point(ground, strip.frame, strip.outer, i, 0.0f, &outer, i);
    for (int i = 1; i < strip.inner; ++i)
        put_point(ground, strip.frame, strip.inner, i, strip.depth, &inner, i - 1);
    step_rows(strip.outer, strip.inner, steps);
    float error = 0.0f;
    for (int row = 1; row < strip.depth && error <= enough; ++row)
        error = larger(strip_row_error(ground, strip, &outer, &inner, steps, row, 1), error);
    return error;
}

// Does the strip along an edge, to an inside of these factors, hold?
inline bool strip_holds(const Ground ground, Tile tile, int edge, float edge_factor, int2 insides,
                        float error)
{
    const bool along_u = edge % 2 == 1;
    const float depth = along_u ? (float)tile.cells_down / insides.y
                                : (float)tile.cells_across / insides.x;
    const Strip strip = {strip_frame(tile, edge), (int)edge_factor,
                         along_u ? insides.x : insides.y, depth};
    return depth <= 1.0f || strip_error(ground, strip, error) <= error;
}

// Of an inside factor of 1 beside a larger one the tessellator makes three segments, two of them
// without a width: a step between edge and inside would become an upright wall. Three segments cost
// the same.
inline int2 inside_factors_of(int2 level, Tile tile)
{
    return (int2)(max(factor_of(level.x, tile.cells_across), 3),
                  max(factor_of(level.y, tile.cells_down), 3));
}

inline int2 fitting_inside(const Ground ground, Tile tile, __global const float *inner_errors,
                           __global const int *order, __global const float *edge_factors,
                           float error)
{
    // one segment inside stands for three
    const int2 full = full_level(tile), least = min((int2)(1, 1), full);
    for (int i = 0; i < LEVELS * LEVELS; ++i) {
        const int2 level = (int2)(order[i] % LEVELS, order[i] / LEVELS);
        if (any(level < least) || any(level > full) || !(inner_errors[order[i]] <= error))
            continue;
        const int2 factors = inside_factors_of(level, tile);
        bool holds = true;
        for (int edge = 0; edge < EDGES && holds; ++edge)
            holds = strip_holds(ground, tile, edge, edge_factors[edge], factors, error);
        if (holds)
            return factors;
    }
    return inside_factors_of(full, tile);
}

#endif
