// Parametric surfaces over a grid of quad patches: position and normal of every tessellated point.
//
//         u = 0        1         A surface is one header that defines
//   v = 0  +---+---+---+
//          | 0 | 1 | 2 |             Place surface(Parameter u, Parameter v,
//          +---+---+---+                           __global const float *shape)
//          | 3 | 4 | 5 |
//   v = 1  +---+---+---+         and one ParametricSurface that names its numbers: shape[RADIUS]
//                                is what was given for radius.
//
// Where a surface closes, u = 1 is evaluated as u = 0, so that the seam has the same bits at both
// sides; where it closes with a twist (Moebius, Klein) v is turned round, and the normal as well.
//
// Built with: GROUP work-items a patch, SURFACE the header, CLOSED_U, CLOSED_V, TWISTED (0 or 1),
// the index of each number of the shape.
#include "curved/parameter.h"

typedef struct {
    float3 position;
    float3 normal;              // towards dP/du x dP/dv, of any length but 0
} Place;

#include SURFACE

inline Place place_at(Parameter u, Parameter v, __global const float *shape)
{
    bool turned = false;
    if (CLOSED_U && u.step == u.steps) {
        u.step = 0;
        turned = TWISTED;
    }
    if (turned)
        v.step = v.steps - v.step;
    if (CLOSED_V && v.step == v.steps)
        v.step = 0;
    Place place = surface(u, v, shape);
    const float scale = 1.0f / sqrt(place.normal.x * place.normal.x
                                    + place.normal.y * place.normal.y
                                    + place.normal.z * place.normal.z);
    place.normal *= turned ? -scale : scale;
    return place;
}

__kernel void surface_points(const int across, const int down,
                             __global const float *shape,           // numbers of the surface
                             __global const uint *point_offsets,    // (P + 1,) P = down * across
                             __global const uint2 *points,          // (N,) u, v in 16.16
                             __global float *positions,             // (N, 3)
                             __global float *normals)               // (N, 3)
{
    for (int patch = get_group_id(0); patch < across * down; patch += get_num_groups(0)) {
        const uint left = (uint)(patch % across) * FIXED_ONE;
        const uint top = (uint)(patch / across) * FIXED_ONE;
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1];
             i += GROUP) {
            const Parameter u = {left + points[i].x, (uint)across * FIXED_ONE};
            const Parameter v = {top + points[i].y, (uint)down * FIXED_ONE};
            const Place place = place_at(u, v, shape);
            // + 0: there is no negative zero among positions
            positions[3 * i + 0] = place.position.x + 0.0f;
            positions[3 * i + 1] = place.position.y + 0.0f;
            positions[3 * i + 2] = place.position.z + 0.0f;
            normals[3 * i + 0] = place.normal.x;
            normals[3 * i + 1] = place.normal.y;
            normals[3 * i + 2] = place.normal.z;
        }
    }
}
