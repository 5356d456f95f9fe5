// How far a pattern is from a lattice, by a group whose items take a sample each at a time.
#ifndef LATTICE_GROUP_H
#define LATTICE_GROUP_H

inline float largest_error(const Lattice *lattice, int fu, int fv, Asked columns, Asked rows,
                           float enough, int2 *worst)
{
    // of an odd number of cells in two segments no sample lies within
    const int width = columns.last - columns.first + 1, height = rows.last - rows.first + 1;
    const int count = max(width, 0) * max(height, 0);
    float own = 0.0f;
    int where = 0;
    for (int i = get_local_id(0); i < count; i += GROUP) {
        const float error = sample_error(lattice, fu, fv, rows.first + i / width,
                                         columns.first + i % width);
        where = error > own ? i : where;
        own = larger(error, own);
    }
    const float error = group_max(own, lattice->scratch);
    if (error > enough) {
        // any of the greatest will do
        __local int *found = (__local int *)(lattice->scratch + GROUP);
        if (own == error)
            *found = where;
        barrier(CLK_LOCAL_MEM_FENCE);
        *worst = (int2)(columns.first + *found % width, rows.first + *found / width);
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    return error;
}

#endif
