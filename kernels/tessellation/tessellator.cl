// The fixed-function tessellator of Direct3D 11: factors in, points and primitives of a domain out.
//
//   count    how many points and primitives each patch makes, in closed form
//   (scan)   where each patch's output begins: scan.cl
//   fill     each point and each primitive on its own, in closed form too
//
//   tessellation/factors.h    what factors ask for
//   tessellation/ruler.h      in which order points appear along an edge
//   tessellation/division.h   where they lie
//   tessellation/stitch.h     how two rows of points are joined
//   tessellation/quad.h       the domains
//   tessellation/triangle.h
//   tessellation/isoline.h
//   tessellation/items.h      who does what
//
// It sees factors alone, no positions. Degenerate triangles are legal and kept.
#include "tessellation/isoline.h"
#include "tessellation/quad.h"
#include "tessellation/triangle.h"

#define MAX_POINTS 65  // along an edge

// P patches; N points, M primitives of all of them

__kernel void quad_count(int patches, int partitioning,
                         __global const float *edge_factors,        // (P, 4)
                         __global const float *inside_factors,      // (P, 2)
                         __global uint *point_counts,               // (P)
                         __global uint *primitive_counts)           // (P)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    const QuadFactors factors = quad_factors(edge_factors, inside_factors, patch, partitioning);
    point_counts[patch] = quad_points(factors, partitioning);
    primitive_counts[patch] = quad_triangles(factors, partitioning);
}

__kernel void triangle_count(int patches, int partitioning,
                             __global const float *edge_factors,    // (P, 3)
                             __global const float *inside_factors,  // (P, 1)
                             __global uint *point_counts,           // (P)
                             __global uint *primitive_counts)       // (P)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    const TriangleFactors factors = triangle_factors(edge_factors, inside_factors, patch,
                                                     partitioning);
    point_counts[patch] = triangle_points(factors, partitioning);
    primitive_counts[patch] = triangle_triangles(factors, partitioning);
}

__kernel void isoline_count(int patches, int partitioning,
                            __global const float *edge_factors,     // (P, 2)
                            __global uint *point_counts,            // (P)
                            __global uint *primitive_counts)        // (P)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    const IsolineFactors factors = isoline_factors(edge_factors, patch, partitioning);
    const int segments = segments_of(factors.detail, partitioning);
    point_counts[patch] = line_count(factors) * (segments + 1);
    primitive_counts[patch] = line_count(factors) * segments;
}

__kernel void quad_fill(int partitioning, int clockwise,
                        __global const float *edge_factors,         // (P, 4)
                        __global const float *inside_factors,       // (P, 2)
                        __global const uint *point_offsets,         // (P + 1)
                        __global const uint *primitive_offsets,     // (P + 1)
                        __global uint *points,                      // (N, 2)
                        __global int *primitives)                   // (M, 3)
{
    const size_t patch = get_group_id(0);
    const QuadFactors factors = quad_factors(edge_factors, inside_factors, patch, partitioning);
    const Division insides[QUAD_AXES] = {divide(factors.insides[0], partitioning),
                                         divide(factors.insides[1], partitioning)};
    __local uint u[MAX_POINTS], v[MAX_POINTS];
    place_all(insides[0], u, group_items());
    place_all(insides[1], v, group_items());
    barrier(CLK_LOCAL_MEM_FENCE);
    __global uint *own_points = points + 2 * (size_t)point_offsets[patch];
    const Triangles triangles = {primitives + 3 * (size_t)primitive_offsets[patch],
                                 point_offsets[patch], clockwise};
    const Lattice lattice = quad_lattice(factors, partitioning);
    if (factors.kind != CULLED)
        fill_quad_edges(factors, insides, lattice, partitioning, own_points, triangles);
    if (factors.kind == DIVIDED) {
        fill_lattice(lattice, u, v, own_points, triangles);
    } else if (factors.kind == WHOLE && group_items().first == 0) {
        put_triangle(triangles, 0, 0, 1, 2);
        put_triangle(triangles, 1, 0, 2, 3);
    }
}

__kernel void triangle_fill(int partitioning, int clockwise,
                            __global const float *edge_factors,     // (P, 3)
                            __global const float *inside_factors,   // (P, 1)
                            __global const uint *point_offsets,     // (P + 1)
                            __global const uint *primitive_offsets, // (P + 1)
                            __global uint2 *points,                 // (N)
                            __global int *primitives)               // (M, 3)
{
    const size_t patch = get_group_id(0);
    const TriangleFactors factors = triangle_factors(edge_factors, inside_factors, patch,
                                                     partitioning);
    const Division inside = divide(factors.inside[0], partitioning);
    const int boundary = triangle_boundary_points(factors, partitioning);
    __global uint2 *own_points = points + point_offsets[patch];
    const Triangles triangles = {primitives + 3 * (size_t)primitive_offsets[patch],
                                 point_offsets[patch], clockwise};
    if (factors.kind != CULLED)
        fill_triangle_edges(factors, inside, boundary, partitioning, own_points, triangles);
    if (factors.kind == DIVIDED)
        fill_rings(inside, boundary, own_points, triangles);
    else if (factors.kind == WHOLE && group_items().first == 0)
        put_triangle(triangles, 0, 0, 1, 2);
}

__kernel void isoline_fill(int partitioning,
                           __global const float *edge_factors,      // (P, 2)
                           __global const uint *point_offsets,      // (P + 1)
                           __global const uint *primitive_offsets,  // (P + 1)
                           __global uint2 *points,                  // (N)
                           __global int2 *primitives)               // (M)
{
    const size_t patch = get_group_id(0);
    const IsolineFactors factors = isoline_factors(edge_factors, patch, partitioning);
    fill_lines(factors, partitioning, point_offsets[patch],
               points + point_offsets[patch], primitives + primitive_offsets[patch]);
}
