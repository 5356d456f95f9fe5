// Sums, minima and maxima over a work-group of GROUP items; each returns the result to all items.
//
//   scratch   a b c d e f g h     a tree: halves fold onto each other,
//             a+e b+f c+g d+h     one barrier a level; a group of one has nothing to fold
//             ...
#ifndef REDUCE_H
#define REDUCE_H

#ifndef GROUP
#error "reduce.h: define GROUP, the work-items of a group (a power of two)"
#endif

#if GROUP == 1
#define DEFINE_REDUCTION(name, fold)                                                               \
    inline float name(float value, __local float *scratch)                                         \
    {                                                                                              \
        return value;                                                                              \
    }
#else
#define DEFINE_REDUCTION(name, fold)                                                               \
    inline float name(float value, __local float *scratch)                                         \
    {                                                                                              \
        const int item = get_local_id(0);                                                          \
        scratch[item] = value;                                                                     \
        for (int half_size = GROUP / 2; half_size > 0; half_size /= 2) {                           \
            barrier(CLK_LOCAL_MEM_FENCE);                                                          \
            if (item < half_size)                                                                  \
                scratch[item] = fold(scratch[item], scratch[item + half_size]);                    \
        }                                                                                          \
        barrier(CLK_LOCAL_MEM_FENCE);                                                              \
        const float folded = scratch[0];                                                           \
        barrier(CLK_LOCAL_MEM_FENCE);                                                              \
        return folded;                                                                             \
    }
#endif

#define ADD(a, b) ((a) + (b))

DEFINE_REDUCTION(group_sum, ADD)
DEFINE_REDUCTION(group_min, fmin)
DEFINE_REDUCTION(group_max, fmax)

#endif
