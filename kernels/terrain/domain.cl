// The domain stage: where a point of a patch stands in the world, and the ground's normal there.
//
// A position is a pure function of the point's global coordinate, counted in 1/65536 of a cell over
// the whole raster, never of anything local to a patch. So two patches that share a point give it
// the same bits:
//
//     global column = first column of the tile * 65536 + u in cells of the tile    (coordinate.h)
//
//       tile A, u = 65536         |  split into the cell and a fraction 0 .. 65535:
//       tile B, u = 0             |  both read (cell 15, fraction 0)
//
// LANES points of a patch are displaced side by side.
//
// Built with: PATCHES, a header that says what patches are; GROUP work-items a patch, LANES (1 or 8), what
// it and ground.h are built with.
#include "terrain/gradient.h"
#include "common/lanes.h"
#include PATCHES

// the same coordinate of LANES points
typedef struct {
    Whole cell, fraction;
} Coordinates;

inline Coordinates global_coordinates(int first, Whole offset)
{
    const Coordinates coordinates = {first + (offset >> FIXED_BITS), offset & (FIXED_ONE - 1)};
    return coordinates;
}

inline Real parts_of(Whole fraction)
{
    return REAL_OF(fraction) * (1.0f / FIXED_ONE);
}

inline Real cells_along(Coordinates along)
{
    return REAL_OF(along.cell) + parts_of(along.fraction);
}

// where LANES points lie, in 1/65536 of a cell from the tile's first sample
typedef struct {
    Whole across, down;
} Places;

// those of `count` points; behind the last of them, it once more
inline Places places_of(const Placing placing, __global const uint2 *points, int count)
{
    uint2 own[LANES];
    int across[LANES], down[LANES];
    if (count == LANES)  // no index to find: one load
        for (int lane = 0; lane < LANES; ++lane)
            own[lane] = points[lane];
    else
        for (int lane = 0; lane < LANES; ++lane)
            own[lane] = points[min(lane, count - 1)];
    for (int lane = 0; lane < LANES; ++lane) {
        const int2 place = place_of(placing, own[lane]);
        across[lane] = place.x;
        down[lane] = place.y;
    }
    const Places places = {*(const Whole *)across, *(const Whole *)down};
    return places;
}

// where LANES points stand, and how the ground rises there: see gradient.h
typedef struct {
    Real height, east, north;
} Stand;

// bilinear between the four samples around; on a line of samples, those beyond it count for nothing
inline Real height_within(const Around *samples, Real x, Real y)
{
    const Real nw = samples->at[5], ne = samples->at[6], sw = samples->at[9], se = samples->at[10];
    const Real upper = x > 0.0f ? nw + (ne - nw) * x : nw;
    const Real lower = x > 0.0f ? sw + (se - sw) * x : sw;
    return y > 0.0f ? upper + (lower - upper) * y : upper;
}

inline Stand stand_within(const Ground ground, Coordinates column, Coordinates row)
{
    const Cells cells = {row.cell, column.cell};
    const Around samples = samples_around(ground, cells);
    const Real x = parts_of(column.fraction), y = parts_of(row.fraction);
    const Stand stand = {height_within(&samples, x, y), rise_east(&samples, x, y),
                         rise_north(&samples, x, y)};
    return stand;
}

// the rises at the four samples around, bilinear as well; on a sample there is just one
inline float2 rise_between(const Ground ground, Coordinate column, Coordinate row)
{
    float2 rise = sample_rise(ground, row.cell, column.cell);
    if (column.fraction > 0) {
        const float2 right = sample_rise(ground, row.cell, column.cell + 1);
        rise.x = blend(rise.x, right.x, column.fraction);
        rise.y = blend(rise.y, right.y, column.fraction);
    }
    if (row.fraction > 0) {
        float2 below = sample_rise(ground, row.cell + 1, column.cell);
        if (column.fraction > 0) {
            const float2 right = sample_rise(ground, row.cell + 1, column.cell + 1);
            below.x = blend(below.x, right.x, column.fraction);
            below.y = blend(below.y, right.y, column.fraction);
        }
        rise.x = blend(rise.x, below.x, row.fraction);
        rise.y = blend(rise.y, below.y, row.fraction);
    }
    return rise;
}

// at the raster's border and beside holes, one by one
inline Stand stand_anywhere(const Ground ground, Coordinates columns, Coordinates rows)
{
    Stand stand;
    for (int lane = 0; lane < LANES; ++lane) {
        const Coordinate column = {WHOLE_LANE(columns.cell, lane), WHOLE_LANE(columns.fraction, lane)};
        const Coordinate row = {WHOLE_LANE(rows.cell, lane), WHOLE_LANE(rows.fraction, lane)};
        const Cells cell = {row.cell, column.cell};
        if (LANES > 1 && are_inner(ground, cell)) {
            const Coordinates c = {column.cell, column.fraction}, r = {row.cell, row.fraction};
            const Stand alone = stand_within(ground, c, r);
            SET_LANE(stand.height, lane, LANE(alone.height, 0));
            SET_LANE(stand.east, lane, LANE(alone.east, 0));
            SET_LANE(stand.north, lane, LANE(alone.north, 0));
            continue;
        }
        const float2 rise = rise_between(ground, column, row);
        SET_LANE(stand.height, lane, height_between(ground, column, row));
        SET_LANE(stand.east, lane, rise.x);
        SET_LANE(stand.north, lane, rise.y);
    }
    return stand;
}

__kernel void domain(const Grid grid,
                     __global const float *heights,         // (R, C)
                     __global const uchar *holes,           // (R, C) where MASKED
                     __global const float *detail_heights,  // where DETAIL
                     PATCH_ARGUMENTS
                     const int patches,
                     __global const uint *point_offsets,    // (P + 1,)
                     __global const uint2 *points,          // (N,) u, v in 16.16
                     __global float *positions,             // (N, 3)
                     __global float *normals)               // (N, 3)
{
    const Ground ground = {grid, heights, holes, detail_heights};
    const PatchSet set = PATCH_SET;
    const int run = (patches + get_num_groups(0) - 1) / get_num_groups(0);
    const int begin = get_group_id(0) * run;
    for (int patch = begin; patch < min(begin + run, patches); ++patch) {
        const Placing placing = placing_of(grid, set, patch);
        const uint end = point_offsets[patch + 1];
        for (uint first = point_offsets[patch] + LANES * get_local_id(0); first < end;
             first += LANES * GROUP) {
            const int count = min((uint)LANES, end - first);
            const Places places = places_of(placing, points + first, count);
            const Coordinates column = global_coordinates(placing.tile.column, places.across);
            const Coordinates row = global_coordinates(placing.tile.row, places.down);
            const Cells cells = {row.cell, column.cell};
            const Stand stand = are_inner(ground, cells) ? stand_within(ground, column, row)
                                                         : stand_anywhere(ground, column, row);
            const Normals normal = normals_of(grid, stand.east, stand.north);
            const Real x = cells_along(column) * grid.dx, y = -cells_along(row) * grid.dy;
            for (int lane = 0; lane < count; ++lane) {
                const uint i = first + lane;
                positions[3 * i + 0] = LANE(x, lane);
                positions[3 * i + 1] = LANE(y, lane);
                positions[3 * i + 2] = lifted(set, i, LANE(stand.height, lane));
                normals[3 * i + 0] = LANE(normal.x, lane);
                normals[3 * i + 1] = LANE(normal.y, lane);
                normals[3 * i + 2] = LANE(normal.z, lane);
            }
        }
    }
}
