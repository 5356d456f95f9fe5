// The sides of leaves: watertight between leaves of any size.
//
// Where a leaf borders finer ones, its side is theirs one after the other: pieces, each a whole side of
// the finer leaf, with the factor that the finer leaf has found for it.
//
//     +-----------+-----+      side u = 1 of the coarse leaf: two pieces of 3 and 2 segments, so an edge
//     |           *  3  |      factor of 5; its outer points are moved, by their index, to those of the
//     |           *     |      pieces. Corners never move.
//     |           +-----+
//     |           *  2  |      A piece's factor keeps along its line what the stricter of both sides
//     +-----------+-----+      is allowed.
//
//   side_factors   of sides that are a piece of their own
//   side_counts    points of every side
//   side_places    where they lie, in 1/65536 of a cell from the leaf's north-western corner
//
// Built with: TILE, FINER, what ground.h is built with.
#include "terrain/ground.h"
#include "terrain/neighbour.h"
#include "terrain/node.h"

#define LINE ((TILE << FINER) + 2)
#define MOST_SEGMENTS 64
#define OF_OTHER -1     // a side's factor: that of the leaf beside it

inline Node node_across(const Node node, int side)
{
    const Node found = {node.level, node.row + ROW_STEP[side + 1], node.column + COLUMN_STEP[side + 1]};
    return found;
}

// a side's first sample, walked east or south
inline int2 side_start(const Tile tile, int side)
{
    return (int2)(side == 2 ? tile.column + tile.cells_across : tile.column,
                  side == 3 ? tile.row + tile.cells_down : tile.row);
}

// The heights of a line's samples, `stride` apart; the last is the line's end.
typedef struct {
    int cells, stride, lines;
    float heights[LINE];
} SideLine;

// height of vertex i of f segments
inline float line_vertex(const SideLine *line, int i, int f)
{
    const int vertex = i * line->cells, west = vertex / (f * line->stride);
    const int east = min(west + 1, line->lines);
    const int width = min(east * line->stride, line->cells) - west * line->stride;
    const float t = east == west ? 0.0f : (float)(vertex - west * f * line->stride) / (f * width);
    return line->heights[west] + (line->heights[east] - line->heights[west]) * t;
}

// `on` of f segments, times the cells, lie between vertex i and sample k
inline float line_error(const SideLine *line, int k, float start, float end, int on)
{
    return absolute(start + (end - start) * ((float)on / line->cells) - line->heights[k]);
}

// Do f segments stay within `room` of all samples? `worst` is one that they may not.
inline bool line_holds(const SideLine *line, int f, float room, int *worst)
{
    const int step = line->stride * f, segment = *worst * step / line->cells;
    if (line_error(line, *worst, line_vertex(line, segment, f), line_vertex(line, segment + 1, f),
                   *worst * step - segment * line->cells) > room)
        return false;
    float start = 0.0f, end = line->heights[0];
    for (int k = 1, i = 0, on = 0; k < line->lines; ++k) {
        on += step;
        const int before = i;
        for (; i == 0 || on >= line->cells; ++i)
            on -= i > 0 ? line->cells : 0;
        if (i > before) {
            start = i == before + 1 ? end : line_vertex(line, i - 1, f);
            end = line_vertex(line, i, f);
        }
        if (line_error(line, k, start, end, on) > room) {
            *worst = k;
            return false;
        }
    }
    return true;
}

// The fewest segments along a side that stay within `room` of the lattice's samples on it. What both sides
// of it ask for is the same, to the bit.
inline int side_segments(const Ground ground, const Tile tile, int stride, int side, float room)
{
    const bool down = side % 2 == 0;
    const int cells = edge_cells(tile, side), most = min(TILE, cells);
    const int2 start = side_start(tile, side);
    SideLine line;
    line.cells = cells;
    line.stride = stride;
    line.lines = (cells + stride - 1) / stride;
    for (int k = 0; k <= line.lines; ++k) {
        const int along = min(k * stride, cells);
        line.heights[k] = down ? sample_height(ground, start.y + along, start.x)
                               : sample_height(ground, start.y, start.x + along);
    }
    int worst = line.lines / 2;
    int f = 1;
    while (f < most && !line_holds(&line, f, room, &worst))
        ++f;
    return f;
}

