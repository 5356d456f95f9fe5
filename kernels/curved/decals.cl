// Displacement decals: dents pressed into any surface where something hit it.
//
//            normal ^            a point within the radius of the hit is projected onto the plane
//                   |            of the hit, and moved into the surface by what the depth map has
//      ----.________|________.---- there:
//           `.      |      .'        moved = position - normal * (bias + scale * depth)
//             `-.___|___.-'
//          |<---- radius --->|   the map spans the square of 2 radius around the hit
//
// What a point is moved by depends on its position alone, so that a closed surface stays closed.
// Where decals overlap, their depths add up.
//
// A normal is turned as the surface is: by the cofactors of the derivative of the moved position,
//
//     J = 1 - sum over decals of normal (x) gradient of depth,   n' ~ (b x c, c x a, a x b) n
//
// for the columns a, b, c of J. So it depends on no triangles, and where refined patches end, both
// sides agree. The gradient is that of the map between half a sample to either side, which is
// continuous. Built with: RUN. After "DirectX 11 tessellation", slides of 2010.
#include "curved/pn_net.h"

// bilinear, clamped at the border
inline float depth_at(__global const float *depths, int rows, int columns, float x, float y)
{
    const float column = fmin(fmax(x * columns - 0.5f, 0.0f), columns - 1.0f);
    const float row = fmin(fmax((1.0f - y) * rows - 0.5f, 0.0f), rows - 1.0f);
    const int left = (int)column, above = (int)row;
    const int right = min(left + 1, columns - 1), below = min(above + 1, rows - 1);
    const float across = column - left, down = row - above;
    const float a = depths[(size_t)above * columns + left];
    const float b = depths[(size_t)above * columns + right];
    const float c = depths[(size_t)below * columns + left];
    const float d = depths[(size_t)below * columns + right];
    const float upper = a + (b - a) * across, lower = c + (d - c) * across;
    return upper + (lower - upper) * down;
}

// How far a bounding box is from a point, squared: never more than the points in it are, since each
// step rounds as theirs does and rounding keeps order.
inline float square_distance(const float3 low, const float3 high, const float3 point)
{
    const float3 below = low - point, above = point - high;
    const float3 off = fmax(fmax(below, above), (float3)(0.0f));
    return dot3(off, off);
}

// how far a decal moves a point, along its normal, and how that grows with the position
typedef struct {
    float depth;
    float3 gradient;
} Press;

inline Press pressed(const Decal decal, __global const float *depths, int rows, int columns,
                     float3 position)
{
    const float3 hit = (float3)(decal.point[0], decal.point[1], decal.point[2]);
    const float3 normal = (float3)(decal.normal[0], decal.normal[1], decal.normal[2]);
    const float3 tangent = (float3)(decal.tangent[0], decal.tangent[1], decal.tangent[2]);
    const float3 off = position - hit;
    Press press = {0.0f, (float3)(0.0f)};
    if (dot3(off, off) > decal.radius * decal.radius)
        return press;
    const float3 upward = cross3(normal, tangent);
    const float x = dot3(off, tangent) / (2.0f * decal.radius) + 0.5f;
    const float y = dot3(off, upward) / (2.0f * decal.radius) + 0.5f;
    const float half_x = 0.5f / columns, half_y = 0.5f / rows;
    const float across = depth_at(depths, rows, columns, x + half_x, y)
                       - depth_at(depths, rows, columns, x - half_x, y);
    const float up = depth_at(depths, rows, columns, x, y + half_y)
                   - depth_at(depths, rows, columns, x, y - half_y);
    press.depth = decal.bias + decal.scale * depth_at(depths, rows, columns, x, y);
    press.gradient = (tangent * (across * columns) + upward * (up * rows))
                   * (decal.scale / (2.0f * decal.radius));
    return press;
}

// N points, D decals that share one depth map; RUN points next to each other are asked together
// which decals are near
__kernel void decals(const int points, const int decal_count,
                     __global const Decal *decals,      // (D,)
                     __global const float *depths,      // (R, C)
                     const int rows, const int columns,
                     __global float *positions,         // (N, 3) moved in place
                     __global float *normals)           // (N, 3) turned in place
{
    const int first = RUN * get_global_id(0), count = min(RUN, points - first);
    if (count <= 0)
        return;
    float3 position[RUN], moved[RUN], columns_of[RUN][3];
    bool touched[RUN];
    float3 low = vector_at(positions, first), high = low;
    for (int i = 0; i < count; ++i) {
        position[i] = moved[i] = vector_at(positions, first + i);
        columns_of[i][0] = (float3)(1.0f, 0.0f, 0.0f);
        columns_of[i][1] = (float3)(0.0f, 1.0f, 0.0f);
        columns_of[i][2] = (float3)(0.0f, 0.0f, 1.0f);
        touched[i] = false;
        low = fmin(low, position[i]);
        high = fmax(high, position[i]);
    }
    for (int k = 0; k < decal_count; ++k) {
        const Decal decal = decals[k];
        const float3 hit = (float3)(decal.point[0], decal.point[1], decal.point[2]);
        if (square_distance(low, high, hit) > decal.radius * decal.radius)
            continue;
        const float3 normal = (float3)(decal.normal[0], decal.normal[1], decal.normal[2]);
        for (int i = 0; i < count; ++i) {
            const Press press = pressed(decal, depths, rows, columns, position[i]);
            moved[i] -= normal * press.depth;
            columns_of[i][0] -= normal * press.gradient.x;
            columns_of[i][1] -= normal * press.gradient.y;
            columns_of[i][2] -= normal * press.gradient.z;
            touched[i] |= dot3(press.gradient, press.gradient) > 0.0f;
        }
    }
    for (int i = 0; i < count; ++i) {
        put_vector(positions, first + i, moved[i]);
        if (!touched[i])
            continue;
        const float3 a = columns_of[i][0], b = columns_of[i][1], c = columns_of[i][2];
        const float3 normal = vector_at(normals, first + i);
        const float3 turned = direction(cross3(b, c) * normal.x + cross3(c, a) * normal.y
                                        + cross3(a, b) * normal.z);
        put_vector(normals, first + i, dot3(turned, turned) > 0.0f ? turned : normal);
    }
}
