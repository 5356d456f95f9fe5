// In which order points appear as half an edge goes from one step to 32: the ruler function.
//
//   steps   begin at, in 64ths of the half (0 the corner, 64 the middle of the edge)
//     1     0
//     2     0                               32
//     3     0              16               32
//     4     0              16               32              48
//     5     0      8       16               32              48
//     6     0      8       16      24       32              48
//     7     0      8       16      24       32      40      48
//     8     0      8       16      24       32      40      48      56
//
// Each doubling splits the steps in two, one after the other from the corner on. So the first
// 2 * split steps are halves, the others still whole, and both where a step begins and how many
// begin before a place are known in closed form.
#ifndef TESSELLATOR_RULER_H
#define TESSELLATOR_RULER_H

typedef struct {
    int steps;          // 0 to 32
    int split;          // of the steps of the doubling before, this many are split
    int shift;          // log2 of the length of a half that this makes
} StepRuler;

inline StepRuler step_ruler(int steps)
{
    StepRuler ruler = {steps, 0, 5};
    for (int power = 2; power <= steps; power *= 2)
        --ruler.shift;
    ruler.split = steps - (32 >> ruler.shift);
    return ruler;
}

// Returns where step 0 <= k < steps begins.
inline int ruler_place(const StepRuler ruler, int k)
{
    return (k <= 2 * ruler.split ? k : 2 * (k - ruler.split)) << ruler.shift;
}

// Returns how many steps begin at a place or before it.
inline int steps_to(const StepRuler ruler, int place)
{
    const int halves = place >> ruler.shift;
    const int last = halves <= 2 * ruler.split ? halves : ruler.split + halves / 2;
    return ruler.steps == 0 || place < 0 ? 0 : last + 1;
}

// Returns the step that begins with the point which one step more would add.
inline int next_point(const StepRuler ruler)
{
    return 2 * ruler.split + 1;
}

#endif
