// Tessellation factors of the edges of a mesh, each asked for once.
//
// Built with: FACTOR, a header that defines edge_factor().
#include "curved/patch_edge.h"
#include FACTOR

inline CurvedEdge curved_edge(__global const int *patches, int2 places,
                              __global const float *positions, __global const float *normals)
{
    CurvedEdge edge = {{patches + (size_t)(places.x / 3) * PATCH_INDICES,
                        patches + (size_t)(places.y / 3) * PATCH_INDICES},
                       places.x % 3, places.x == places.y, positions, normals};
    for (int end = 0; end < 2; ++end)
        edge.ends[end] = vector_at(positions, edge.patches[0][(edge.side + 1 + end) % 3]);
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
