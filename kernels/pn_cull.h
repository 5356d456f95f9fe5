// What cannot be seen of a PN-triangle, from its ten control points: the patch lies in their convex
// hull, and its normals in that of the cross products of its tangents.
#ifndef PN_CULL_H
#define PN_CULL_H

#include "frustum.h"
#include "pn_net.h"

enum { CONTROLS = 10, TANGENTS = 6 };

// the control points' exponents of u, v, w, in the order of the net
//
//              0 = 300
//           6 = 201  7 = 210
//        5 = 102  9 = 111  8 = 120
//     2 = 003  4 = 012  3 = 021  1 = 030
//
// and the six small triangles that stand upright like the patch, whose sides are its tangents
__constant int UPRIGHT[TANGENTS][3] = {
    {0, 7, 6}, {8, 1, 3}, {5, 4, 2}, {7, 8, 9}, {6, 9, 5}, {9, 3, 4}};

inline void control_points(__global const float *net, float3 *controls)
{
    float3 sum = (float3)(0.0f);
    for (int k = 0; k < 3; ++k) {
        const float3 from = vector_at(net, NET_CORNER + (k + 1) % 3);
        const float3 to = vector_at(net, NET_CORNER + (k + 2) % 3);
        const float3 first = vector_at(net, NET_LIFT + 2 * k);
        const float3 second = vector_at(net, NET_LIFT + 2 * k + 1);
        controls[k] = vector_at(net, NET_CORNER + k);
        controls[3 + 2 * k] = (from * 2.0f + to + first) / 3.0f;
        controls[4 + 2 * k] = (from + to * 2.0f + second) / 3.0f;
        sum += controls[k];
    }
    controls[9] = sum / 3.0f + vector_at(net, NET_MIDDLE) / 6.0f;
}

inline bool out_of_view(const float3 *controls, const View view)
{
    float3 low = controls[0], high = controls[0];
    for (int i = 1; i < CONTROLS; ++i) {
        low = fmin(low, controls[i]);
        high = fmax(high, controls[i]);
    }
    return outside_frustum(view, low, high);
}

// Is every normal n of the patch turned away from the eye, seen from every point p of it, by more
// than a cosine: n . (p - eye) > cosine |n| |p - eye|?
//
// Asked of all pairs of control normals and control points. For a cosine of 0 the left side is
// linear in both, so that what holds for the hulls' corners holds for all of the patch.
inline bool seen_from_behind(const float3 *controls, const View view, float cosine)
{
    const float3 forward = (float3)(view.axes[2][0], view.axes[2][1], view.axes[2][2]);
    const float3 eye = (float3)(view.eye[0], view.eye[1], view.eye[2]);
    float3 rays[CONTROLS];
    for (int i = 0; i < CONTROLS; ++i)
        rays[i] = view.parallel ? forward : direction(controls[i] - eye);
    for (int i = 0; i < TANGENTS; ++i)
        for (int j = 0; j < TANGENTS; ++j) {
            const float3 across = controls[UPRIGHT[i][0]] - controls[UPRIGHT[i][2]];
            const float3 along = controls[UPRIGHT[j][1]] - controls[UPRIGHT[j][2]];
            const float3 normal = direction(cross3(across, along));
            for (int k = 0; k < CONTROLS; ++k)
                if (!(dot3(normal, rays[k]) > cosine))
                    return false;
        }
    return true;
}

#endif
