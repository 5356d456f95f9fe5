// As terrain/lod/coplanarity.h, with any power in place of the cube root.
#include "terrain/patch.h"

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    const float depth = view.parallel ? 1.0f : fmax(distance_to_eye(patch, view), view.near);
    const float seen = patch.deviation * (view.focal / depth);
    const float share = pow(fmin(seen / parameters[LOD_PIXELS], 1.0f), parameters[LOD_POWER]);
    return fmax(parameters[LOD_MAXIMUM] * share, 1.0f);
}
