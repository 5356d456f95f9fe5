// How far an error in metres may show in pixels.
//
// A sample stands at depth z1, the mesh above or below it, off by e, at z2. With the vertical's
// components (a, b) across the picture and c along the view, and the sample's own tangent t, its
// position in the picture moves by
//
//     focal |e| |(a, b) - t c| / z2  <=  focal e (|(a, b)| + |t| |c|) / (z - e |c|)
//
// where z is the least depth at which the tile can be seen: nothing of it is nearer than its box,
// and nothing nearer than the near plane is seen. Solved for e, that is the error in metres that
// moves no visible sample of the tile by more than the pixels asked for, wherever it stands.
#ifndef SCREEN_H
#define SCREEN_H

#include "common/frustum.h"

// the largest component sum of a box along an axis of the view, from the eye
inline float farthest_along(const View view, Box box, int axis, float sign)
{
    const float x = sign * view.axes[axis][0], y = sign * view.axes[axis][1];
    const float z = sign * view.axes[axis][2];
    return x * ((x > 0.0f ? box.high.x : box.low.x) - view.eye[0])
         + y * ((y > 0.0f ? box.high.y : box.low.y) - view.eye[1])
         + z * ((z > 0.0f ? box.high.z : box.low.z) - view.eye[2]);
}

inline float largest_tangent(const View view, Box box, float depth)
{
    const float right = fmax(farthest_along(view, box, 0, 1.0f), farthest_along(view, box, 0, -1.0f));
    const float up = fmax(farthest_along(view, box, 1, 1.0f), farthest_along(view, box, 1, -1.0f));
    return fmin(sqrt(right * right + up * up) / depth, view.widest);
}

// the vertical error of a tile that stays within so many pixels
inline float metres_for_pixels(const View view, Box box, float pixels)
{
    const float across = sqrt(view.axes[0][2] * view.axes[0][2] + view.axes[1][2] * view.axes[1][2]);
    const float along = fabs(view.axes[2][2]);
    if (view.parallel)
        return pixels / (view.focal * fmax(across, 1e-6f));
    // 1e-6 of slack against the rounding of depths far from the origin
    const float nearest = -farthest_along(view, box, 2, -1.0f);
    const float depth = fmax(nearest * (1.0f - 1e-6f), view.near);
    const float moved = view.focal * (across + largest_tangent(view, box, depth) * along);
    return pixels * depth / (moved + pixels * along);
}

#endif
