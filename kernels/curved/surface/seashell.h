// A sea shell: a tube along a spiral that is `growth` times as large after each turn, the opening
// of size one; u along the spiral, v around the tube. `tube` is its radius, `height` how far the
// spiral falls, both over the spiral's radius.
//
//   P = scale(u) Q(u, v),   Q = (1 + tube cos t) r(u) + (tube sin t - height) z
//
// After Raup, "Geometric analysis of shell coiling", Journal of Paleontology 40(5), 1966.

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = circle(u, (int)(2.0f * shape[TURNS])), t = turns(v, 1);
    const float speed = log(shape[GROWTH]) / 6.283185307179586f;    // of the scale, an angle of 1
    const float scale = pow(shape[GROWTH], shape[TURNS] * (fraction(u) - 1.0f));
    const float distance = 1.0f + shape[TUBE] * t.x;
    const float3 q = (float3)(distance * around, shape[TUBE] * t.y - shape[HEIGHT]);
    Place place;
    place.position = scale * q;
    place.normal = cross(speed * q + distance * (float3)(-around.y, around.x, 0.0f),
                         (float3)(-t.y * around, t.x));
    return place;
}
