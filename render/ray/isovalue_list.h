/* isovalue_list.h - the isosurfaces that rays look for, in the caller's order: a hit's `iso` counts
 * from 0 here. The values that a volume is asked for because of them are an interest
 * (stream/interest.h).
 */
#ifndef RENDER_RAY_ISOVALUE_LIST_H
#define RENDER_RAY_ISOVALUE_LIST_H

enum { ISOVALUES_MAX = 32 };

typedef struct isovalue_list {
    int count; /* at most ISOVALUES_MAX */
    const double *isovalues;
} isovalue_list;

#endif
