// Segments of so many pixels. The length is that of the edge's bounding sphere on the screen, which
// does not change as the edge turns: an edge seen end on may bulge sideways.
#include "curved/patch_edge.h"

#if !defined(FACTOR_PIXELS) || !defined(FACTOR_MINIMUM) || !defined(FACTOR_MAXIMUM)
#error "curved/factor/length.h: one of pixels, minimum, maximum is missing"
#endif

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const float diameter = edge_length(edge) * pixels_per_unit(view, eye_distance(edge, view));
    return fmin(fmax(diameter / parameters[FACTOR_PIXELS], parameters[FACTOR_MINIMUM]),
                parameters[FACTOR_MAXIMUM]);
}
