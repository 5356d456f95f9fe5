// Heights of a mesh as drawn and rays against it: a lattice of bins over the mesh, in 64 bits.
//
//     .----.----.----.      a bin lists the triangles whose bounding box reaches it, and knows the
//     | /\ |    |    |      range of their heights; a query looks at the bins above or below which
//     |/  \|____|    |      it passes, and no others
//     .----.----.----.
//
// Whether a ray passes a triangle is decided as in Woop, Benthin, Wald, "Watertight Ray/Triangle
// Intersection", Journal of Computer Graphics Techniques 2(1), 2013: corners are sheared so that the
// ray looks along an axis, and the signs of three areas decide. Both triangles at an edge compute
// the same products, negated: no ray passes between them. A height is the same with an upright ray.
#include "common/walk.h"

// bins that boxes are larger by, so that rounding along a ray's way does not matter
#define PAD 0x1p-20

inline double3 corner(__global const float *vertices, int index)
{
    // no vload3: PoCL calls it, and this is the innermost loop
    __global const float *vertex = vertices + 3 * (size_t)index;
    return (double3)(vertex[0], vertex[1], vertex[2]);
}

typedef struct {
    double3 a, b, c;
} Corners;

inline Corners corners_of(int triangle, __global const int *triangles,
                          __global const float *vertices)
{
    __global const int *index = triangles + 3 * (size_t)triangle;
    const Corners corners = {corner(vertices, index[0]), corner(vertices, index[1]),
                             corner(vertices, index[2])};
    return corners;
}

// first and last bin that a triangle reaches along one axis
inline int2 bins_along(double a, double b, double c, double low, double per_unit, int count)
{
    const double first = (fmin(fmin(a, b), c) - low) * per_unit - PAD;
    const double last = (fmax(fmax(a, b), c) - low) * per_unit + PAD;
    return (int2)(cell_of(first, 0, count), cell_of(last, 0, count));
}

// how many triangles each bin lists
__kernel void count_bins(const int count, const Bins bins,
                         __global const int *triangles,     // (T, 3)
                         __global const float *vertices,    // (V, 3)
                         volatile __global uint *counts)    // (bins,) 0 before
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Corners t = corners_of(i, triangles, vertices);
    const int2 across = bins_along(t.a.x, t.b.x, t.c.x, bins.low_x, bins.per_x, bins.across);
    const int2 down = bins_along(t.a.y, t.b.y, t.c.y, bins.low_y, bins.per_y, bins.down);
    for (int row = down.x; row <= down.y; ++row)
        for (int column = across.x; column <= across.y; ++column)
            atomic_inc(counts + row * bins.across + column);
}

// list them, in any order
__kernel void fill_bins(const int count, const Bins bins,
                        __global const int *triangles,
                        __global const float *vertices,
                        __global const uint *offsets,       // (bins + 1,)
                        volatile __global uint *counts,     // (bins,) 0 before
                        __global int *lists)                // (offsets[bins],) triangles
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Corners t = corners_of(i, triangles, vertices);
    const int2 across = bins_along(t.a.x, t.b.x, t.c.x, bins.low_x, bins.per_x, bins.across);
    const int2 down = bins_along(t.a.y, t.b.y, t.c.y, bins.low_y, bins.per_y, bins.down);
    for (int row = down.x; row <= down.y; ++row)
        for (int column = across.x; column <= across.y; ++column) {
            const int bin = row * bins.across + column;
            lists[offsets[bin] + atomic_inc(counts + bin)] = i;
        }
}

// lowest and highest corner of what each bin lists
__kernel void bin_ranges(const int count,
                         __global const uint *offsets,
                         __global const int *lists,
                         __global const int *triangles,
                         __global const float *vertices,
                         __global float2 *ranges)           // (bins,)
{
    const int bin = get_global_id(0);
    if (bin >= count)
        return;
    float2 range = (float2)(INFINITY, -INFINITY);
    for (uint k = offsets[bin]; k < offsets[bin + 1]; ++k)
        for (int side = 0; side < 3; ++side) {
            const float z = vertices[3 * triangles[3 * lists[k] + side] + 2];
            range = (float2)(fmin(range.x, z), fmax(range.y, z));
        }
    ranges[bin] = range;
}

// Twice the areas that a point in the origin makes with the sides across from a, b and c; 0 in all
// where it is outside, or the triangle is seen edge on.
inline double3 areas_around(double2 a, double2 b, double2 c)
{
    const double3 areas = {c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x};
    const bool negative = areas.x < 0.0 || areas.y < 0.0 || areas.z < 0.0;
    const bool positive = areas.x > 0.0 || areas.y > 0.0 || areas.z > 0.0;
    return negative && positive ? (double3)(0.0, 0.0, 0.0) : areas;
}

inline double higher(double highest, double height)
{
    return highest > height ? highest : height;
}

