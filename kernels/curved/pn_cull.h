// What cannot be seen of a PN-triangle, from its ten control points: the patch lies in their convex
// hull, and the triangles that it is drawn with are turned like products of its control tangents.
#ifndef PN_CULL_H
#define PN_CULL_H

#include "common/frustum.h"
#include "curved/pn_net.h"

enum { CONTROLS = 10, TANGENTS = 6, TANGENT_LANES = 8, SIDES = 3 };

// the control points' exponents of u, v, w, in the order of the net
//
//              0 = 300
//           6 = 201  7 = 210
//        5 = 102  9 = 111  8 = 120
//     2 = 003  4 = 012  3 = 021  1 = 030
//
// and the six small triangles that stand upright like the patch, corner by corner: their sides are
// the control tangents along the patch's
__constant int UPRIGHT[TANGENTS][SIDES] = {
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

// points of the patch may have been moved by so much
inline bool out_of_view(const float3 *controls, float moved, const View view)
{
    float3 low = controls[0], high = controls[0];
    for (int i = 1; i < CONTROLS; ++i) {
        low = fmin(low, controls[i]);
        high = fmax(high, controls[i]);
    }
    return outside_frustum(view, low - moved, high + moved);
}

inline float3 tangent_along(int side, int i, const float3 *controls)
{
    return controls[UPRIGHT[i][(side + 2) % SIDES]] - controls[UPRIGHT[i][(side + 1) % SIDES]];
}

// Are all triangles that the patch is drawn with turned away from the eye: with a normal n, seen from
// every point p of the patch, by more than a cosine: n . (p - eye) > cosine |n| |p - eye|?
//
// A chord of the patch along a side is a mean of the control tangents along it. So the normal of a
// drawn triangle with edges along two sides is a mean of products of theirs, and likewise if one edge
// is along a side and the other two lie between the directions of the other sides: patterns of one
// factor are made so. All products are asked, against all control points. For a cosine of 0 the left
// side is linear in each of them: what holds for the corners of the hulls, holds inside.
//
// The normals of the smooth surface are means of fewer products, fifteen sums of them. Those would
// leave out more patches, some with triangles that can be seen: they lean further than the surface.
inline bool seen_from_behind(const float3 *controls, const View view, float cosine)
{
    const float3 forward = (float3)(view.axes[2][0], view.axes[2][1], view.axes[2][2]);
    const float3 eye = (float3)(view.eye[0], view.eye[1], view.eye[2]);
    float3 rays[CONTROLS];
    for (int i = 0; i < CONTROLS; ++i)
        rays[i] = view.parallel ? forward : direction(controls[i] - eye);
    for (int side = 0; side < SIDES; ++side) {
        // the next side's tangents lie side by side, the last one more than once
        float x[TANGENT_LANES], y[TANGENT_LANES], z[TANGENT_LANES];
        for (int lane = 0; lane < TANGENT_LANES; ++lane) {
            const int last = min(lane, TANGENTS - 1);
            const float3 tangent = tangent_along((side + 1) % SIDES, last, controls);
            x[lane] = tangent.x, y[lane] = tangent.y, z[lane] = tangent.z;
        }
        const float8 bx = vload8(0, x), by = vload8(0, y), bz = vload8(0, z);
        for (int i = 0; i < TANGENTS; ++i) {
            const float3 a = tangent_along(side, i, controls);
            const float8 nx = a.y * bz - a.z * by, ny = a.z * bx - a.x * bz,
                         nz = a.x * by - a.y * bx;
            const float8 limit = cosine * sqrt(nx * nx + ny * ny + nz * nz);
            for (int k = 0; k < CONTROLS; ++k)
                if (!all(nx * rays[k].x + ny * rays[k].y + nz * rays[k].z > limit))
                    return false;
        }
    }
    return true;
}

#endif
