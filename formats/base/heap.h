/* heap.h - binary heaps in arrays: items[0] comes out first, and no item comes before its parent
 * items[(i - 1) / 2].
 *
 * There are only two operations. Each is a function made for one type and one order, as fast as one
 * written by hand. NAME_rise() and NAME_sink() put an item into a heap that has one free place, and
 * move other items out of the way.
 *
 *     push:  thing_rise(items, count++, item);
 *     pop:   first = items[0]; last = items[--count]; thing_sink(items, 0, count, last);
 *
 * BEFORE(a, b), of two pointers: whether *a must come out before *b. A strict order.
 */
#ifndef FORMATS_BASE_HEAP_H
#define FORMATS_BASE_HEAP_H

#include <stddef.h>

/* HEAP_RISE() - defines NAME_rise(): put an item in at a free place, moving it towards the
 * first. */
#define HEAP_RISE(NAME, TYPE, BEFORE)                                             \
    static inline void NAME##_rise(TYPE *items, size_t at, TYPE added) {          \
        for (; at > 0 && BEFORE(&added, &items[(at - 1) / 2]); at = (at - 1) / 2) \
            items[at] = items[(at - 1) / 2];                                      \
        items[at] = added;                                                        \
    }

/* HEAP_SINK() - defines NAME_sink(): put an item in at a free place, moving it away from the first,
 * among `count` items. */
#define HEAP_SINK(NAME, TYPE, BEFORE)                                                  \
    static inline void NAME##_sink(TYPE *items, size_t at, size_t count, TYPE added) { \
        for (size_t child; (child = 2 * at + 1) < count; at = child) {                 \
            if (child + 1 < count && BEFORE(&items[child + 1], &items[child]))         \
                child++;                                                               \
            if (!BEFORE(&items[child], &added))                                        \
                break;                                                                 \
            items[at] = items[child];                                                  \
        }                                                                              \
        items[at] = added;                                                             \
    }

#endif
