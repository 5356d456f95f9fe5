// Heights that float within the tolerance: vertices are moved until no sample is farther from its triangle
// than its patch allows.
//
//        o                          a chord with its ends on the ground errs to one side; lifted, it
//      o   o    . . .  - - -        errs half as much to both
//     *-----*
//
// What is made small is the sum of squares of what errors exceed, over all samples s of all triangles:
//
//     sum over s of max(0, |r_s| - allowed)^2,     r_s = w_1 z_1 + w_2 z_2 + w_3 z_3 - h_s
//
// Every pass moves all vertices at once. A vertex goes against the gradient, divided by the weights of the
// samples that pull at it: a separable majoriser of the sum (De Pierro, "A modified expectation maximization
// algorithm for penalized likelihood estimation in emission tomography", IEEE Trans. Medical Imaging 14,
// 1995). Momentum is dropped where it points uphill (O'Donoghue, Candes, "Adaptive restart for accelerated
// gradient schemes", Found. Comput. Math. 15, 2015).
//
// Patches add to the same vertex in any order, so what they add are whole numbers: no order changes a bit.
//
//   put_points    where points stand
//   weld          points at one place are one vertex, found in a hash table
//   recall        vertices that were there before begin where that left them
//   pull, move    a pass
//   spread        what its vertex has found, to each point
//
// Built with: PATCHES, GROUP work-items a patch, what these and ground.h are built with.
#include "common/reduce.h"
#include PATCHES

#define NOBODY -1
// Shares of what a vertex allows are counted in 1 / UNITS; samples pull no harder than LONGEST of it. Four
// patches of 128 x 128 samples, a third of which is a corner's, come to 1.5e9: sums are 32-bit numbers.
#define UNITS 8192.0f
#define LONGEST 8.0f
// weight of the place where a vertex stands already, beside samples of weight 1
#define INERTIA 0.25f
#define MOMENTUM 0.8f
// of what is allowed, fits may use so much: what is left is room for their end
#define FITTED_SHARE 0.97f
// a vertex that moves by less of what it allows has come to rest
#define REST 1e-3f
// samples on a triangle's outline are its own, however places are rounded
#define OUTSIDE -1e-4f

__kernel void put_points(const Grid grid,
                         __global const float *heights,         // (R, C)
                         __global const uchar *holes,           // (R, C) where MASKED
                         __global const float *detail_heights,  // where DETAIL
                         PATCH_ARGUMENTS
                         const int patches,
                         __global const uint *point_offsets,    // (P + 1,)
                         __global const uint2 *points,          // (N,)
                         __global int4 *places,                 // (N,) cells and fractions, east and south
                         __global float4 *corners)              // (N,) in strides from the patch's first
                                                                // sample, and the ground's height
{
    const Ground ground = {grid, heights, holes, detail_heights};
    const PatchSet set = PATCH_SET;
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patches); ++patch) {
        const Placing placing = placing_of(grid, set, patch);
        const float scale = 1.0f / FIXED_ONE / placing.stride;
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1]; i += GROUP) {
            const int2 offset = place_of(placing, points[i]);
            const Coordinate column = global_coordinate(placing.tile.column, offset.x);
            const Coordinate row = global_coordinate(placing.tile.row, offset.y);
            places[i] = (int4)(column.cell, row.cell, column.fraction, row.fraction);
            corners[i] = (float4)(offset.x * scale, offset.y * scale, height_between(ground, column, row),
                                  0.0f);
        }
    }
}

inline uint hash_of(int4 place)
{
    uint hash = ((uint)place.x << 16 ^ (uint)place.z) * 2654435761u;
    hash = (hash ^ hash >> 15 ^ (uint)place.y << 16 ^ (uint)place.w) * 2246822519u;
    return hash ^ hash >> 13;
}

