// The lattice that a node is looked at on, and how far a pattern of it is from there.
//
//     o . . . o . . . o      samples of the lattice o, `stride` apart; beyond the raster's last row or
//     . . . . . . . . .      column it goes on as it came: height_beyond
//     . . . . . . . . .
//     o . . . o . . . o
//
// At factors (fu, fv) with edges to match the tessellator cuts a node into a regular grid of cells, whose
// vertices are bilinear in the lattice and whose triangles are plane.
#ifndef LATTICE_H
#define LATTICE_H

#include "terrain/ground.h"
#include "terrain/node.h"

#define WIDTH ((TILE << FINER) + 1)

typedef struct {
    int cells_across, cells_down, stride;
    int across, down;               // lattice cells; the last may reach beyond the node
    float heights[WIDTH * WIDTH];
} Lattice;

inline void read_lattice(const Ground ground, const Tile tile, int stride, Lattice *lattice)
{
    lattice->cells_across = tile.cells_across;
    lattice->cells_down = tile.cells_down;
    lattice->stride = stride;
    lattice->across = (tile.cells_across + stride - 1) / stride;
    lattice->down = (tile.cells_down + stride - 1) / stride;
    for (int row = 0; row <= lattice->down; ++row)
        for (int column = 0; column <= lattice->across; ++column)
            lattice->heights[row * WIDTH + column] =
                height_beyond(ground, tile.row + row * stride, tile.column + column * stride);
}

// vertex i of f segments along so many cells: a lattice line, and how far on to the next
typedef struct {
    int line;
    float fraction;
} Place;

inline Place vertex_place(int i, int f, int cells, int stride)
{
    const int line = i * cells / (f * stride);
    const Place place = {line, (float)(i * cells - line * f * stride) / (f * stride)};
    return place;
}

inline float vertex_height(const Lattice *lattice, const Place across, const Place down)
{
    const float *z = lattice->heights + down.line * WIDTH + across.line;
    const int east = across.fraction > 0.0f, south = down.fraction > 0.0f ? WIDTH : 0;
    const float upper = z[0] + (z[east] - z[0]) * across.fraction;
    const float lower = z[south] + (z[south + east] - z[south]) * across.fraction;
    return upper + (lower - upper) * down.fraction;
}

// where lattice line k lies in a pattern of f segments
inline Place pattern_place(int k, int f, int cells, int stride)
{
    const int cell = min(k * stride * f / cells, f - 1);
    const Place place = {cell, (float)(k * stride * f - cell * cells) / cells};
    return place;
}

// Does the diagonal of cell (i, j) run from north-west to south-east? As the tessellator draws them:
// north-west and south-east of the middle it does; of an odd number of cells the middle column falls,
// the middle row rises.
inline bool is_falling(int i, int j, int fu, int fv)
{
    const int below = 2 * j + 1 - fv, beside = 2 * i + 1 - fu;
    return (below < 0 && beside <= 0) || (below > 0 && beside >= 0);
}

// height at (a, b) of a cell, on the triangle that holds the point
inline float on_triangle(float z00, float z10, float z01, float z11, float a, float b, bool falling)
{
    if (falling)
        return a >= b ? z00 + (z10 - z00) * a + (z11 - z10) * b
                      : z00 + (z01 - z00) * b + (z11 - z01) * a;
    return a + b <= 1.0f ? z00 + (z10 - z00) * a + (z01 - z00) * b
                         : z11 + (z01 - z11) * (1.0f - a) + (z10 - z11) * (1.0f - b);
}

// the error of one sample of the lattice
inline float sample_error(const Lattice *lattice, int fu, int fv, int row, int column)
{
    const int stride = lattice->stride;
    const Place across = pattern_place(column, fu, lattice->cells_across, stride);
    const Place down = pattern_place(row, fv, lattice->cells_down, stride);
    const Place west = vertex_place(across.line, fu, lattice->cells_across, stride);
    const Place east = vertex_place(across.line + 1, fu, lattice->cells_across, stride);
    const Place north = vertex_place(down.line, fv, lattice->cells_down, stride);
    const Place south = vertex_place(down.line + 1, fv, lattice->cells_down, stride);
    const float z = on_triangle(vertex_height(lattice, west, north), vertex_height(lattice, east, north),
                                vertex_height(lattice, west, south), vertex_height(lattice, east, south),
                                across.fraction, down.fraction,
                                is_falling(across.line, down.line, fu, fv));
    return absolute(z - lattice->heights[row * WIDTH + column]);
}

// samples first .. last of a line that a pattern of f segments is asked of: all of the node, or those
// between its outermost inner lines
inline int2 asked_samples(int f, int cells, int stride, bool inner)
{
    return inner ? (int2)((cells + f * stride - 1) / (f * stride), (cells - (cells + f - 1) / f) / stride)
                 : (int2)(0, cells / stride);
}

// The largest error of a pattern of fu x fv segments at the samples of the lattice; beyond `enough` it is
// not sought further. `worst` is where it was found, and where it is looked at first.
inline float pattern_error(const Lattice *lattice, int fu, int fv, bool inner, float enough, int2 *worst)
{
    const int stride = lattice->stride;
    const int2 columns = asked_samples(fu, lattice->cells_across, stride, inner);
    const int2 rows = asked_samples(fv, lattice->cells_down, stride, inner);
    float error = 0.0f;
    if (worst->x >= columns.x && worst->x <= columns.y && worst->y >= rows.x && worst->y <= rows.y) {
        error = sample_error(lattice, fu, fv, worst->y, worst->x);
        if (error > enough)
            return error;
    }
    float upper[TILE + 1], lower[TILE + 1], fraction[WIDTH];
    int cell[WIDTH];
    for (int column = columns.x; column <= columns.y; ++column) {
        const Place place = pattern_place(column, fu, lattice->cells_across, stride);
        cell[column] = place.line;
        fraction[column] = place.fraction;
    }
    int line = -1;
    for (int row = rows.x; row <= rows.y && error <= enough; ++row) {
        const Place place = pattern_place(row, fv, lattice->cells_down, stride);
        if (place.line != line) {
            line = place.line;
            const Place north = vertex_place(line, fv, lattice->cells_down, stride);
            const Place south = vertex_place(line + 1, fv, lattice->cells_down, stride);
            for (int i = 0; i <= fu; ++i) {
                const Place across = vertex_place(i, fu, lattice->cells_across, stride);
                upper[i] = vertex_height(lattice, across, north);
                lower[i] = vertex_height(lattice, across, south);
            }
        }
        const float *heights = lattice->heights + row * WIDTH;
        for (int column = columns.x; column <= columns.y; ++column) {
            const int i = cell[column];
            const float z = on_triangle(upper[i], upper[i + 1], lower[i], lower[i + 1], fraction[column],
                                        place.fraction, is_falling(i, line, fu, fv));
            const float difference = absolute(z - heights[column]);
            if (difference > error) {
                error = difference;
                *worst = (int2)(column, row);
            }
        }
    }
    return error;
}

// nothing is known but that it is no less than this
#define UNMEASURED -1e-30f

// An error that is remembered: itself where it was measured, or minus the least that it is known to be.
inline bool is_within(__global float *remembered, float room, const Lattice *lattice, int fu, int fv,
                      bool inner, int2 *worst)
{
    const float known = *remembered;
    if (known >= 0.0f)
        return known <= room;
    if (-known > room)
        return false;
    const float error = pattern_error(lattice, fu, fv, inner, room, worst);
    *remembered = error <= room ? error : -error;
    return error <= room;
}

#endif
