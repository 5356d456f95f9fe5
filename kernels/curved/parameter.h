// A parameter that runs from 0 to 1 in whole steps, and angles that are exact in the quarters.
//
// Steps are counted over all patches side by side, so a point that two patches share has the same
// number in both, and anything that is computed from the number has the same bits.
#ifndef PARAMETER_H
#define PARAMETER_H

#include "layout.h"

// the same bits from both sides of an edge
#pragma OPENCL FP_CONTRACT OFF

typedef struct {
    uint step, steps;           // 0 <= step <= steps
} Parameter;

inline float fraction(Parameter p)
{
    return (float)p.step / (float)p.steps;
}

// Returns cosine and sine of half_turns * pi * p. Whole quarters are taken off in integers, so that
// at 0, 1/4, ... of a turn the results are 0, 1 and -1: poles are points, seams close.
inline float2 circle(Parameter p, int half_turns)
{
    const ulong quarters = (ulong)p.step * (2 * half_turns);
    const uint whole = (uint)(quarters / p.steps);
    const uint rest = (uint)(quarters - (ulong)whole * p.steps);
    const float angle = (float)rest / (float)p.steps * 1.5707963267948966f;
    float sine = sin(angle), cosine = cos(angle);
    if (whole % 2 == 1) {
        const float turned = cosine;
        cosine = -sine;
        sine = turned;
    }
    return whole % 4 < 2 ? (float2)(cosine, sine) : (float2)(-cosine, -sine);
}

// the same point of a circle as often as the parameter goes round
inline float2 turns(Parameter p, int count)
{
    return circle(p, 2 * count);
}

#endif
