// Curves over isolines laid end to end: position and unit tangent of every tessellated point.
//
// A curve is one header that defines
//
//     Bead curve(Parameter t, __global const float *shape)
//
// and one ParametricCurve that names its numbers: shape[RADIUS] is what was given for radius. Where a
// curve closes, t = 1 is evaluated as t = 0.
//
// Built with: GROUP work-items a piece, CURVE the header, CLOSED (0 or 1), the index of each number
// of the shape.
#include "curved/parameter.h"

typedef struct {
    float3 position;
    float3 tangent;             // of any length but 0
} Bead;

#include CURVE

__kernel void curve_points(const int pieces,
                           __global const float *shape,             // numbers of the curve
                           __global const uint *point_offsets,      // (P + 1,)
                           __global const uint2 *points,            // (N,) u in 16.16, v = 0
                           __global float *positions,               // (N, 3)
                           __global float *tangents)                // (N, 3)
{
    for (int piece = get_group_id(0); piece < pieces; piece += get_num_groups(0))
        for (uint i = point_offsets[piece] + get_local_id(0); i < point_offsets[piece + 1];
             i += GROUP) {
            Parameter t = {(uint)piece * FIXED_ONE + points[i].x, (uint)pieces * FIXED_ONE};
            if (CLOSED && t.step == t.steps)
                t.step = 0;
            const Bead bead = curve(t, shape);
            const float3 tangent = bead.tangent / sqrt(bead.tangent.x * bead.tangent.x
                                                       + bead.tangent.y * bead.tangent.y
                                                       + bead.tangent.z * bead.tangent.z);
            // + 0: there is no negative zero among positions
            positions[3 * i + 0] = bead.position.x + 0.0f;
            positions[3 * i + 1] = bead.position.y + 0.0f;
            positions[3 * i + 2] = bead.position.z + 0.0f;
            tangents[3 * i + 0] = tangent.x;
            tangents[3 * i + 1] = tangent.y;
            tangents[3 * i + 2] = tangent.z;
        }
}
