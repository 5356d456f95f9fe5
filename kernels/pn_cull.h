// What cannot be seen of a PN-triangle, from its ten control points: the patch lies in their convex
// hull, and its normals in that of fifteen control normals.
#ifndef PN_CULL_H
#define PN_CULL_H

#include "frustum.h"
#include "pn_net.h"

enum { CONTROLS = 10, TANGENTS = 6, NORMALS_SIDE = 5 };

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

// their exponents of u and v, those of w making up two, and how often the Bernstein polynomials of
// degree two have each
__constant int TANGENT_POWERS[TANGENTS][2] = {{2, 0}, {0, 2}, {0, 0}, {1, 1}, {1, 0}, {0, 1}};
__constant float TANGENT_TIMES[TANGENTS] = {1.0f, 1.0f, 1.0f, 2.0f, 2.0f, 2.0f};

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

// The normal, the product of two quadratic tangents across and along, is a patch of degree four: its
// control normal of u^i v^j w^(4 - i - j) at [i][j], but for its length.
inline void control_normals(const float3 *controls, float3 normals[NORMALS_SIDE][NORMALS_SIDE])
{
    for (int i = 0; i < NORMALS_SIDE; ++i)
        for (int j = 0; j < NORMALS_SIDE; ++j)
            normals[i][j] = (float3)(0.0f);
    for (int a = 0; a < TANGENTS; ++a)
        for (int b = 0; b < TANGENTS; ++b) {
            const float3 across = controls[UPRIGHT[a][0]] - controls[UPRIGHT[a][2]];
            const float3 along = controls[UPRIGHT[b][1]] - controls[UPRIGHT[b][2]];
            const int i = TANGENT_POWERS[a][0] + TANGENT_POWERS[b][0];
            const int j = TANGENT_POWERS[a][1] + TANGENT_POWERS[b][1];
            normals[i][j] += cross3(across, along) * (TANGENT_TIMES[a] * TANGENT_TIMES[b]);
        }
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
    float3 normals[NORMALS_SIDE][NORMALS_SIDE];
    control_normals(controls, normals);
    for (int i = 0; i < NORMALS_SIDE; ++i)
        for (int j = 0; j < NORMALS_SIDE - i; ++j) {
            const float3 normal = direction(normals[i][j]);
            for (int k = 0; k < CONTROLS; ++k)
                if (!(dot3(normal, rays[k]) > cosine))
                    return false;
        }
    return true;
}

#endif
