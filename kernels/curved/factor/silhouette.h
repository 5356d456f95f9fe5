// Segments where the outline of the picture is. The silhouetteness of an edge, after C. Dyken,
// M. Reimers, J. Seland, "Real-Time GPU Silhouette Refinement Using Adaptively Blended Bezier
// Patches", 2008: 1 where one of its two faces is seen from the front and the other from behind, or
// where it has one face only; falling to 0 where both are turned by more than a cosine.
//
//      1 +-------.
//        |        `.
//        |          `.
//      0 +-----------+-------->  min(|cosine of face 0|, |cosine of face 1|) where of one sign
//        0        cosine
#include "curved/patch_edge.h"

#if !defined(FACTOR_COSINE) || !defined(FACTOR_MINIMUM) || !defined(FACTOR_MAXIMUM)
#error "curved/factor/silhouette.h: one of cosine, minimum, maximum is missing"
#endif

inline float silhouetteness(const CurvedEdge edge, const View view, float cosine)
{
    const float3 towards = to_eye(edge, view);
    const float first = dot3(face_normal(edge, 0), towards);
    const float second = dot3(face_normal(edge, 1), towards);
    const float off = fmin(fabs(first), fabs(second)) / cosine;
    return edge.outline || first * second <= 0.0f ? 1.0f : 1.0f - fmin(off, 1.0f);
}

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const float minimum = parameters[FACTOR_MINIMUM], maximum = parameters[FACTOR_MAXIMUM];
    return minimum + (maximum - minimum) * silhouetteness(edge, view, parameters[FACTOR_COSINE]);
}
