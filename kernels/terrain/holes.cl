// Ground without data is not covered: triangles that reach into it are left out.
//
// A cell has data where its four samples have. A triangle stays if no cell without data shares
// more than an outline with it. Patches without holes, most of them, are copied as they are. Points
// that no triangle uses any more are left out, too: their height would be that of no ground.
//
//     sample without data  o          x  cell without data: bilinear would need the sample
//          +---+---+---+
//          |   | x | x |
//          +---+---o---+              triangles of the cells around the x stay, whole
//          |   | x | x |
//          +---+---+---+
// Built with: what ground.h is built with, MASKED being 1.
#include "terrain/ground.h"

// corners in 1/65536 of a cell from the tile's first sample, x east, y south
typedef struct {
    int x[3], y[3];
} Triangle;

inline Triangle triangle_at(const Ruler across, const Ruler down, __global const uint2 *points,
                            __global const int *corners)
{
    Triangle triangle;
    for (int i = 0; i < 3; ++i) {
        const uint2 point = points[corners[i]];
        triangle.x[i] = cell_offset(across, point.x);
        triangle.y[i] = cell_offset(down, point.y);
    }
    return triangle;
}

// twice the signed area of (corner i, corner i + 1, point)
inline long side_of(const Triangle t, int i, int x, int y)
{
    const int j = (i + 1) % 3;
    return (long)(t.x[j] - t.x[i]) * (y - t.y[i]) - (long)(t.y[j] - t.y[i]) * (x - t.x[i]);
}

// Return true where some edge of the triangle has the whole cell on its outer side.
inline bool apart(const Triangle t, long area, int column, int row)
{
    const int west = column * FIXED_ONE, north = row * FIXED_ONE;
    const int east = west + FIXED_ONE, south = north + FIXED_ONE;
    for (int i = 0; i < 3; ++i) {
        const long sides[4] = {side_of(t, i, west, north), side_of(t, i, east, north),
                               side_of(t, i, west, south), side_of(t, i, east, south)};
        bool outside = true;
        for (int corner = 0; corner < 4; ++corner)
            outside = outside && (area > 0 ? sides[corner] <= 0 : sides[corner] >= 0);
        if (outside)
            return true;
    }
    return false;
}

inline bool is_kept(const Ground ground, const Tile tile, const Triangle t)
{
    const long area = side_of(t, 0, t.x[2], t.y[2]);
    // a triangle without an area covers nothing
    if (area == 0)
        return false;
    const int west = min(t.x[0], min(t.x[1], t.x[2])), east = max(t.x[0], max(t.x[1], t.x[2]));
    const int north = min(t.y[0], min(t.y[1], t.y[2])), south = max(t.y[0], max(t.y[1], t.y[2]));
    for (int row = north >> FIXED_BITS; row << FIXED_BITS < south; ++row)
        for (int column = west >> FIXED_BITS; column << FIXED_BITS < east; ++column) {
            if (!cell_has_data(ground, tile.row + row, tile.column + column)
                && !apart(t, area, column, row))
                return false;
        }
    return true;
}

// How many triangles of each patch stay, and how many of its points these use; a work-item a patch.
__kernel void count_kept(const Grid grid,
                         __global const float *heights,              // (R, C)
                         __global const uchar *holes,                // (R, C)
                         __global const float *detail_heights,       // where DETAIL
                         __global const float4 *details,             // (P,) .w: samples without data
                         __global const uint *point_offsets,         // (P + 1,)
                         __global const uint2 *points,               // (N,)
                         __global const uint *triangle_offsets,      // (P + 1,)
                         __global const int *triangles,              // (M, 3)
                         __global uchar *kept,                       // (M,)
                         __global uchar *used,                       // (N,)
                         __global uint *counts,                      // (P,)
                         __global uint *point_counts)                // (P,)
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid))
        return;
    const Ground ground = {grid, heights, holes, detail_heights};
    const Tile tile = tile_at(grid, patch);
    const Ruler across = ruler_of(tile.cells_across), down = ruler_of(tile.cells_down);
    const bool whole = details[patch].w == 0.0f;
    for (uint i = point_offsets[patch]; i < point_offsets[patch + 1]; ++i)
        used[i] = whole;
    uint count = 0;
    for (uint i = triangle_offsets[patch]; i < triangle_offsets[patch + 1]; ++i) {
        const bool keep = whole || is_kept(ground, tile,
            triangle_at(across, down, points, triangles + 3 * i));
        kept[i] = keep;
        count += keep;
        for (int corner = 0; corner < 3; ++corner)
            used[triangles[3 * i + corner]] |= keep;
    }
    counts[patch] = count;
    uint point_count = 0;
    for (uint i = point_offsets[patch]; i < point_offsets[patch + 1]; ++i)
        point_count += used[i];
    point_counts[patch] = point_count;
}

// Copy those that stay, in their order, and number the points anew; a work-item a patch.
__kernel void copy_kept(const int patches,
                        __global const uint *point_offsets,          // (P + 1,)
                        __global const uint2 *points,                // (N,)
                        __global const uint *triangle_offsets,       // (P + 1,)
                        __global const int *triangles,               // (M, 3)
                        __global const uchar *kept,                  // (M,)
                        __global const uchar *used,                  // (N,)
                        __global const uint *kept_offsets,           // (P + 1,)
                        __global const uint *used_offsets,           // (P + 1,)
                        __global uint *renumbered,                   // (N,)
                        __global int *kept_triangles,                // (K, 3)
                        __global uint2 *used_points)                 // (U,)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    uint place = used_offsets[patch];
    for (uint i = point_offsets[patch]; i < point_offsets[patch + 1]; ++i) {
        if (!used[i])
            continue;
        used_points[place] = points[i];
        renumbered[i] = place++;
    }
    uint target = kept_offsets[patch];
    for (uint i = triangle_offsets[patch]; i < triangle_offsets[patch + 1]; ++i) {
        if (!kept[i])
            continue;
        for (int corner = 0; corner < 3; ++corner)
            kept_triangles[3 * target + corner] = renumbered[triangles[3 * i + corner]];
        ++target;
    }
}