// what the errors of a leaf's pattern may use, beside its lattice's own
inline float room_of(float allowed, float share, float drift)
{
    return share > 0.0f ? allowed * share - drift : 0.0f;
}

// A side that is a piece of its own: is all that is across of its own size, or larger?
inline bool is_piece(const Tree tree, __global const uint *marks, uint stamp, const Node node, int side)
{
    const Node across = node_across(node, side);
    return !is_in_tree(tree, across) || mark_of(marks, stamp, node_index(tree, across)) != SPLIT;
}

#define LEAF_ARGUMENTS                                                                             \
    const Grid grid, __global const float *heights, __global const uchar *holes,                   \
    __global const float *detail_heights, const Tree tree,                                         \
    __global const float4 *details,             /* (N,) */                                         \
    const uint stamp, __global const uint *marks, __global const float *allowed,    /* (N,) */     \
    const int count, __global const int *leaves, __global const float *shares,      /* (P,) */     \
    __global const int *leaf_of                 /* (N,) */

// Sides that are a piece of both leaves beside them are found by the western and the northern one.
__kernel void side_factors(LEAF_ARGUMENTS, __global int *factors,       // (P, 4) 0 where not a piece
                           __global float *rooms)                       // (P, 4) that they were found for
{
    const int i = get_global_id(0);
    if (i >= count * EDGES)
        return;
    const int leaf = i / EDGES, side = i % EDGES, index = leaves[leaf];
    const Ground ground = {grid, heights, holes, detail_heights};
    const Node node = node_at(tree, index);
    if (mark_of(marks, stamp, index) != LEAF)
        return;
    if (!is_piece(tree, marks, stamp, node, side)) {
        factors[i] = 0;
        return;
    }
    float room = room_of(allowed[index], shares[leaf], details[index].x);
    bool holed = details[index].w > 0.0f;
    const Node across = node_across(node, side);
    if (is_in_tree(tree, across)) {
        const int beside = node_index(tree, across);
        if (side < 2 && mark_of(marks, stamp, beside) == LEAF) {
            factors[i] = OF_OTHER;
            return;
        }
        const int cover = node_index(tree, cover_of(tree, marks, stamp, across));
        // tiles with holes are meshed in full, their sides too
        holed |= node.level == 0 && details[beside].w > 0.0f;
        if (mark_of(marks, stamp, cover) == LEAF)
            room = smaller(room, room_of(allowed[cover], shares[leaf_of[cover]], details[cover].x));
    }
    // what was found in another round
    if (factors[i] > 0 && rooms[i] == room)
        return;
    const Tile tile = node_tile(grid, node);
    rooms[i] = room;
    factors[i] = holed || !(room > 0.0f) ? min(TILE, edge_cells(tile, side))
                                         : side_segments(ground, tile, stride_of(node.level), side, room);
}

inline int own_factor(const Tree tree, __global const int *leaf_of, __global const int *factors, int leaf,
                      const Node node, int side)
{
    const int own = factors[leaf * EDGES + side];
    return own != OF_OTHER ? own
         : factors[leaf_of[node_index(tree, node_across(node, side))] * EDGES + (side + 2) % EDGES];
}

// a walk along the pieces of a side
typedef struct {
    Node tile;              // the next tile across
    int left;               // tiles yet to come
} Walk;

inline Walk walk_along(const Grid grid, const Node node, int side)
{
    const int k = node.level;
    const bool down = side % 2 == 0;
    const int row = node.row << k, column = node.column << k;
    const int rows = min(1 << k, grid.tile_rows - row), columns = min(1 << k, grid.tile_columns - column);
    const Walk walk = {{0, side == 1 ? row - 1 : side == 3 ? row + rows : row,
                        side == 0 ? column - 1 : side == 2 ? column + columns : column},
                       down ? rows : columns};
    return walk;
}

// the piece that a walk has come to, whose segments lie from `begin` on
typedef struct {
    int segments, begin, cells;
    int level;
} Piece;

