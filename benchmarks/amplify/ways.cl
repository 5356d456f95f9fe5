// Ways to make many triangles of one, without a tessellator: the surface of a PN-triangle at one odd
// level, as triangles with vertices of their own.
//
//   place_nets    control nets of every copy of a mesh
//   direct        a work-item a patch makes all of its triangles
//   emitters      first pass: records, each of which stands for some triangles of a patch
//   emit          second pass: a work-item an emitter makes them
//   place         vertices that were stored, at every copy
//   pass_through  corners of indexed triangles, forwarded
//
// LEVEL, where it is given, is the level that `direct` is built for; otherwise it takes any.
// Built with: STRIP (where strip.h is), LANES 1, LINEAR_NORMALS 0, [LEVEL], QUADS (1: an emitter makes
// a quad; 0: a border).
#include STRIP
#include "curved/pn_point.h"

#ifdef LEVEL
#define CHOSEN(level) LEVEL
#else
#define CHOSEN(level) (level)
#endif

enum { TRANSFORM = 12 };    // 3 rows of a rotation and a shift

// where triangles go
typedef struct {
    __global float *positions;
    __global float *normals;
} Target;

inline float3 turned(__global const float *transform, float3 a)
{
    return (float3)(transform[0] * a.x + transform[1] * a.y + transform[2] * a.z,
                    transform[4] * a.x + transform[5] * a.y + transform[6] * a.z,
                    transform[8] * a.x + transform[9] * a.y + transform[10] * a.z);
}

inline float3 placed(__global const float *transform, float3 a)
{
    return turned(transform, a) + (float3)(transform[3], transform[7], transform[11]);
}

inline Vertices vertex_at(__global const float *net, float3 fallback,
                          __global const uint2 *points, int point)
{
    const uint2 at = points[point];
    return evaluate((float)at.x * (1.0f / FIXED_ONE), (float)at.y * (1.0f / FIXED_ONE), net,
                    fallback);
}

inline void put_corner(const Target target, size_t corner, const Vertices vertex)
{
    for (int axis = 0; axis < 3; ++axis) {
        target.positions[3 * corner + axis] = vertex.position[axis];
        target.normals[3 * corner + axis] = vertex.normal[axis];
    }
}

inline void put_triangle(const Target target, size_t triangle, const Vertices a, const Vertices b,
                         const Vertices c)
{
    put_corner(target, 3 * triangle, a);
    put_corner(target, 3 * triangle + 1, b);
    put_corner(target, 3 * triangle + 2, c);
}

// Makes triangles first .. first + count - 1 of a strip, each vertex computed once a row.
inline void emit_strip(int level, int ring, int side, int first, int count,
                       __global const float *net, __global const uint2 *points,
                       const Target target, size_t triangle)
{
    const float3 fallback = fallback_normal(net);
    int outer = outer_steps(level, ring, first), inner = first - outer;
    Vertices near = vertex_at(net, fallback, points, point_of(level, ring, side, outer));
    Vertices far = vertex_at(net, fallback, points, point_of(level, ring + 1, side, inner));
    triangle += triangles_outside(level, ring) + side * strip_triangles(level, ring);
    for (int t = first; t < first + count; ++t) {
        if (outer_steps(level, ring, t + 1) > outer) {
            const int next = point_of(level, ring, side, ++outer);
            const Vertices vertex = vertex_at(net, fallback, points, next);
            put_triangle(target, triangle + t, near, vertex, far);
            near = vertex;
        } else {
            const int next = point_of(level, ring + 1, side, ++inner);
            const Vertices vertex = vertex_at(net, fallback, points, next);
            put_triangle(target, triangle + t, far, near, vertex);
            far = vertex;
        }
    }
}

inline void emit_middle(int level, __global const float *net, __global const uint2 *points,
                        const Target target, size_t triangle)
{
    const float3 fallback = fallback_normal(net);
    const int ring = rings_of(level), first = points_outside(level, ring);
    put_triangle(target, triangle + triangles_outside(level, ring),
                 vertex_at(net, fallback, points, first),
                 vertex_at(net, fallback, points, first + 1),
                 vertex_at(net, fallback, points, first + 2));
}

