// Bicubic Bezier patches: where a point (u, v) of a quad lies on its patch, and the normal there.
//
//   control point [i][j]                  P(u, v) = sum of B_i(u) B_j(v) P_ij,  i, j = 0 .. 3
//   i along u, j along v
//                                         B_0 .. B_3 = t^3, 3 s t^2, 3 s^2 t, s^3 at s, t = 1 - s
//   00--10--20--30  v = 0
//    |   |   |   |                        The four rows along v are evaluated first, then the cubic
//   01--11--21--31                        through what they give along u.
//    |   |   |   |
//   02--12--22--32                        On an edge all weights but those of its own four points
//    |   |   |   |                        are 0 and 1, and sums are taken from both ends alike: two
//   03--13--23--33  v = 1                 patches with the same points along an edge get the same
//                                         bits, in whichever direction each runs along it.
//
// After Farin, "Curves and Surfaces for CAGD", chapters 4 (derivatives of a Bezier curve) and 14
// (tensor products).
//
// Built with: GROUP work-items a patch.
#include "layout.h"

// the same bits from both sides of an edge
#pragma OPENCL FP_CONTRACT OFF

#define NET 16

// Bernstein polynomials of degree 3, 2 and 1
typedef struct {
    float cubic[4], quadratic[3], linear[2];
} Weights;

// a cubic curve at a point: itself, its first and its second derivative
typedef struct {
    float3 at, slope, bend;
} Jet;

// a patch at a point: itself and its derivatives
typedef struct {
    float3 at, u, v, uu, uv, vv;
} Sheet;

inline Weights weights_at(uint place)
{
    const float s = place * (1.0f / FIXED_ONE), t = (FIXED_ONE - place) * (1.0f / FIXED_ONE);
    const Weights weights = {
        {t * t * t, 3.0f * (s * t * t), 3.0f * (s * t * s), s * s * s},
        {t * t, 2.0f * (s * t), s * s},
        {t, s},
    };
    return weights;
}

inline Jet cubic_at(const Weights w, float3 a, float3 b, float3 c, float3 d)
{
    const float3 first = b - a, middle = c - b, last = d - c;
    Jet jet;
    jet.at = (w.cubic[0] * a + w.cubic[3] * d) + (w.cubic[1] * b + w.cubic[2] * c);
    jet.slope = 3.0f * ((w.quadratic[0] * first + w.quadratic[2] * last)
                        + w.quadratic[1] * middle);
    jet.bend = 6.0f * (w.linear[0] * (middle - first) + w.linear[1] * (last - middle));
    return jet;
}

inline Sheet sheet_at(__global const float4 *net, uint u, uint v)
{
    const Weights along_u = weights_at(u), along_v = weights_at(v);
    Jet rows[4];
    for (int i = 0; i < 4; ++i)
        rows[i] = cubic_at(along_v, net[4 * i].xyz, net[4 * i + 1].xyz,
                           net[4 * i + 2].xyz, net[4 * i + 3].xyz);
    const Jet at = cubic_at(along_u, rows[0].at, rows[1].at, rows[2].at, rows[3].at);
    const Jet slope = cubic_at(along_u, rows[0].slope, rows[1].slope,
                               rows[2].slope, rows[3].slope);
    const Jet bend = cubic_at(along_u, rows[0].bend, rows[1].bend, rows[2].bend, rows[3].bend);
    const Sheet sheet = {at.at, at.slope, slope.at, at.bend, slope.slope, bend.at};
    return sheet;
}

// PoCL calls its cross and dot, and keeps them out of line
inline float3 crossed(float3 a, float3 b)
{
    return a.yzx * b.zxy - a.zxy * b.yzx;
}

inline float squared(float3 a)
{
    return a.x * a.x + a.y * a.y + a.z * a.z;
}

// Returns what derivatives are divided by, so that no product leaves the range of floats: the
// longest side of the box around the control points.
inline float extent(__global const float4 *net)
{
    float4 low = net[0], high = net[0];
    for (int i = 1; i < NET; ++i) {
        low = fmin(low, net[i]);
        high = fmax(high, net[i]);
    }
    const float4 size = high - low;
    return fmax(fmax(size.x, size.y), size.z);
}

// shorter than this, of lengths near one, a normal is rounding
#define LEAST 1e-6f

inline bool is_normal(float3 normal)
{
    return squared(normal) > LEAST * LEAST;
}

// The normal N = P_u x P_v where it vanishes. An edge that is collapsed into a point, as at the lid
// of a teapot, has N = 0: there the limit of N / |N| on the way to the middle of the patch is the
// derivative of N in that direction (l'Hopital's rule). Where that vanishes as well, a corner with
// a cusp, the normal a sixteenth of the way to the middle stands in, and so on; a patch without
// any area gets (0, 0, 1).
inline float3 limit_normal(__global const float4 *net, float shrink, uint u, uint v)
{
    for (int attempt = 0; attempt < 4; ++attempt) {
        const Sheet sheet = sheet_at(net, u, v);
        const float to_u = 0.5f - u * (1.0f / FIXED_ONE), to_v = 0.5f - v * (1.0f / FIXED_ONE);
        const float3 along_u = shrink * sheet.u, along_v = shrink * sheet.v;
        const float3 twist = shrink * sheet.uv;
        float3 normal = crossed(along_u, along_v);
        if (!is_normal(normal))
            normal = to_u * (crossed(shrink * sheet.uu, along_v) + crossed(along_u, twist))
                   + to_v * (crossed(twist, along_v) + crossed(along_u, shrink * sheet.vv));
        if (is_normal(normal))
            return normal;
        u += ((int)(FIXED_ONE / 2) - (int)u) / 16;
        v += ((int)(FIXED_ONE / 2) - (int)v) / 16;
    }
    return (float3)(0.0f, 0.0f, 1.0f);
}

__kernel void bezier(const int patches,
                     __global const float4 *nets,           // (P, 4, 4) control points, .w unused
                     __global const uint *point_offsets,    // (P + 1,)
                     __global const uint2 *points,          // (N,) u, v in 16.16
                     __global float *positions,             // (N, 3)
                     __global float *normals)               // (N, 3)
{
    for (int patch = get_group_id(0); patch < patches; patch += get_num_groups(0)) {
        __global const float4 *net = nets + NET * patch;
        const float size = extent(net), shrink = size > 0.0f ? 1.0f / size : 0.0f;
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1];
             i += GROUP) {
            const Sheet sheet = sheet_at(net, points[i].x, points[i].y);
            float3 normal = crossed(shrink * sheet.u, shrink * sheet.v);
            if (!is_normal(normal))
                normal = limit_normal(net, shrink, points[i].x, points[i].y);
            normal /= sqrt(squared(normal));
            positions[3 * i + 0] = sheet.at.x;
            positions[3 * i + 1] = sheet.at.y;
            positions[3 * i + 2] = sheet.at.z;
            normals[3 * i + 0] = normal.x;
            normals[3 * i + 1] = normal.y;
            normals[3 * i + 2] = normal.z;
        }
    }
}
