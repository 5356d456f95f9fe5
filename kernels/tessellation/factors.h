// What tessellation factors ask for, in 16.16 fixed point.
//
// An edge factor that is not above 0 culls its patch; others are clamped to their partitioning's
// range and rounded. Roundings are part of the algorithm: two patches agree on a factor to the bit.
#ifndef TESSELLATOR_FACTORS_H
#define TESSELLATOR_FACTORS_H

#include "layout.h"

// what becomes of a patch; a whole one has factors of one alone and is left as it is
enum { CULLED, WHOLE, DIVIDED };

// a float of this size has no bits below one: adding it rounds to the nearest whole, ties to even
#define ROUNDER 8388608.0f

// Returns a factor in 16.16: clamped, NaN to the least, and rounded up to a whole number or a power
// of two, or to the nearest that fixed point has.
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

// Fixes a patch's factors and says what becomes of it. One inside would leave no ring between the
// edges and the inside: it becomes the next number above.
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

// Returns whether a factor's division has a segment in its middle, not a point.
inline bool is_odd(uint factor, int partitioning)
{
    return partitioning == FRACTIONAL_ODD
        || (partitioning != FRACTIONAL_EVEN && (factor / FIXED_ONE) % 2 == 1);
}

// Returns the segments that a factor makes of its edge: the next number, odd or even.
inline int segments_of(uint factor, int partitioning)
{
    const int whole = (factor + FIXED_ONE - 1) / FIXED_ONE;
    return whole + (whole % 2 != (int)is_odd(factor, partitioning));
}

#endif
