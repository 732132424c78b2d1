/* loader_expect.h - what is read of another set before that is selected: loader_expect().
 *
 * All of it needs the lock. Nothing of it becomes READY: it goes to the cache, where the selection
 * of its set finds it.
 */
#ifndef STREAM_LOADER_EXPECT_H
#define STREAM_LOADER_EXPECT_H

#include "stream/loader_private.h"

/* loader_expect_any() - whether there may be more to read. */
bool loader_expect_any(const struct loader_private *h);

/* loader_expect_next() - take the next treelet to read, for which there is room then;
 * LEAF_NO_TREELET: there is none, or nothing more shall be freed for one. */
uint32_t loader_expect_next(loader *l);

/* loader_expect_ahead() - list those after it that are to be read ahead, each once. */
void loader_expect_ahead(struct loader_private *h, loader_seat *seat);

/* loader_expect_meets() - whether treelet t of a set meets the interest and is not taken whole.
 * loader_expect_serves() - whether a treelet is that set's, or will be when that is selected. NULL
 * is not. */
bool loader_expect_meets(const loader *l, uint32_t set, uint32_t t);
bool loader_expect_serves(const struct loader_private *h, const treelet *tr, uint32_t set);

/* loader_expect_end() - read nothing more. Reads under way go on. */
void loader_expect_end(struct loader_private *h);

#endif