inline bool is_same(int4 a, int4 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

__kernel void weld(const int patches,
                   __global const uint *point_offsets,          // (P + 1,)
                   __global const int4 *places,                 // (N,)
                   __global const float *allowed,               // (P,)
                   const uint last,                             // slots of the table, a power of two, less 1
                   __global int *table,                         // points, NOBODY where free
                   __global int *vertices,                      // (N,) of each point: one of those there
                   __global int *finest)                        // (N,) of a vertex: bits of the least that
                                                                // its patches allow, a float above 0
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    for (uint i = point_offsets[patch]; i < point_offsets[patch + 1]; ++i) {
        const int4 place = places[i];
        int vertex = NOBODY;
        for (uint slot = hash_of(place) & last; vertex == NOBODY; slot = (slot + 1) & last) {
            const int other = atomic_cmpxchg(table + slot, NOBODY, (int)i);
            if (other == NOBODY)
                vertex = i;
            else if (is_same(places[other], place))
                vertex = other;
        }
        vertices[i] = vertex;
        atomic_min(finest + vertex, as_int(allowed[patch]));
    }
}

__kernel void recall(const int count,
                     __global const int4 *places,               // (N,)
                     __global const int *vertices,              // (N,)
                     __global const int4 *earlier_places,       // of the round before, likewise
                     const uint earlier_last, __global const int *earlier_table,
                     __global const float *earlier_heights,
                     __global float *heights_above)             // (N,) of vertices, above the ground
{
    const int i = get_global_id(0);
    if (i >= count || vertices[i] != i)
        return;
    const int4 place = places[i];
    float height = 0.0f;
    for (uint slot = hash_of(place) & earlier_last; earlier_table[slot] != NOBODY;
         slot = (slot + 1) & earlier_last)
        if (is_same(earlier_places[earlier_table[slot]], place)) {
            height = earlier_heights[earlier_table[slot]];
            break;
        }
    heights_above[i] = height;
}

// Adds what the samples of one triangle ask of its corners; says whether any asks for anything.
inline bool pull_triangle(const Ground ground, const Placing placing, float room, const float4 *corner,
                          const int *vertex, __global const int *finest, __global int *pulls,
                          __global int *weights)
{
    const float4 a = corner[0], b = corner[1], c = corner[2];
    const float x1 = b.x - a.x, y1 = b.y - a.y, rise1 = b.z - a.z;
    const float x2 = c.x - a.x, y2 = c.y - a.y, rise2 = c.z - a.z;
    const float area = x1 * y2 - x2 * y1;
    if (area == 0.0f)
        return false;
    const float inverse = 1.0f / area;
    const int left = (int)ceil(smaller(smaller(a.x, b.x), c.x)), right = (int)larger(larger(a.x, b.x), c.x);
    const int top = (int)ceil(smaller(smaller(a.y, b.y), c.y)), bottom = (int)larger(larger(a.y, b.y), c.y);
    float3 pull = (float3)(0.0f, 0.0f, 0.0f), weight = pull;
    bool found = false;
    for (int row = top; row <= bottom; ++row) {
        bool entered = false;
        for (int column = left; column <= right; ++column) {
            const float x = column - a.x, y = row - a.y;
            const float w1 = (x * y2 - x2 * y) * inverse, w2 = (x1 * y - x * y1) * inverse;
            const float w0 = 1.0f - w1 - w2;
            if (smaller(smaller(w1, w2), w0) < OUTSIDE) {
                if (entered)
                    break;
                continue;
            }
            entered = true;
            const int r = placing.tile.row + row * placing.stride;
            const int s = placing.tile.column + column * placing.stride;
            const float residual = (a.z - sample_height(ground, r, s)) + w1 * rise1 + w2 * rise2;
            const float excess = residual > room ? residual - room : residual < -room ? residual + room : 0.0f;
            if (excess == 0.0f || !sample_has_data(ground, r, s))
                continue;
            found = true;
            pull += (float3)(w0, w1, w2) * excess;
            weight += (float3)(w0, w1, w2);
        }
    }
    if (!found)
        return false;
    const float of_pull[3] = {pull.x, pull.y, pull.z}, of_weight[3] = {weight.x, weight.y, weight.z};
    for (int k = 0; k < 3; ++k) {
        const float unit = as_float(finest[vertex[k]]);
        const float most = LONGEST * of_weight[k];
        if (!(unit > 0.0f) || !(of_weight[k] > 0.0f))
            continue;
        const float asked = smaller(larger(of_pull[k] / unit, -most), most);
        atomic_add(pulls + vertex[k], convert_int_rte(asked * UNITS));
        atomic_add(weights + vertex[k], convert_int_rte(of_weight[k] * UNITS));
    }
    return true;
}

