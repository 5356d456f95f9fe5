// Which patches do decals reach? Edge by edge, each asked once, then the triangle between them.
//
//        o hit         An edge is reached where it comes within the radius of a hit: by an end, or by
//        |             the foot of the hit on it. The inside is, where an edge is, or where the hit
//     ---+-------      is above the triangle and within the radius of its plane.
//       foot
//
// Both sides of an edge take what was found of it. Curved patches leave their planes: what they
// bulge adds to the radius. After "DirectX 11 tessellation", slides of 2010, displacement adaptive.
#include "curved/pn_net.h"

inline float length3(float3 a)
{
    return sqrt(dot3(a, a));
}

// How far a patch may leave its plane triangle: its lifts have weights of no more than
// uv + vw + wu <= 1/3, the middle one of uvw <= 1/27.
inline float bulge(__global const float *net)
{
    float lift = 0.0f;
    for (int i = NET_LIFT; i < NET_MIDDLE; ++i)
        lift = fmax(lift, length3(vector_at(net, i)));
    return lift / 3.0f + length3(vector_at(net, NET_MIDDLE)) / 27.0f;
}

inline float3 hit_of(const Decal decal)
{
    return (float3)(decal.point[0], decal.point[1], decal.point[2]);
}

inline bool near_segment(float3 hit, float radius, float3 from, float3 to)
{
    const float3 along = to - from;
    const float square = dot3(along, along);
    const float t = square > 0.0f ? dot3(hit - from, along) / square : 0.0f;
    const float3 foot = from + along * fmin(fmax(t, 0.0f), 1.0f);
    return length3(foot - hit) <= radius;
}

inline bool over_triangle(float3 hit, float radius, float3 a, float3 b, float3 c)
{
    const float3 plane = direction(cross3(b - a, c - a));
    return fabs(dot3(hit - a, plane)) <= radius
        && dot3(cross3(b - a, hit - a), plane) >= 0.0f
        && dot3(cross3(c - b, hit - b), plane) >= 0.0f
        && dot3(cross3(a - c, hit - c), plane) >= 0.0f;
}

// E edges, T triangles, D decals
__kernel void edges(const int edge_count, const int decal_count,
                    __global const Decal *decals,       // (D,)
                    __global const int2 *sides,         // (E,)
                    __global const float *nets,         // (T, NET_VECTORS, 3)
                    __global int *reached)              // (E,)
{
    const int edge = get_global_id(0);
    if (edge >= edge_count)
        return;
    const int side = sides[edge].x % 3;
    __global const float *net = nets + (size_t)(sides[edge].x / 3) * (3 * NET_VECTORS);
    __global const float *other = nets + (size_t)(sides[edge].y / 3) * (3 * NET_VECTORS);
    const float3 from = vector_at(net, (side + 1) % 3), to = vector_at(net, (side + 2) % 3);
    const float more = fmax(bulge(net), bulge(other));
    int found = 0;
    for (int k = 0; k < decal_count && !found; ++k)
        found = near_segment(hit_of(decals[k]), decals[k].radius + more, from, to);
    reached[edge] = found;
}

__kernel void patches(const int triangles, const int decal_count,
                      const float factor, const float elsewhere,
                      __global const Decal *decals,     // (D,)
                      __global const int *edges,        // (T, 3)
                      __global const int *reached,      // (E,)
                      __global const float *nets,       // (T, NET_VECTORS, 3)
                      __global float *edge_factors,     // (T, 3)
                      __global float *inside_factors)   // (T, 1)
{
    const int patch = get_global_id(0);
    if (patch >= triangles)
        return;
    int found = 0;
    for (int side = 0; side < 3; ++side) {
        const int here = reached[edges[3 * patch + side]];
        edge_factors[3 * patch + side] = here ? factor : elsewhere;
        found |= here;
    }
    __global const float *net = nets + (size_t)patch * (3 * NET_VECTORS);
    const float3 a = vector_at(net, 0), b = vector_at(net, 1), c = vector_at(net, 2);
    const float more = bulge(net);
    for (int k = 0; k < decal_count && !found; ++k)
        found = over_triangle(hit_of(decals[k]), decals[k].radius + more, a, b, c);
    inside_factors[patch] = found ? factor : elsewhere;
}
