// Exclusive prefix sum over the work-items of a group, after Hillis and Steele.
//
// Built with: GROUP, the work-items of a group.
#ifndef GROUP_SCAN_H
#define GROUP_SCAN_H

// Returns the sum of the values of all items before this one. All items of the group must call it.
inline ulong sum_before(ulong value, __local ulong *sums)
{
    const int item = get_local_id(0);
    ulong sum = value;
    for (int distance = 1; distance < GROUP; distance *= 2) {
        sums[item] = sum;
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item >= distance)
            sum += sums[item - distance];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    return sum - value;
}

#endif
