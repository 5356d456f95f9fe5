// Displacement: points of curved patches moved along the surface's normal by a map of heights.
//
//     moved = position + normal * (bias + scale * height at the texture coordinates)
//
// Inside a patch normal and texture coordinates are blends of its corners'. Where patches meet that
// do not have the same there, a seam of the texture or a sharp edge, each must find the same:
//
//     on an edge    the mean of both sides' normals at either end, and the texture coordinates of
//                   the side that is dominant
//     at a corner   the mean of all normals at the position, and the texture coordinates of the
//                   vertex that is dominant
//
// so that nothing there depends on which patch asks. After J. McDonald, "Tessellation on Any
// Budget", 2011, whose dominant side also gives the normal.
//
// Built with: GROUP work-items a patch.
#include "curved/pn_net.h"

typedef struct {
    float3 normal;
    float2 texture;
} Surface;

// What the vertices of a mesh with split normals and texture seams have.
typedef struct {
    __global const int *patch;          // PATCH_INDICES
    __global const int *dominant;       // 6: both ends of edges 0, 1, 2 at the dominant side
    __global const float *normals;
    __global const float *shared;       // the mean normal at each vertex's position
    __global const float *textures;
} Vertices;

inline float2 texture_at(const Vertices mesh, int vertex)
{
    return (float2)(mesh.textures[2 * vertex], mesh.textures[2 * vertex + 1]);
}

inline Surface inside_patch(const Vertices mesh, const float *weights)
{
    Surface found = {(float3)(0.0f), (float2)(0.0f)};
    for (int corner = 0; corner < 3; ++corner) {
        found.normal += vector_at(mesh.normals, mesh.patch[corner]) * weights[corner];
        found.texture += texture_at(mesh, mesh.patch[corner]) * weights[corner];
    }
    return found;
}

// sums of two, which commute: the other side runs along the edge the other way
inline Surface on_edge(const Vertices mesh, int side, const float *weights)
{
    float3 normals[2];
    float2 textures[2];
    for (int end = 0; end < 2; ++end) {
        const int corner = (side + 1 + end) % 3, place = 2 * side + end;
        const int own = mesh.patch[corner], other = mesh.patch[PATCH_ADJACENT + place];
        const float3 both = other < 0 ? vector_at(mesh.shared, own)
                          : vector_at(mesh.normals, own) + vector_at(mesh.normals, other);
        normals[end] = direction(both) * weights[corner];
        textures[end] = texture_at(mesh, mesh.dominant[place]) * weights[corner];
    }
    const Surface found = {normals[0] + normals[1], textures[0] + textures[1]};
    return found;
}

inline Surface surface_at(const Vertices mesh, const float *weights)
{
    for (int corner = 0; corner < 3; ++corner)
        if (weights[corner] == 1.0f) {
            const int vertex = mesh.patch[PATCH_DOMINANT + corner];
            const Surface found = {vector_at(mesh.shared, vertex), texture_at(mesh, vertex)};
            return found;
        }
    for (int side = 0; side < 3; ++side)
        if (weights[side] == 0.0f)
            return on_edge(mesh, side, weights);
    return inside_patch(mesh, weights);
}

// the whole number below, without a call that a CPU does not inline
inline int floor_of(float x)
{
    const int toward_zero = (int)x;
    return toward_zero - (toward_zero > x);
}

// Bilinear between the map's samples, which stand in the middles of its cells; the map repeats. The
// texture's v runs up, the map's rows down.
inline float height_at(__global const float *heights, int rows, int columns, float2 texture)
{
    const float x = (texture.x - floor_of(texture.x)) * columns - 0.5f;
    const float y = (1.0f - (texture.y - floor_of(texture.y))) * rows - 0.5f;
    // from -1 on, and below the number of samples
    const int left = floor_of(x), above = floor_of(y);
    const float across = x - left, down = y - above;
    const int near_column = left < 0 ? columns - 1 : left;
    const int near_row = above < 0 ? rows - 1 : above;
    const int far_column = left + 1 < columns ? left + 1 : 0;
    const int far_row = above + 1 < rows ? above + 1 : 0;
    const float a = heights[(size_t)near_row * columns + near_column];
    const float b = heights[(size_t)near_row * columns + far_column];
    const float c = heights[(size_t)far_row * columns + near_column];
    const float d = heights[(size_t)far_row * columns + far_column];
    const float upper = a + (b - a) * across, lower = c + (d - c) * across;
    return upper + (lower - upper) * down;
}

// P patches, N points, V vertices
__kernel void displaced(const int patch_count,
                        __global const int *patches,        // (P, PATCH_INDICES)
                        __global const int *dominant,       // (P, 6)
                        __global const float *normals,      // (V, 3)
                        __global const float *shared,       // (V, 3)
                        __global const float *textures,     // (V, 2)
                        __global const float *heights,      // (R, C)
                        const int rows, const int columns, const float scale, const float bias,
                        __global const uint *point_offsets, // (P + 1,)
                        __global const uint2 *points,       // (N,) u, v in 16.16
                        __global float *positions)          // (N, 3) moved in place
{
    const int run = (patch_count + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patch_count); ++patch) {
        const Vertices mesh = {patches + (size_t)patch * PATCH_INDICES,
                               dominant + (size_t)patch * 6, normals, shared, textures};
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1];
             i += GROUP) {
            const float u = points[i].x * (1.0f / FIXED_ONE), v = points[i].y * (1.0f / FIXED_ONE);
            const float weights[3] = {u, v, (1.0f - u) - v};
            const Surface surface = surface_at(mesh, weights);
            const float height = height_at(heights, rows, columns, surface.texture);
            const float3 position = vector_at(positions, i);
            put_vector(positions, i,
                       position + direction(surface.normal) * (bias + scale * height));
        }
    }
}
