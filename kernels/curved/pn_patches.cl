// Tessellation factors of curved PN-triangles: those of their edges, or none where a patch is not
// seen.
#include "curved/pn_cull.h"

// T triangles; the inside is divided as finely as the finest edge
__kernel void pn_patches(const int triangles, const View view,
                               const int cull_frustum,
                               const float back_cosine,             // 2 keeps all
                               __global const int *edges,           // (T, 3)
                               __global const float *factors,       // (E,)
                               __global const float *nets,          // (T, NET_VECTORS, 3)
                               __global float *edge_factors,        // (T, 3)
                               __global float *inside_factors)      // (T, 1)
{
    const int triangle = get_global_id(0);
    if (triangle >= triangles)
        return;
    bool culled = false;
    if (cull_frustum || back_cosine < 1.0f) {
        float3 controls[CONTROLS];
        control_points(nets + (size_t)triangle * (3 * NET_VECTORS), controls);
        culled = (cull_frustum && out_of_view(controls, 0.0f, view))
              || (back_cosine < 1.0f && seen_from_behind(controls, view, back_cosine));
    }
    float inside = 0.0f;
    for (int side = 0; side < 3; ++side) {
        const float factor = culled ? 0.0f : factors[edges[3 * triangle + side]];
        edge_factors[3 * triangle + side] = factor;
        inside = fmax(inside, factor);
    }
    inside_factors[triangle] = inside;
}
