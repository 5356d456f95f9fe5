// A torus: u around the axis, v around the tube from its outermost circle.

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = turns(u, 1), tube = turns(v, 1);
    Place place;
    place.normal = (float3)(tube.x * around, tube.y);
    place.position = (float3)((shape[RADIUS] + shape[TUBE] * tube.x) * around,
                              shape[TUBE] * tube.y);
    return place;
}
