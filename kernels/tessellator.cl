// The fixed-function tessellator of Direct3D 11: factors in, points and triangles of the domain out.
//
//   count    how many points and primitives each patch makes, in closed form
//   (scan)   where each patch's output begins: scan.cl
//   fill     every point and every triangle on its own, in closed form too
//
// A work-group per patch fills: one work-item on a CPU; on a GPU a few rows of items, which take
// lattice rows and columns in strides, and along edges every items-th point.
//
//   tessellator_division.h   where the points of an edge lie
//   tessellator_stitch.h     how two rows of points are joined
//   tessellator_quad.h       the domains
//
// It sees factors alone, no positions; degenerate triangles are legal and kept.
#include "tessellator_division.h"
#include "tessellator_stitch.h"
#include "tessellator_quad.h"

#define MAX_POINTS 65  // along an edge

// this item of its work-group, and how many there are
inline int group_item(void)
{
    return get_local_id(1) * get_local_size(0) + get_local_id(0);
}

inline int group_items(void)
{
    return get_local_size(0) * get_local_size(1);
}

inline void place_all(const Division division, __local uint *places)
{
    for (int i = group_item(); i <= division.segments; i += group_items())
        places[i] = place(division, i);
}

__kernel void quad_count(int patches, int partitioning,
                         __global const float *edge_factors,    // (P, 4)
                         __global const float *inside_factors,  // (P, 2)
                         __global uint *point_counts,           // (P)
                         __global uint *primitive_counts)       // (P)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    const QuadFactors factors = quad_factors(edge_factors, inside_factors, patch, partitioning);
    point_counts[patch] = quad_points(factors, partitioning);
    primitive_counts[patch] = quad_triangles(factors, partitioning);
}

// the boundary, and the strips that join it to the lattice
inline void fill_quad_edges(const QuadFactors factors, const Division *insides,
                            const Lattice lattice, int partitioning,
                            __global uint2 *points, const Triangles triangles)
{
    int point = 0, triangle = 0;
    for (int edge = 0; edge < QUAD_EDGES; ++edge) {
        const Division division = divide(factors.edges[edge], partitioning);
        quad_boundary(points + point, edge, division, group_item(), group_items());
        const int next = point + division.segments;
        const Row outer = {point, 1, edge == QUAD_EDGES - 1 ? 0 : next,
                           division.segments + 1, division.half_steps, division.odd};
        // along u = 0 and u = 1 runs v
        const Row inner = lattice_row(lattice, edge, insides[1 - edge % 2]);
        if (factors.kind == DIVIDED)
            stitch(triangles, triangle, outer, inner, group_item(), group_items());
        point = next;
        triangle += strip_triangles(outer.points, inner.points);
    }
}

// rows and columns of the lattice go to rows and columns of work-items
inline void fill_lattice(const Lattice lattice, __local const uint *u, __local const uint *v,
                         __global uint2 *points, const Triangles triangles, int triangle)
{
    const int across = lattice.columns - 1, down = lattice.rows - 1;
    for (int row = get_local_id(1); row < lattice.rows; row += get_local_size(1)) {
        const int point = lattice.first + row * lattice.columns;
        for (int column = get_local_id(0); column < lattice.columns; column += get_local_size(0))
            points[point + column] = (uint2)(u[column + 1], v[row + 1]);
    }
    for (int row = get_local_id(1); row < down; row += get_local_size(1)) {
        const int point = lattice.first + row * lattice.columns;
        for (int column = get_local_id(0); column < across; column += get_local_size(0))
            lattice_cell(triangles, triangle + 2 * (row * across + column), point + column,
                         lattice.columns, diagonal_falls(column, row, across, down));
    }
}

__kernel void quad_fill(int partitioning, int clockwise,
                        __global const float *edge_factors,         // (P, 4)
                        __global const float *inside_factors,       // (P, 2)
                        __global const uint *point_offsets,         // (P + 1)
                        __global const uint *primitive_offsets,     // (P + 1)
                        __global uint2 *points,                     // (N)
                        __global int *primitives)                   // (M, 3)
{
    const size_t patch = get_group_id(0);
    const QuadFactors factors = quad_factors(edge_factors, inside_factors, patch, partitioning);
    const Lattice lattice = quad_lattice(factors, partitioning);
    const Division insides[QUAD_AXES] = {divide(factors.insides[0], partitioning),
                                         divide(factors.insides[1], partitioning)};
    __local uint u[MAX_POINTS], v[MAX_POINTS];
    place_all(insides[0], u);
    place_all(insides[1], v);
    barrier(CLK_LOCAL_MEM_FENCE);
    __global uint2 *own_points = points + point_offsets[patch];
    const Triangles triangles = {primitives + 3 * (size_t)primitive_offsets[patch],
                                 point_offsets[patch], clockwise};
    if (factors.kind != CULLED)
        fill_quad_edges(factors, insides, lattice, partitioning, own_points, triangles);
    if (factors.kind == DIVIDED) {
        const int strips = lattice.first + 2 * (lattice.columns + lattice.rows - 2);
        fill_lattice(lattice, u, v, own_points, triangles, strips);
    } else if (factors.kind == WHOLE && group_item() == 0) {
        put_triangle(triangles, 0, 0, 1, 3);
        put_triangle(triangles, 1, 1, 2, 3);
    }
}
