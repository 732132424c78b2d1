/* loader_slots.h - what a loader holds: READY treelets in slots, others in the cache, and the
 * payloads that treelets of several sets share.
 *
 * All of it needs the lock, and evicts only while no ray is being traced.
 */
#ifndef STREAM_LOADER_SLOTS_H
#define STREAM_LOADER_SLOTS_H

#include "stream/loader_private.h"

residence loader_slots_state(const struct loader_private *h, uint32_t t); /* needs no lock */
void loader_slots_set_state(struct loader_private *h, uint32_t t, residence to);

/* loader_slots_publish() - make a treelet READY, in a free slot. */
void loader_slots_publish(loader *l, treelet *tr);

/* loader_slots_fits() - whether a treelet is of the selected set; one of another set that is the
 * same there becomes one of this, unless the cache has that, too.
 * loader_slots_take_back() - take treelet t from the cache and make it READY. Returns false if the
 * cache has none that fits. */
bool loader_slots_fits(loader *l, treelet *tr);
bool loader_slots_take_back(loader *l, uint32_t t);

/* loader_slots_withdraw() - make a treelet ABSENT for rays. The caller removes it from `slots`. */
void loader_slots_withdraw(loader *l, treelet *tr);

/* loader_slots_discard() - free a treelet that is neither READY nor in the cache. */
void loader_slots_discard(loader *l, treelet *tr);

/* loader_slots_evict() - free the `count` oldest READY treelets; the cache does not get them. */
void loader_slots_evict(loader *l, uint32_t count);

/* loader_slots_make_room() - free treelets of the cache, the oldest first, until there is room for
 * the treelets that are being read and `more` others, or the cache is empty. False: there is none.
 */
bool loader_slots_make_room(loader *l, uint32_t more);

/* For kinds whose sets share payloads; for others, these functions do nothing.
 *
 * loader_slots_share() - add a user of treelet t's shared payload. Returns the payload, or NULL if
 * it is not in memory. loader_slots_release() - remove a user; the payload is freed with the last
 * one. loader_slots_offer() - let other treelets of the same id share this one's payload; where
 * they share another copy, it keeps its own. */
const void *loader_slots_share(struct loader_private *h, uint32_t t);
void loader_slots_release(struct loader_private *h, uint32_t t);
void loader_slots_offer(struct loader_private *h, treelet *tr);

/* loader_slots_most_bytes() - returns the most memory of a resident treelet. */
size_t loader_slots_most_bytes(const loader *l);

#endif
