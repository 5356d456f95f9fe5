// The more a surface is seen from its side, the more segments: by the least cosine between view and
// normal at the edge's ends.
#include "curved/patch_edge.h"

#if !defined(FACTOR_MINIMUM) || !defined(FACTOR_MAXIMUM)
#error "curved/factor/orientation.h: minimum or maximum is missing"
#endif

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const float3 towards = to_eye(edge, view);
    float cosine = 1.0f;
    for (int i = 0; i < EDGE_NORMALS; ++i)
        cosine = fmin(cosine, fabs(dot3(end_normal(edge, i), towards)));
    const float minimum = parameters[FACTOR_MINIMUM], maximum = parameters[FACTOR_MAXIMUM];
    return minimum + (maximum - minimum) * (1.0f - cosine);
}
