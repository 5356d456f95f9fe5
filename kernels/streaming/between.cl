// How far triangles over a lattice are from the samples: at every point of the lattice, and where the
// level leaves samples out, from its surface, bilinear in each of its cells.
//
// Such a level knows how far all samples are from that surface; so an error is at most this much
// more. terrain/lattice_error.h says why it is a bound.
//
// Built with: GROUP, what ground.h is built with.
#include "terrain/lattice_error.h"

// the largest difference at points of the lattice within a triangle
inline float points_error(const Measured lattice, float4 a, float4 b, float4 c)
{
    const float x1 = b.x - a.x, y1 = b.y - a.y, rise1 = b.z - a.z;
    const float x2 = c.x - a.x, y2 = c.y - a.y, rise2 = c.z - a.z;
    const float area = x1 * y2 - x2 * y1;
    if (area == 0.0f)
        return 0.0f;
    const float inverse = 1.0f / area;
    // a point that stands on a side belongs to the triangles on both sides of it
    const float near = 1e-5f;
    const int left = (int)ceil(smaller(smaller(a.x, b.x), c.x)), right = (int)larger(larger(a.x, b.x), c.x);
    const int top = (int)ceil(smaller(smaller(a.y, b.y), c.y)), bottom = (int)larger(larger(a.y, b.y), c.y);
    float error = 0.0f;
    for (int row = top; row <= bottom; ++row)
        for (int column = left; column <= right; ++column) {
            const float x = column - a.x, y = row - a.y;
            const float weight1 = (x * y2 - x2 * y) * inverse, weight2 = (x1 * y - x * y1) * inverse;
            if (smaller(smaller(weight1, weight2), 1.0f - weight1 - weight2) < -near)
                continue;
            if (!sample_has_data(lattice.ground, row, column))
                continue;
            const float height = lattice_height(lattice, row, column);
            const float difference = (a.z - height) + weight1 * rise1 + weight2 * rise2;
            error = larger(error, absolute(difference));
        }
    // roundings of weights, as parts of what is interpolated
    return error > 0.0f ? error + 1e-6f * (error + absolute(rise1) + absolute(rise2)) : 0.0f;
}

// How far a corner is from the surface, and a quarter of the twist of the cells around it: a side that
// begins there may rise by so much. Corners of a leaf are on its own surface, those of a joined one on
// a finer one's.
inline float corner_error(const Measured lattice, float4 corner)
{
    const int row = min((int)corner.y, lattice.tile.cells_down - 1);
    const int column = min((int)corner.x, lattice.tile.cells_across - 1);
    const float down = corner.y - row, across = corner.x - column;
    const float nw = lattice_height(lattice, row, column), ne = lattice_height(lattice, row, column + 1);
    const float sw = lattice_height(lattice, row + 1, column);
    const float se = lattice_height(lattice, row + 1, column + 1);
    const float north = nw + (ne - nw) * across, south = sw + (se - sw) * across;
    float twist = 0.0f;
    for (int r = down == 0.0f ? max(row - 1, 0) : row; r <= row; ++r)
        for (int c = across == 0.0f ? max(column - 1, 0) : column; c <= column; ++c)
            twist = larger(twist, twist_of(lattice, r, c));
    const float error = absolute(corner.z - (north + (south - north) * down));
    return error + 0.25f * twist;
}

__kernel void between(const Grid grid,
                      __global const float *heights,            // (R, C) of the lattice
                      __global const uchar *holes,              // (R, C) where MASKED
                      __global const float *detail_heights,     // where DETAIL
                      const int is_full,                        // no samples are left out
                      const int count,
                      __global const float4 *points,            // (V,) column, row, height, 1 if between
                      __global const int *triangles,            // (count, 3)
                      __global float *errors)                   // (count,)
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Ground ground = {grid, heights, holes, detail_heights};
    const Tile tile = {0, 0, grid.rows - 1, grid.columns - 1};
    const Measured lattice = {ground, tile, 1};
    const float4 a = points[triangles[3 * i]], b = points[triangles[3 * i + 1]];
    const float4 c = points[triangles[3 * i + 2]];
    if ((b.x - a.x) * (c.y - a.y) == (c.x - a.x) * (b.y - a.y)) {
        errors[i] = 0.0f;   // no surface
        return;
    }
    if (is_full) {
        errors[i] = points_error(lattice, a, b, c);
        return;
    }
    const float corners = larger(larger(corner_error(lattice, a), corner_error(lattice, b)),
                                 corner_error(lattice, c));
    const float inner = lattice_triangle_error(lattice, a, b, c, max(grid.rows, grid.columns));
    errors[i] = larger(inner, corners * (1.0f + 1e-6f));
}
