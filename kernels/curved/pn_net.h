// Curved point-normal triangles: the control net of a patch.
//
// After A. Vlachos, J. Peters, C. Boyd, J. L. Mitchell, "Curved PN Triangles", I3D 2001: a cubic
// Bezier triangle for positions and a quadratic one for normals, both from three corners with their
// normals. Edge k lies opposite corner k and has the weight of that corner zero:
//
//               0  u = 1               edge 0: u = 0, from corner 1 to corner 2
//              / \                     edge 1: v = 0, from corner 2 to corner 0
//    edge 1   6---7   edge 2           edge 2: w = 0, from corner 0 to corner 1
//            / \ / \                   (w = 1 - u - v)
//           5---9---8
//          / \ / \ / \                 the numbers are those of the vectors below
//         2---4---3---1
//     w = 1   edge 0    v = 1
//
//     0-2    corners
//     3-8    lifts: edge k from its first end, edge k from its second
//     9      middle
//    10-12   normals of the corners
//    13-15   normals of the middles of edges 0, 1, 2
//
// A control point is stored as what it adds to the plane triangle. Edge i -> j has by equation 2 of
// the paper the control point (2 P_i + P_j - w N_i) / 3 with w = (P_j - P_i) . N_i, which is the
// point a third along the edge and a third of the lift  a_ij = -w N_i.  The one in the middle,
// E + (E - V) / 2, is V and half of that times half of the sum of the lifts. So
//
//     b(u, v, w) = u P_0 + v P_1 + w P_2
//                + v w (v a_12 + w a_21) + w u (w a_20 + u a_02) + u v (u a_01 + v a_10)
//                + u v w m,            m = (a_12 + a_21 + a_20 + a_02 + a_01 + a_10) / 2
//
// That rounds less than a sum of ten large terms, and needs no order of an edge's two ends: on the
// edge all that is left is a sum of two and a sum of two, which commute. Both patches at an edge
// find the same bits, and an edge of no length stays a point.
#ifndef PN_NET_H
#define PN_NET_H

#include "layout.h"

// two patches must compute the same bits for the same point
#pragma OPENCL FP_CONTRACT OFF

enum {
    NET_CORNER = 0,
    NET_LIFT = 3,
    NET_MIDDLE = 9,
    NET_NORMAL = 10,
    NET_EDGE_NORMAL = 13
};

inline float dot3(float3 a, float3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline float3 cross3(float3 a, float3 b)
{
    return (float3)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

inline float3 vector_at(__global const float *vectors, int index)
{
    return (float3)(vectors[3 * index], vectors[3 * index + 1], vectors[3 * index + 2]);
}

inline void put_vector(__global float *vectors, int index, float3 value)
{
    vectors[3 * index] = value.x;
    vectors[3 * index + 1] = value.y;
    vectors[3 * index + 2] = value.z;
}

// unit length, or zero for what has no direction
inline float3 direction(float3 a)
{
    const float square = dot3(a, a);
    return square > 0.0f ? a / sqrt(square) : (float3)(0.0f);
}

// how three times the control point a third along from -> to stands off the plane triangle
inline float3 lift(float3 from, float3 to, float3 normal)
{
    return normal * -dot3(to - from, normal);
}

// The ends of an edge and the lifts at them.
typedef struct {
    float3 ends[2];
    float3 lifts[2];
} PnEdge;

// The curve of edge `side` of a patch of 12 indices. Its lifts are the means of those that the two
// sides of the edge would have by themselves (J. McDonald, M. Kilgard, "Crack-Free Point-Normal
// Triangles Using Adjacent Edge Normals", 2010): a sum of two, so that both sides agree. Where the
// two sides have the same normals it is plain PN. Without a neighbour to agree with, the edge is
// straight.
inline PnEdge pn_edge(__global const int *patch, int side,
                      __global const float *positions, __global const float *normals)
{
    PnEdge edge;
    for (int end = 0; end < 2; ++end)
        edge.ends[end] = vector_at(positions, patch[(side + 1 + end) % 3]);
    for (int end = 0; end < 2; ++end) {
        const float3 from = edge.ends[end], to = edge.ends[1 - end];
        const int other = patch[PATCH_ADJACENT + 2 * side + end];
        if (other < 0) {
            edge.lifts[end] = (float3)(0.0f);
            continue;
        }
        const float3 own = vector_at(normals, patch[(side + 1 + end) % 3]);
        edge.lifts[end] =
            (lift(from, to, own) + lift(from, to, vector_at(normals, other))) * 0.5f;
    }
    return edge;
}

#endif
