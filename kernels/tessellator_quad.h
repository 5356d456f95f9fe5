// The quad domain: a boundary, a lattice inside it, and a strip between them along each edge.
//
//       v = 0 (edge 1)
//       2-----3-----4-----5      Points: the boundary, walked clockwise with u to the right and v
//       |                 |      down, from u = 0, v = 1; then the lattice, row by row.
//       |  10----11----12 |
// u = 0 1   | \   |   / | 6      Triangles: the strips along the edges u = 0, v = 0, u = 1, v = 1;
//  (0)  |  13----14----15 |      then the lattice, row by row, two a cell.
//       |                 |
//       0-----9-----8-----7      Factors here: 2, 3, 2, 3 and inside 4 along u, 3 along v.
#ifndef TESSELLATOR_QUAD_H
#define TESSELLATOR_QUAD_H

#include "tessellator_stitch.h"

enum { QUAD_EDGES = 4, QUAD_AXES = 2 };

typedef struct {
    int kind;                       // CULLED, WHOLE or DIVIDED
    uint edges[QUAD_EDGES];         // fixed point: u = 0, v = 0, u = 1, v = 1
    uint insides[QUAD_AXES];        // along u, along v
} QuadFactors;

// points of the lattice: those of the inside divisions, without their ends
typedef struct {
    int first, columns, rows;
} Lattice;

inline QuadFactors quad_factors(__global const float *edges, __global const float *insides,
                                size_t patch, int partitioning)
{
    QuadFactors factors;
    factors.kind = fix_factors(edges + QUAD_EDGES * patch, QUAD_EDGES,
                               insides + QUAD_AXES * patch, QUAD_AXES,
                               partitioning, factors.edges, factors.insides);
    return factors;
}

inline Lattice quad_lattice(const QuadFactors factors, int partitioning)
{
    Lattice lattice = {0, segments_of(factors.insides[0], partitioning) - 1,
                       segments_of(factors.insides[1], partitioning) - 1};
    for (int edge = 0; edge < QUAD_EDGES; ++edge)
        lattice.first += segments_of(factors.edges[edge], partitioning);
    return lattice;
}

inline int quad_points(const QuadFactors factors, int partitioning)
{
    const Lattice lattice = quad_lattice(factors, partitioning);
    return factors.kind == CULLED ? 0
         : factors.kind == WHOLE  ? QUAD_EDGES
                                  : lattice.first + lattice.columns * lattice.rows;
}

inline int quad_triangles(const QuadFactors factors, int partitioning)
{
    const Lattice lattice = quad_lattice(factors, partitioning);
    const int across = lattice.columns - 1, down = lattice.rows - 1;
    return factors.kind == CULLED ? 0
         : factors.kind == WHOLE  ? 2
                                  : lattice.first + 2 * (across + down) + 2 * across * down;
}

// Places the points of an edge, the last one left to the next edge.
inline void fill_boundary(__global uint2 *points, int edge, const Division division, Items items)
{
    for (int k = items.first; k < division.segments; k += items.step) {
        // u = 0 is walked against v, v = 0 with u, u = 1 with v, v = 1 against u
        const uint along = place(division, edge == 1 || edge == 2 ? k : division.segments - k);
        const uint across = edge < 2 ? 0 : FIXED_ONE;
        points[k] = edge % 2 == 0 ? (uint2)(across, along) : (uint2)(along, across);
    }
}

// lattice point at the corner where the walk along an edge begins
inline int lattice_corner(const Lattice lattice, int edge)
{
    const int right = lattice.columns - 1, bottom = (lattice.rows - 1) * lattice.columns;
    const bool is_right = edge == 2 || edge == 3, is_bottom = edge == 0 || edge == 3;
    return lattice.first + (is_right ? right : 0) + (is_bottom ? bottom : 0);
}

// the lattice's row or column along an edge, in the direction of the walk
inline Row lattice_row(const Lattice lattice, int edge, const Division along)
{
    const int stride = edge % 2 == 0 ? lattice.columns : 1;
    Row row = {lattice_corner(lattice, edge), edge == 1 || edge == 2 ? stride : -stride,
               lattice_corner(lattice, (edge + 1) % QUAD_EDGES),
               along.segments - 1, along.half_steps, along.odd};
    return row;
}

// Returns whether a cell's diagonal falls, \, or rises, /. Diagonals point to the middle:
//
//    | \ \ \ / / |    with an odd number of cells, the middle column falls
//    | / / / / / |    and the middle row rises, with the cell that is in both
//    | / / \ \ \ |
inline bool diagonal_falls(int column, int row, int across, int down)
{
    const int right = 2 * column + 1 - across, below = 2 * row + 1 - down;
    return below != 0 && (right == 0 || (right > 0) == (below > 0));
}

inline void lattice_cell(const Triangles triangles, int triangle, int corner, int columns,
                         bool falls)
{
    //  a---b
    //  |   |
    //  c---d
    const int a = corner, b = corner + 1, c = corner + columns, d = corner + columns + 1;
    put_triangle(triangles, triangle, a, b, falls ? d : c);
    put_triangle(triangles, triangle + 1, falls ? a : b, d, c);
}

// the boundary, and the strips that join it to the lattice
inline void fill_quad_edges(const QuadFactors factors, const Division *insides,
                            const Lattice lattice, int partitioning,
                            __global uint2 *points, const Triangles triangles)
{
    int point = 0, triangle = 0;
    for (int edge = 0; edge < QUAD_EDGES; ++edge) {
        const Division division = divide(factors.edges[edge], partitioning);
        fill_boundary(points + point, edge, division, group_items());
        const int next = point + division.segments;
        const Row outer = {point, 1, edge == QUAD_EDGES - 1 ? 0 : next,
                           division.segments + 1, division.half_steps, division.odd};
        // along u = 0 and u = 1 runs v
        const Row inner = lattice_row(lattice, edge, insides[1 - edge % 2]);
        if (factors.kind == DIVIDED)
            stitch(triangles, triangle, outer, inner, group_items());
        point = next;
        triangle += strip_triangles(outer.points, inner.points);
    }
}

// rows and columns of the lattice go to rows and columns of work-items
inline void fill_lattice(const Lattice lattice, __local const uint *u, __local const uint *v,
                         __global uint2 *points, const Triangles triangles)
{
    const int across = lattice.columns - 1, down = lattice.rows - 1;
    const int strips = lattice.first + 2 * (across + down);
    for (int row = get_local_id(1); row < lattice.rows; row += get_local_size(1)) {
        const int point = lattice.first + row * lattice.columns;
        for (int column = get_local_id(0); column < lattice.columns; column += get_local_size(0))
            points[point + column] = (uint2)(u[column + 1], v[row + 1]);
    }
    for (int row = get_local_id(1); row < down; row += get_local_size(1)) {
        const int point = lattice.first + row * lattice.columns;
        for (int column = get_local_id(0); column < across; column += get_local_size(0))
            lattice_cell(triangles, strips + 2 * (row * across + column), point + column,
                         lattice.columns, diagonal_falls(column, row, across, down));
    }
}

#endif
