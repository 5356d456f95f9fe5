// The same factor at every edge.
#include "curved/patch_edge.h"

#ifndef FACTOR_FACTOR
#error "curved/factor/uniform.h: parameter factor is missing"
#endif

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    return parameters[FACTOR_FACTOR];
}
