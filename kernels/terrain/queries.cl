// Heights of the ground and rays against it: bilinear between samples, in 64 bits.
//
// Everything happens in grid coordinates: x counts columns, y rows, z is height above the base. A
// ray walks from tile to tile and, where its heights meet those of the tile, from cell to cell:
//
//     tile (minimum .. maximum)      skipped while the ray stays above or below
//     cell, a and b from 0 to 1      h = z00 + (z10 - z00) a + (z01 - z00) b + k a b
//                                    f(t) = z(t) - h(a(t), b(t)), a quadratic: its first root
//
// At a line between cells both give f the same value but for rounding. So the side of the ground
// that the ray is on is kept: where it is another at the next cell's border, the ray has passed
// through that border. A cell has a surface where all of its four samples have data; a ray along the
// line between two cells meets that of either.
//
// Built with: NEAR, cells within which a point is on a sample; what ground.h is built with.
#include "terrain/ground.h"
#include "common/walk.h"

// relative spacing of 64-bit floats
#define DOUBLE 0x1p-52

// what the surface of a cell is made of
typedef struct {
    double z, east, south, twist;       // z + east a + south b + twist a b
} Cell;

// A world coordinate in cells; what rounding far from the world's origin may have moved off a
// sample is put back on it.
inline double in_cells(double value, double origin, double step)
{
    const double cells = (value - origin) / step;
    const double near = NEAR + 4.0 * DOUBLE * (fabs(value) + fabs(origin)) / fabs(step);
    const double whole = rint(cells);
    return fabs(cells - whole) <= near ? whole : cells;
}

inline double known_height(const Ground ground, int row, int column)
{
    return sample_has_data(ground, row, column) ? sample_height(ground, row, column) : NAN;
}

inline double mix_known(double a, double b, double t)
{
    // a sample without weight need not have data
    return t == 0.0 ? a : a + (b - a) * t;
}

__kernel void ground_heights(const Grid grid, const int count,
                             const double x0, const double y0, const double base,
                             const double dx, const double dy,
                             __global const float *heights,     // (R, C)
                             __global const uchar *holes,       // (R, C) where MASKED
                             __global const float *detail_heights,  // where DETAIL
                             __global const double *points,     // (N, 2) in the world
                             __global double *found)            // (N,) NaN where there is none
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Ground ground = {grid, heights, holes, detail_heights};
    const double x = in_cells(points[2 * i], x0, dx), y = in_cells(points[2 * i + 1], y0, -dy);
    if (!(x >= 0.0 && x <= grid.columns - 1 && y >= 0.0 && y <= grid.rows - 1)) {
        found[i] = NAN;
        return;
    }
    const int column = (int)x, row = (int)y;
    const double a = x - column, b = y - row;
    const int right = column + (a > 0.0), below = row + (b > 0.0);
    const double upper = mix_known(known_height(ground, row, column),
                                   known_height(ground, row, right), a);
    const double lower = mix_known(known_height(ground, below, column),
                                   known_height(ground, below, right), a);
    found[i] = base + mix_known(upper, lower, b);
}

inline Cell cell_at(const Ground ground, int row, int column)
{
    const double z00 = known_height(ground, row, column);
    const double z10 = known_height(ground, row, column + 1);
    const double z01 = known_height(ground, row + 1, column);
    const double z11 = known_height(ground, row + 1, column + 1);
    const Cell cell = {z00, z10 - z00, z01 - z00, (z00 - z10) - (z01 - z11)};
    return cell;
}

inline double cell_height(const Cell cell, double a, double b)
{
    return cell.z + cell.east * a + cell.south * b + cell.twist * a * b;
}

inline int side_of_ground(double above)
{
    return (above > 0.0) - (above < 0.0);
}

// The first root of p + q s + r s^2 in 0 .. length; NaN where there is none.
//
// Citardauq's form of one root of the two, so that nothing cancels.
inline double first_root(double p, double q, double r, double length)
{
    const double discriminant = q * q - 4.0 * p * r;
    if (discriminant < 0.0)
        return NAN;
    const double sum = -0.5 * (q + copysign(sqrt(discriminant), q));
    double s = NAN;
    if (sum != 0.0 && p / sum >= 0.0 && p / sum <= length)
        s = p / sum;
    if (r != 0.0 && sum / r >= 0.0 && sum / r <= length && !(s <= sum / r))
        s = sum / r;
    return s;
}

