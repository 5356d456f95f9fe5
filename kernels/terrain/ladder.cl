// The error ladder: how far is each tile from the ground at every pair of factors?
//
// At odd factors (fu, fv) with edges to match, the tessellator cuts a tile into a regular lattice;
// its vertices are bilinear between samples, its triangles are plane. For every pair of the ladder
//
//     error[tile, fv, fu] = max over the tile's samples |height of the triangle - sample|
//
// and the same of the samples within the tile's inner part, which edges of other factors leave as it
// is; and for every edge between tiles along its line. One pass over the raster: a tile's samples
// are read once and all pairs are measured from there.
//
//     lattice cell (i, j)      z00 --- z10     diagonals as the tessellator draws them: '\' north-west
//     of 3 x 3: \ \ /           |  \    |      and south-east of the middle, '/' elsewhere
//               / / /           |    \  |
//               / \ \          z01 --- z11
//
// LANES tiles of equal size are measured side by side, lane by lane the same arithmetic: that is
// what makes a CPU's vector unit busy. A GPU takes one tile an item and shares out the factors.
//
// Built with: TILE cells, LEVELS of the ladder, LANES (1 or 8), what ground.h is built with.
#include "terrain/ground.h"
#include "common/lanes.h"
#include "terrain/levels.h"

// each lane rounds by itself: nothing is shared with another stage to the bit
#pragma OPENCL FP_CONTRACT ON

#define WIDTH (TILE + 1)

// a / b for numbers up to 64 * 64: a division of whole numbers costs a CPU as much as ten samples. A
// quotient is never as near as a half to the next whole number from below.
inline int quotient(int a, int b)
{
    return (int)((a + 0.5f) * (1.0f / b));
}

// where the samples of a line of cells lie in a lattice of f segments
typedef struct {
    int cell[WIDTH];
    float fraction[WIDTH];
} Axis;

inline Axis lattice_axis(int f, int cells)
{
    Axis axis;
    for (int s = 0; s <= cells; ++s) {
        const int cell = min(quotient(s * f, cells), f - 1);
        axis.cell[s] = cell;
        axis.fraction[s] = (float)(s * f - cell * cells) / cells;
    }
    return axis;
}

// the first sample on or beyond the first inner line of a lattice
inline int first_inner_sample(int f, int cells)
{
    return (cells + f - 1) / f;
}

// the cells of lattice line j whose diagonal runs from north-west to south-east: first .. last
inline int2 falling_cells(int j, int fu, int fv)
{
    const int middle_u = fu / 2, middle_v = fv / 2;
    if (j < middle_v)
        return (int2)(0, middle_u);
    return j > middle_v ? (int2)(middle_u, fu) : (int2)(1, 0);
}

// a lattice's lines are bilinear in the samples: first along each row of samples ...
inline void resample_rows(const Real *heights, int fu, int cells_across, int rows, Real *columns)
{
    for (int i = 0; i <= fu; ++i) {
        const int sample = quotient(i * cells_across, fu);
        const int next = sample < cells_across ? sample + 1 : sample;
        const float fraction = (float)(i * cells_across - sample * fu) / fu;
        for (int row = 0; row < rows; ++row) {
            const Real left = heights[row * WIDTH + sample], right = heights[row * WIDTH + next];
            columns[row * WIDTH + i] = left + (right - left) * fraction;
        }
    }
}

// ... then between two of them
inline void resample_line(const Real *columns, int j, int fu, int fv, int cells_down, Real *line)
{
    const int sample = quotient(j * cells_down, fv);
    const int next = sample < cells_down ? sample + 1 : sample;
    const float fraction = (float)(j * cells_down - sample * fv) / fv;
    for (int i = 0; i <= fu; ++i) {
        const Real above = columns[sample * WIDTH + i], below = columns[next * WIDTH + i];
        line[i] = above + (below - above) * fraction;
    }
}

// height at (a, b) of a lattice cell, on the triangle that holds the point
inline Real on_triangle(Real z00, Real z10, Real z01, Real z11, float a, float b, bool falling)
{
    if (falling)
        return a >= b ? z00 + (z10 - z00) * a + (z11 - z10) * b
                      : z00 + (z01 - z00) * b + (z11 - z01) * a;
    return a + b <= 1.0f ? z00 + (z10 - z00) * a + (z01 - z00) * b
                         : z11 + (z01 - z11) * (1.0f - a) + (z10 - z11) * (1.0f - b);
}

// the largest error of samples first .. last of a row, at b between two lattice lines
inline Real row_error(const Real *heights, const Real *upper, const Real *lower, int first, int last,
                      const Axis *across, int2 falling, float b)
{
    Real error = 0.0f;
    for (int column = first; column <= last; ++column) {
        const int i = across->cell[column];
        const Real z = on_triangle(upper[i], upper[i + 1], lower[i], lower[i + 1],
                                   across->fraction[column], b, i >= falling.x && i <= falling.y);
        const Real difference = ABSOLUTE(z - heights[column]);
        error = LARGER(difference, error);
    }
    return error;
}

// all of a tile's samples, and those not between its edges and the lattice's outermost inner lines
typedef struct {
    Real all, inner;
} Errors;

