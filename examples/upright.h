// More segments along edges that stand upright.
#include "curved/patch_edge.h"

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const float rise = fabs(edge.ends[1].z - edge.ends[0].z) / edge_length(edge);
    return 1.0f + (parameters[FACTOR_MOST] - 1.0f) * rise;
}
