// As much detail as the tile's bounding box has area in the picture.
//
//     lod = sqrt(area) / pixels           a segment for every so many pixels along a side
//
//       .----.                            each point of a box's outline in the picture is covered
//      / top /|                           by one face of its front and by one of its back:
//     +----+  |                               area = 1/2 sum over its six faces |area of face|
//     |    |  '
//     '----'                              a corner nearer than the near plane is taken to lie on
//                                         it, far out of the picture: all the detail there is
#include "terrain/patch.h"

#if !defined(LOD_PIXELS) || !defined(LOD_MINIMUM) || !defined(LOD_MAXIMUM)
#error "terrain/lod/area.h: pixels, minimum or maximum is missing"
#endif

inline float2 in_picture(const View view, float x, float y, float z)
{
    x -= view.eye[0];
    y -= view.eye[1];
    z -= view.eye[2];
    const float depth = x * view.axes[2][0] + y * view.axes[2][1] + z * view.axes[2][2];
    const float scale = view.focal / (view.parallel ? 1.0f : fmax(depth, view.near));
    const float2 place = (float2)(x * view.axes[0][0] + y * view.axes[0][1] + z * view.axes[0][2],
                                  x * view.axes[1][0] + y * view.axes[1][1] + z * view.axes[1][2]);
    // so that areas are finite
    return clamp(place * scale, -1e18f, 1e18f);
}

// of a face whose corners follow each other: half of what its diagonals span
inline float face_area(float2 a, float2 b, float2 c, float2 d)
{
    const float2 one = c - a, other = d - b;
    return 0.5f * fabs(one.x * other.y - one.y * other.x);
}

inline float area_in_picture(const View view, const Box box)
{
    // corner 0 .. 7: bit 0 high x, bit 1 high y, bit 2 high z
    float2 corner[8];
    for (int i = 0; i < 8; ++i)
        corner[i] = in_picture(view, i & 1 ? box.high.x : box.low.x,
                               i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z);
    float sum = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        // the two directions along the face, and the one from it to the opposite face
        const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, across = 1 << axis;
        sum += face_area(corner[0], corner[u], corner[u + v], corner[v]);
        sum += face_area(corner[across], corner[across + u], corner[across + u + v],
                         corner[across + v]);
    }
    return 0.5f * sum;
}

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    const float segments = sqrt(area_in_picture(view, patch.box)) / parameters[LOD_PIXELS];
    return fmin(fmax(segments, parameters[LOD_MINIMUM]), parameters[LOD_MAXIMUM]);
}
