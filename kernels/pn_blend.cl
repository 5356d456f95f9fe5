// Curved PN-triangles on semi-uniform patterns whose levels lie between whole numbers.
//
// A level of n - 1 + f, with f above 0 and at most 1, has the points of level n. Those that level
// n - 1 has not, grow out of the middles of its segments as f goes to 1:
//
//     point = (a + b) / 2 + f (surface - (a + b) / 2)        a, b its two neighbours of level n - 1
//
//     level 1         level 1.5           level 2
//        .           .-'o'-.             .-' o '-.         along an edge by the edge's own level, so
//       / \         o       o           o         o        that both sides of it agree; inside by
//      /   \       /         \         /           \       the patch's, the largest of its edges'
//
// so that a patch at f = 0 is the one of level n - 1, and nothing jumps as a camera moves, but for
// the rim of patches beside an edge of a lower level: where that level passes a whole number, the
// rim is cut into other triangles.
//
// Built with: GROUP work-items a patch, LANES 1, LINEAR_NORMALS (0 or 1).
#include "pn_point.h"

#if LANES != 1
#error "pn_blend.cl: points are evaluated one by one, LANES must be 1"
#endif

typedef struct {
    float3 position, normal;
} Vertex;

// What a patch's points depend on.
typedef struct {
    __global const float *net;
    float3 fallback;
    float edges[3];             // levels of u = 0, v = 0, w = 0
    float inside;               // the largest of them
} Patch;

// factors become levels; what is culled has a level below 0. N factors.
__kernel void pn_levels(const int count, const float maximum,
                        __global const float *factors,      // (N,)
                        __global float *levels)             // (N,)
{
    const int i = get_global_id(0);
    if (i < count)
        levels[i] = factors[i] > 0.0f ? fmin(fmax(log2(factors[i]), 0.0f), maximum) : -1.0f;
}

inline int whole_level(float level)
{
    return (int)ceil(level);
}

inline Vertex on_surface(const Patch patch, uint u, uint v)
{
    const Vertices found = evaluate(u * (1.0f / FIXED_ONE), v * (1.0f / FIXED_ONE), patch.net,
                                    patch.fallback);
    const Vertex vertex = {
        (float3)(found.position[0], found.position[1], found.position[2]),
        (float3)(found.normal[0], found.normal[1], found.normal[2])};
    return vertex;
}

// between the middle of a and b and the point itself; the same whichever of a and b comes first
inline Vertex grown(const Vertex a, const Vertex b, const Vertex full, float part)
{
    const float3 middle = (a.position + b.position) * 0.5f;
    const float3 normal = (a.normal + b.normal) * 0.5f;
    const float3 mixed = direction(normal + (full.normal - normal) * part);
    Vertex vertex;
    vertex.position = part < 1.0f ? middle + (full.position - middle) * part : full.position;
    vertex.normal = part < 1.0f && dot3(mixed, mixed) > 0.0f ? mixed : full.normal;
    return vertex;
}

// edge that a point lies on, 3 for none
inline int edge_of(uint2 at)
{
    return at.x == 0 ? 0 : at.y == 0 ? 1 : at.x + at.y == FIXED_ONE ? 2 : 3;
}

// a point of an edge's own level, `along` being the weight that grows along it
inline Vertex on_edge(const Patch patch, int edge, uint2 at)
{
    const Vertex full = on_surface(patch, at.x, at.y);
    const int level = whole_level(patch.edges[edge]);
    const uint step = FIXED_ONE >> level, along = edge == 0 ? at.y : at.x;
    if (along / step % 2 == 0)
        return full;
    // edge 0 runs along v, edge 1 along u, edge 2 along both in opposite directions
    const uint2 next = edge == 0 ? (uint2)(0, step) : edge == 1 ? (uint2)(step, 0)
                                                                : (uint2)(step, -step);
    const uint2 before = at - next, after = at + next;
    return grown(on_surface(patch, before.x, before.y), on_surface(patch, after.x, after.y), full,
                 patch.edges[edge] - (level - 1));
}

// The snap function of semi_uniform.cl, of a place on an edge in 16.16: the nearest of the 2^level
// steps; half-way between two, the one nearer to an end.
inline uint snapped(uint place, int level)
{
    const uint step = FIXED_ONE >> level;
    const uint nearer_first = 2 * place < FIXED_ONE;
    return (place + step / 2 - (step > 1 ? nearer_first : 0)) / step * step;
}

// a point of the lattice one level coarser
inline Vertex on_lattice(const Patch patch, uint2 at)
{
    const int edge = edge_of(at);
    if (edge == 3)
        return on_surface(patch, at.x, at.y);
    // walked as the pattern is: u = 0 from v = 1, v = 0 from u = 0, w = 0 from u = 1
    const int level = whole_level(patch.edges[edge]);
    const uint walked = edge == 1 ? at.x : FIXED_ONE - (edge == 0 ? at.y : at.x);
    const uint place = snapped(walked, level);
    const uint2 moved = edge == 0 ? (uint2)(0, FIXED_ONE - place)
                      : edge == 1 ? (uint2)(place, 0)
                                  : (uint2)(FIXED_ONE - place, place);
    return on_edge(patch, edge, moved);
}

inline Vertex inside_patch(const Patch patch, uint2 at)
{
    const Vertex full = on_surface(patch, at.x, at.y);
    const int level = whole_level(patch.inside);
    const uint step = FIXED_ONE >> level;
    const uint odd_u = at.x / step % 2, odd_v = at.y / step % 2;
    if (odd_u + odd_v == 0)
        return full;
    // along u, along v, or along the lattice's third direction
    const uint2 next = (uint2)(odd_u * step, odd_u && odd_v ? -step : odd_v * step);
    return grown(on_lattice(patch, at - next), on_lattice(patch, at + next), full,
                 patch.inside - (level - 1));
}

// P patches, N points
__kernel void pn_blend(const int patches,
                       __global const float *nets,          // (P, NET_VECTORS, 3)
                       __global const float *levels,        // (P, 3)
                       __global const uint *point_offsets,  // (P + 1,)
                       __global const uint2 *points,        // (N,) u, v in 16.16
                       __global float *positions,           // (N, 3)
                       __global float *normals)             // (N, 3)
{
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int i = first; i < min(first + run, patches); ++i) {
        __global const float *own = levels + (size_t)3 * i;
        Patch patch = {nets + (size_t)i * (3 * NET_VECTORS), (float3)(0.0f),
                       {own[0], own[1], own[2]}, fmax(own[0], fmax(own[1], own[2]))};
        patch.fallback = fallback_normal(patch.net);
        for (uint k = point_offsets[i] + get_local_id(0); k < point_offsets[i + 1]; k += GROUP) {
            const int edge = edge_of(points[k]);
            const bool corner = points[k].x == FIXED_ONE || points[k].y == FIXED_ONE
                             || points[k].x + points[k].y == 0;
            const Vertex found = corner ? on_surface(patch, points[k].x, points[k].y)
                               : edge < 3 ? on_edge(patch, edge, points[k])
                                          : inside_patch(patch, points[k]);
            put_vector(positions, k, found.position);
            put_vector(normals, k, found.normal);
        }
    }
}
