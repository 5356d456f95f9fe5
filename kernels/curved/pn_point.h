// A point of a curved PN-triangle: its position and normal, from the control net.
//
// Built with: LANES (1 or 8) points side by side, LINEAR_NORMALS (0 or 1).
#ifndef PN_POINT_H
#define PN_POINT_H

#include "curved/pn_net.h"

#if LANES == 8
typedef float8 Real;
#else
typedef float Real;
#endif

// a blend of unit normals shorter than this has no direction; squared
#define NO_DIRECTION 1e-12f

// weights of corners 0, 1, 2; sixteen bits each, so float holds them exactly
typedef struct {
    Real u, v, w;
} Weights;

inline Real position_of(const Weights at, __global const float *net)
{
    const Real u = at.u, v = at.v, w = at.w;
    // `net` begins at x, y or z of the first vector
    const Real flat = (u * net[0] + v * net[3]) + w * net[6];
    __global const float *lifts = net + 3 * NET_LIFT;
    const Real curved = (v * w) * (v * lifts[0] + w * lifts[3])
                      + (w * u) * (w * lifts[6] + u * lifts[9])
                      + (u * v) * (u * lifts[12] + v * lifts[15]);
    return flat + (curved + (u * v * w) * net[3 * NET_MIDDLE]);
}

inline Real normal_of(const Weights at, __global const float *net)
{
    const Real u = at.u, v = at.v, w = at.w;
    __global const float *corner = net + 3 * NET_NORMAL;
#if LINEAR_NORMALS
    return (u * corner[0] + v * corner[3]) + w * corner[6];
#else
    __global const float *edge = net + 3 * NET_EDGE_NORMAL;
    return ((u * u) * corner[0] + (v * v) * corner[3] + (w * w) * corner[6])
         + ((v * w) * edge[0] + (w * u) * edge[3] + (u * v) * edge[6]);
#endif
}

// the plane triangle's own normal, for where the blend has no direction
inline float3 fallback_normal(__global const float *net)
{
    const float3 a = vector_at(net, 0), b = vector_at(net, 1), c = vector_at(net, 2);
    const float3 across = direction(cross3(b - a, c - a));
    return dot3(across, across) > 0.0f ? across : (float3)(0.0f, 0.0f, 1.0f);
}

// What a batch of points comes to.
typedef struct {
    Real position[3];
    Real normal[3];
} Vertices;

inline Vertices evaluate(Real u, Real v, __global const float *net, float3 fallback)
{
    const Weights at = {u, v, (1.0f - u) - v};
    Vertices found;
    for (int axis = 0; axis < 3; ++axis) {
        found.position[axis] = position_of(at, net + axis);
        found.normal[axis] = normal_of(at, net + axis);
    }
    const Real square = found.normal[0] * found.normal[0] + found.normal[1] * found.normal[1]
                      + found.normal[2] * found.normal[2];
    const Real length = sqrt(square);
    const float instead[3] = {fallback.x, fallback.y, fallback.z};
    for (int axis = 0; axis < 3; ++axis)
        found.normal[axis] =
            square > NO_DIRECTION ? found.normal[axis] / length : (Real)(instead[axis]);
    return found;
}

#endif
