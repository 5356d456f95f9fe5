// The triangle domain: a boundary and rings inside it, down to a triangle or a point.
//
//    w = 1  v = 0 (edge 1)
//        3----4----5----6       Points: the boundary, then ring after ring inside it, each walked
//        |             .  u = 1 clockwise with u to the right and v down, from where v is largest.
//        2   10---11  7         The innermost ring of an odd division is a triangle, that of an
// u = 0  |    |  .   .          even one the point in the middle.
//  (0)   1    9    8            Triangles: ring by ring from the outside, the strips along u = 0,
//        |       .    w = 0     v = 0 and w = 0; then the triangle in the middle.
//        |    .        (2)
//        0 .                    Factors here: 3, 3, 3 and inside 3. w = 1 - u - v.
//    v = 1
#ifndef TESSELLATOR_TRIANGLE_H
#define TESSELLATOR_TRIANGLE_H

#include "tessellation/stitch.h"

enum { TRIANGLE_EDGES = 3, TRIANGLE_AXES = 1 };

#define TWO_THIRDS (2 * FIXED_ONE / 3)
#define ONE_THIRD (FIXED_ONE / 3)

typedef struct {
    int kind;                       // CULLED, WHOLE or DIVIDED
    uint edges[TRIANGLE_EDGES];     // fixed point: u = 0, v = 0, w = 0
    uint inside[TRIANGLE_AXES];
} TriangleFactors;

inline TriangleFactors triangle_factors(__global const float *edges,
                                        __global const float *insides,
                                        size_t patch, int partitioning)
{
    TriangleFactors factors;
    factors.kind = fix_factors(edges + TRIANGLE_EDGES * patch, TRIANGLE_EDGES,
                               insides + TRIANGLE_AXES * patch, TRIANGLE_AXES,
                               partitioning, factors.edges, factors.inside);
    return factors;
}

inline int triangle_boundary_points(const TriangleFactors factors, int partitioning)
{
    int points = 0;
    for (int edge = 0; edge < TRIANGLE_EDGES; ++edge)
        points += segments_of(factors.edges[edge], partitioning);
    return points;
}

// Ring r = 1, 2, ... has an inside division's points without r of them at both ends:
// segments + 1 - 2 r along an edge, and 3 (segments - 2 r) all around. The sums of that over the
// rings before r, and of the 6 (segments - 2 r + 1) triangles outside each but the first:
inline int ring_first_point(int segments, int ring)
{
    return 3 * (ring - 1) * (segments - ring);
}

inline int ring_first_triangle(int segments, int ring)
{
    return 3 * (segments - 2) + 6 * (ring - 2) * (segments - ring);
}

inline int triangle_points(const TriangleFactors factors, int partitioning)
{
    const int segments = segments_of(factors.inside[0], partitioning);
    const int inside = ring_first_point(segments, (segments + 1) / 2) + (segments % 2 == 0);
    const int boundary = triangle_boundary_points(factors, partitioning);
    return factors.kind == CULLED ? 0 : factors.kind == WHOLE ? boundary : boundary + inside;
}

inline int triangle_triangles(const TriangleFactors factors, int partitioning)
{
    const int segments = segments_of(factors.inside[0], partitioning);
    const int inside = ring_first_triangle(segments, segments / 2 + 1) + segments % 2;
    const int boundary = triangle_boundary_points(factors, partitioning);
    return factors.kind == CULLED ? 0 : factors.kind == WHOLE ? 1 : boundary + inside;
}

// point of an edge or of a ring's side, `along` from one end and `across` from the boundary
inline uint2 triangle_point(int edge, uint along, uint across)
{
    return edge == 0 ? (uint2)(across, along)
         : edge == 1 ? (uint2)(along, across)
                     : (uint2)(along, FIXED_ONE - along - across);
}

