// The nearer the eye, the more detail; section 9.1.1, listing 9.7, with the scaled distance clamped
// and measured to the ground instead of to the plane below it.
//
//     lod ^
// maximum |----.                  falloff 1: linear, as the book has it
//         |     `.                falloff > 1: steep near the eye, like a depth buffer
// minimum |       `.__________
//         +----+----+---------> distance
//            near  far
#include "terrain/patch.h"

#if !defined(LOD_NEAR) || !defined(LOD_FAR) || !defined(LOD_MINIMUM) || !defined(LOD_MAXIMUM) \
    || !defined(LOD_FALLOFF)
#error "terrain/lod/distance.h: one of near, far, minimum, maximum, falloff is missing"
#endif

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    const float scale = nearness(distance_to_eye(patch, view), parameters[LOD_NEAR],
                                 parameters[LOD_FAR]);
    const float minimum = parameters[LOD_MINIMUM], maximum = parameters[LOD_MAXIMUM];
    const float falloff = parameters[LOD_FALLOFF];
    const float weight = falloff == 1.0f ? scale : pow(scale, falloff);
    return minimum + (maximum - minimum) * weight;
}
