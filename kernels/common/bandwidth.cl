// What the device can do at best: the yardsticks of benchmarks/.
//
// On a GPU, items that are neighbours touch neighbours in memory, and all groups sweep over the arrays
// together; on a CPU a group is one item, and takes a run of its own.
//
// Built with: GROUP work-items a group.

// blocks that an item has on their way at a time
#define AT_ONCE 4

#if GROUP == 1
// sixteen floats at any address
typedef float16 Floats __attribute__((aligned(4)));
typedef uint16 Words __attribute__((aligned(4)));
#define BLOCK 16
#else
typedef float4 Floats;
typedef uint4 Words;
#define BLOCK 4
#endif

typedef struct {
    size_t first, end, step;
} Share;

// the blocks of an item
inline Share share_of(size_t blocks)
{
#if GROUP == 1
    const size_t run = (blocks + get_num_groups(0) - 1) / get_num_groups(0);
    const size_t first = get_group_id(0) * run;
    const Share share = {first, first + run < blocks ? first + run : blocks, 1};
#else
    const Share share = {get_global_id(0), blocks, get_global_size(0)};
#endif
    return share;
}

// Read every float of a whole number of blocks once; what is written keeps the compiler from leaving it out.
__kernel void read_floats(__global const float *values, const ulong count,
                          __global float *sums)         // (groups * GROUP,)
{
    const Share share = share_of(count / BLOCK);
    __global const Floats *blocks = (__global const Floats *)values;
    Floats sum = 0.0f;
    size_t i = share.first;
    for (; i + (AT_ONCE - 1) * share.step < share.end; i += AT_ONCE * share.step) {
        Floats read[AT_ONCE];
#pragma unroll
        for (int k = 0; k < AT_ONCE; ++k)
            read[k] = blocks[i + k * share.step];
#pragma unroll
        for (int k = 0; k < AT_ONCE; ++k)
            sum += read[k];
    }
    for (; i < share.end; i += share.step)
        sum += blocks[i];
#if GROUP == 1
    const float8 eight = sum.lo + sum.hi;
    const float4 four = eight.lo + eight.hi;
#else
    const float4 four = sum;
#endif
    sums[get_global_id(0)] = four.x + four.y + four.z + four.w;
}

// Copy a whole number of blocks.
__kernel void copy_words(__global const uint *source, const ulong count, __global uint *target)
{
    const Share share = share_of(count / BLOCK);
    for (size_t i = share.first; i < share.end; i += share.step)
        ((__global Words *)target)[i] = ((__global const Words *)source)[i];
}
