// Which patches do decals reach? Edge by edge, each asked once, then the triangle between them.
//
//        o hit         An edge is reached where it comes within the radius of a hit: by an end, or by
//        |             the foot of the hit on it. The inside is, where an edge is, or where the hit
//     ---+-------      is above the triangle and within the radius of its plane.
//       foot
//
// Both sides of an edge take what was found of it. Curved patches leave their planes: what they
// bulge adds to the radius. After "DirectX 11 tessellation", slides of 2010, displacement adaptive.
//
// What a camera does not see is not refined: patches out of its view, and decals all of whose
// patches are turned away. A decal is asked as a whole, because its far wall may be seen over a rim
// that is pressed in, though the wall's own patch is turned away.
#include "curved/pn_cull.h"

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

// PoCL calls its fmin
inline float3 smaller3(float3 a, float3 b)
{
    return (float3)(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z));
}

inline bool reaches(const Decal decal, __global const float *net, float bulged)
{
    const float3 hit = hit_of(decal);
    const float3 a = vector_at(net, 0), b = vector_at(net, 1), c = vector_at(net, 2);
    const float radius = decal.radius + bulged;
    // most are far from the box around the corners
    const float3 low = smaller3(a, smaller3(b, c)), high = -smaller3(-a, smaller3(-b, -c));
    const float3 outside = -smaller3(smaller3(hit - low, high - hit), (float3)(0.0f));
    if (dot3(outside, outside) > radius * radius * 1.001f)
        return false;
    return near_segment(hit, radius, a, b) || near_segment(hit, radius, b, c)
        || near_segment(hit, radius, c, a) || over_triangle(hit, radius, a, b, c);
}

// Which patches are in view when all decals have moved them, and which decals have a patch there
// that is not turned away?
__kernel void views(const int triangles, const int decal_count, const View view,
                    const float back_cosine,            // 2 turns none away
                    __global const Decal *decals,       // (D,)
                    __global const float *moves,        // (D,) the most that each moves a point
                    __global const float *nets,         // (T, NET_VECTORS, 3)
                    __global int *in_view,              // (T,)
                    __global int *seen)                 // (D,) zero before
{
    const int patch = get_global_id(0);
    if (patch >= triangles)
        return;
    __global const float *net = nets + (size_t)patch * (3 * NET_VECTORS);
    const float bulged = bulge(net);
    float moved = 0.0f;
    bool reached = false;
    for (int k = 0; k < decal_count; ++k)
        if (reaches(decals[k], net, bulged)) {
            moved += moves[k];
            reached = true;
        }
    float3 controls[CONTROLS];
    control_points(net, controls);
    in_view[patch] = !out_of_view(controls, moved, view);
    if (!reached || !in_view[patch] || (back_cosine < 1.0f && seen_from_behind(controls, view, back_cosine)))
        return;
    for (int k = 0; k < decal_count; ++k)
        if (reaches(decals[k], net, bulged))
            atomic_or(&seen[k], 1);
}

// E edges, T triangles, D decals
__kernel void edges(const int edge_count, const int decal_count,
                    __global const Decal *decals,       // (D,)
                    __global const int2 *sides,         // (E,)
                    __global const int *in_view,        // (T,)
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
    const bool wanted = in_view[sides[edge].x / 3] || in_view[sides[edge].y / 3];
    for (int k = 0; k < decal_count && wanted && !found; ++k)
        found = near_segment(hit_of(decals[k]), decals[k].radius + more, from, to);
    reached[edge] = found;
}

__kernel void patches(const int triangles, const int decal_count,
                      const float elsewhere,
                      __global const Decal *decals,     // (D,)
                      __global const float *factors,    // (E,) where a decal reaches
                      __global const int *in_view,      // (T,)
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
    float finest = elsewhere;
    for (int side = 0; side < 3; ++side) {
        const int edge = edges[3 * patch + side], here = reached[edge];
        edge_factors[3 * patch + side] = here ? fmax(factors[edge], elsewhere) : elsewhere;
        finest = fmax(finest, factors[edge]);
        found |= here;
    }
    __global const float *net = nets + (size_t)patch * (3 * NET_VECTORS);
    const float3 a = vector_at(net, 0), b = vector_at(net, 1), c = vector_at(net, 2);
    const float more = bulge(net);
    for (int k = 0; k < decal_count && in_view[patch] && !found; ++k)
        found = over_triangle(hit_of(decals[k]), decals[k].radius + more, a, b, c);
    inside_factors[patch] = found ? finest : elsewhere;
}
