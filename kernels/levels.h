// The levels of the error ladder.
#ifndef LEVELS_H
#define LEVELS_H

// the factor of a level: 1, 3, 5, ...; a tile of fewer cells stops at its cells
inline int factor_of(int level, int cells)
{
    const int factor = 2 * level + 1;
    return factor < cells ? factor : cells;
}

#endif
