// The hull stage of curved PN-triangles: the control net of every patch, see pn_net.h.
#include "curved/pn_net.h"

// The normal in the middle of an edge: the mean of its ends', mirrored at the plane across the edge,
// so that an S-shaped edge is seen to lean (equation 9.10 of "Practical Rendering and Computation
// with Direct3D 11"; its N_i - N_j is a slip, the paper and listing 9.20 add). Zero where it has no
// direction, as between opposite normals.
inline float3 edge_normal(float3 from, float3 to, float3 at_from, float3 at_to)
{
    const float3 along = to - from, sum = at_from + at_to;
    const float square = dot3(along, along);
    const float slope = square > 0.0f ? 2.0f * dot3(along, sum) / square : 0.0f;
    return direction(sum - along * slope);
}

// T triangles, V vertices
__kernel void pn_hull(const int triangles,
                      __global const int *patches,          // (T, PATCH_INDICES)
                      __global const float *positions,      // (V, 3)
                      __global const float *normals,        // (V, 3) unit length or zero
                      __global float *nets)                 // (T, NET_VECTORS, 3)
{
    const int triangle = get_global_id(0);
    if (triangle >= triangles)
        return;
    __global const int *patch = patches + (size_t)triangle * PATCH_INDICES;
    __global float *net = nets + (size_t)triangle * (3 * NET_VECTORS);

    float3 middle = (float3)(0.0f);
    for (int side = 0; side < 3; ++side) {
        const PnEdge edge = pn_edge(patch, side, positions, normals);
        const int from = patch[(side + 1) % 3], to = patch[(side + 2) % 3];
        put_vector(net, NET_CORNER + side, vector_at(positions, patch[side]));
        put_vector(net, NET_LIFT + 2 * side, edge.lifts[0]);
        put_vector(net, NET_LIFT + 2 * side + 1, edge.lifts[1]);
        put_vector(net, NET_NORMAL + side, vector_at(normals, patch[side]));
        put_vector(net, NET_EDGE_NORMAL + side,
                   edge_normal(edge.ends[0], edge.ends[1], vector_at(normals, from),
                               vector_at(normals, to)));
        middle += edge.lifts[0] + edge.lifts[1];
    }
    put_vector(net, NET_MIDDLE, middle * 0.5f);
}
