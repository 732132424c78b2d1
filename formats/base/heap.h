/* heap.h - binary heaps in arrays: item 0 comes first, and none comes before items[(i - 1) / 2].
 *
 * Two steps are all there is; each is a function made for one type and one order, so that it costs
 * what it would cost written by hand. NAME_rise() and NAME_sink() put an item into the heap, given
 * the one place that is free; what is in the way moves.
 *
 *     push:  thing_rise(items, count++, item);
 *     pop:   first = items[0]; last = items[--count]; thing_sink(items, 0, count, last);
 *
 * BEFORE(a, b), of two pointers: whether *a must come out before *b. A strict order.
 */
#ifndef FORMATS_BASE_HEAP_H
#define FORMATS_BASE_HEAP_H

#include <stddef.h>

/* HEAP_RISE() - defines NAME_rise(): from a free place at the end towards the first. */
#define HEAP_RISE(NAME, TYPE, BEFORE)                                             \
    static inline void NAME##_rise(TYPE *items, size_t at, TYPE added) {          \
        for (; at > 0 && BEFORE(&added, &items[(at - 1) / 2]); at = (at - 1) / 2) \
            items[at] = items[(at - 1) / 2];                                      \
        items[at] = added;                                                        \
    }

/* HEAP_SINK() - defines NAME_sink(): from a free place away from the first, among `count` items. */
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
