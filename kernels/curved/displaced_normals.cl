// Normals of a surface whose points were moved, from its triangles: the sums of their cross products,
// twice their areas long, over all that meet at a point.
//
//   faces      within each patch, whose points are its own
//   edges      along an edge that is smooth: what both sides have, added up
//   corners    at a corner: what all patches with that normal have
//   normalise  to unit length
//
// A patch's boundary comes first among its points, side by side, so that the points of an edge's
// two sides are known by number. An edge is smooth where both sides have the same normals at its
// ends; across a sharp one nothing is added.
#include "curved/pn_net.h"
#include "tessellation/triangle.h"

// where the points of a patch's side begin, and how many segments it has; its last point is the
// first of the next side
typedef struct {
    int first;
    int segments;
} Side;

inline Side side_of(const TriangleFactors factors, int side, int partitioning)
{
    Side found = {0, segments_of(factors.edges[side], partitioning)};
    for (int before = 0; before < side; ++before)
        found.first += segments_of(factors.edges[before], partitioning);
    return found;
}

// corner 1 is the first point of side 0, corner 2 of side 1, corner 0 of side 2
inline int side_from(int corner)
{
    return (corner + 2) % 3;
}

inline bool same(float3 a, float3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

// P patches, N points, M triangles

__kernel void faces(const int patches,
                    __global const uint *point_offsets,     // (P + 1,)
                    __global const uint *triangle_offsets,  // (P + 1,)
                    __global const int *triangles,          // (M, 3)
                    __global const float *positions,        // (N, 3)
                    __global float *sums)                   // (N, 3)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    for (uint i = point_offsets[patch]; i < point_offsets[patch + 1]; ++i)
        put_vector(sums, i, (float3)(0.0f));
    for (uint t = triangle_offsets[patch]; t < triangle_offsets[patch + 1]; ++t) {
        const int a = triangles[3 * t], b = triangles[3 * t + 1], c = triangles[3 * t + 2];
        const float3 corner = vector_at(positions, a);
        const float3 across =
            cross3(vector_at(positions, b) - corner, vector_at(positions, c) - corner);
        put_vector(sums, a, vector_at(sums, a) + across);
        put_vector(sums, b, vector_at(sums, b) + across);
        put_vector(sums, c, vector_at(sums, c) + across);
    }
}

// E edges
__kernel void edges(const int edge_count, const int partitioning,
                    __global const int2 *sides,             // (E,)
                    __global const int *patches,            // (P, PATCH_INDICES)
                    __global const float *mesh_normals,     // (V, 3)
                    __global const float *edge_factors,     // (P, 3)
                    __global const float *inside_factors,   // (P, 1)
                    __global const uint *point_offsets,     // (P + 1,)
                    __global const float *positions,        // (N, 3)
                    __global float *sums)                   // (N, 3)
{
    const int edge = get_global_id(0);
    if (edge >= edge_count || sides[edge].x == sides[edge].y)
        return;
    const int patch = sides[edge].x / 3, other = sides[edge].y / 3;
    const int side = sides[edge].x % 3;
    __global const int *own = patches + (size_t)patch * PATCH_INDICES;
    for (int end = 0; end < 2; ++end) {
        const int adjacent = own[PATCH_ADJACENT + 2 * side + end];
        if (adjacent < 0 || !same(vector_at(mesh_normals, own[(side + 1 + end) % 3]),
                                  vector_at(mesh_normals, adjacent)))
            return;
    }
    const TriangleFactors here =
        triangle_factors(edge_factors, inside_factors, patch, partitioning);
    const TriangleFactors there =
        triangle_factors(edge_factors, inside_factors, other, partitioning);
    if (here.kind == CULLED || there.kind == CULLED)
        return;
    const Side mine = side_of(here, side, partitioning);
    const Side others = side_of(there, sides[edge].y % 3, partitioning);
    const size_t first = point_offsets[patch] + mine.first;
    const size_t second = point_offsets[other] + others.first;
    // two triangles that face the same way run along their edge in opposite directions
    const bool forth = same(vector_at(positions, first), vector_at(positions, second));
    for (int k = 1; k < mine.segments; ++k) {
        const size_t i = first + k, j = second + (forth ? k : mine.segments - k);
        const float3 sum = vector_at(sums, i) + vector_at(sums, j);
        put_vector(sums, i, sum);
        put_vector(sums, j, sum);
    }
}

// K kinds of corners, by position and normal
__kernel void corners(const int kinds, const int partitioning,
                      __global const int *offsets,          // (K + 1,)
                      __global const int *members,          // (3 P,) 3 patch + corner, by kind
                      __global const float *edge_factors,   // (P, 3)
                      __global const float *inside_factors, // (P, 1)
                      __global const uint *point_offsets,   // (P + 1,)
                      __global float *sums)                 // (N, 3)
{
    const int kind = get_global_id(0);
    if (kind >= kinds)
        return;
    float3 sum = (float3)(0.0f);
    // first add up, then hand out
    for (int pass = 0; pass < 2; ++pass)
        for (int i = offsets[kind]; i < offsets[kind + 1]; ++i) {
            const int patch = members[i] / 3;
            const TriangleFactors factors =
                triangle_factors(edge_factors, inside_factors, patch, partitioning);
            if (factors.kind == CULLED)
                continue;
            const size_t point = point_offsets[patch]
                               + side_of(factors, side_from(members[i] % 3), partitioning).first;
            if (pass == 0)
                sum += vector_at(sums, point);
            else
                put_vector(sums, point, sum);
        }
}

__kernel void normalise(const int points,
                        __global const float *sums,         // (N, 3)
                        __global float *normals)            // (N, 3) kept where there is no sum
{
    const int i = get_global_id(0);
    if (i >= points)
        return;
    const float3 sum = vector_at(sums, i);
    // not squared before it is of a size that squares keep
    const float largest = fmax(fabs(sum.x), fmax(fabs(sum.y), fabs(sum.z)));
    if (largest > 0.0f)
        put_vector(normals, i, direction(sum / largest));
}