__kernel void mesh_heights(const int count, const Bins bins,
                           __global const uint *offsets,
                           __global const int *lists,
                           __global const int *triangles,
                           __global const float *vertices,
                           __global const double *points,   // (N, 2) relative to the mesh's origin
                           __global double *found)          // (N,) the highest; NaN: none
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const double2 point = vload2(i, points);
    double highest = NAN;
    const double x = (point.x - bins.low_x) * bins.per_x, y = (point.y - bins.low_y) * bins.per_y;
    if (x >= -PAD && x <= bins.across + PAD && y >= -PAD && y <= bins.down + PAD) {
        const int bin = cell_of(y, 0, bins.down) * bins.across + cell_of(x, 0, bins.across);
        for (uint k = offsets[bin]; k < offsets[bin + 1]; ++k) {
            const Corners t = corners_of(lists[k], triangles, vertices);
            const double3 areas = areas_around(t.a.xy - point, t.b.xy - point, t.c.xy - point);
            const double sum = areas.x + areas.y + areas.z;
            if (sum != 0.0)
                highest = higher(
                    highest, (areas.x * t.a.z + areas.y * t.b.z + areas.z * t.c.z) / sum);
        }
    }
    found[i] = highest;
}

// a vector with its axes turned until the longest of the ray's is the last
inline double3 turned(double3 vector, int axis)
{
    return axis == 0 ? vector.yzx : axis == 1 ? vector.zxy : vector;
}

inline double2 sheared(double3 corner, double3 along)
{
    return corner.xy - along.xy / along.z * corner.z;
}

// t of the hit; NaN where there is none
inline double cast_at_triangle(const Corners t, const Ray ray, int axis)
{
    const double3 along = turned(ray.direction, axis);
    const double3 a = turned(t.a - ray.origin, axis), b = turned(t.b - ray.origin, axis);
    const double3 c = turned(t.c - ray.origin, axis);
    const double3 areas = areas_around(sheared(a, along), sheared(b, along), sheared(c, along));
    const double sum = areas.x + areas.y + areas.z;
    if (sum == 0.0)
        return NAN;
    const double distance = (areas.x * a.z + areas.y * b.z + areas.z * c.z) / sum / along.z;
    return distance >= 0.0 ? distance : NAN;
}

inline int longest_axis(double3 direction)
{
    const double3 size = fabs(direction);
    return size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
}

__kernel void mesh_rays(const int count, const Bins bins,
                        __global const uint *offsets,
                        __global const int *lists,
                        __global const float2 *ranges,
                        __global const int *triangles,
                        __global const float *vertices,
                        __global const double *origins,     // (N, 3) relative to the mesh's origin
                        __global const double *directions,  // (N, 3)
                        __global double *ts,                // (N,) of directions; NaN: no hit
                        __global int *found)                // (N,) triangle, -1
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Ray ray = {vload3(i, origins), vload3(i, directions)};
    const int axis = longest_axis(ray.direction);
    const double x = (ray.origin.x - bins.low_x) * bins.per_x, dx = ray.direction.x * bins.per_x;
    const double y = (ray.origin.y - bins.low_y) * bins.per_y, dy = ray.direction.y * bins.per_y;
    double t = 0.0, end = INFINITY, best = INFINITY;
    int nearest = -1;
    clip_axis(x, dx, -PAD, bins.across + PAD, &t, &end);
    clip_axis(y, dy, -PAD, bins.down + PAD, &t, &end);
    // a ray beside the mesh is asked for nothing
    if (!(t <= end))
        best = -1.0;
    int column = cell_of(at(x, dx, t), 0, bins.across), row = cell_of(at(y, dy, t), 0, bins.down);
    while (t <= best && column >= 0 && column < bins.across && row >= 0
           && row < bins.down) {
        const double cross_x = next_line(x, dx, column, column + 1);
        const double cross_y = next_line(y, dy, row, row + 1);
        const double out = fmax(t, fmin(cross_x, cross_y));
        const double z0 = at(ray.origin.z, ray.direction.z, t);
        const double z1 = isinf(out) ? z0 + copysign((double)INFINITY, ray.direction.z)
                                     : at(ray.origin.z, ray.direction.z, out);
        const int bin = row * bins.across + column;
        const double slack = 1e-9 * (fabs(z0) + (isinf(z1) ? 0.0 : fabs(z1)));
        if (fmin(z0, z1) - slack <= ranges[bin].y && fmax(z0, z1) + slack >= ranges[bin].x)
            for (uint k = offsets[bin]; k < offsets[bin + 1]; ++k) {
                const double hit =
                    cast_at_triangle(corners_of(lists[k], triangles, vertices), ray, axis);
                // of triangles hit at once the first, whatever the order of the list
                if (hit < best || (hit == best && lists[k] < nearest)) {
                    best = hit;
                    nearest = lists[k];
                }
            }
        if (!(out < end))
            break;
        column += cross_x <= cross_y ? (dx > 0.0 ? 1 : -1) : 0;
        row += cross_x <= cross_y ? 0 : (dy > 0.0 ? 1 : -1);
        t = out;
    }
    ts[i] = nearest < 0 ? NAN : best;
    found[i] = nearest;
}
