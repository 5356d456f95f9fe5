// The pattern of a triangle whose factors are all the same odd level, as strips of sub-triangles.
//
// Rings of 3 (level - 2 ring) points lie in each other, down to the triangle in the middle. Between
// a ring and the next, each of the three sides is a strip:
//
//   0-----1-----2-----3-----4-----5       outer row: side of a ring with `steps` steps
//    \   / \   / \   /|   / \   /         inner row: side of the next, two steps fewer
//     \ /   \ /   \ / |  /   \ /
//      0-----1-----2--+-3-----4           A strip goes on by one point at a time, outer and inner
//                                         row in turn; half-way, after an outer one, the order is
//   mirrored: two outer ones follow each other. So each of its 2 steps - 2 triangles is known on
//   its own, and they are those of the tessellator (tessellation/stitch.h), in its order.
//
// After the "structural subdivision levels" of a thesis on PN-triangles by geometry shader, and its
// emitters of one border or one quad.
#ifndef STRIP_OF_SUB_TRIANGLES_H
#define STRIP_OF_SUB_TRIANGLES_H

enum { SIDES = 3 };

inline int rings_of(int level)
{
    return (level - 1) / 2;
}

inline int ring_steps(int level, int ring)
{
    return level - 2 * ring;
}

// points, and triangles, outside a ring: sums of 3 steps and of 3 (2 steps - 2)
inline int points_outside(int level, int ring)
{
    return 3 * ring * (level - ring + 1);
}

inline int triangles_outside(int level, int ring)
{
    return 6 * ring * (level - ring);
}

inline int triangles_of(int level)
{
    return triangles_outside(level, rings_of(level)) + 1;
}

inline int strip_triangles(int level, int ring)
{
    return 2 * ring_steps(level, ring) - 2;
}

// point k of a side of a ring; the last of all is the first
inline int point_of(int level, int ring, int side, int k)
{
    const int steps = ring_steps(level, ring), place = side * steps + k;
    return points_outside(level, ring) + (place == SIDES * steps ? 0 : place);
}

// how many of the first t triangles of a strip go on along the outer row
inline int outer_steps(int level, int ring, int t)
{
    const int middle = ring_steps(level, ring) - 1;
    return t <= middle ? (t + 1) / 2 : middle / 2 + 1 + (t - middle) / 2;
}

#endif
