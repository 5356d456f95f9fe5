// What another work-item of the group has: item i asks item i ^ distance, a power of two.
//
//     distance 4    0 1 2 3 4 5 6 7       halves onto halves, and every item knows the sum:
//                   4 5 6 7 0 1 2 3           for (int d = COLUMNS / 2; d > 0; d /= 2)
//                                                 sum += of_item(sum, d, scratch);
//
// Every item of the group asks at once. On NVIDIA's cards items of a warp read each other's registers;
// elsewhere they meet in local memory.
//
// Built with: GROUP work-items a group, more than one.
#ifndef EXCHANGE_H
#define EXCHANGE_H

inline float of_item(float value, int distance, __local float *scratch) // GROUP
{
#ifdef __NV_CL_C_VERSION
    if (distance < 32) {
        float other;
        __asm__ volatile("shfl.sync.bfly.b32 %0, %1, %2, 0x1f, 0xffffffff;"
                         : "=f"(other) : "f"(value), "r"(distance));
        return other;
    }
#endif
    barrier(CLK_LOCAL_MEM_FENCE);
    scratch[get_local_id(0)] = value;
    barrier(CLK_LOCAL_MEM_FENCE);
    return scratch[get_local_id(0) ^ distance];
}

#endif
