// Triangles between two rows of points that are divided differently.
//
//   o   o+1        o           outer row     The strip between the rows goes on by one point at a
//   *-----*        *                         time, on one row or the other; each step is a triangle
//    \   /        / \                        with the point that the other row has come to. The
//     \ /        /   \                       inner row lacks the first and last step of its own
//      *        *-----*                      division.
//      i        i    i+1       inner row
//
// Rows step in the order of their rulers, the inner one first where both step at the same place.
// With 4 steps in half the outer row and 3 in half the inner one:
//
//   place       0     16    32    48  |  48    32    16    0
//   outer       o     o     o     o   |  o     o     o     o       in the second half everything
//   inner             i     i         |        i     i             is mirrored, order included
//   triangles   0     1 2   3 4   5   |  6     7 8   9 10  11
//
// So the number of each triangle is that of the steps before it, on both rows: triangles are made
// each on its own. Where the division is odd, a step of the row crosses the middle.
#ifndef TESSELLATOR_STITCH_H
#define TESSELLATOR_STITCH_H

#include "tessellation/division.h"
#include "tessellation/items.h"

// a row of points, walked along
typedef struct {
    int first, stride, last;    // indices of its points; the last may be anywhere
    int points;
    StepRuler ruler;                 // of its whole division
    bool odd;
} Row;

// where the triangles of a patch go
typedef struct {
    __global int *indices;      // of its first triangle
    int base;                   // its first point
    bool clockwise;             // seen with u to the right and v down
} Triangles;

// Puts a clockwise triangle, or turns it.
inline void put_triangle(const Triangles triangles, int triangle, int a, int b, int c)
{
    __global int *corner = triangles.indices + 3 * triangle;
    corner[0] = triangles.base + a;
    corner[triangles.clockwise ? 1 : 2] = triangles.base + b;
    corner[triangles.clockwise ? 2 : 1] = triangles.base + c;
}

// the points of an edge, the last of which is the first of the next edge
inline Row boundary_row(int first, int last, const Division division)
{
    const Row row = {first, 1, last, division.segments + 1, division.ruler, division.odd};
    return row;
}

inline int point_of(const Row row, int i)
{
    return i == row.points - 1 ? row.last : row.first + i * row.stride;
}

inline int strip_triangles(const Row outer, const Row inner)
{
    return outer.points + inner.points - 2;
}

// Puts the steps across the middle: of both rows, of one, or of none.
inline void stitch_middle(const Triangles triangles, int triangle, const Row outer, const Row inner)
{
    const int k = outer.ruler.steps, a = inner.ruler.steps - 1;
    const int o = point_of(outer, k), i = point_of(inner, a);
    if (inner.odd)
        put_triangle(triangles, triangle, i, o, point_of(inner, a + 1));
    if (outer.odd)
        put_triangle(triangles, triangle + inner.odd,
                     o, point_of(outer, k + 1), inner.odd ? point_of(inner, a + 1) : i);
}

// Puts the strip between two rows, beginning with triangle `first`; items share it. Inlined always:
// to pass rows through memory costs a CPU a third of all its time.
__attribute__((always_inline))
inline void stitch(const Triangles triangles, int first, const Row outer, const Row inner,
                   Items items)
{
    const int outer_end = outer.points - 1, inner_end = inner.points - 1;
    const int last = first + strip_triangles(outer, inner) - 1;
    for (int k = items.first; k < outer.ruler.steps; k += items.step) {
        // outer step k, and its mirror image
        const int a = steps_to(inner.ruler, ruler_place(outer.ruler, k)) - 1;
        put_triangle(triangles, first + k + a,
                     point_of(outer, k), point_of(outer, k + 1), point_of(inner, a));
        put_triangle(triangles, last - k - a, point_of(outer, outer_end - k - 1),
                     point_of(outer, outer_end - k), point_of(inner, inner_end - a));
    }
    for (int a = items.first; a < inner.ruler.steps - 1; a += items.step) {
        // inner step a, which is step a + 1 of its division
        const int k = steps_to(outer.ruler, ruler_place(inner.ruler, a + 1) - 1);
        put_triangle(triangles, first + k + a,
                     point_of(inner, a), point_of(outer, k), point_of(inner, a + 1));
        put_triangle(triangles, last - k - a, point_of(inner, inner_end - a - 1),
                     point_of(outer, outer_end - k), point_of(inner, inner_end - a));
    }
    if (items.first == 0)
        stitch_middle(triangles, first + outer.ruler.steps + inner.ruler.steps - 1, outer, inner);
}

#endif
