// The same factor everywhere.
#include "terrain/patch.h"

#ifndef LOD_FACTOR
#error "terrain/lod/uniform.h: parameter factor is missing"
#endif

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    return parameters[LOD_FACTOR];
}
