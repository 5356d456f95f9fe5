// The isoline domain: lines of constant v, each divided alike.
//
//   v = 0    0-----1-----2-----3      Points and segments: line by line, along u. There is no line
//            4-----5-----6-----7      at v = 1: it is the first of the next patch.
//
//   v = 1    .                 .      Factors here: 2 lines (always whole), 3 segments a line.
#ifndef TESSELLATOR_ISOLINE_H
#define TESSELLATOR_ISOLINE_H

#include "tessellation/division.h"
#include "tessellation/items.h"

enum { LINES, DETAIL, ISOLINE_FACTORS };

typedef struct {
    bool drawn;
    uint lines;                     // fixed point, whole
    uint detail;                    // segments a line
} IsolineFactors;

inline IsolineFactors isoline_factors(__global const float *edges, size_t patch, int partitioning)
{
    const float lines = edges[ISOLINE_FACTORS * patch + LINES];
    const float detail = edges[ISOLINE_FACTORS * patch + DETAIL];
    IsolineFactors factors = {lines > 0.0f && detail > 0.0f,  // not where one is NaN
                              fixed_factor(lines, INTEGER),
                              fixed_factor(detail, partitioning)};
    return factors;
}

inline int line_count(const IsolineFactors factors)
{
    return factors.drawn ? factors.lines / FIXED_ONE : 0;
}

// lines go to rows of work-items
inline void fill_lines(const IsolineFactors factors, int partitioning, int base,
                       __global uint2 *points, __global int2 *segments)
{
    const Division across = divide(factors.lines, INTEGER);
    const Division along = divide(factors.detail, partitioning);
    const int count = along.segments;
    const Items items = row_items();
    for (int line = get_local_id(1); line < line_count(factors); line += get_local_size(1)) {
        const int first = line * (count + 1);
        const uint v = place(across, line);
        for (int k = items.first; k <= count; k += items.step)
            points[first + k] = (uint2)(place(along, k), v);
        for (int k = items.first; k < count; k += items.step)
            segments[line * count + k] = (int2)(base + first + k, base + first + k + 1);
    }
}

#endif
