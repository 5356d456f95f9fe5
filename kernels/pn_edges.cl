// Tessellation factors of the edges of a mesh, each asked for once.
//
// Built with: FACTOR, a header that defines edge_factor().
#include "patch_edge.h"
#include FACTOR

// the plane triangle's normal
inline float3 face_normal(__global const int *patch, __global const float *positions)
{
    const float3 corner = vector_at(positions, patch[0]);
    return direction(cross3(vector_at(positions, patch[1]) - corner,
                            vector_at(positions, patch[2]) - corner));
}

inline CurvedEdge curved_edge(__global const int *patches, int2 places,
                       __global const float *positions, __global const float *normals)
{
    const int side = places.x % 3;
    __global const int *own = patches + (size_t)(places.x / 3) * PATCH_INDICES;
    __global const int *other = patches + (size_t)(places.y / 3) * PATCH_INDICES;
    CurvedEdge edge;
    edge.curve = pn_edge(own, side, positions, normals);
    edge.outline = places.x == places.y;
    edge.faces[0] = face_normal(own, positions);
    edge.faces[1] = face_normal(other, positions);
    for (int end = 0; end < 2; ++end) {
        const int mine = own[(side + 1 + end) % 3];
        const int adjacent = own[PATCH_ADJACENT + 2 * side + end];
        edge.normals[end] = vector_at(normals, mine);
        edge.normals[2 + end] = vector_at(normals, adjacent < 0 ? mine : adjacent);
    }
    return edge;
}

// E edges
__kernel void pn_edges(const int edges, const View view,
                       __global const float *parameters,     // of the formula
                       __global const int2 *sides,           // (E,)
                       __global const int *patches,          // (T, PATCH_INDICES)
                       __global const float *positions,      // (V, 3)
                       __global const float *normals,        // (V, 3)
                       __global float *factors)              // (E,)
{
    const int i = get_global_id(0);
    if (i >= edges)
        return;
    const CurvedEdge edge = curved_edge(patches, sides[i], positions, normals);
    factors[i] = fmax(edge_factor(edge, view, parameters), 1.0f);
}
