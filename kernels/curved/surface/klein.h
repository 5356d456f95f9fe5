// A Klein bottle: a figure eight, once around the axis with half a turn of the eight meanwhile.
//
//   P = (radius + x) r(u) + y z,   r = (cos 2 pi u, sin 2 pi u, 0)
//   (x, y) = size (sin t, sin 2t) turned by pi u,   t = 2 pi v

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = turns(u, 1), tilt = circle(u, 1), t = turns(v, 1), twice = turns(v, 2);
    const float2 eight = shape[SIZE] * (float2)(t.y, twice.y);
    const float2 along = shape[SIZE] * (float2)(t.x, 2.0f * twice.x);     // d/dt
    const float2 at = (float2)(tilt.x * eight.x - tilt.y * eight.y,
                               tilt.y * eight.x + tilt.x * eight.y);
    const float2 slope = (float2)(tilt.x * along.x - tilt.y * along.y,
                                  tilt.y * along.x + tilt.x * along.y);
    const float distance = shape[RADIUS] + at.x;
    // dP/du over 2 pi: the way round, and half as fast the turn of the eight
    const float3 forth = (float3)(-0.5f * at.y * around, 0.5f * at.x)
                       + distance * (float3)(-around.y, around.x, 0.0f);
    Place place;
    place.position = (float3)(distance * around, at.y);
    place.normal = cross(forth, (float3)(slope.x * around, slope.y));
    return place;
}
