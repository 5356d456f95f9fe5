// The lattice that a node is looked at on, and how far a pattern of it is from there.
//
//     o . . . o . . . o      samples of the lattice o, `stride` apart; beyond the raster's last row or
//     . . . . . . . . .      column it goes on as it came: height_beyond
//     . . . . . . . . .
//     o . . . o . . . o
//
// At factors (fu, fv) with edges to match the tessellator cuts a node into a regular grid of cells, whose
// vertices are bilinear in the lattice and whose triangles are plane.
//
// The items of a group look at one node together and all come to the same; on a CPU a group is one item,
// which takes eight samples of a row at a time.
//
// Built with: TILE, FINER, GROUP, what ground.h is built with.
#ifndef LATTICE_H
#define LATTICE_H

#include "common/reduce.h"
#include "terrain/ground.h"
#include "terrain/node.h"

#define WIDTH ((TILE << FINER) + 1)
#define PITCH ((WIDTH + 7) / 8 * 8)         // from row to row in memory

typedef struct {
    int cells_across, cells_down, stride;
    int across, down;               // lattice cells; the last may reach beyond the node
    __local float *heights;         // WIDTH rows of PITCH
    __local float *scratch;         // GROUP + 1
} Lattice;

inline Lattice lattice_of(const Tile tile, int stride, __local float *heights, __local float *scratch)
{
    const Lattice lattice = {tile.cells_across, tile.cells_down, stride,
                             (tile.cells_across + stride - 1) / stride,
                             (tile.cells_down + stride - 1) / stride, heights, scratch};
    return lattice;
}

// Every item of the group calls this together.
inline void read_lattice(const Ground ground, const Tile tile, const Lattice *lattice)
{
    const int stride = lattice->stride, columns = lattice->across + 1;
    const bool inside = tile.row + lattice->down * stride < ground.grid.rows
                     && tile.column + lattice->across * stride < ground.grid.columns;
#if GROUP == 1
    for (int line = 0; line <= lattice->down; ++line) {
        const int row = tile.row + line * stride;
        __local float *heights = lattice->heights + line * PITCH;
        if (inside)
            for (int k = 0; k < columns; ++k)
                heights[k] = sample_height(ground, row, tile.column + k * stride);
        else
            for (int k = 0; k < columns; ++k)
                heights[k] = height_beyond(ground, row, tile.column + k * stride);
        // nobody asks for what is behind, but it is read
        for (int k = columns; k < PITCH; ++k)
            heights[k] = 0.0f;
    }
#else
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = get_local_id(0); i < columns * (lattice->down + 1); i += GROUP) {
        const int line = i / columns, k = i % columns;
        const int row = tile.row + line * stride, column = tile.column + k * stride;
        lattice->heights[line * PITCH + k] = inside ? sample_height(ground, row, column)
                                                    : height_beyond(ground, row, column);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
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
    __local const float *z = lattice->heights + down.line * PITCH + across.line;
    const int east = across.fraction > 0.0f, south = down.fraction > 0.0f ? PITCH : 0;
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
                      : z00 + (z11 - z01) * a + (z01 - z00) * b;
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
    return absolute(z - lattice->heights[row * PITCH + column]);
}

// samples first .. last of a line that a pattern of f segments is asked of: all of the node, or those
// between its outermost inner lines
typedef struct {
    int first, last;
} Asked;

inline Asked asked_samples(int f, int cells, int stride, bool inner)
{
    Asked asked = {0, cells / stride};
    if (inner) {
        asked.first = (cells + f * stride - 1) / (f * stride);
        asked.last = (cells - (cells + f - 1) / f) / stride;
    }
    return asked;
}

#if GROUP == 1
#include "terrain/lattice_rows.h"
#else
#include "terrain/lattice_group.h"
#endif

// The largest error of a pattern of fu x fv segments at the samples of the lattice; beyond `enough` it is
// not sought further. `worst` is where it was found, and where it is looked at first.
inline float pattern_error(const Lattice *lattice, int fu, int fv, bool inner, float enough, int2 *worst)
{
    const Asked columns = asked_samples(fu, lattice->cells_across, lattice->stride, inner);
    const Asked rows = asked_samples(fv, lattice->cells_down, lattice->stride, inner);
    if (worst->x >= columns.first && worst->x <= columns.last && worst->y >= rows.first
        && worst->y <= rows.last) {
        const float error = sample_error(lattice, fu, fv, worst->y, worst->x);
        if (error > enough)
            return error;
    }
    return largest_error(lattice, fu, fv, columns, rows, enough, worst);
}

// Errors are remembered in 16 bits: 0 where nothing is known, else which 1024th of an octave, from 2^-16 on,
// an error lies in, and whether it is there or there at least. Where that does not tell, it is measured again.
#define STEP_BITS 10
#define FIRST_STEP ((127 - 16) << STEP_BITS)
#define LAST_STEP 32766

inline float step_begin(int step)
{
    return step > 0 ? as_float((uint)(FIRST_STEP + step) << (23 - STEP_BITS)) : 0.0f;
}

inline float step_end(int step)
{
    return step < LAST_STEP ? as_float((uint)(FIRST_STEP + step + 1) << (23 - STEP_BITS)) : INFINITY;
}

inline ushort remembered_error(float error, bool is_all)
{
    const int step = clamp((int)(as_uint(error) >> (23 - STEP_BITS)) - FIRST_STEP, 0, LAST_STEP);
    return 2 * (step + 1) + is_all;
}

// Is the error of a pattern within `room`? The lattice is read when it is first wanted.
inline bool is_within(const Ground ground, const Tile tile, const Lattice *lattice, bool *is_read,
                      __global ushort *remembered, float room, int fu, int fv, bool inner, int2 *worst)
{
    const int known = *remembered, step = known / 2 - 1;
    if (known > 0) {
        if (step_begin(step) > room)
            return false;
        if (known % 2 == 1 && step_end(step) <= room)
            return true;
    }
#if GROUP > 1
    // all have read what one of them writes now
    barrier(CLK_GLOBAL_MEM_FENCE);
#endif
    if (!*is_read)
        read_lattice(ground, tile, lattice);
    *is_read = true;
    const float error = pattern_error(lattice, fu, fv, inner, room, worst);
    if (get_local_id(0) == 0)
        *remembered = remembered_error(error, error <= room);
    return error <= room;
}

#endif
