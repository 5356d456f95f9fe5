// As many segments as keep the polyline within so many pixels of the curved edge.
//
// With lifts a and b the curve leaves the straight edge by t (1 - t) ((1 - t) a + t b), whose second
// derivative is linear, from 2 b - 4 a to 2 a - 4 b. A chord over a length h of t is off by no more
// than h^2 / 8 of the second derivative:
//
//     error <= h^2 max(|2 b - 4 a|, |2 a - 4 b|) / 8
//
// Segments of a fractional factor are not all 1 / f long. Between two whole ones, n and n + 2, points
// go in straight lines from their places of n to those of n + 2, so the longest segment is
//
//     h = (1 - q) / n + q / (n + 2),     q = (f - n) / 2,     n odd or even as the partitioning is
//
// 2 / 3 at f = 2 between 1 and 3. The factor is raised until h is short enough either way.
//
// A pixel is taken as small as it is at the nearest point of the edge's bounding sphere.
#include "curved/patch_edge.h"

#if !defined(FACTOR_PIXELS) || !defined(FACTOR_MINIMUM) || !defined(FACTOR_MAXIMUM)
#error "curved/factor/curvature.h: one of pixels, minimum, maximum is missing"
#endif

// the factor between n and n + 2 whose longest segment is 1 / segments
inline float factor_between(float n, float segments)
{
    return n + 2.0f * (1.0f / n - 1.0f / segments) / (1.0f / n - 1.0f / (n + 2.0f));
}

// the least factor that has no segment longer than 1 / segments in any partitioning
inline float factor_for(float segments)
{
    const float odd = 2.0f * floor((segments - 1.0f) * 0.5f) + 1.0f;
    const float even = 2.0f * floor(segments * 0.5f);
    const float between_odd = segments > 1.0f ? factor_between(odd, segments) : 1.0f;
    const float between_even = segments > 2.0f ? factor_between(even, segments) : 1.0f;
    return fmax(between_odd, between_even);
}

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const PnEdge curve = edge_curve(edge);
    const float3 a = curve.lifts[0], b = curve.lifts[1];
    const float3 at_start = b * 2.0f - a * 4.0f, at_end = a * 2.0f - b * 4.0f;
    const float bend = sqrt(fmax(dot3(at_start, at_start), dot3(at_end, at_end)));
    const float nearest = eye_distance(edge, view) - 0.5f * edge_length(edge);
    const float pixels = bend * 0.125f * pixels_per_unit(view, nearest);
    const float most = parameters[FACTOR_MAXIMUM];
    const float factor = factor_for(fmin(sqrt(pixels / parameters[FACTOR_PIXELS]), most));
    return fmin(fmax(factor, parameters[FACTOR_MINIMUM]), most);
}
