// A torus knot: `p` times around the axis and `q` times around the tube. It is one closed thread
// where p and q have no common divisor.

inline Bead curve(Parameter t, __global const float *shape)
{
    const float2 around = turns(t, (int)shape[P]), tube = turns(t, (int)shape[Q]);
    const float distance = shape[RADIUS] + shape[TUBE] * tube.x;
    const float slope = -shape[TUBE] * shape[Q] * tube.y;          // of the distance
    Bead bead;
    bead.position = (float3)(distance * around, shape[TUBE] * tube.y);
    bead.tangent = (float3)(slope * around + shape[P] * distance * (float2)(-around.y, around.x),
                            shape[TUBE] * shape[Q] * tube.x);
    return bead;
}
