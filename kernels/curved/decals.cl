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
// Where decals overlap, their depths add up. Built with: RUN. After "DirectX 11 tessellation", slides of 2010.
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

// where decals move a point to
inline float3 pressed(const Decal decal, __global const float *depths, int rows, int columns,
                      float3 position)
{
    const float3 hit = (float3)(decal.point[0], decal.point[1], decal.point[2]);
    const float3 normal = (float3)(decal.normal[0], decal.normal[1], decal.normal[2]);
    const float3 tangent = (float3)(decal.tangent[0], decal.tangent[1], decal.tangent[2]);
    const float3 off = position - hit;
    if (dot3(off, off) > decal.radius * decal.radius)
        return (float3)(0.0f);
    const float x = dot3(off, tangent) / (2.0f * decal.radius) + 0.5f;
    const float y = dot3(off, cross3(normal, tangent)) / (2.0f * decal.radius) + 0.5f;
    return normal * (decal.bias + decal.scale * depth_at(depths, rows, columns, x, y));
}

// N points, D decals that share one depth map; RUN points next to each other are asked together
// which decals are near
__kernel void decals(const int points, const int decal_count,
                     __global const Decal *decals,      // (D,)
                     __global const float *depths,      // (R, C)
                     const int rows, const int columns,
                     __global float *positions)         // (N, 3) moved in place
{
    const int first = RUN * get_global_id(0), count = min(RUN, points - first);
    if (count <= 0)
        return;
    float3 position[RUN], moved[RUN];
    float3 low = vector_at(positions, first), high = low;
    for (int i = 0; i < count; ++i) {
        position[i] = moved[i] = vector_at(positions, first + i);
        low = fmin(low, position[i]);
        high = fmax(high, position[i]);
    }
    for (int k = 0; k < decal_count; ++k) {
        const Decal decal = decals[k];
        const float3 hit = (float3)(decal.point[0], decal.point[1], decal.point[2]);
        if (square_distance(low, high, hit) > decal.radius * decal.radius)
            continue;
        for (int i = 0; i < count; ++i)
            moved[i] -= pressed(decal, depths, rows, columns, position[i]);
    }
    for (int i = 0; i < count; ++i)
        put_vector(positions, first + i, moved[i]);
}
