// An egg around the z axis: u around it, v from its lower pole to the upper one.
#include "curved/parameter.h"

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    // exact in the quarters, so that poles are points and the seam closes
    const float2 around = turns(u, 1), up = circle(v, 1);
    Place place;
    place.position = (float3)(shape[RADIUS] * up.y * around, -shape[HEIGHT] * up.x);
    place.normal = (float3)(shape[HEIGHT] * up.y * around, -shape[RADIUS] * up.x);
    return place;
}
