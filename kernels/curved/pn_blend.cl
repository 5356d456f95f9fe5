// Curved PN-triangles on semi-uniform patterns whose levels lie between whole numbers.
//
// A level of n - 1 + f, with f above 0 and at most 1, has the points of level n. At f = 0 the patch
// is that of level n - 1, and nothing jumps as a camera moves:
//
//   along an edge, points that level n - 1 has not, slide along the curve, from the point of level
//   n - 1 that they come from (dyadic_edge.h) to their own place:
//
//       level 1            level 1.5            level 2
//       o-------o-------o  o-o-----o-----o-o    o---o---o---o---o
//
//   by the edge's own level, so that both sides of it agree;
//
//   inside, they grow out of the middles of the segments of level n - 1, by the patch's level, the
//   largest of its edges':
//
//       point = (a + b) / 2 + f (surface - (a + b) / 2)      a, b its two neighbours of level n - 1
//
// Built with: GROUP work-items a patch, LANES 1, LINEAR_NORMALS (0 or 1).
#include "tessellation/dyadic_edge.h"
#include "curved/pn_point.h"

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

// Does the middle of an edge go to the start of the walk at level 0? To the lesser end, seen from
// both sides. Edge k is walked from corner k + 1 to corner k + 2.
inline bool is_turned(__global const float *net, int edge)
{
    const float3 from = vector_at(net, NET_CORNER + (edge + 1) % 3);
    const float3 to = vector_at(net, NET_CORNER + (edge + 2) % 3);
    return from.x != to.x ? from.x < to.x : from.y != to.y ? from.y < to.y : from.z < to.z;
}

// a bit an edge, for semi_uniform.cl; P patches
__kernel void pn_turns(const int patches,
                       __global const float *nets,          // (P, NET_VECTORS, 3)
                       __global int *turns)                 // (P,)
{
    const int i = get_global_id(0);
    if (i >= patches)
        return;
    __global const float *net = nets + (size_t)i * (3 * NET_VECTORS);
    turns[i] = is_turned(net, 0) | is_turned(net, 1) << 1 | is_turned(net, 2) << 2;
}

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

// a place on an edge in 16.16, in the direction of the walk: u = 0 from v = 1, v = 0 from u = 0,
// w = 0 from u = 1
inline uint walked(int edge, uint2 at)
{
    return edge == 1 ? at.x : FIXED_ONE - (edge == 0 ? at.y : at.x);
}

// point k of an edge's own level
inline Vertex on_edge(const Patch patch, int edge, int k)
{
    const int level = whole_level(patch.edges[edge]);
    const int from = level == 0 ? k : origin_of(k, level, is_turned(patch.net, edge));
    const int step = FIXED_ONE >> level;
    const int way = (int)((patch.edges[edge] - (level - 1)) * step + 0.5f);
    const uint place = from * step + (k - from) * way;
    return edge == 0 ? on_surface(patch, 0, FIXED_ONE - place)
         : edge == 1 ? on_surface(patch, place, 0)
                     : on_surface(patch, FIXED_ONE - place, place);
}

// a point of the lattice one level coarser
inline Vertex on_lattice(const Patch patch, uint2 at)
{
    const int edge = edge_of(at);
    if (edge == 3)
        return on_surface(patch, at.x, at.y);
    const int level = whole_level(patch.inside), own = whole_level(patch.edges[edge]);
    const int k = walked(edge, at) / (FIXED_ONE >> level);
    return on_edge(patch, edge, snap(k, level, own, is_turned(patch.net, edge)) >> (level - own));
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
            const uint2 at = points[k];
            const int edge = edge_of(at);
            const uint step = FIXED_ONE >> whole_level(edge < 3 ? patch.edges[edge] : 0.0f);
            const Vertex found = edge < 3 ? on_edge(patch, edge, walked(edge, at) / step)
                                          : inside_patch(patch, at);
            put_vector(positions, k, found.position);
            put_vector(normals, k, found.normal);
        }
    }
}