// Follow the ray through a cell; return t of the hit, or NaN and the side that it leaves on.
inline double cast_in_cell(const Cell cell, const Ray ray, int row, int column, double enter,
                           double leave, int *side)
{
    if (isnan(cell.twist)) {
        *side = 0;
        return NAN;
    }
    const double a = at(ray.origin.x, ray.direction.x, enter) - column;
    const double b = at(ray.origin.y, ray.direction.y, enter) - row;
    const double above = at(ray.origin.z, ray.direction.z, enter) - cell_height(cell, a, b);
    const int entered = side_of_ground(above);
    if (entered == 0 || (*side != 0 && entered != *side))
        return enter;
    *side = entered;
    const double da = ray.direction.x, db = ray.direction.y;
    const double slope = ray.direction.z - (cell.east * da + cell.south * db)
                       - cell.twist * (a * db + b * da);
    const double s = first_root(above, slope, -cell.twist * da * db, leave - enter);
    if (!isnan(s))
        return enter + s;
    const double left = at(ray.origin.z, ray.direction.z, leave)
                      - cell_height(cell, at(ray.origin.x, da, leave) - column,
                                    at(ray.origin.y, db, leave) - row);
    return side_of_ground(left) == entered ? NAN : leave;
}

// The cell of a ray's place, or, where that has no data and the ray runs along its border, the one on
// the other side: both agree on what is between them.
inline int2 cell_with_data(const Ground ground, const Ray ray, int column, int row)
{
    const bool on_column = ray.direction.x == 0.0 && ray.origin.x == column && column > 0;
    const bool on_row = ray.direction.y == 0.0 && ray.origin.y == row && row > 0;
    for (int north = 0; north <= on_row; ++north)
        for (int west = 0; west <= on_column; ++west)
            if (cell_has_data(ground, row - north, column - west))
                return (int2)(column - west, row - north);
    return (int2)(column, row);
}

// Walk the cells of a tile; return t of the first hit or NaN, and the cell that it is in.
inline double cast_in_tile(const Ground ground, const Tile tile, const Ray ray, double enter,
                           double leave, int *side, int2 *hit_cell)
{
    int column = cell_of(at(ray.origin.x, ray.direction.x, enter), tile.column, tile.cells_across);
    int row = cell_of(at(ray.origin.y, ray.direction.y, enter), tile.row, tile.cells_down);
    double t = enter;
    while (column >= tile.column && column < tile.column + tile.cells_across
           && row >= tile.row && row < tile.row + tile.cells_down) {
        const double cross_x = next_line(ray.origin.x, ray.direction.x, column, column + 1);
        const double cross_y = next_line(ray.origin.y, ray.direction.y, row, row + 1);
        const double out = fmax(t, fmin(fmin(cross_x, cross_y), leave));
        const int2 place = cell_with_data(ground, ray, column, row);
        const double hit = cast_in_cell(cell_at(ground, place.y, place.x), ray, place.y, place.x,
                                        t, out, side);
        if (!isnan(hit)) {
            *hit_cell = place;
            return hit;
        }
        if (fmin(cross_x, cross_y) >= leave)
            break;
        column += cross_x <= cross_y ? (ray.direction.x > 0.0 ? 1 : -1) : 0;
        row += cross_x <= cross_y ? 0 : (ray.direction.y > 0.0 ? 1 : -1);
        t = out;
    }
    return NAN;
}

// the row or column of tiles that a coordinate lies in; the last ones may be smaller
inline int tile_of(double coordinate, int tile, int tiles, int last)
{
    return coordinate >= last ? tiles - 1 : clamp((int)(coordinate / tile), 0, max(tiles - 2, 0));
}

