// Queues of patches by key, in the order of the patches: one compaction for all queues together.
//
//   keys       2 0 2 1              queue 0 | queue 1 | queue 2
//   flags      0 1 0 0   0 0 0 1   1 0 1 0      a row a queue: is this patch in it?
//   (scan)     0 0 1 1   1 1 1 1   2 3 3 4      where each would go: scan.cl
//   members    1 | 3 | 0 2                      those with a flag go there
//   begins     0   1   2   4                    the scan at the start of each row, and the total
//
// Dyken, Reimers and Seland build their render queues with one HistoPyramid a queue (Ziegler et al.,
// "GPU point list generation through histogram pyramids", 2006) and name the scan of Harris,
// "Parallel prefix sum with CUDA", 2007, as its equal. A key below 0 is in no queue.

__kernel void queue_flags(int patches, int queues,
                          __global const int *keys,         // (P,)
                          __global uint *flags)             // (Q, P)
{
    const int patch = get_global_id(0);
    if (patch >= patches)
        return;
    for (int queue = 0; queue < queues; ++queue)
        flags[(size_t)queue * patches + patch] = keys[patch] == queue;
}

__kernel void queue_fill(int patches, int queues,
                         __global const int *keys,          // (P,)
                         __global const uint *offsets,      // (Q * P + 1,)
                         __global uint *members,            // (P,) those in no queue are left out
                         __global uint *begins)             // (Q + 1,)
{
    const int patch = get_global_id(0);
    if (patch <= queues)
        begins[patch] = offsets[(size_t)patch * patches];
    if (patch < patches && keys[patch] >= 0)
        members[offsets[(size_t)keys[patch] * patches + patch]] = patch;
}
