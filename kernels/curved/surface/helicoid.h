// A helicoid: u along a diameter, v up the screw; `pitch` is the rise a turn.

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = circle(v, (int)(2.0f * shape[TURNS]));
    const float distance = shape[RADIUS] * (2.0f * fraction(u) - 1.0f);
    const float rise = shape[PITCH] / 6.283185307179586f;   // an angle of 1
    Place place;
    place.position = (float3)(distance * around, shape[PITCH] * shape[TURNS] * fraction(v));
    place.normal = cross((float3)(around, 0.0f),
                         (float3)(-distance * around.y, distance * around.x, rise));
    return place;
}
