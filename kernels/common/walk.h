// A ray's way across a lattice of cells, seen from above.
//
//      .-----.-----.-----.         the ray is at origin + t direction; within a cell it stays from
//      |     |    _|-->  |         t to `leave`, then it crosses the nearer of two lines
//      |     | .-' |     |
//      |    _|'    |     |         Amanatides, Woo, "A Fast Voxel Traversal Algorithm for Ray
//      .--''-.-----.-----.         Tracing", 1987; lines need not be evenly spaced here
#ifndef QUERIES_WALK_H
#define QUERIES_WALK_H

#include "common/common.h"

#ifndef cl_khr_fp64
#error "common/walk.h: needs a device with 64-bit floats"
#endif
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

typedef struct {
    double3 origin, direction;
} Ray;

inline double at(double origin, double direction, double t)
{
    return origin + t * direction;
}

// Narrow t to where the ray is between two lines across one axis.
inline void clip_axis(double origin, double direction, double low, double high,
                      double *enter, double *leave)
{
    if (direction == 0.0) {
        if (origin < low || origin > high)
            *leave = -1.0;
        return;
    }
    const double t0 = (low - origin) / direction, t1 = (high - origin) / direction;
    *enter = fmax(*enter, fmin(t0, t1));
    *leave = fmin(*leave, fmax(t0, t1));
}

// where the ray crosses the line that it meets next, of those before and behind a cell
inline double next_line(double origin, double direction, double before, double behind)
{
    if (direction == 0.0)
        return INFINITY;
    return ((direction > 0.0 ? behind : before) - origin) / direction;
}

// the cell, of `count` from `first` on, that a coordinate lies in
inline int cell_of(double coordinate, int first, int count)
{
    return clamp((int)floor(clamp(coordinate, first - 1.0, first + count + 1.0)), first,
                 first + count - 1);
}

#endif
