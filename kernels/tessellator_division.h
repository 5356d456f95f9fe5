// One dimension of the Direct3D 11 tessellator: how a factor divides an edge, in 16.16 fixed point.
//
// A factor between two whole divisions is a blend of both. From 3 to 5 segments (fractional_odd):
//
//   3      0---------------1---------------2---------------3      coarse
//   3.1    0-------------1-2--------------3-4-------------5       a new point leaves its inner
//   4      0---------1----2----------------3----1---------5       neighbour, on both sides of
//   5      0--------1--------2--------3--------4--------5         the middle ...    fine
//
// The halves mirror each other exactly: u and 1 - u are divided alike, so that the two patches at
// an edge, which may run along it in opposite directions, place the same points. Odd divisions
// have a segment in their middle, even ones a point.
//
// Where the next pair of points appears follows the ruler function, see tessellator_stitch.h.
//
// After the Direct3D 11.3 Functional Specification, chapter Tessellator; the results agree with
// Microsoft's reference tessellator to the bit, so roundings are part of the algorithm.
#ifndef TESSELLATOR_DIVISION_H
#define TESSELLATOR_DIVISION_H

#include "layout.h"

#define FIXED_HALF (FIXED_ONE / 2)

// a float of this size has no bits below one: adding it rounds to the nearest whole, ties to even
#define ROUNDER 8388608.0f

// what is to be done with a patch
enum { CULLED, WHOLE, DIVIDED };

typedef struct {
    int segments;       // of the fine division; one point more
    int half_steps;         // steps in each half, without the segment in the middle if there is one
    bool odd;           // a segment in the middle, not a point
    int newest;         // the point that only the fine division has, in the first half
    uint fraction;      // weight of the fine division, 0 to FIXED_ONE - 1
    uint coarse_step;   // length of a segment in each
    uint fine_step;
} Division;

// which share of a loop is a work-item's own: first, first + step, ...
typedef struct {
    int first, step;
} Items;

inline Items group_items(void)
{
    Items items = {get_local_id(1) * get_local_size(0) + get_local_id(0),
                   get_local_size(0) * get_local_size(1)};
    return items;
}

inline Items row_items(void)
{
    Items items = {get_local_id(0), get_local_size(0)};
    return items;
}

// Returns a factor in 16.16: clamped to what its partitioning allows, NaN to the least, and
// rounded, up to a whole number or power of two, or to the nearest in fixed point, ties to even.
inline uint fixed_factor(float factor, int partitioning)
{
    const float least = partitioning == FRACTIONAL_EVEN ? 2.0f : 1.0f;
    const float most = partitioning == FRACTIONAL_ODD ? 63.0f : 64.0f;
    const float clamped = !(factor > least) ? least : factor < most ? factor : most;
    if (partitioning == FRACTIONAL_ODD || partitioning == FRACTIONAL_EVEN)
        return (uint)(clamped * FIXED_ONE + ROUNDER - ROUNDER);
    uint whole = (uint)clamped;
    whole += whole < clamped;
    if (partitioning == POW2)
        while (whole & (whole - 1))
            ++whole;
    return whole * FIXED_ONE;
}

// Returns whether a factor's division has a segment in its middle.
inline bool is_odd(uint factor, int partitioning)
{
    return partitioning == FRACTIONAL_ODD
        || (partitioning != FRACTIONAL_EVEN && (factor / FIXED_ONE) % 2 == 1);
}

// Returns the segments of a factor's fine division: the next odd or even number.
inline int segments_of(uint factor, int partitioning)
{
    const int whole = (factor + FIXED_ONE - 1) / FIXED_ONE;
    return whole + (whole % 2 != (int)is_odd(factor, partitioning));
}

// Fixes `count` edge and inside factors each and says what they make of the patch. A factor of one
// inside would leave no ring between the edges and the inside: it becomes the next above.
inline int fix_factors(__global const float *edges, int edge_count,
                       __global const float *insides, int inside_count,
                       int partitioning, uint *fixed_edges, uint *fixed_insides)
{
    bool drawn = true, whole = true;
    for (int edge = 0; edge < edge_count; ++edge) {
        drawn = drawn && edges[edge] > 0.0f;  // not where it is NaN
        fixed_edges[edge] = fixed_factor(edges[edge], partitioning);
        whole = whole && fixed_edges[edge] == FIXED_ONE;
    }
    for (int axis = 0; axis < inside_count; ++axis) {
        fixed_insides[axis] = fixed_factor(insides[axis], partitioning);
        whole = whole && fixed_insides[axis] == FIXED_ONE;
    }
    const uint least = partitioning == FRACTIONAL_ODD ? FIXED_ONE + 1 : 2 * FIXED_ONE;
    for (int axis = 0; axis < inside_count; ++axis)
        fixed_insides[axis] = max(fixed_insides[axis], least);
    return !drawn ? CULLED : whole ? WHOLE : DIVIDED;
}

// Returns x without its highest set bit.
inline int without_top_bit(int x)
{
    return x == 0 ? 0 : x - (1 << (31 - clz(x)));
}

// length of one of so many segments, rounded
inline uint segment_length(int segments)
{
    return (2 * FIXED_ONE + segments) / (2 * segments);
}

inline Division divide(uint factor, int partitioning)
{
    Division division;
    division.odd = is_odd(factor, partitioning);
    // of steps in a half, the segment in the middle counted as one
    const uint halved = (factor + 1) / 2 + (division.odd ? FIXED_HALF : 0);
    const int coarse = halved / FIXED_ONE;
    division.fraction = halved % FIXED_ONE;
    const int fine = coarse + (division.fraction != 0);
    division.segments = 2 * fine - division.odd;
    division.half_steps = fine - division.odd;
    const int coarse_half = coarse - division.odd;
    division.newest = division.fraction == 0 ? division.segments
                    : coarse_half == 0       ? 0
                                             : 2 * without_top_bit(coarse_half) + 1;
    division.coarse_step = segment_length(2 * coarse - division.odd);
    division.fine_step = segment_length(division.segments);
    return division;
}

// Returns where point 0 <= i <= segments of a division lies, 0 to FIXED_ONE.
inline uint place(const Division division, int i)
{
    // the second half mirrors the first
    const int point = 2 * i <= division.segments ? i : division.segments - i;
    if (2 * point == division.segments)
        return FIXED_HALF;  // segments do not add up to it exactly
    const uint coarse = (point - (point > division.newest)) * division.coarse_step;
    const uint fine = point * division.fine_step;
    const uint blend = coarse * (FIXED_ONE - division.fraction) + fine * division.fraction;
    const uint location = (blend + FIXED_HALF) / FIXED_ONE;
    return point == i ? location : FIXED_ONE - location;
}

inline void place_all(const Division division, __local uint *places, Items items)
{
    for (int i = items.first; i <= division.segments; i += items.step)
        places[i] = place(division, i);
}

#endif