// Walk the tiles; return t of the first hit or NaN, and where it is.
inline double cast_ray(const Ground ground, const Ray ray, __global const float4 *details,
                       int *hit_tile, int2 *hit_cell)
{
    const Grid grid = ground.grid;
    double t = 0.0, end = INFINITY;
    clip_axis(ray.origin.x, ray.direction.x, 0.0, grid.columns - 1, &t, &end);
    clip_axis(ray.origin.y, ray.direction.y, 0.0, grid.rows - 1, &t, &end);
    if (!(t <= end))
        return NAN;
    int across = tile_of(at(ray.origin.x, ray.direction.x, t), grid.tile, grid.tile_columns,
                         grid.last_column);
    int down = tile_of(at(ray.origin.y, ray.direction.y, t), grid.tile, grid.tile_rows,
                       grid.last_row);
    // straight up or down within one cell: as far as the ground goes
    const bool is_upright = isinf(end);
    int side = 0;
    while (across >= 0 && across < grid.tile_columns && down >= 0 && down < grid.tile_rows) {
        const int index = down * grid.tile_columns + across;
        const Tile tile = tile_at(grid, index);
        const double minimum = details[index].y, maximum = details[index].z;
        if (is_upright) {
            const double level = ray.direction.z > 0.0 ? maximum + 1.0 : minimum - 1.0;
            end = (level - ray.origin.z) / ray.direction.z;
            if (!(end >= t))
                return NAN;
        }
        const double cross_x = next_line(ray.origin.x, ray.direction.x, tile.column,
                                         tile.column + tile.cells_across);
        const double cross_y = next_line(ray.origin.y, ray.direction.y, tile.row,
                                         tile.row + tile.cells_down);
        const double out = fmax(t, fmin(fmin(cross_x, cross_y), end));
        const double z0 = at(ray.origin.z, ray.direction.z, t);
        const double z1 = at(ray.origin.z, ray.direction.z, out);
        if (fmin(z0, z1) > maximum)
            side = 1;
        else if (fmax(z0, z1) < minimum)
            side = -1;
        else if (isnan(minimum))
            side = 0;
        else {
            const double hit = cast_in_tile(ground, tile, ray, t, out, &side, hit_cell);
            if (!isnan(hit)) {
                *hit_tile = index;
                return hit;
            }
        }
        if (fmin(cross_x, cross_y) >= end)
            break;
        across += cross_x <= cross_y ? (ray.direction.x > 0.0 ? 1 : -1) : 0;
        down += cross_x <= cross_y ? 0 : (ray.direction.y > 0.0 ? 1 : -1);
        t = out;
    }
    return NAN;
}

__kernel void ground_rays(const Grid grid, const int count,
                          const double x0, const double y0, const double base,
                          const double dx, const double dy,
                          __global const float *heights,        // (R, C)
                          __global const uchar *holes,          // (R, C) where MASKED
                          __global const float *detail_heights, // where DETAIL
                          __global const float4 *details,       // (P,)
                          __global const double *origins,       // (N, 3) in the world
                          __global const double *directions,    // (N, 3)
                          __global double *ts,                  // (N,) of directions; NaN: no hit
                          __global int *tiles,                  // (N,) -1
                          __global double *normals)             // (N, 3) NaN
{
    const int i = get_global_id(0);
    if (i >= count)
        return;
    const Ground ground = {grid, heights, holes, detail_heights};
    const double3 origin = vload3(i, origins), direction = vload3(i, directions);
    Ray ray;
    ray.origin = (double3)(in_cells(origin.x, x0, dx), in_cells(origin.y, y0, -dy),
                           origin.z - base);
    ray.direction = (double3)(direction.x / dx, -direction.y / dy, direction.z);
    int tile = -1;
    int2 place = (int2)(0, 0);
    const double t = cast_ray(ground, ray, details, &tile, &place);
    ts[i] = t;
    tiles[i] = tile;
    double3 normal = (double3)(NAN, NAN, NAN);
    if (!isnan(t)) {
        const Cell cell = cell_at(ground, place.y, place.x);
        const double a = at(ray.origin.x, ray.direction.x, t) - place.x;
        const double b = at(ray.origin.y, ray.direction.y, t) - place.y;
        normal = normalize((double3)(-(cell.east + cell.twist * b) / dx,
                                     (cell.south + cell.twist * a) / dy, 1.0));
    }
    vstore3(normal, i, normals);
}
