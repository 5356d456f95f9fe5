// What a level-of-detail formula knows of a patch.
//
// A formula is one header that defines
//
//     float patch_lod(const Patch patch, const View view, __global const float *parameters)
//
// and returns segments along an edge, 1 or more. Its parameters are named by the host: the class
// that goes with the header has a field `near`, the header reads parameters[LOD_NEAR].
#ifndef PATCH_H
#define PATCH_H

#include "common/frustum.h"

// positions are relative to the terrain's origin and base
typedef struct {
    float3 midpoint;            // mean of the displaced corners
    float3 normal;              // of the tile's plane, unit length
    float deviation;            // from that plane
    float minimum, maximum;     // heights; NaN where the tile has no data
    Box box;                    // between these heights
    float holes;                // samples without data
} Patch;

inline float distance_to_eye(const Patch patch, const View view)
{
    const float x = patch.midpoint.x - view.eye[0];
    const float y = patch.midpoint.y - view.eye[1];
    const float z = patch.midpoint.z - view.eye[2];
    // squares of more would overflow; a power of two changes no bit
    const float unit = fmax(fmax(fabs(x), fabs(y)), fabs(z)) > 1e18f ? 0x1p-66f : 1.0f;
    const float u = x * unit, v = y * unit, w = z * unit;
    return sqrt(u * u + v * v + w * w) / unit;
}

// 1 at the near distance and before, 0 at the far one and beyond
inline float nearness(float distance, float near, float far)
{
    const float scaled = (distance - near) / (far - near);
    return 1.0f - fmin(fmax(scaled, 0.0f), 1.0f);
}

#endif
