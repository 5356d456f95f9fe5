// The cube root of a tile's deviation in the picture, which is its share of a sum of least error.
//
//     lod = maximum * cbrt(deviation in the picture / pixels)      at most maximum
//
// A tile that leaves its plane by d, seen from r, is wrong by about d n^-a / r when it has n
// segments along a side, which take 2 n^2 triangles. Of all ways to spend a number of triangles
//
//     minimise S (d n^-a / r)^2 where S n^2 is given:   a (d / r)^2 n^(-2a-2) = constant
//                                                       n ~ (d / r)^(1 / (1 + a))
//
// Where ground is smooth, the error of a segment goes with the square of its length: a = 2.
#include "terrain/patch.h"

#if !defined(LOD_PIXELS) || !defined(LOD_MINIMUM) || !defined(LOD_MAXIMUM)
#error "terrain/lod/coplanarity.h: pixels, minimum or maximum is missing"
#endif

// Of a number from 0 to 1. The library's cbrt is rounded by each device in its own way; three steps
// of Newton's method, from a third of the exponent, are the same everywhere.
inline float cube_root(float x)
{
    float root = as_float(as_uint(x) / 3 + 0x2a514067u);
    for (int step = 0; step < 3; ++step)
        root = (2.0f * root + x / (root * root)) / 3.0f;
    return root;
}

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    const float depth = view.parallel ? 1.0f : fmax(distance_to_eye(patch, view), view.near);
    const float seen = patch.deviation * (view.focal / depth);
    const float share = cube_root(fmin(seen / parameters[LOD_PIXELS], 1.0f));
    return fmax(parameters[LOD_MAXIMUM] * share, parameters[LOD_MINIMUM]);
}
