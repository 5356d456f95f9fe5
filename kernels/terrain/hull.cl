// The hull stage: tessellation factors of every patch from its 12 control points.
//
// The patch-constant function of interlocking tiles ("Practical Rendering and Computation with
// Direct3D 11", section 9.1.1, after Snook 2001): midpoints of the own tile and of its four
// neighbours, a level of detail for each, the own for the inside, a rule of two for each edge.
//
//             10 --- 11                 u east, v south; at the border of the terrain
//              |     |                  far corners are clamped onto near ones, and the
//        8 --- 0 --- 1 --- 4            neighbour's midpoint is the midpoint of the edge
//        |     |     |     |
//        9 --- 2 --- 3 --- 5            edges: u = 0 west, v = 0 north, u = 1 east, v = 1 south
//              |     |
//              6 --- 7
//
// Both sides of an edge must find the same bits: corners are summed row by row from the north-west
// whichever tile asks, and the level of detail is a function of the tile alone.
//
// Built with: LOD, a header that defines patch_lod(); EDGE_RULE, fmin or fmax.
#include "terrain/neighbour.h"
#include "terrain/patch.h"
#include LOD

// control points of the own tile and its neighbours: north-west, north-east, south-west, south-east
__constant int CORNERS[5][4] = {
    {0, 1, 2, 3}, {8, 0, 9, 2}, {10, 11, 0, 1}, {1, 4, 3, 5}, {2, 3, 6, 7}};

inline float3 midpoint(__global const float4 *control_points, __global const int *indices,
                       int side)
{
    const float4 corner[4] = {
        control_points[indices[CORNERS[side][0]]], control_points[indices[CORNERS[side][1]]],
        control_points[indices[CORNERS[side][2]]], control_points[indices[CORNERS[side][3]]]};
    // quarters first, which are exact: a sum may overflow
    const float4 mean = ((0.25f * corner[0] + 0.25f * corner[1]) + 0.25f * corner[2])
                      + 0.25f * corner[3];
    return mean.xyz;
}

inline Patch look_at(Grid grid, int patch, int side,
                     __global const float4 *control_points, __global const int *indices,
                     __global const float4 *planes, __global const float4 *details)
{
    const int tile = neighbour(grid, patch, side);
    Patch seen;
    seen.midpoint = midpoint(control_points, indices, side);
    seen.normal = planes[tile].xyz;
    seen.deviation = details[tile].x;
    seen.minimum = details[tile].y;
    seen.maximum = details[tile].z;
    seen.box = tile_box(grid, tile_at(grid, tile), seen.minimum, seen.maximum);
    seen.holes = details[tile].w;
    return seen;
}

// one segment a cell is all that the raster can show; where a tile has holes it is what keeps
// triangles off them
inline float limited(float lod, bool has_holes, int cells)
{
    return has_holes ? cells : fmax(fmin(lod, (float)cells), 1.0f);
}

// A single cell beside several takes up to three segments inside: of one, the tessellator makes
// three as well, two of them without a width, and a step that belongs between edge and inside
// becomes an upright wall.
inline float inside_factor(float lod, bool has_holes, int cells, int cells_beside)
{
    return limited(lod, has_holes, cells == 1 && cells_beside > 1 ? 3 : cells);
}

inline float edge_factor(const Patch own, float own_lod, const Patch other, float other_lod,
                         int cells)
{
    const float lod = isnan(other_lod) ? own_lod : EDGE_RULE(own_lod, other_lod);
    return limited(lod, own.holes > 0.0f || other.holes > 0.0f, cells);
}

__kernel void hull(const Grid grid, const View view, const int cull,
                   __global const float *parameters,        // of the level of detail
                   __global const float4 *control_points,   // (TR + 1, TC + 1)
                   __global const int *patch_indices,       // (P, 12)
                   __global const float4 *planes,           // (P,)
                   __global const float4 *details,          // (P,)
                   __global const float *weights,           // (P,) on the level of detail
                   __global float *edge_factors,            // (P, 4)
                   __global float *inside_factors)          // (P, 2)
{
    const int patch = get_global_id(0);
    if (patch >= tile_count(grid))
        return;
    __global const int *indices = patch_indices + patch * CONTROL_POINTS;
    const Tile tile = tile_at(grid, patch);

    Patch seen[5];
    float lod[5];
    for (int side = OWN; side <= SOUTH; ++side) {
        seen[side] = look_at(grid, patch, side, control_points, indices, planes, details);
        const float weight = weights[neighbour(grid, patch, side)];
        // a formula that has no answer gets a segment: a tile is left out for want of data alone
        lod[side] = isnan(seen[side].minimum)
                        ? NAN
                        : weight * fmax(patch_lod(seen[side], view, parameters), 1.0f);
    }

    const bool empty = isnan(lod[OWN]);
    const bool culled = empty || (cull && is_out_of_view(grid, tile, view, seen[OWN].minimum,
                                                         seen[OWN].maximum));
    const bool holes = seen[OWN].holes > 0.0f;
    for (int edge = 0; edge < EDGES; ++edge) {
        const float factor = edge_factor(seen[OWN], lod[OWN], seen[edge + 1], lod[edge + 1],
                                         edge_cells(tile, edge));
        edge_factors[patch * EDGES + edge] = culled ? 0.0f : factor;
    }
    inside_factors[patch * INSIDES + 0] =
        culled ? 0.0f : inside_factor(lod[OWN], holes, tile.cells_across, tile.cells_down);
    inside_factors[patch * INSIDES + 1] =
        culled ? 0.0f : inside_factor(lod[OWN], holes, tile.cells_down, tile.cells_across);
}
