// Which share of a loop is a work-item's own: first, first + step, ...
//
// A work-group per patch is one work-item on a CPU and rows of items on a GPU. What lies in rows
// goes to rows of items; an edge is walked by all of them.
#ifndef TESSELLATOR_ITEMS_H
#define TESSELLATOR_ITEMS_H

typedef struct {
    int first, step;
} Items;

inline Items group_items(void)
{
    const Items items = {get_local_id(1) * get_local_size(0) + get_local_id(0),
                         get_local_size(0) * get_local_size(1)};
    return items;
}

inline Items row_items(void)
{
    const Items items = {get_local_id(0), get_local_size(0)};
    return items;
}

#endif
