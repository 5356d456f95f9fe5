// The quad domain: a boundary, a lattice inside it, and a strip between them along each edge.
//
//            v = 0 (edge 1)
//        2------3------4------5    Points: the boundary, walked clockwise with u to the right and
//        |                    |    v down, from u = 0, v = 1; then the lattice, row by row.
//        |   10----11----12   |
//        |    | \  |  / |    |    Triangles: the strips along u = 0, v = 0, u = 1 and v = 1; then
// u = 0  1   13----14----15   6    the lattice, row by row, two a cell.
//  (0)   |    | /  |  \ |    |
//        |   16----17----18   |    Factors here: 2, 3, 2, 3 and inside 4, 4.
//        |                    |
//        0------9------8------7
#ifndef TESSELLATOR_QUAD_H
#define TESSELLATOR_QUAD_H

#include "tessellation/stitch.h"

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

// Places the points of an edge; the last is the next edge's.
inline void fill_quad_edge(__global uint *points, int edge, const Division division, Items items)
{
    for (int k = items.first; k < division.segments; k += items.step) {
        // u = 0 is walked against v, v = 0 with u, u = 1 with v, v = 1 against u
        const uint along = place(division, edge == 1 || edge == 2 ? k : division.segments - k);
        const uint across = edge < 2 ? 0 : FIXED_ONE;
        points[2 * k + edge % 2] = across;
        points[2 * k + 1 - edge % 2] = along;
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
               along.segments - 1, along.ruler, along.odd};
    return row;
}

// A cell's two triangles as indices relative to its first corner.
//
//   a---b        falls  a b d, a d c
//   |   |        rises  a b c, b d c      clockwise; otherwise the last two corners change places
//   c---d
typedef struct {
    int corners[6];
} Cell;

inline Cell lattice_cell(bool falls, int columns, bool clockwise)
{
    const int a = 0, b = 1, c = columns, d = columns + 1;
    const int third = falls ? d : c, fourth = falls ? a : b;
    const Cell cell = {{a, clockwise ? b : third, clockwise ? third : b,
                        fourth, clockwise ? d : c, clockwise ? c : d}};
    return cell;
}

inline void fill_cells(__global int *indices, int corner, const Cell cell, int begin, int end,
                       Items items)
{
    for (int column = begin + items.first; column < end; column += items.step)
        for (int i = 0; i < 6; ++i)
            indices[6 * column + i] = cell.corners[i] + (corner + column);
}

// Diagonals point to the middle:
//
//    | \ \ \ / / |    with an odd number of cells, the middle column falls
//    | / / / / / |    and the middle row rises, with the cell that is in both
//    | / / \ \ \ |
inline void fill_cell_row(const Triangles triangles, int triangle, int corner, int row,
                          int across, int down)
{
    const int below = 2 * row + 1 - down;
    const int turn = below < 0 ? (across + 1) / 2 : across / 2;
    const Cell left = lattice_cell(below < 0, across + 1, triangles.clockwise);
    const Cell right = lattice_cell(below > 0, across + 1, triangles.clockwise);
    __global int *indices = triangles.indices + 3 * triangle;
    fill_cells(indices, triangles.base + corner, left, 0, turn, row_items());
    fill_cells(indices, triangles.base + corner, right, turn, across, row_items());
}

inline void place_all(const Division division, __local uint *places, Items items)
{
    for (int i = items.first; i <= division.segments; i += items.step)
        places[i] = place(division, i);
}

inline void fill_row(__global uint *points, __local const uint *u, uint v, int count, Items items)
{
    for (int column = items.first; column < count; column += items.step) {
        points[2 * column] = u[column];
        points[2 * column + 1] = v;
    }
}

// the boundary, and the strips that join it to the lattice
inline void fill_quad_edges(const QuadFactors factors, const Division *insides,
                            const Lattice lattice, int partitioning,
                            __global uint *points, const Triangles triangles)
{
    int point = 0, triangle = 0;
    for (int edge = 0; edge < QUAD_EDGES; ++edge) {
        const Division division = divide(factors.edges[edge], partitioning);
        fill_quad_edge(points + 2 * point, edge, division, group_items());
        const int next = point + division.segments;
        const Row outer = boundary_row(point, edge == QUAD_EDGES - 1 ? 0 : next, division);
        // along u = 0 and u = 1 runs v
        const Row inner = lattice_row(lattice, edge, insides[1 - edge % 2]);
        if (factors.kind == DIVIDED)
            stitch(triangles, triangle, outer, inner, group_items());
        point = next;
        triangle += strip_triangles(outer, inner);
    }
}

// rows and columns of the lattice go to rows and columns of work-items
inline void fill_lattice(const Lattice lattice, __local const uint *u, __local const uint *v,
                         __global uint *points, const Triangles triangles)
{
    const int across = lattice.columns - 1, down = lattice.rows - 1;
    const int strips = lattice.first + 2 * (across + down);
    for (int row = get_local_id(1); row < lattice.rows; row += get_local_size(1)) {
        const int first = lattice.first + row * lattice.columns;
        fill_row(points + 2 * first, u + 1, v[row + 1], lattice.columns, row_items());
        if (row < down)
            fill_cell_row(triangles, strips + 2 * row * across, first, row, across, down);
    }
}

#endif
