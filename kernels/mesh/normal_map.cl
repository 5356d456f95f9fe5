// Normal maps: texels of a coarse mesh's texture take the normals of a fine one.
//
//      v                       a texel belongs to the triangle that holds its middle; of several
//      |  .--.--.--.           that share it, at an edge, to the last
//      |  |  | /|  |
//      |  .--/--.--.           row 0 is the top of the picture, where v is 1
//      +---------------- u
//
// The tangent space is that of glTF and MikkTSpace: normal and tangent are blended and not made unit
// length, the bitangent is w cross(normal, tangent), and a texel holds what the three are multiplied
// by. In 64 bits.
#include "common/common.h"
#pragma OPENCL FP_CONTRACT OFF

inline double3 triple(__global const float *values, int stride, int index)
{
    __global const float *value = values + (size_t)stride * index;
    return (double3)(value[0], value[1], value[2]);
}

inline double2 texture_of(__global const float *textures, int index)
{
    return (double2)(textures[2 * (size_t)index], textures[2 * (size_t)index + 1]);
}

inline double doubled_area(double2 a, double2 b, double2 c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// middle of a texel in texture coordinates
inline double2 middle(int row, int column, int rows, int columns)
{
    return (double2)((column + 0.5) / columns, 1.0 - (row + 0.5) / rows);
}

// weights of the corners at a texel's middle; all are positive inside
inline double3 weights_at(double2 at, double2 a, double2 b, double2 c)
{
    const double area = doubled_area(a, b, c);
    if (area == 0.0)
        return (double3)(-1.0);
    return (double3)(doubled_area(at, b, c), doubled_area(a, at, c), doubled_area(a, b, at)) / area;
}

typedef struct {
    double2 a, b, c;
    int first_row, last_row, first_column, last_column;
} Place;

inline Place place_of(int triangle, __global const int *triangles, __global const float *textures,
                      int rows, int columns)
{
    __global const int *index = triangles + 3 * (size_t)triangle;
    Place t = {texture_of(textures, index[0]), texture_of(textures, index[1]),
               texture_of(textures, index[2]), 0, 0, 0, 0};
    const double2 low = fmin(fmin(t.a, t.b), t.c), high = fmax(fmax(t.a, t.b), t.c);
    t.first_row = max((int)floor((1.0 - high.y) * rows) - 1, 0);
    t.last_row = min((int)ceil((1.0 - low.y) * rows), rows - 1);
    t.first_column = max((int)floor(low.x * columns) - 1, 0);
    t.last_column = min((int)ceil(high.x * columns), columns - 1);
    return t;
}

// the last triangle that holds each texel
__kernel void cover(const int count,
                    __global const int *triangles,     // (T, 3)
                    __global const float *textures,    // (V, 2)
                    const int rows, const int columns,
                    volatile __global int *owners)     // (rows, columns) -1 before
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Place t = place_of(i, triangles, textures, rows, columns);
    for (int row = t.first_row; row <= t.last_row; ++row)
        for (int column = t.first_column; column <= t.last_column; ++column) {
            const double3 w = weights_at(middle(row, column, rows, columns), t.a, t.b, t.c);
            if (w.x >= 0.0 && w.y >= 0.0 && w.z >= 0.0)
                atomic_max(owners + row * columns + column, i);
        }
}

// how many texels lie within a triangle that do not belong to it
__kernel void shared_texels(const int count,
                            __global const int *triangles,     // (T, 3)
                            __global const float *textures,    // (V, 2)
                            const int rows, const int columns,
                            __global const int *owners,        // (rows, columns)
                            volatile __global uint *counts)    // (1,) 0 before
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Place t = place_of(i, triangles, textures, rows, columns);
    for (int row = t.first_row; row <= t.last_row; ++row)
        for (int column = t.first_column; column <= t.last_column; ++column) {
            const double3 w = weights_at(middle(row, column, rows, columns), t.a, t.b, t.c);
            if (w.x > 1e-9 && w.y > 1e-9 && w.z > 1e-9 && owners[row * columns + column] != i)
                atomic_inc(counts);
        }
}

typedef struct {
    int3 corners;
    double3 weights;
} Within;

