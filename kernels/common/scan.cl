// Exclusive prefix sum: offsets[i] = counts[0] + ... + counts[i - 1], of any length.
//
//   counts     3 1 4 | 1 5 9 | 2 6          blocks of BLOCK
//   block_sums     8 |    15 |   8          each block summed by one work-group
//   scan_sums      0 |     8 |  23 | 31     scanned by one work-group; the last is the total
//   scan_blocks 0 3 4 | 8 9 14 | 23 25 | 31
//
//   scan_one   0 3 4   8 9 14   23 25   31     all of it by one work-group, where it is short
//
// Totals are 64-bit, so that the host learns of an overflow before anything is allocated. Two arrays of one
// length are scanned side by side, by work-groups of two rows: a launch costs a GPU as much as the work.
//
// After Blelloch, "Prefix sums and their applications", 1990, section 1.2.
//
// Built with: BLOCK counts, GROUP items that share a block.
#include "common/group_scan.h"

#if !defined(BLOCK) || !defined(GROUP)
#error "scan.cl: define BLOCK, the counts of a block, and GROUP, the work-items that share it"
#endif

#define RUN (BLOCK / GROUP)

// the row of work-groups says which of two arrays is meant
#define OWN(one, other) (get_group_id(1) == 0 ? (one) : (other))

// where this item's run of the block begins and ends
inline uint run_begin(uint count)
{
    return min(count, (uint)get_group_id(0) * BLOCK + (uint)get_local_id(0) * RUN);
}

inline uint run_end(uint count)
{
    return min(count, (uint)get_group_id(0) * BLOCK + (uint)(get_local_id(0) + 1) * RUN);
}

inline ulong run_sum(__global const uint *counts, uint count)
{
    ulong sum = 0;
    for (uint i = run_begin(count); i < run_end(count); ++i)
        sum += counts[i];
    return sum;
}

__kernel void block_sums(uint count,
                         __global const uint *counts,   // (count)
                         __global const uint *others,   // (count)
                         __global ulong *sums)          // (rows, blocks + 1)
{
    sums += get_group_id(1) * (get_num_groups(0) + 1);
    __local ulong scratch[GROUP];
    const ulong mine = run_sum(OWN(counts, others), count);
    const ulong before = sum_before(mine, scratch);
    if (get_local_id(0) == GROUP - 1)
        sums[get_group_id(0)] = before + mine;
}

// one work-group a row, in place
__kernel void scan_sums(uint blocks,
                        __global ulong *sums)           // (rows, blocks + 1)
{
    sums += get_group_id(1) * (blocks + 1);
    __local ulong scratch[GROUP];
    // each item takes a run of the blocks
    const uint run = (blocks + GROUP - 1) / GROUP;
    const uint begin = min(blocks, (uint)get_local_id(0) * run), end = min(blocks, begin + run);
    ulong mine = 0;
    for (uint i = begin; i < end; ++i)
        mine += sums[i];
    ulong before = sum_before(mine, scratch);
    for (uint i = begin; i < end; ++i) {
        const ulong sum = sums[i];
        sums[i] = before;
        before += sum;
    }
    if (get_local_id(0) == GROUP - 1)
        sums[blocks] = before;
}

__kernel void scan_blocks(uint count,
                          __global const uint *counts,  // (count)
                          __global const uint *others,  // (count)
                          __global const ulong *sums,   // (rows, blocks + 1)
                          __global uint *offsets,       // (count + 1)
                          __global uint *other_offsets) // (count + 1)
{
    __local ulong scratch[GROUP];
    counts = OWN(counts, others);
    offsets = OWN(offsets, other_offsets);
    sums += get_group_id(1) * (get_num_groups(0) + 1);
    uint offset = sums[get_group_id(0)] + sum_before(run_sum(counts, count), scratch);
    for (uint i = run_begin(count); i < run_end(count); ++i) {
        offsets[i] = offset;
        offset += counts[i];
    }
    // the last item that has anything to add up ends at the total
    if (get_global_id(0) == 0)
        offsets[count] = sums[get_num_groups(0)];
}

__kernel void scan_one(uint count,
                       __global const uint *counts,     // (count)
                       __global const uint *others,     // (count)
                       __global ulong *totals,          // (rows)
                       __global uint *offsets,          // (count + 1)
                       __global uint *other_offsets)    // (count + 1)
{
    __local ulong scratch[GROUP];
    counts = OWN(counts, others);
    offsets = OWN(offsets, other_offsets);
    // each item takes a run
    const uint run = (count + GROUP - 1) / GROUP;
    const uint begin = min(count, (uint)get_local_id(0) * run), end = min(count, begin + run);
    ulong sum = 0;
    for (uint i = begin; i < end; ++i)
        sum += counts[i];
    ulong before = sum_before(sum, scratch);
    for (uint i = begin; i < end; ++i) {
        offsets[i] = before;
        before += counts[i];
    }
    if (get_local_id(0) == GROUP - 1) {
        offsets[count] = before;
        totals[get_group_id(1)] = before;
    }
}
