// A Lissajous curve: an oscillation along each axis, `x`, `y` and `z` times to and fro. Those along
// y and z are a quarter and an eighth of a turn behind: the curve moves at every moment.

inline Bead curve(Parameter t, __global const float *shape)
{
    const float2 x = turns(t, (int)shape[X]), y = turns(t, (int)shape[Y]),
                 z = turns(t, (int)shape[Z]);
    const float eighth = 0.70710678f;
    Bead bead;
    bead.position = shape[SIZE] * (float3)(x.x, y.y, eighth * (z.x + z.y));
    bead.tangent = (float3)(-shape[X] * x.y, shape[Y] * y.x, shape[Z] * eighth * (z.x - z.y));
    return bead;
}
