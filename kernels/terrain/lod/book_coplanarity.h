// Distance scaled by deviation, as the book weighs it: section 9.1.2.
//
//     lod = minimum + (maximum - minimum) * nearness * weight
//
//  weight ^
//       1 |          .-------     a tile that lies on its plane keeps flat_weight of its detail,
//         |     .--'              one that leaves it by full_deviation keeps all
//    flat |.-'
//         +----------+------> deviation
//              full_deviation
//
// Between them the weight goes with the square root of the deviation.
#include "terrain/patch.h"

#if !defined(LOD_NEAR) || !defined(LOD_FAR) || !defined(LOD_MINIMUM) || !defined(LOD_MAXIMUM) \
    || !defined(LOD_FULL_DEVIATION) || !defined(LOD_FLAT_WEIGHT)
#error "terrain/lod/book_coplanarity.h: near, far, minimum, maximum, full_deviation or flat_weight is missing"
#endif

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    const float scale = nearness(distance_to_eye(patch, view), parameters[LOD_NEAR],
                                 parameters[LOD_FAR]);
    const float detail = fmin(patch.deviation / parameters[LOD_FULL_DEVIATION], 1.0f);
    const float flat = parameters[LOD_FLAT_WEIGHT];
    const float weight = flat + (1.0f - flat) * sqrt(detail);
    const float minimum = parameters[LOD_MINIMUM], maximum = parameters[LOD_MAXIMUM];
    return minimum + (maximum - minimum) * scale * weight;
}
