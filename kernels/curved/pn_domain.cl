// The domain stage of curved PN-triangles: positions and normals at the points of a pattern.
//
// LANES points of a patch are evaluated side by side, lane by lane the same arithmetic: that keeps a
// CPU's vector unit busy. The last points of a patch are evaluated together with some before them
// once more, which writes the same bits again.
//
// Built with: GROUP work-items a patch, LANES (1 or 8), LINEAR_NORMALS (0 or 1).
#include "curved/pn_point.h"

#if LANES == 8
// eight points, at any address that a point may have
typedef uint16 Points __attribute__((aligned(8)));
#define POINTS_AT(points, i) (*(__global const Points *)((points) + (i)))
#define U_OF(points) ((points).even)
#define V_OF(points) ((points).odd)
#define REAL_OF(integers) convert_float8(integers)
#define LANE(real, lane) ((const float *)&(real))[lane]
#else
typedef uint2 Points;
#define POINTS_AT(points, i) ((points)[i])
#define U_OF(points) ((points).x)
#define V_OF(points) ((points).y)
#define REAL_OF(integers) ((float)(integers))
#define LANE(real, lane) (real)
#endif

// fewer than LANES points, the rest zero
inline Points few_points(__global const uint2 *points, int count)
{
    Points some = (Points)(0);
    for (int k = 0; k < count; ++k)
        ((uint2 *)&some)[k] = points[k];
    return some;
}

inline void store(const Vertices found, int lanes, __global float *positions,
                  __global float *normals)
{
    for (int lane = 0; lane < lanes; ++lane)
        for (int axis = 0; axis < 3; ++axis) {
            positions[3 * lane + axis] = LANE(found.position[axis], lane);
            normals[3 * lane + axis] = LANE(found.normal[axis], lane);
        }
}

// P patches, N points
__kernel void pn_domain(const int patches,
                        __global const float *nets,         // (P, NET_VECTORS, 3)
                        __global const uint *point_offsets, // (P + 1,)
                        __global const uint2 *points,       // (N,) u, v in 16.16
                        __global float *positions,          // (N, 3)
                        __global float *normals)            // (N, 3)
{
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int first = get_group_id(0) * run;
    for (int patch = first; patch < min(first + run, patches); ++patch) {
        __global const float *net = nets + (size_t)patch * (3 * NET_VECTORS);
        const float3 fallback = fallback_normal(net);
        const uint begin = point_offsets[patch], end = point_offsets[patch + 1];
        for (uint batch = begin + LANES * get_local_id(0); batch < end; batch += LANES * GROUP) {
            const bool whole = end - begin >= LANES;
            const size_t i = whole ? min(batch, end - LANES) : batch;
            const Points here = whole ? POINTS_AT(points, i) : few_points(points + i, end - batch);
            const Vertices found = evaluate(REAL_OF(U_OF(here)) * (1.0f / FIXED_ONE),
                                            REAL_OF(V_OF(here)) * (1.0f / FIXED_ONE), net, fallback);
            if (whole)
                store(found, LANES, positions + 3 * i, normals + 3 * i);
            else
                store(found, end - batch, positions + 3 * i, normals + 3 * i);
        }
    }
}
