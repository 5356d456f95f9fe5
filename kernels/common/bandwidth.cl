// What the device can do at best: the yardsticks of benchmarks/.
//
// Groups share an array in runs, as the stages do.
//
// Built with: GROUP work-items a group.

// sixteen floats at any address
typedef float16 Floats __attribute__((aligned(4)));

// Read every float once; what is written keeps the compiler from leaving it out.
__kernel void read_floats(__global const float *values, const int count,
                          __global float *sums)         // (groups * GROUP,)
{
    const size_t blocks = count / 16;
    const size_t run = (blocks + get_num_groups(0) - 1) / get_num_groups(0);
    const size_t first = get_group_id(0) * run;
    const size_t end = first + run < blocks ? first + run : blocks;
    Floats sum = 0.0f;
    for (size_t i = first + get_local_id(0); i < end; i += GROUP)
        sum += ((__global const Floats *)values)[i];
    const float8 eight = sum.lo + sum.hi;
    const float4 four = eight.lo + eight.hi;
    sums[get_global_id(0)] = four.x + four.y + four.z + four.w;
}

// Copy every 32-bit word.
__kernel void copy_words(__global const uint *source, const int count, __global uint *target)
{
    const size_t run = ((size_t)count + get_num_groups(0) - 1) / get_num_groups(0);
    const size_t first = get_group_id(0) * run;
    const size_t end = first + run < (size_t)count ? first + run : (size_t)count;
    for (size_t i = first + get_local_id(0); i < end; i += GROUP)
        target[i] = source[i];
}
