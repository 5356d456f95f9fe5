// As many segments as keep the polyline within so many pixels of the curved edge.
//
// With lifts a and b the curve leaves the straight edge by t (1 - t) ((1 - t) a + t b), whose second
// derivative is linear, from 2 b - 4 a to 2 a - 4 b. A chord over a length h of t is off by no more
// than h^2 / 8 of the second derivative, and no segment of a factor f is longer than 1 / f:
//
//     error <= max(|2 b - 4 a|, |2 a - 4 b|) / (8 f^2)
//
// A pixel is taken as small as it is at the nearest point of the edge's bounding sphere.
#include "patch_edge.h"

#if !defined(FACTOR_PIXELS) || !defined(FACTOR_MINIMUM) || !defined(FACTOR_MAXIMUM)
#error "factor_curvature.h: one of pixels, minimum, maximum is missing"
#endif

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const float3 a = edge.curve.lifts[0], b = edge.curve.lifts[1];
    const float3 at_start = b * 2.0f - a * 4.0f, at_end = a * 2.0f - b * 4.0f;
    const float bend = sqrt(fmax(dot3(at_start, at_start), dot3(at_end, at_end)));
    const float nearest = eye_distance(edge, view) - 0.5f * edge_length(edge);
    const float pixels = bend * 0.125f * pixels_per_unit(view, nearest);
    return fmin(fmax(sqrt(pixels / parameters[FACTOR_PIXELS]), parameters[FACTOR_MINIMUM]),
                parameters[FACTOR_MAXIMUM]);
}