// Places the points of ring r >= 1 but the middle one. Its sides are the inside division pushed in
// from the boundary; what is lost at each end is half of the way in, as w = 1 - u - v has it.
inline void fill_ring_points(__global uint2 *points, int ring, const Division inside, Items items)
{
    const uint depth = place(inside, ring);
    const uint across = (depth * TWO_THIRDS + FIXED_HALF) / FIXED_ONE;
    const int steps = inside.segments - 2 * ring;
    for (int edge = 0; edge < TRIANGLE_EDGES; ++edge)
        for (int k = items.first; k < steps; k += items.step) {
            const int i = ring + (edge == 1 ? k : steps - k);
            const uint along = place(inside, i) - (across + 1) / 2;
            points[edge * steps + k] = triangle_point(edge, along, across);
        }
}

// side of a ring of `steps` a side, in the direction of the walk
inline Row ring_row(int first, int edge, int steps, const StepRuler ruler, bool odd)
{
    const int last = edge == TRIANGLE_EDGES - 1 ? first : first + (edge + 1) * steps;
    Row row = {first + edge * steps, 1, last, steps + 1, ruler, odd};
    return row;
}

// Joins ring r >= 2 to the one around it: both go on with the same division, a step less at both
// ends each ring further in, so that the strip is a zigzag.
inline void stitch_rings(const Triangles triangles, int triangle, int boundary, int ring,
                         const Division inside, Items items)
{
    const StepRuler ruler = step_ruler(inside.ruler.steps - (ring - 1));
    const int steps = inside.segments - 2 * ring;
    const int outer_first = boundary + ring_first_point(inside.segments, ring - 1);
    const int inner_first = boundary + ring_first_point(inside.segments, ring);
    for (int edge = 0; edge < TRIANGLE_EDGES; ++edge) {
        const Row outer = ring_row(outer_first, edge, steps + 2, ruler, inside.odd);
        const Row inner = ring_row(inner_first, edge, steps, ruler, inside.odd);
        stitch(triangles, triangle, outer, inner, items);
        triangle += strip_triangles(outer, inner);
    }
}

// the boundary, and the strips that join it to the first ring
inline void fill_triangle_edges(const TriangleFactors factors, const Division inside,
                                int boundary, int partitioning,
                                __global uint2 *points, const Triangles triangles)
{
    int point = 0, triangle = 0;
    for (int edge = 0; edge < TRIANGLE_EDGES; ++edge) {
        const Division division = divide(factors.edges[edge], partitioning);
        const int next = point + division.segments;
        for (int k = group_items().first; k < division.segments; k += group_items().step) {
            const uint along = place(division, edge == 1 ? k : division.segments - k);
            points[point + k] = triangle_point(edge, along, 0);
        }
        const Row outer = boundary_row(point, edge == TRIANGLE_EDGES - 1 ? 0 : next, division);
        const Row inner = ring_row(boundary, edge, inside.segments - 2, inside.ruler, inside.odd);
        if (factors.kind == DIVIDED)
            stitch(triangles, triangle, outer, inner, group_items());
        point = next;
        triangle += strip_triangles(outer, inner);
    }
}

// rings go to rows of work-items
inline void fill_rings(const Division inside, int boundary,
                       __global uint2 *points, const Triangles triangles)
{
    const int segments = inside.segments, middle = segments / 2;
    for (int ring = 1 + get_local_id(1); ring <= middle; ring += get_local_size(1)) {
        fill_ring_points(points + boundary + ring_first_point(segments, ring), ring, inside,
                         row_items());
        if (ring > 1)
            stitch_rings(triangles, boundary + ring_first_triangle(segments, ring), boundary,
                         ring, inside, row_items());
    }
    if (group_items().first != 0)
        return;
    const int last = boundary + ring_first_point(segments, middle);
    if (inside.odd)
        put_triangle(triangles, boundary + ring_first_triangle(segments, middle + 1),
                     last, last + 1, last + 2);
    else
        points[last] = (uint2)(ONE_THIRD, ONE_THIRD);
}

#endif
