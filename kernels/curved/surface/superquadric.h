// A superellipsoid: a sphere whose sines and cosines are raised to powers, `across` around the axis
// and `along` from pole to pole: 1 is round, below towards a box, 2 an octahedron.
//
// After Barr, "Superquadrics and angle-preserving transformations", IEEE Computer Graphics and
// Applications 1(1), 1981: the normal has 2 less the powers.

inline float signed_power(float x, float power)
{
    return x == 0.0f ? 0.0f : copysign(pow(fabs(x), power), x);
}

// Returns x to 2 less the power, x to the power given.
inline float2 complements(float2 x, float2 powers)
{
    return (float2)(powers.x == 0.0f ? 0.0f : x.x * x.x / powers.x,
                    powers.y == 0.0f ? 0.0f : x.y * x.y / powers.y);
}

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = turns(u, 1), up = circle(v, 1);
    const float2 ring = (float2)(signed_power(around.x, shape[ACROSS]),
                                 signed_power(around.y, shape[ACROSS]));
    const float2 side = (float2)(signed_power(up.x, shape[ALONG]),
                                 signed_power(up.y, shape[ALONG]));
    const float2 outward = complements(up, side);
    Place place;
    place.position = shape[RADIUS] * (float3)(side.y * ring, -side.x);
    place.normal = (float3)(outward.y * complements(around, ring), -outward.x);
    return place;
}