__kernel void pull(const Grid grid,
                   __global const float *heights,               // (R, C)
                   __global const uchar *holes,                 // (R, C) where MASKED
                   __global const float *detail_heights,        // where DETAIL
                   PATCH_ARGUMENTS
                   __global const float4 *details,              // by the numbers of patches; .x: drift
                   const int patches,
                   __global const uint *point_offsets,          // (P + 1,)
                   __global const uint *triangle_offsets,       // (P + 1,)
                   __global const int *triangles,               // (M, 3)
                   __global const float4 *corners,              // (N,)
                   __global const int *vertices,                // (N,)
                   __global const int *finest,                  // (N,)
                   __global const float *allowed,               // (P,)
                   __global const float *heights_above,         // (N,)
                   __global const uchar *moved,                 // (N,) vertices, in the last pass
                   __global uchar *asking,                      // (P,) patches with a sample that pulls
                   __global int *pulls, __global int *weights,  // (N,) sums, 0 before
                   __local float *scratch)                      // GROUP
{
    const Ground ground = {grid, heights, holes, detail_heights};
    const PatchSet set = PATCH_SET;
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patches); ++patch) {
        float awake = asking[patch];
        for (uint i = point_offsets[patch] + get_local_id(0); i < point_offsets[patch + 1]; i += GROUP)
            awake = larger(awake, moved[vertices[i]]);
        if (group_max(awake, scratch) == 0.0f)
            continue;
        const Placing placing = placing_of(grid, set, patch);
        // a lattice is off the samples; where that is most of what is allowed, the leaf will be split
        const float all = allowed[patch] * FITTED_SHARE;
        const float drift = placing.stride > 1 ? details[number_of(set, patch)].x : 0.0f;
        const float room = larger(all - drift, 0.1f * all);
        bool found = false;
        for (uint t = triangle_offsets[patch] + get_local_id(0); t < triangle_offsets[patch + 1]; t += GROUP) {
            float4 corner[3];
            int vertex[3];
            for (int k = 0; k < 3; ++k) {
                const int point = triangles[3 * t + k];
                vertex[k] = vertices[point];
                corner[k] = corners[point];
                corner[k].z += heights_above[vertex[k]];
            }
            found |= pull_triangle(ground, placing, room, corner, vertex, finest, pulls, weights);
        }
        const float any = group_max(found, scratch);
        if (get_local_id(0) == 0)
            asking[patch] = any > 0.0f;
    }
}

__kernel void move(const int count,
                   __global const int *vertices,                // (N,)
                   __global const int *finest,                  // (N,)
                   __global int *pulls, __global int *weights,  // (N,) 0 afterwards
                   __global float *heights_above,               // (N,)
                   __global float *before,                      // (N,) without momentum
                   __global uchar *moved)                       // (N,)
{
    const int i = get_global_id(0);
    if (i >= count || vertices[i] != i)
        return;
    const float unit = as_float(finest[i]), height = heights_above[i];
    const float step = pulls[i] == 0 ? 0.0f
        : unit * ((pulls[i] / UNITS) / (weights[i] / UNITS + INERTIA));
    // no vertex is farther from the ground than samples may be
    const float most = unit * FITTED_SHARE;
    const float next = smaller(larger(height - step, -most), most), way = next - before[i];
    const bool is_resting = step == 0.0f && absolute(way) < REST * unit;
    // momentum ends where it points uphill
    const float further = is_resting || (height - next) * way > 0.0f ? 0.0f : MOMENTUM * way;
    const float there = smaller(larger(next + further, -most), most);
    before[i] = next;
    heights_above[i] = there;
    moved[i] = there != height;
    pulls[i] = weights[i] = 0;
}

__kernel void spread(const int count, __global const int *vertices, __global const float *heights_above,
                     __global float *lifts)                     // (N,) of points
{
    const int i = get_global_id(0);
    if (i < count)
        lifts[i] = heights_above[vertices[i]];
}
