// A helix around the z axis; `pitch` is the rise a turn.

inline Bead curve(Parameter t, __global const float *shape)
{
    const float2 around = circle(t, (int)(2.0f * shape[TURNS]));
    Bead bead;
    bead.position = (float3)(shape[RADIUS] * around, shape[PITCH] * shape[TURNS] * fraction(t));
    bead.tangent = (float3)(-shape[RADIUS] * around.y, shape[RADIUS] * around.x,
                            shape[PITCH] / 6.283185307179586f);
    return bead;
}
