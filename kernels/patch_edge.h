// What a tessellation-factor formula knows of an edge.
//
// A formula is one header, factor_*.h, that defines
//
//     float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
//
// and returns segments along the edge, 1 or more. It is asked once an edge, whatever number of
// patches meet there, so that they cannot disagree. Its parameters are named by the host: the class
// that goes with the header has a field `near`, the header reads parameters[FACTOR_NEAR].
#ifndef PATCH_EDGE_H
#define PATCH_EDGE_H

#include "pn_net.h"

enum { EDGE_SIDES = 2 };

// positions are relative to the mesh's origin
typedef struct {
    PnEdge curve;
    float3 normals[2 * EDGE_SIDES];     // of the mesh, at both ends of both sides
    float3 faces[EDGE_SIDES];           // of the plane triangles: unit length, or zero
    bool outline;                       // there is one side only
} CurvedEdge;

inline float3 edge_middle(const CurvedEdge edge)
{
    return (edge.curve.ends[0] + edge.curve.ends[1]) * 0.5f;
}

inline float edge_length(const CurvedEdge edge)
{
    const float3 along = edge.curve.ends[1] - edge.curve.ends[0];
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
