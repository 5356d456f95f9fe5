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
// Where patches only approximate a smooth surface, normals come from fields of tangents that do fit
// at edges: along u quadratic in u and cubic in v, along v the other way round (Loop and Schaefer,
// "Approximating Catmull-Clark Subdivision Surfaces with Bicubic Patches", 2008).
//
// Built with: GROUP work-items a patch, LANES points side by side, TANGENTS (0 or 1).
#include "common/lanes.h"
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

// Bernstein polynomials of degrees 3 and 2 at points side by side
typedef struct {
    Real cubic[4], quadratic[3];
} Blend;

inline Blend blend_at(Real s, Real t)
{
    const Blend blend = {
        {t * t * t, 3.0f * (s * t * t), 3.0f * (s * t * s), s * s * s},
        {t * t, 2.0f * (s * t), s * s},
    };
    return blend;
}

// from both ends alike
inline Real cubic_of(const Blend w, Real a, Real b, Real c, Real d)
{
    return (w.cubic[0] * a + w.cubic[3] * d) + (w.cubic[1] * b + w.cubic[2] * c);
}

inline Real quadratic_of(const Blend w, Real a, Real b, Real c)
{
    return (w.quadratic[0] * a + w.quadratic[2] * c) + w.quadratic[1] * b;
}

typedef struct {
    Real at[3], u[3], v[3];         // position, and tangents up to their lengths
} Points;

#define FIELD 12

// one of x, y and z of control points that lie `step` floats apart
inline Real cubic_along(const Blend w, __global const float *points, int step)
{
    return cubic_of(w, points[0], points[step], points[2 * step], points[3 * step]);
}

inline Points points_at(const Blend u, const Blend v, __global const float *net, float shrink
#if TANGENTS
                        , __global const float *along_u, __global const float *along_v
#endif
                        )
{
    Points found;
    for (int axis = 0; axis < 3; ++axis) {
        Real rows[4];
        for (int i = 0; i < 4; ++i)
            rows[i] = cubic_along(v, net + 16 * i + axis, 4);
        found.at[axis] = cubic_of(u, rows[0], rows[1], rows[2], rows[3]);
#if TANGENTS
        // 3 along u and 4 along v; and 4 along u and 3 along v
        __global const float *field = along_u + axis, *other = along_v + axis;
        found.u[axis] = shrink * quadratic_of(u, cubic_along(v, field, 4),
                                              cubic_along(v, field + 16, 4),
                                              cubic_along(v, field + 32, 4));
        found.v[axis] = shrink * quadratic_of(v, cubic_along(u, other, 12),
                                              cubic_along(u, other + 4, 12),
                                              cubic_along(u, other + 8, 12));
#else
        Real slopes[4];
        for (int i = 0; i < 4; ++i) {
            __global const float *row = net + 16 * i + axis;
            slopes[i] = quadratic_of(v, row[4] - row[0], row[8] - row[4], row[12] - row[8]);
        }
        found.u[axis] = 3.0f * shrink * quadratic_of(u, rows[1] - rows[0], rows[2] - rows[1],
                                                     rows[3] - rows[2]);
        found.v[axis] = 3.0f * shrink * cubic_of(u, slopes[0], slopes[1], slopes[2], slopes[3]);
#endif
    }
    return found;
}

__kernel void bezier(const int patches,
                     __global const float4 *nets,           // (P, 4, 4) control points, .w unused
#if TANGENTS
                     __global const float4 *along_u,        // (P, 3, 4) control vectors
                     __global const float4 *along_v,        // (P, 4, 3)
#endif
                     __global const uint *point_offsets,    // (P + 1,)
                     __global const uint2 *points,          // (N,) u, v in 16.16
                     __global float *positions,             // (N, 3)
                     __global float *normals)               // (N, 3)
{
    for (int patch = get_group_id(0); patch < patches; patch += get_num_groups(0)) {
        __global const float4 *net = nets + NET * patch;
        const float size = extent(net), shrink = size > 0.0f ? 1.0f / size : 0.0f;
        const uint end = point_offsets[patch + 1];
        for (uint first = point_offsets[patch] + LANES * get_local_id(0); first < end;
             first += LANES * GROUP) {
            Real u, v, s, t;
            for (int lane = 0; lane < LANES; ++lane) {
                const uint2 point = points[min(first + lane, end - 1)];
                SET_LANE(u, lane, point.x * (1.0f / FIXED_ONE));
                SET_LANE(v, lane, point.y * (1.0f / FIXED_ONE));
                SET_LANE(s, lane, (FIXED_ONE - point.x) * (1.0f / FIXED_ONE));
                SET_LANE(t, lane, (FIXED_ONE - point.y) * (1.0f / FIXED_ONE));
            }
            const Points found = points_at(blend_at(u, s), blend_at(v, t),
                                           (__global const float *)net, shrink
#if TANGENTS
                                           , (__global const float *)(along_u + FIELD * patch)
                                           , (__global const float *)(along_v + FIELD * patch)
#endif
                                           );
            const Real x = found.u[1] * found.v[2] - found.u[2] * found.v[1];
            const Real y = found.u[2] * found.v[0] - found.u[0] * found.v[2];
            const Real z = found.u[0] * found.v[1] - found.u[1] * found.v[0];
            const Real length = sqrt(x * x + y * y + z * z);
            for (int lane = 0; lane < LANES && first + lane < end; ++lane) {
                const uint i = first + lane;
                float3 normal = (float3)(LANE(x, lane), LANE(y, lane), LANE(z, lane));
                if (LANE(length, lane) > LEAST) {
                    normal /= LANE(length, lane);
                } else {
                    normal = limit_normal(net, shrink, points[i].x, points[i].y);
                    normal /= sqrt(squared(normal));
                }
                positions[3 * i + 0] = LANE(found.at[0], lane);
                positions[3 * i + 1] = LANE(found.at[1], lane);
                positions[3 * i + 2] = LANE(found.at[2], lane);
                normals[3 * i + 0] = normal.x;
                normals[3 * i + 1] = normal.y;
                normals[3 * i + 2] = normal.z;
            }
        }
    }
}
