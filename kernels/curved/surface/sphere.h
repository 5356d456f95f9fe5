// A sphere: u the longitude, v from the south pole to the north pole.

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = turns(u, 1), up = circle(v, 1);
    Place place;
    place.normal = (float3)(up.y * around, -up.x);
    place.position = shape[RADIUS] * place.normal;
    return place;
}
