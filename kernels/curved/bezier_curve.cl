// Bezier curves of any degree, piece by piece: de Casteljau's construction, whose last step but one is
// the tangent.
//
//   degree 2   a . . b . . c         a' = a + (b - a) t        point   = a' + (b' - a') t
//                 a'   b'            b' = b + (c - b) t        tangent = b' - a'
//
// At t = 0 and t = 1 the points are the first and the last control point, to the bit. After Farin,
// "Curves and Surfaces for CAGD", section 4.2.
//
// Built with: GROUP work-items a piece, DEGREE of all pieces.
#include "layout.h"

#pragma OPENCL FP_CONTRACT OFF

__kernel void bezier_curve(const int pieces,
                           __global const float4 *controls,      // (K, DEGREE + 1), .w unused
                           __global const uint *point_offsets,   // (K + 1,)
                           __global const uint2 *points,         // (N,) u along the piece, in 16.16
                           __global float *positions,            // (N, 3)
                           __global float *tangents)             // (N, 3)
{
    const int piece = get_group_id(0);
    if (piece >= pieces)
        return;
    for (uint i = point_offsets[piece] + get_local_id(0); i < point_offsets[piece + 1];
         i += GROUP) {
        const float t = points[i].x * (1.0f / FIXED_ONE), s = 1.0f - t;
        float3 at[DEGREE + 1];
        for (int k = 0; k <= DEGREE; ++k)
            at[k] = controls[(DEGREE + 1) * piece + k].xyz;
        for (int left = DEGREE; left > 1; --left)
            for (int k = 0; k < left; ++k)
                at[k] = at[k] * s + at[k + 1] * t;
        float3 tangent = at[1] - at[0];
        // where the nearest control points coincide with an end, the next one shows the way
        for (int k = 2; k <= DEGREE && all(tangent == 0.0f); ++k)
            tangent = t < 0.5f ? controls[(DEGREE + 1) * piece + k].xyz - at[0]
                               : at[1] - controls[(DEGREE + 1) * piece + DEGREE - k].xyz;
        at[0] = at[0] * s + at[1] * t;
        const float largest = fmax(fmax(fabs(tangent.x), fabs(tangent.y)), fabs(tangent.z));
        tangent = largest > 0.0f ? tangent / largest : (float3)(1.0f, 0.0f, 0.0f);
        tangent /= sqrt(tangent.x * tangent.x + tangent.y * tangent.y + tangent.z * tangent.z);
        positions[3 * i + 0] = at[0].x;
        positions[3 * i + 1] = at[0].y;
        positions[3 * i + 2] = at[0].z;
        tangents[3 * i + 0] = tangent.x;
        tangents[3 * i + 1] = tangent.y;
        tangents[3 * i + 2] = tangent.z;
    }
}
