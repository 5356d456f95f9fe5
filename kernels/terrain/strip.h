// The error of the strip of triangles between an edge of a tile and the lattice inside it.
//
//     0    outer    o   o+1      points of the edge, at even distances; the rung (o, i) joins the two
//     *---*----*----*----*--     rows, the next step on either row makes a triangle
//      \  |  / | . / \ . | .     samples . of one row: where rungs cross it they have one height, and
//       \ | /  |  /   \  |       between two rungs the strip is straight
//         *----*-------*---      points of the lattice's outermost line
//         0    i      i+1
//
// Rows step in the order of the tessellator: tessellation/stitch.h.
#ifndef STRIP_H
#define STRIP_H

#include "terrain/ground.h"
#include "tessellation/ruler.h"

#define MOST_POINTS 65  // of a row

// where rows of points are kept: an item's own memory, or its group's
#ifndef STRIP_MEMORY
#define STRIP_MEMORY
#endif

// samples seen from an edge: `along` it as the tessellator walks, and `inwards`
typedef struct {
    int row, column;                // of the corner where the walk begins
    int along_row, along_column;    // a sample further along
    int in_row, in_column;          // a sample further inwards
    int cells;                      // along the edge
} Frame;

typedef struct {
    Frame frame;
    int outer, inner;               // factors: segments of the edge, and of the inside along it
    float depth;                    // cells from the edge to the lattice
} Strip;

inline Frame strip_frame(Tile tile, int edge)
{
    const int south = tile.row + tile.cells_down, east = tile.column + tile.cells_across;
    const Frame frames[EDGES] = {
        {south, tile.column, -1, 0, 0, 1, tile.cells_down},
        {tile.row, tile.column, 0, 1, 1, 0, tile.cells_across},
        {tile.row, east, 1, 0, 0, -1, tile.cells_down},
        {south, east, 0, -1, -1, 0, tile.cells_across},
    };
    return frames[edge];
}

inline float height_in(const Ground ground, const Frame frame, int along, int inwards)
{
    return sample_height(ground, frame.row + along * frame.along_row + inwards * frame.in_row,
                         frame.column + along * frame.along_column + inwards * frame.in_column);
}

// bilinear, where a point of the pattern stands
inline float height_at(const Ground ground, const Frame frame, float along, float inwards)
{
    const int a = (int)along, b = (int)inwards;
    const int next_a = a < frame.cells ? a + 1 : a, next_b = inwards > b ? b + 1 : b;
    const float left = along - a, above = inwards - b;
    const float z00 = height_in(ground, frame, a, b), z10 = height_in(ground, frame, next_a, b);
    const float upper = z00 + (z10 - z00) * left;
    if (next_b == b)
        return upper;
    const float z01 = height_in(ground, frame, a, next_b);
    const float z11 = height_in(ground, frame, next_a, next_b);
    const float lower = z01 + (z11 - z01) * left;
    return upper + (lower - upper) * above;
}

// points of a row, from both of its ends alike
typedef struct {
    float along[MOST_POINTS], height[MOST_POINTS];
} Points;

// Puts point i of a division into so many segments.
inline void put_point(const Ground ground, const Frame frame, int segments, int i, float inwards,
                      STRIP_MEMORY Points *points, int target)
{
    // whole where it is whole
    const float along = i == segments ? frame.cells : i * ((float)frame.cells / segments);
    points->along[target] = along;
    points->height[target] = height_at(ground, frame, along, inwards);
}

// Writes which row takes each step, 1 the inner one; returns how many steps there are.
inline int step_rows(int outer, int inner, STRIP_MEMORY uchar *steps)
{
    const StepRuler outer_ruler = step_ruler(outer / 2), inner_ruler = step_ruler(inner / 2);
    const int count = outer + inner - 2;
    int o = 0, i = 0, step = 0;
    while (o < outer_ruler.steps || i < inner_ruler.steps - 1) {
        // the lattice lacks its division's first step; the inner row goes first
        const bool is_inner = i < inner_ruler.steps - 1
            && (o == outer_ruler.steps
                || ruler_place(inner_ruler, i + 1) <= ruler_place(outer_ruler, o));
        o += !is_inner;
        i += is_inner;
        // the second half is the first one's mirror image
        steps[count - 1 - step] = is_inner;
        steps[step++] = is_inner;
    }
    // across the middle
    if (inner % 2 == 1)
        steps[step++] = 1;
    if (outer % 2 == 1)
        steps[step] = 0;
    return count;
}

// The largest error of the samples of one row between a strip's two rows of points, `stride` apart.
inline float strip_row_error(const Ground ground, const Strip strip, STRIP_MEMORY const Points *outer,
                             STRIP_MEMORY const Points *inner, STRIP_MEMORY const uchar *steps,
                             int row, int stride)
{
    const float t = row / strip.depth;
    const int count = strip.outer + strip.inner - 2;
    float error = 0.0f;
    // the rung behind, the rung ahead, and the samples between
    float behind = inner->along[0] * t;
    float low = outer->height[0] + (inner->height[0] - outer->height[0]) * t;
    int sample = (int)(behind / stride) * stride;
    sample += sample < behind ? stride : 0;
    for (int step = 0, o = 0, i = 0; step < count; ++step) {
        i += steps[step];
        o += 1 - steps[step];
        const float ahead = outer->along[o] + (inner->along[i] - outer->along[o]) * t;
        const float high = outer->height[o] + (inner->height[i] - outer->height[o]) * t;
        for (; sample <= ahead; sample += stride) {
            const float z = low + (high - low) * ((sample - behind) / (ahead - behind));
            const float difference = z - height_in(ground, strip.frame, sample, row);
            error = larger(absolute(difference), error);
        }
        behind = ahead;
        low = high;
    }
    return error;
}

#endif