__attribute__((always_inline)) inline Piece next_piece(const Ground ground, const Tree tree, __global const float4 *details,
                        __global const uint *marks, uint stamp, __global const int *leaf_of,
                        __global const int *factors, const Tile leaf_tile, int side, float room,
                        Walk *walk)
{
    const Node cover = cover_of(tree, marks, stamp, walk->tile);
    const int index = node_index(tree, cover), opposite = (side + 2) % EDGES;
    const Tile tile = node_tile(ground.grid, cover);
    const bool down = side % 2 == 0;
    const int2 start = side_start(leaf_tile, side), begin = side_start(tile, opposite);
    Piece piece;
    // what is across and not drawn has no say
    piece.segments = mark_of(marks, stamp, index) == LEAF
        ? factors[leaf_of[index] * EDGES + opposite]
        : !(room > 0.0f) ? min(TILE, edge_cells(tile, side))
                         : side_segments(ground, tile, stride_of(cover.level), opposite, room);
    piece.begin = down ? begin.y - start.y : begin.x - start.x;
    piece.cells = edge_cells(tile, side);
    piece.level = cover.level;
    walk->left -= 1 << cover.level;
    if (down)
        walk->tile.row += 1 << cover.level;
    else
        walk->tile.column += 1 << cover.level;
    return piece;
}

// Puts the points of a piece; returns how many segments it has.
inline int put_piece(const Piece piece, __global int *places)
{
    const int f = piece.segments;
    for (int k = 0; k <= f && places; ++k)
        places[k] = piece.begin * FIXED_ONE + (int)(((long)k * piece.cells * FIXED_ONE + f / 2) / f);
    return f;
}

inline uint key_of(uint before, const Piece piece)
{
    return before * 1031 + piece.level * 67 + piece.segments;
}

// How many points a side has, and a key of its pieces; puts them where there are places.
__attribute__((always_inline)) inline int side_points(LEAF_ARGUMENTS, __global const int *factors, int leaf, int side, uint *key,
                       __global int *places)
{
    const Ground ground = {grid, heights, holes, detail_heights};
    const int index = leaves[leaf];
    const Node node = node_at(tree, index);
    const Tile tile = node_tile(grid, node);
    const int own = own_factor(tree, leaf_of, factors, leaf, node, side);
    if (own > 0) {
        const Piece piece = {own, 0, edge_cells(tile, side), node.level};
        *key = key_of(0, piece);
        return put_piece(piece, places) + 1;
    }
    const float room = room_of(allowed[index], shares[leaf], details[index].x);
    Walk walk = walk_along(grid, node, side);
    int segments = 0;
    *key = 0;
    while (walk.left > 0) {
        const Piece piece = next_piece(ground, tree, details, marks, stamp, leaf_of, factors, tile, side,
                                       room, &walk);
        segments += put_piece(piece, places ? places + segments : 0);
        *key = key_of(*key, piece);
    }
    return segments + 1;
}

__kernel void side_counts(LEAF_ARGUMENTS, __global const int *factors,      // (P, 4)
                          __global uint *keys,                      // (P * 4,) of its pieces
                          __global uint *counts,                    // (P * 4,)
                          __global float *edge_factors,             // (P, 4) 0 where not drawn
                          __global uchar *changed,                  // (P,)
                          __global uchar *failed)                   // (P,) more than fit
{
    const int i = get_global_id(0);
    if (i >= count * EDGES)
        return;
    const int leaf = i / EDGES;
    counts[i] = 0;
    edge_factors[i] = 0.0f;
    if (mark_of(marks, stamp, leaves[leaf]) != LEAF)
        return;
    uint key;
    counts[i] = side_points(grid, heights, holes, detail_heights, tree, details, stamp, marks, allowed,
                            count, leaves, shares, leaf_of, factors, leaf, i % EDGES, &key, 0);
    edge_factors[i] = counts[i] - 1;
    if (keys[i] != key)
        changed[leaf] = 1;
    keys[i] = key;
    if (counts[i] > MOST_SEGMENTS + 1)
        failed[leaf] = 1;
}

__kernel void side_places(LEAF_ARGUMENTS, __global const int *factors,      // (P, 4)
                          __global const uint *offsets,             // (P * 4 + 1,)
                          __global int *places)
{
    const int i = get_global_id(0);
    if (i >= count * EDGES || offsets[i] == offsets[i + 1])
        return;
    uint key;
    side_points(grid, heights, holes, detail_heights, tree, details, stamp, marks, allowed, count,
                leaves, shares, leaf_of, factors, i / EDGES, i % EDGES, &key, places + offsets[i]);
}
