// Points of an edge that is divided in halves of halves, and where they come from.
//
// Level n has the points k = 0 .. 2^n. Those of odd k are not on level n - 1: there they are at their
// origin, the neighbour that level n - 2 has too. Down several levels, they go one after the other.
//
//     k         0   1   2   3   4   5   6   7   8
//     origin    0 <-'   2   '-> 4 <-'   6   '-> 8
//
// The two sides of an edge walk it in opposite directions and agree: mirrored, 1 is 3 modulo 4. The
// middle of level 1 is as far from both ends: it goes to the end of the walk, or turned to its start.
#ifndef DYADIC_EDGE_H
#define DYADIC_EDGE_H

inline int origin_of(int k, int level, bool turned)
{
    const bool onwards = level > 1 ? (k & 2) != 0 : !turned;
    return k % 2 == 0 ? k : onwards ? k + 1 : k - 1;
}

// To the nearest point of the lower level, in one step: equation 1 of the paper. Of two as near, to
// the one nearer to an end. The middle is as near to both where there are no others: there sigma(t)
// and sigma(1 - t) are both 1, and the equation does not say which end; turned does.
inline int snap_to_nearest(int k, int level, int edge_level, bool turned)
{
    const int shift = level - edge_level, half_step = (1 << shift) / 2, middle = 1 << level;
    const bool back = 2 * k < middle || (2 * k == middle && edge_level == 0 && turned);
    return (k + half_step - (back && shift > 0)) >> shift << shift;
}

// where point k of a level is when the edge has a lower one, counted in steps of its own level
inline int snap(int k, int level, int edge_level, bool turned)
{
    for (int n = level; n > edge_level; --n)
        k = origin_of(k, n, turned) / 2;
    return k << (level - edge_level);
}

#endif