// T triangles of the mesh, K copies
__kernel void place_nets(const int triangles, const int copies,
                         __global const float *transforms,  // (K, TRANSFORM)
                         __global const float *nets,        // (T, NET_VECTORS, 3)
                         __global float *placed_nets)       // (K, T, NET_VECTORS, 3)
{
    const int patch = get_global_id(0);
    if (patch >= copies * triangles)
        return;
    __global const float *transform = transforms + TRANSFORM * (patch / triangles);
    __global const float *net = nets + (size_t)(patch % triangles) * (3 * NET_VECTORS);
    __global float *target = placed_nets + (size_t)patch * (3 * NET_VECTORS);
    for (int i = 0; i < NET_VECTORS; ++i) {
        // all but the corners are differences and directions
        const float3 vector = vector_at(net, i);
        put_vector(target, i, i < NET_LIFT ? placed(transform, vector) : turned(transform, vector));
    }
}

// P = K T patches, S triangles of each
__kernel void direct(const int patches, const int level,
                     __global const float *nets,            // (P, NET_VECTORS, 3)
                     __global const uint2 *points,          // of one patch
                     __global float *positions,             // (P, S, 3 corners, 3)
                     __global float *normals)               // (P, S, 3, 3)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    const Target target = {positions, normals};
    __global const float *net = nets + (size_t)patch * (3 * NET_VECTORS);
    const size_t triangle = (size_t)patch * triangles_of(CHOSEN(level));
    for (int ring = 0; ring < rings_of(CHOSEN(level)); ++ring)
        for (int side = 0; side < SIDES; ++side)
            emit_strip(CHOSEN(level), ring, side, 0, strip_triangles(CHOSEN(level), ring),
                       net, points, target, triangle);
    emit_middle(CHOSEN(level), net, points, target, triangle);
}

// E emitters of each of P patches, the middle one last
__kernel void emitters(const int patches, const int level, const int each,
                       __global int4 *records)              // (P, E) patch, ring, side, first
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    __global int4 *record = records + (size_t)patch * each;
    for (int ring = 0; ring < rings_of(level); ++ring)
        for (int side = 0; side < SIDES; ++side) {
            const int run = QUADS ? 2 : strip_triangles(level, ring);
            for (int first = 0; first < strip_triangles(level, ring); first += run)
                *record++ = (int4)(patch, ring, side, first);
        }
    *record = (int4)(patch, rings_of(level), 0, 0);
}

__kernel void emit(const int count, const int level,
                   __global const int4 *records,            // (count)
                   __global const float *nets,              // (P, NET_VECTORS, 3)
                   __global const uint2 *points,            // of one patch
                   __global float *positions,               // (P, S, 3 corners, 3)
                   __global float *normals)                 // (P, S, 3, 3)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const int4 record = records[i];
    const Target target = {positions, normals};
    __global const float *net = nets + (size_t)record.x * (3 * NET_VECTORS);
    const size_t triangle = (size_t)record.x * triangles_of(level);
    if (record.y == rings_of(level))
        emit_middle(level, net, points, target, triangle);
    else
        emit_strip(level, record.y, record.z, record.w,
                   QUADS ? 2 : strip_triangles(level, record.y), net, points, target, triangle);
}

// N vertices, K copies
__kernel void place(const int vertices, const int copies,
                    __global const float *transforms,       // (K, TRANSFORM)
                    __global const float *stored_positions, // (N, 3)
                    __global const float *stored_normals,   // (N, 3)
                    __global float *positions,              // (K, N, 3)
                    __global float *normals)                // (K, N, 3)
{
    const int i = get_global_id(0);
    if (i >= vertices)
        return;
    const float3 position = vector_at(stored_positions, i), normal = vector_at(stored_normals, i);
    for (int copy = 0; copy < copies; ++copy) {
        __global const float *transform = transforms + TRANSFORM * copy;
        const size_t first = 3 * (size_t)copy * vertices;
        put_vector(positions + first, i, placed(transform, position));
        put_vector(normals + first, i, turned(transform, normal));
    }
}

// C corners of indexed triangles
__kernel void pass_through(const int corners,
                           __global const int *indices,             // (C)
                           __global const float *vertex_positions,  // (N, 3)
                           __global const float *vertex_normals,    // (N, 3)
                           __global float *positions,               // (C, 3)
                           __global float *normals)                 // (C, 3)
{
    const int i = get_global_id(0);
    if (i >= corners)
        return;
    put_vector(positions, i, vector_at(vertex_positions, indices[i]));
    put_vector(normals, i, vector_at(vertex_normals, indices[i]));
}
