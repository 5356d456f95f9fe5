// What a tessellation-factor formula knows of an edge.
//
// A formula is one header that defines
//
//     float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
//
// and returns segments along the edge, 1 or more. It is asked once an edge, whatever number of
// patches meet there, so that they cannot disagree. Its parameters are named by the host: the class
// that goes with the header has a field `near`, the header reads parameters[FACTOR_NEAR].
#ifndef PATCH_EDGE_H
#define PATCH_EDGE_H

#include "curved/pn_net.h"

enum { EDGE_SIDES = 2, EDGE_NORMALS = 4 };

// An edge; what a formula does not ask of it below, is not computed. Relative to the mesh's origin.
typedef struct {
    __global const int *patches[EDGE_SIDES];
    int side;                           // of the first patch
    bool outline;                       // there is one patch only, twice
    __global const float *positions, *normals;
    float3 ends[2];
} CurvedEdge;

inline PnEdge edge_curve(const CurvedEdge edge)
{
    return pn_edge(edge.patches[0], edge.side, edge.positions, edge.normals);
}

// of the plane triangle on side 0 or 1: unit length, or zero
inline float3 face_normal(const CurvedEdge edge, int side)
{
    __global const int *patch = edge.patches[side];
    const float3 corner = vector_at(edge.positions, patch[0]);
    return direction(cross3(vector_at(edge.positions, patch[1]) - corner,
                            vector_at(edge.positions, patch[2]) - corner));
}

// one of the four of the mesh at the ends: both ends of side 0, then those of side 1
inline float3 end_normal(const CurvedEdge edge, int i)
{
    const int own = edge.patches[0][(edge.side + 1 + i % 2) % 3];
    const int adjacent = edge.patches[0][PATCH_ADJACENT + 2 * edge.side + i % 2];
    return vector_at(edge.normals, i < 2 || adjacent < 0 ? own : adjacent);
}

inline float3 edge_middle(const CurvedEdge edge)
{
    return (edge.ends[0] + edge.ends[1]) * 0.5f;
}

inline float edge_length(const CurvedEdge edge)
{
    const float3 along = edge.ends[1] - edge.ends[0];
    return sqrt(dot3(along, along));
}

inline float3 eye_of(const View view)
{
    return (float3)(view.eye[0], view.eye[1], view.eye[2]);
}

inline float eye_distance(const CurvedEdge edge, const View view)
{
    const float3 away = edge_middle(edge) - eye_of(view);
    return sqrt(dot3(away, away));
}

// from the middle of the edge to the eye, unit length
inline float3 to_eye(const CurvedEdge edge, const View view)
{
    const float3 forward = (float3)(view.axes[2][0], view.axes[2][1], view.axes[2][2]);
    return view.parallel ? -forward : direction(eye_of(view) - edge_middle(edge));
}

// how many pixels a length covers where it is nearest to the eye, turned towards it
inline float pixels_per_unit(const View view, float distance)
{
    return view.parallel ? view.focal : view.focal / fmax(distance, view.near);
}

#endif
