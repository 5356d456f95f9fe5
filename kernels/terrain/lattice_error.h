// The vertical error of a coarse leaf: a bound for its triangles against every sample of the ground.
//
// It is looked at on its lattice. B is the lattice's surface, bilinear in each of its cells, and no
// sample is farther than the drift from it; so an error is at most |triangle - B| + drift. In what a
// triangle has of a cell the difference is a + b x + c y - t x y: a saddle, so it is largest on the outline.
// Along lattice lines it is straight, along the triangle's own sides a parabola, which rises above its ends
// by |t| dx dy / 4 at most, where t is the cell's twist and dx, dy what the side has of the cell. So
//
//     error <= max over lattice points in the triangle, its corners, and crossings of its sides with
//              lattice lines, + |t| / 4 + drift
#ifndef LATTICE_ERROR_H
#define LATTICE_ERROR_H

#include "terrain/ground.h"

typedef struct {
    Ground ground;
    Tile tile;
    int stride;
} Measured;

inline float lattice_height(const Measured lattice, int row, int column)
{
    return height_beyond(lattice.ground, lattice.tile.row + row * lattice.stride,
                         lattice.tile.column + column * lattice.stride);
}

inline float twist_of(const Measured lattice, int row, int column)
{
    return absolute(lattice_height(lattice, row, column) - lattice_height(lattice, row, column + 1)
                - lattice_height(lattice, row + 1, column) + lattice_height(lattice, row + 1, column + 1));
}

// .x the largest difference at crossings of a side with lattice lines, .y the largest twist on its way
inline float2 side_error(const Measured lattice, float4 a, float4 b)
{
    float2 found = (float2)(0.0f, 0.0f);
    const float dx = b.x - a.x, dy = b.y - a.y;
    const bool slanted = dx != 0.0f && dy != 0.0f;
    if (slanted)
        found.y = larger(twist_of(lattice, (int)a.y, (int)a.x), twist_of(lattice, (int)b.y, (int)b.x));
    for (int axis = 0; axis < 2; ++axis) {
        const float from = axis ? a.y : a.x, to = axis ? b.y : b.x;
        if (from == to)
            continue;
        const int first = (int)ceil(smaller(from, to)), last = (int)floor(larger(from, to));
        for (int line = first; line <= last; ++line) {
            const float t = (line - from) / (to - from);
            const float other = axis ? a.x + dx * t : a.y + dy * t;
            const int cell = max((int)other, 0);
            const float z = a.z + (b.z - a.z) * t;
            const float one = axis ? lattice_height(lattice, line, cell) : lattice_height(lattice, cell, line);
            const float next = axis ? lattice_height(lattice, line, cell + 1)
                                    : lattice_height(lattice, cell + 1, line);
            found.x = larger(found.x, absolute(z - (one + (next - one) * (other - cell))));
            if (slanted) {
                const int row = axis ? line : cell, column = axis ? cell : line;
                found.y = larger(found.y, twist_of(lattice, row, column));
                if (line > 0)
                    found.y = larger(found.y, axis ? twist_of(lattice, row - 1, column)
                                                 : twist_of(lattice, row, column - 1));
            }
        }
    }
    return found;
}

inline float lattice_triangle_error(const Measured lattice, float4 a, float4 b, float4 c, float cells)
{
    const float x1 = b.x - a.x, y1 = b.y - a.y, rise1 = b.z - a.z;
    const float x2 = c.x - a.x, y2 = c.y - a.y, rise2 = c.z - a.z;
    const float area = x1 * y2 - x2 * y1;
    if (area == 0.0f)
        return 0.0f;
    const float inverse = 1.0f / area;
    const float rounding = 1.2e-7f * larger(absolute(x1), absolute(x2)) * larger(absolute(y1), absolute(y2)) * absolute(inverse)
                         + 2.4e-7f;
    const int left = (int)ceil(smaller(smaller(a.x, b.x), c.x)), right = (int)larger(larger(a.x, b.x), c.x);
    const int top = (int)ceil(smaller(smaller(a.y, b.y), c.y)), bottom = (int)larger(larger(a.y, b.y), c.y);
    float error = 0.0f;
    for (int row = top; row <= bottom; ++row)
        for (int column = left; column <= right; ++column) {
            const float x = column - a.x, y = row - a.y;
            const float share1 = x * y2 - x2 * y, share2 = x1 * y - x * y1;
            const float weight1 = share1 * inverse, weight2 = share2 * inverse;
            if (smaller(smaller(weight1, weight2), 1.0f - weight1 - weight2) < -rounding)
                continue;
            const float height = lattice_height(lattice, row, column);
            // a corner has its own height, to the bit; else differences come first
            const float between = (a.z - height) + weight1 * rise1 + weight2 * rise2;
            const float difference = share1 == area ? b.z - height : share2 == area ? c.z - height : between;
            error = larger(error, absolute(difference));
        }
    const float2 ab = side_error(lattice, a, b), bc = side_error(lattice, b, c);
    const float2 ca = side_error(lattice, c, a);
    error = larger(error, larger(larger(ab.x, bc.x), ca.x))
          + 0.25f * larger(larger(ab.y, bc.y), ca.y);
    if (error == 0.0f)
        return 0.0f;
    // how far rounding x and y to floats in the world may move heights
    const float rise = absolute(rise1 * y2 - rise2 * y1) + absolute(x1 * rise2 - x2 * rise1);
    const float tallest = larger(larger(absolute(rise1), absolute(rise2)), absolute(rise2 - rise1));
    const float moved = a.w + b.w + c.w > 0.0f
        ? smaller(rise * absolute(inverse) * (1.2e-7f * cells / lattice.stride), tallest) : 0.0f;
    const float slack = rounding * (error + absolute(rise1) + absolute(rise2));
    return (error + slack) * (1.0f + 1e-6f) + moved;
}

// The largest of triangles first .. end - 1; items share them.
inline float lattice_patch_error(const Ground ground, const Tile tile, int stride,
                                 __global const int *triangles, uint first, uint end,
                                 __global const float4 *corners, float cells)
{
    const Measured lattice = {ground, tile, stride};
    float error = 0.0f;
    for (uint i = first + get_local_id(0); i < end; i += GROUP) {
        const float4 a = corners[triangles[3 * i]], b = corners[triangles[3 * i + 1]];
        const float4 c = corners[triangles[3 * i + 2]];
        error = larger(error, lattice_triangle_error(lattice, a, b, c, cells));
    }
    return error;
}

#endif
