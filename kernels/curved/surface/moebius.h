// A Moebius strip: u once around the axis, half a turn of the strip meanwhile; v across the strip.
//
//   P = radius * r(u) + s * d(u),   s = width * (v - 1/2)
//   r = (cos 2 pi u, sin 2 pi u, 0), d = cos(pi u) r + sin(pi u) z

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = turns(u, 1), tilt = circle(u, 1);
    const float s = shape[WIDTH] * (fraction(v) - 0.5f);
    const float3 across = (float3)(tilt.x * around, tilt.y);
    // dP/du over 2 pi: the way round, and half as fast the turn of the strip
    const float3 forth = (shape[RADIUS] + s * tilt.x) * (float3)(-around.y, around.x, 0.0f)
                       + 0.5f * s * (float3)(-tilt.y * around, tilt.x);
    Place place;
    place.position = (float3)(shape[RADIUS] * around, 0.0f) + s * across;
    place.normal = cross(forth, across);
    return place;
}
