// The nearer the eye, the more segments:  (1 - t) maximum + t minimum,  t from 0 at the near
// distance to 1 at the far one. With a minimum of 1 it is the (1 - t) maximum + t of the slides on
// Direct3D tessellation.
#include "curved/patch_edge.h"

#if !defined(FACTOR_NEAR) || !defined(FACTOR_FAR) || !defined(FACTOR_MINIMUM) \
    || !defined(FACTOR_MAXIMUM)
#error "curved/factor/distance.h: one of near, far, minimum, maximum is missing"
#endif

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const float near = parameters[FACTOR_NEAR], far = parameters[FACTOR_FAR];
    const float scaled = (eye_distance(edge, view) - near) / (far - near);
    const float t = fmin(fmax(scaled, 0.0f), 1.0f);
    return (1.0f - t) * parameters[FACTOR_MAXIMUM] + t * parameters[FACTOR_MINIMUM];
}
