// How far is a mesh from the ground? Its vertical error at every sample that a triangle covers.
//
// Everything happens in grid coordinates, in 64 bits: x counts columns and y rows, so that samples
// stand at whole numbers; z is the height above the ground's base. A triangle is cut by every row
// of samples that it reaches, and the samples it covers are the whole numbers on the cut:
//
//              a
//             / \               left    where edge a-b crosses the row
//   row -----o-*-*-o-----       right   where edge a-c crosses it
//           /       \           z       runs straight from left to right
//          b---------c
//
// A crossing is computed from its edge alone, upper end first: both triangles at an edge find the
// same bits, so no sample falls between them. Nothing is divided by an area and nothing is
// extrapolated: on a sliver the height stays between those of its edges.
//
// Of several triangles over a sample the one farthest from the ground counts. Errors meet in
// atomic_max as keys, which makes the result independent of the order:
//
//   key = bits(|error|) << 1 | (error >= 0)       0 where nothing covers the sample
//
// A triangle that reaches more than BAND samples is left to measure_bands, so that one work-item
// never walks over the whole raster.
//
// Built with: NEAR, cells within which a point is on a sample; SINGLE, the relative spacing of
// float32; BAND. Both fractions are powers of two, exact in any width.
#include "layout.h"

#ifndef cl_khr_fp64
#error "vertical_error.cl: needs a device with 64-bit floats"
#endif
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

// samples that a triangle may cover; empty where bottom < top
typedef struct {
    int top, bottom, left, right;
} Box;

// where a row cuts a triangle
typedef struct {
    double left, left_z, right, right_z;
} Cut;

// exact at both ends
inline double between(double start, double end, double t)
{
    return t == 1.0 ? end : start + t * (end - start);
}

inline double onto_sample(double value, double near)
{
    const double whole = rint(value);
    return fabs(value - whole) <= near ? whole : value;
}

// a vertex in grid coordinates, on the sample's line where float32 cannot tell it from there
__kernel void place(const uint count,
                    const double shift_x, const double shift_y, const double shift_z,
                    const double dx, const double dy,
                    __global const float *vertices,     // (V, 3) relative to the mesh's origin
                    __global double *placed)            // (V, 3) column, row, height
{
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const double3 vertex = convert_double3(vload3(i, vertices));
    const double near_x = fmax(fabs(vertex.x) * SINGLE / dx, (double)NEAR);
    const double near_y = fmax(fabs(vertex.y) * SINGLE / dy, (double)NEAR);
    vstore3((double3)(onto_sample((vertex.x + shift_x) / dx, near_x),
                      onto_sample(-(vertex.y + shift_y) / dy, near_y),
                      vertex.z + shift_z), i, placed);
}

inline void load_corners(uint triangle, __global const int *triangles,
                         __global const double *placed, double3 *corners)
{
    const int3 indices = vload3(triangle, triangles);
    corners[0] = vload3(indices.x, placed);
    corners[1] = vload3(indices.y, placed);
    corners[2] = vload3(indices.z, placed);
}

inline double smallest(double a, double b, double c)
{
    return fmin(fmin(a, b), c);
}

inline double largest(double a, double b, double c)
{
    return fmax(fmax(a, b), c);
}

// the samples in a triangle's bounding box; none where it is too thin to cover any
inline Box box_of(const double3 *corners, int rows, int columns)
{
    const double3 a = corners[0], b = corners[1], c = corners[2];
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const double low_x = smallest(a.x, b.x, c.x), high_x = largest(a.x, b.x, c.x);
    const double low_y = smallest(a.y, b.y, c.y), high_y = largest(a.y, b.y, c.y);
    Box box = {0, -1, 0, -1};
    if (fabs(area) > NEAR * fmax(high_x - low_x, high_y - low_y)) {
        // clipped before the conversion: an int holds any sample, not any double
        box.top = (int)clamp(ceil(low_y), 0.0, (double)rows);
        box.bottom = (int)clamp(floor(high_y), -1.0, rows - 1.0);
        box.left = (int)clamp(ceil(low_x - NEAR), 0.0, (double)columns);
        box.right = (int)clamp(floor(high_x + NEAR), -1.0, columns - 1.0);
        if (box.right < box.left)
            box.bottom = box.top - 1;
    }
    return box;
}

inline int rows_in_band(Box box)
{
    return max(1, BAND / (box.right - box.left + 1));
}

inline int bands_of(Box box)
{
    if (box.bottom < box.top)
        return 0;
    return (box.bottom - box.top) / rows_in_band(box) + 1;
}