inline Errors lattice_errors(const Real *heights, const Real *columns, const Axis *across,
                             int cells_across, int cells_down, int fu, int fv)
{
    const Axis down = lattice_axis(fv, cells_down);
    Real upper[WIDTH], lower[WIDTH];
    Real outer = 0.0f, inner = 0.0f;
    const int first = first_inner_sample(fu, cells_across);
    const int first_row = first_inner_sample(fv, cells_down);
    int line = -1;
    for (int row = 0; row <= cells_down; ++row) {
        const int j = down.cell[row];
        if (j != line) {
            resample_line(columns, j, fu, fv, cells_down, upper);
            resample_line(columns, j + 1, fu, fv, cells_down, lower);
            line = j;
        }
        // a row is inner from its sample `begin` to before `end`
        const bool is_inner = row >= first_row && row <= cells_down - first_row;
        const int begin = is_inner ? min(first, cells_across + 1) : cells_across + 1;
        const int end = max(cells_across - first + 1, begin);
        const int2 falling = falling_cells(j, fu, fv);
        const Real *samples = heights + row * WIDTH;
        const float b = down.fraction[row];
        const Real west = row_error(samples, upper, lower, 0, begin - 1, across, falling, b);
        const Real found = row_error(samples, upper, lower, begin, end - 1, across, falling, b);
        const Real east = row_error(samples, upper, lower, end, cells_across, across, falling, b);
        outer = LARGER(west, outer);
        outer = LARGER(east, outer);
        inner = LARGER(found, inner);
    }
    const Errors errors = {LARGER(outer, inner), inner};
    return errors;
}

__kernel void ladder(const Grid grid,
                     __global const float *heights,         // (R, C)
                     __global const uchar *holes,           // (R, C) where MASKED
                     __global const float *detail_heights,  // where DETAIL
                     __global const float4 *details,        // (P,) .w: samples without data
                     __global const int *groups,            // (G, LANES) tiles of equal size
                     const int group_count,
                     __global float *errors,                // (P, LEVELS, LEVELS): fv, fu
                     __global float *inner_errors)          // the same, of inner samples
{
    const int group = get_global_id(0);
    if (group >= group_count)
        return;
    __global const int *tiles = groups + group * LANES;
    const Ground ground = {grid, heights, holes, detail_heights};
    const Tile first = tile_at(grid, tiles[0]);
    Real samples[WIDTH * WIDTH], columns[WIDTH * WIDTH];
    for (int lane = 0; lane < LANES; ++lane) {
        const Tile tile = tile_at(grid, tiles[lane]);
        for (int row = 0; row <= tile.cells_down; ++row)
            for (int column = 0; column <= tile.cells_across; ++column)
                SET_LANE(samples[row * WIDTH + column], lane,
                         sample_height(ground, tile.row + row, tile.column + column));
    }
    for (int level_u = get_global_id(1); level_u < LEVELS; level_u += get_global_size(1)) {
        const int fu = factor_of(level_u, first.cells_across);
        const Axis across = lattice_axis(fu, first.cells_across);
        resample_rows(samples, fu, first.cells_across, first.cells_down + 1, columns);
        for (int level_v = 0; level_v < LEVELS; ++level_v) {
            const int fv = factor_of(level_v, first.cells_down);
            const Errors found = lattice_errors(samples, columns, &across, first.cells_across,
                                                first.cells_down, fu, fv);
            const bool is_full = fu == first.cells_across && fv == first.cells_down;
            for (int lane = 0; lane < LANES; ++lane) {
                // a tile with holes is always meshed in full
                const bool usable = is_full || details[tiles[lane]].w == 0.0f;
                const size_t place = ((size_t)tiles[lane] * LEVELS + level_v) * LEVELS + level_u;
                errors[place] = usable ? LANE(found.all, lane) : INFINITY;
                inner_errors[place] = usable ? LANE(found.inner, lane) : INFINITY;
            }
        }
    }
}

// The largest error of f segments along a line of samples. Places go on by a quotient and a remainder.
inline float line_error(const float *line, int cells, int f)
{
    float points[WIDTH];
    for (int point = 0, sample = 0, rest = 0; point <= f; ++point) {
        const float here = line[sample], next = line[sample < cells ? sample + 1 : sample];
        points[point] = here + (next - here) * ((float)rest / f);
        const bool whole = rest + cells % f >= f;
        sample += cells / f + whole;
        rest += cells % f - (whole ? f : 0);
    }
    float error = 0.0f;
    // the last sample is the last point
    for (int sample = 0, point = 0, rest = 0; sample < cells; ++sample) {
        const float z = points[point] + (points[point + 1] - points[point]) * ((float)rest / cells);
        const float difference = ABSOLUTE(z - line[sample]);
        error = LARGER(difference, error);
        const bool whole = rest + f >= cells;
        point += whole;
        rest += f - (whole ? cells : 0);
    }
    return error;
}

// Along a line of samples: the edges between tiles, and the terrain's border.
__kernel void edge_ladder(const Grid grid, const int vertical,
                          const int count,
                          __global const int *edges,        // (count,) to measure
                          __global const float *heights,    // (R, C)
                          __global const uchar *holes,      // (R, C) where MASKED
                          __global const float *detail_heights,     // where DETAIL
                          __global float *errors)           // (edges, LEVELS)
{
    // edges that run across: (TR + 1, TC); edges that run down: (TR, TC + 1)
    const int across = grid.tile_columns + vertical;
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const int edge = edges[i];
    const int tile_r = edge / across, tile_c = edge % across;
    const int row = tile_row(grid, tile_r), column = tile_column(grid, tile_c);
    const int cells = vertical ? tile_row(grid, tile_r + 1) - row
                               : tile_column(grid, tile_c + 1) - column;
    const Ground ground = {grid, heights, holes, detail_heights};
    float line[WIDTH];
    for (int s = 0; s <= cells; ++s)
        line[s] = vertical ? sample_height(ground, row + s, column)
                           : sample_height(ground, row, column + s);
    for (int level = 0; level < LEVELS; ++level)
        errors[edge * LEVELS + level] = line_error(line, cells, factor_of(level, cells));
}
