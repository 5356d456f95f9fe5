// A quadtree of patches over the tiles of a grid.
//
// Node (row, column) of level k covers 2^k x 2^k tiles, as far as there are any; level 0 are the tiles
// themselves. Nodes are numbered level by level, row by row.
//
//     +-------+---+---+
//     |       |   |   |      a node of level 1 beside four tiles
//     |       +---+---+
//     |       |   |   |
//     +-------+---+---+
#ifndef NODE_H
#define NODE_H

#include "common/common.h"

typedef struct {
    int level, row, column;
} Node;

inline int node_index(const Tree tree, const Node node)
{
    return tree.first[node.level] + node.row * tree.columns[node.level] + node.column;
}

inline Node node_at(const Tree tree, int index)
{
    int level = 0;
    while (level + 1 < tree.levels && index >= tree.first[level + 1])
        ++level;
    const int within = index - tree.first[level], columns = tree.columns[level];
    const Node node = {level, within / columns, within % columns};
    return node;
}

inline bool is_in_tree(const Tree tree, const Node node)
{
    return node.row >= 0 && node.row < tree.rows[node.level]
        && node.column >= 0 && node.column < tree.columns[node.level];
}

inline Node parent_of(const Node node)
{
    const Node parent = {node.level + 1, node.row >> 1, node.column >> 1};
    return parent;
}

// child 0 north-west, 1 north-east, 2 south-west, 3 south-east; at the border some are not there
inline Node child_of(const Node node, int child)
{
    const Node found = {node.level - 1, 2 * node.row + child / 2, 2 * node.column + child % 2};
    return found;
}

inline Tile node_tile(const Grid grid, const Node node)
{
    const int k = node.level;
    Tile tile;
    tile.row = tile_row(grid, node.row << k);
    tile.column = tile_column(grid, node.column << k);
    tile.cells_down = tile_row(grid, min((node.row + 1) << k, grid.tile_rows)) - tile.row;
    tile.cells_across = tile_column(grid, min((node.column + 1) << k, grid.tile_columns))
                      - tile.column;
    return tile;
}

// Coarse nodes are looked at on a lattice, 2^FINER times as fine as their own finest pattern; how far
// it is from the samples is known: details.x.
inline int stride_of(int level)
{
    return level > FINER ? 1 << (level - FINER) : 1;
}

// What became of a node in the mesh that is being made, by its number: others' marks do not count.
enum { UNSEEN, SPLIT, LEAF, ABSENT };

inline int mark_of(__global const uint *marks, uint stamp, int index)
{
    return marks[index] / 4 == stamp ? (int)(marks[index] % 4) : UNSEEN;
}

// the node of the mesh that covers this one, itself or an ancestor
inline Node cover_of(const Tree tree, __global const uint *marks, uint stamp, Node node)
{
    while (mark_of(marks, stamp, node_index(tree, node)) == UNSEEN)
        node = parent_of(node);
    return node;
}

#endif
