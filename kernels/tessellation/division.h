// Where the points along an edge lie, in 16.16 fixed point.
//
// A factor between two whole divisions is a blend of both. From 3 to 5 segments (fractional_odd):
//
//   3     0-----------------1-----------------2-----------------3     coarse
//   3.5   0---------------1--2---------------3--4---------------5     points 1 and 4 are new: they
//   4.25  0-------------1-----2-------------3-----4-------------5     leave their inner neighbours
//   5     0----------1----------2---------3----------4----------5     fine
//
// The halves mirror each other exactly: two patches at an edge, which may run along it in opposite
// directions, place the same points. Which point is new follows from the ruler.
//
// After the Direct3D 11.3 Functional Specification, chapter Tessellator; the results agree with
// Microsoft's reference tessellator to the bit.
#ifndef TESSELLATOR_DIVISION_H
#define TESSELLATOR_DIVISION_H

#include "tessellation/factors.h"
#include "tessellation/ruler.h"

#define FIXED_HALF (FIXED_ONE / 2)

typedef struct {
    int segments;       // of the fine division; one point more
    bool odd;           // there is one in the middle, not a point
    StepRuler ruler;        // the steps in each half, without that one
    int newest;         // the point of the first half that the coarse division does not have
    uint fraction;      // weight of the fine division, 0 to FIXED_ONE - 1
    uint coarse_length; // of a segment
    uint fine_length;
} Division;

// length of one of so many segments, rounded to the nearest
inline uint segment_length(int segments)
{
    return (2 * FIXED_ONE + segments) / (2 * segments);
}

inline Division divide(uint factor, int partitioning)
{
    Division division;
    division.odd = is_odd(factor, partitioning);
    // segments in a half, the one in the middle counted as one
    const uint halved = (factor + 1) / 2 + (division.odd ? FIXED_HALF : 0);
    division.fraction = halved % FIXED_ONE;
    const int coarse = halved / FIXED_ONE, fine = coarse + (division.fraction != 0);
    division.segments = 2 * fine - division.odd;
    division.ruler = step_ruler(fine - division.odd);
    division.coarse_length = segment_length(2 * coarse - division.odd);
    division.fine_length = segment_length(division.segments);
    // from one segment to three, the new points leave the corners
    const int coarse_steps = coarse - division.odd;
    division.newest = division.fraction == 0 ? division.segments
                    : coarse_steps == 0      ? 0
                                             : next_point(step_ruler(coarse_steps));
    return division;
}

// Returns where point 0 <= i <= segments of a division lies, 0 to FIXED_ONE.
inline uint place(const Division division, int i)
{
    // the second half mirrors the first
    const int point = 2 * i <= division.segments ? i : division.segments - i;
    if (2 * point == division.segments)
        return FIXED_HALF;  // rounded segments do not add up to it
    const uint coarse = (point - (point > division.newest)) * division.coarse_length;
    const uint fine = point * division.fine_length;
    const uint blend = coarse * (FIXED_ONE - division.fraction) + fine * division.fraction;
    const uint location = (blend + FIXED_HALF) / FIXED_ONE;
    return point == i ? location : FIXED_ONE - location;
}

#endif
