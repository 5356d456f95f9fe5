// Triangles between two rows of points that are divided differently.
//
//   outer  0-----1--2--3-----4-----5--6--7-----8      A strip advances one point at a time, on the
//           \   /|\ | /|\   / \   /|\ | /|\   /       outer or the inner row; each step is a
//            \ / | \|/ | \ /   \ / | \|/ | \ /        triangle with the point that the other row
//   inner     0--1--2--3--4-----5--6--7--8--9         has come to. The halves mirror each other.
//
// Which row advances next follows from where a row's points would come to lie were it divided as
// finely as can be, in 32 steps a half, doubling in ruler order (0 is the corner, 32 the middle):
//
//   half = 1   0                               each doubling first splits the step at the corner
//   half = 2   0               16              and then the next towards the middle, so the point
//   half = 3   0       8       16              with which a row of `half` steps begins its step k
//   half = 4   0       8       16      24      is known in closed form, and so is how many of a
//   half = 5   0   4   8       16      24      row's points lie before another: every triangle
//   ...                                        is made on its own.
//
// Where both rows have a point at the same place, the inner one steps first in the first half.
#ifndef TESSELLATOR_STITCH_H
#define TESSELLATOR_STITCH_H

#include "tessellator_division.h"

// the steps of half a division among those of the finest one
typedef struct {
    int steps;
    int split;                  // of the steps of the doubling before, this many are split in two
    int shift;                  // log2 of the length of such a half, in 64ths of half the division
} Ruler;

inline Ruler ruler_of(int steps)
{
    Ruler ruler = {steps, 0, 5};
    for (int power = 2; power <= steps; power *= 2)
        --ruler.shift;
    ruler.split = steps - (32 >> ruler.shift);
    return ruler;
}

// Returns where step 0 <= k < steps begins.
inline int ruler_place(const Ruler ruler, int k)
{
    return k <= 2 * ruler.split ? k << ruler.shift : (2 * k - 2 * ruler.split) << ruler.shift;
}

// Returns how many steps begin at a place or before it.
inline int steps_to(const Ruler ruler, int place)
{
    const int fine = place >> ruler.shift;
    const int steps = 1 + (fine <= 2 * ruler.split ? fine : ruler.split + fine / 2);
    return ruler.steps == 0 || place < 0 ? 0 : steps;
}

// a row of points, walked along
typedef struct {
    int first, stride, last;    // indices of its points; the last may be anywhere
    int points;
    Ruler ruler;                // steps in each half of its division
    bool odd;                   // a step in the middle, between the halves
} Row;

// where the primitives of a patch go
typedef struct {
    __global int *indices;      // of the patch's first triangle
    int base;                   // index of the patch's first point
    bool clockwise;             // seen with u to the right and v down
} Triangles;

inline void put_triangle(const Triangles triangles, int triangle, int a, int b, int c)
{
    __global int *corner = triangles.indices + 3 * triangle;
    corner[0] = triangles.base + a;
    corner[triangles.clockwise ? 1 : 2] = triangles.base + b;
    corner[triangles.clockwise ? 2 : 1] = triangles.base + c;
}

inline int point_of(const Row row, int i)
{
    return i == row.points - 1 ? row.last : row.first + i * row.stride;
}

inline int strip_triangles(int outer_points, int inner_points)
{
    return outer_points + inner_points - 2;
}

// the step between the halves: of both rows, of one, or of none
__attribute__((always_inline)) inline void stitch_middle(const Triangles triangles, int triangle, const Row outer, const Row inner)
{
    const int k = outer.ruler.steps, a = inner.ruler.steps - 1;
    const int o = point_of(outer, k), i = point_of(inner, a);
    if (outer.odd && inner.odd) {
        put_triangle(triangles, triangle, i, o, point_of(inner, a + 1));
        put_triangle(triangles, triangle + 1, point_of(inner, a + 1), o, point_of(outer, k + 1));
    } else if (outer.odd) {
        put_triangle(triangles, triangle, i, o, point_of(outer, k + 1));
    } else if (inner.odd) {
        put_triangle(triangles, triangle, i, o, point_of(inner, a + 1));
    }
}

// Stitches two rows; the outer one runs a step further at both ends. Items share the work.
//
//   triangle k + a            outer step k (o, o + 1, i)       inner step a (i, o, i + 1)
//   triangle count - 1 - ...  the same mirrored
__attribute__((always_inline)) inline void stitch(const Triangles triangles, int first, const Row outer, const Row inner,
                   Items items)
{
    const int outer_end = outer.points - 1, inner_end = inner.points - 1;
    const int last = first + outer_end + inner_end - 1;
    for (int k = items.first; k < outer.ruler.steps; k += items.step) {
        // the inner row has no step at the corner
        const int a = steps_to(inner.ruler, ruler_place(outer.ruler, k)) - 1;
        put_triangle(triangles, first + k + a,
                     point_of(outer, k), point_of(outer, k + 1), point_of(inner, a));
        put_triangle(triangles, last - k - a, point_of(outer, outer_end - k - 1),
                     point_of(outer, outer_end - k), point_of(inner, inner_end - a));
    }
    for (int a = items.first; a < inner.ruler.steps - 1; a += items.step) {
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