// extend the cut to where edge a-b crosses the row
inline void cut_edge(double3 a, double3 b, double row, Cut *cut)
{
    // an edge along the row adds nothing: its ends are ends of the other two
    if (a.y == b.y)
        return;
    if (a.y > b.y) {
        const double3 upper = b;
        b = a;
        a = upper;
    }
    if (row < a.y || row > b.y)
        return;
    const double t = (row - a.y) / (b.y - a.y);
    const double x = onto_sample(between(a.x, b.x, t), NEAR);
    const double z = between(a.z, b.z, t);
    if (x < cut->left) {
        cut->left = x;
        cut->left_z = z;
    }
    if (x > cut->right) {
        cut->right = x;
        cut->right_z = z;
    }
}

inline uint key_of(float error)
{
    return as_uint(fabs(error)) << 1 | (error >= 0.0f);
}

inline void measure_row(const double3 *corners, int row, Box box, int columns,
                        __global const float *heights, volatile __global uint *keys)
{
    Cut cut = {INFINITY, 0.0, -INFINITY, 0.0};
    cut_edge(corners[0], corners[1], row, &cut);
    cut_edge(corners[1], corners[2], row, &cut);
    cut_edge(corners[2], corners[0], row, &cut);
    const int first = max(box.left, (int)ceil(fmax(cut.left, (double)box.left)));
    const int last = min(box.right, (int)floor(fmin(cut.right, (double)box.right)));
    const double width = cut.right - cut.left;
    const size_t start = (size_t)row * columns;
    for (int column = first; column <= last; ++column) {
        const float height = heights[start + column];
        if (isnan(height))
            continue;
        const double t = width > 0.0 ? (column - cut.left) / width : 0.0;
        const uint key = key_of((float)(between(cut.left_z, cut.right_z, t) - height));
        // the plain read saves most of the atomic operations; a stale one costs one more
        if (key > keys[start + column])
            atomic_max(keys + start + column, key);
    }
}

// small triangles at once; counts the bands of the others
__kernel void measure(const uint count, const int rows, const int columns,
                      __global const int *triangles,    // (T, 3)
                      __global const double *placed,    // (V, 3)
                      __global const float *heights,    // (R, C), NaN where there is no data
                      volatile __global uint *keys,     // (R, C), 0 before
                      volatile __global uint *band_count)
{
    const uint i = get_global_id(0);
    if (i >= count)
        return;
    double3 corners[3];
    load_corners(i, triangles, placed, corners);
    const Box box = box_of(corners, rows, columns);
    const int bands = bands_of(box);
    if (bands > 1) {
        atomic_add(band_count, (uint)bands);
        return;
    }
    for (int row = box.top; row <= box.bottom; ++row)
        measure_row(corners, row, box, columns, heights, keys);
}

// lists the bands that measure counted, in any order
__kernel void list_bands(const uint count, const int rows, const int columns,
                         __global const int *triangles,
                         __global const double *placed,
                         __global int *bands,           // (bands, 2) triangle, first row
                         volatile __global uint *band_count)    // 0 before
{
    const uint i = get_global_id(0);
    if (i >= count)
        return;
    double3 corners[3];
    load_corners(i, triangles, placed, corners);
    const Box box = box_of(corners, rows, columns);
    const int own = bands_of(box);
    if (own < 2)
        return;
    const uint start = atomic_add(band_count, (uint)own);
    for (int band = 0; band < own; ++band)
        vstore2((int2)((int)i, box.top + band * rows_in_band(box)), start + band, bands);
}

__kernel void measure_bands(const uint count, const int rows, const int columns,
                            __global const int *triangles,
                            __global const double *placed,
                            __global const float *heights,
                            __global const int *bands,
                            volatile __global uint *keys)
{
    const uint i = get_global_id(0);
    if (i >= count)
        return;
    const int2 band = vload2(i, bands);
    double3 corners[3];
    load_corners(band.x, triangles, placed, corners);
    const Box box = box_of(corners, rows, columns);
    const int end = min(box.bottom + 1, band.y + rows_in_band(box));
    for (int row = band.y; row < end; ++row)
        measure_row(corners, row, box, columns, heights, keys);
}

// keys back to errors: mesh minus ground, NaN where nothing covers the sample
__kernel void read_keys(const uint count,
                        __global const uint *keys,      // (R, C)
                        __global float *errors)         // (R, C)
{
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const uint key = keys[i];
    const float size = as_float(key >> 1);
    errors[i] = key == 0 ? NAN : (key & 1 ? size : -size);
}