inline Within within(int texel, __global const int *owners, __global const int *triangles,
                     __global const float *textures, int rows, int columns)
{
    __global const int *index = triangles + 3 * (size_t)owners[texel];
    const Within at = {
        (int3)(index[0], index[1], index[2]),
        weights_at(middle(texel / columns, texel % columns, rows, columns),
                   texture_of(textures, index[0]), texture_of(textures, index[1]),
                   texture_of(textures, index[2]))};
    return at;
}

inline double3 blended(Within at, __global const float *values, int stride)
{
    return at.weights.x * triple(values, stride, at.corners.x)
           + at.weights.y * triple(values, stride, at.corners.y)
           + at.weights.z * triple(values, stride, at.corners.z);
}

// where each texel lies on the mesh, and the mesh's normal there
__kernel void place(const int count,
                    __global const int *texels,        // (count,)
                    __global const int *owners,        // (rows, columns)
                    __global const int *triangles,     // (T, 3)
                    __global const float *textures,    // (V, 2)
                    const int rows, const int columns,
                    __global const float *normals,     // (V, 3)
                    __global const float *vertices,    // (V, 3)
                    __global double *points,           // (count, 3)
                    __global double *ways)             // (count, 3) unit
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Within at = within(texels[i], owners, triangles, textures, rows, columns);
    const double3 point = blended(at, vertices, 3), normal = blended(at, normals, 3);
    const double size = length(normal);
    const double3 way = size > 0.0 ? normal / size : (double3)(0.0, 0.0, 1.0);
    vstore3(point, i, points);
    vstore3(way, i, ways);
}

// the fine mesh's normal where it was found; the mesh's own otherwise
inline double3 fine_normal(int triangle, double3 at, __global const int *triangles,
                           __global const float *vertices, __global const float *normals)
{
    __global const int *index = triangles + 3 * (size_t)triangle;
    const double3 a = triple(vertices, 3, index[0]), b = triple(vertices, 3, index[1]),
                  c = triple(vertices, 3, index[2]);
    const double3 across = cross(b - a, c - a);
    const double squared = dot(across, across);
    double3 w = (double3)(1.0, 0.0, 0.0);
    if (squared > 0.0) {
        w.y = dot(cross(at - a, c - a), across) / squared;
        w.z = dot(cross(b - a, at - a), across) / squared;
        w.x = 1.0 - w.y - w.z;
    }
    return w.x * triple(normals, 3, index[0]) + w.y * triple(normals, 3, index[1])
           + w.z * triple(normals, 3, index[2]);
}

// what each texel says
__kernel void encode(const int count,
                     __global const int *texels,             // (count,)
                     __global const int *owners,             // (rows, columns)
                     __global const int *triangles,          // (T, 3)
                     __global const float *textures,         // (V, 2)
                     const int rows, const int columns,
                     __global const float *normals,          // (V, 3)
                     __global const float *tangents,         // (V, 4)
                     __global const int *fine_triangles,     // (FT, 3)
                     __global const float *fine_vertices,    // (FV, 3)
                     __global const float *fine_normals,     // (FV, 3)
                     __global const int *found,              // (count,) -1 where nothing is
                     __global const double *positions,       // (count, 3) on the fine mesh
                     __global uchar *pixels)                 // (count, 3)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    double3 says = (double3)(0.0, 0.0, 1.0);
    if (found[i] >= 0) {
        const Within at = within(texels[i], owners, triangles, textures, rows, columns);
        const double3 n = blended(at, normals, 3), t = blended(at, tangents, 4);
        const double3 b = tangents[4 * (size_t)at.corners.x + 3] * cross(n, t);
        const double3 fine = fine_normal(found[i], vload3(i, positions), fine_triangles,
                                         fine_vertices, fine_normals);
        const double volume = dot(t, cross(b, n));
        if (volume != 0.0)
            says = (double3)(dot(fine, cross(b, n)), dot(fine, cross(n, t)),
                             dot(fine, cross(t, b))) / volume;
        says.z = fmax(says.z, 0.0);
        const double size = length(says);
        says = size > 0.0 ? says / size : (double3)(0.0, 0.0, 1.0);
    }
    vstore3(convert_uchar3_sat_rte(127.5 * says + 127.5), i, pixels);
}
