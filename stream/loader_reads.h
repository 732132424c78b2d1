/* loader_reads.h - what a loader has queued, and how the readers take it: one read at a time, the
 * most urgent first.
 *
 * loader_reads_begin() and loader_reads_end() apart, all needs the lock.
 */
#ifndef STREAM_LOADER_READS_H
#define STREAM_LOADER_READS_H

#include "stream/loader_private.h"

/* loader_reads_begin() - make scratch for `workers` reads at a time. Join the readers given, or
 * create own ones (NULL). loader_reads_end() - undo what loader_reads_begin() did, even if it
 * failed half-way. Waits for reads under way. */
CHECKED status loader_reads_begin(loader *l, readers *given, int workers);
void loader_reads_end(loader *l);

/* loader_reads_renew() - make scratch anew, as the file has other payloads now. Only while nothing
 * is read. On failure nothing has changed. */
CHECKED status loader_reads_renew(loader *l);

/* loader_reads_before() - returns whether a is read before b. */
bool loader_reads_before(const loader_request *a, const loader_request *b);

/* loader_reads_push() - queue a request. loader_reads_tell() - tell the readers, after the queue or
 * the slots have changed. */
void loader_reads_push(struct loader_private *h, loader_request r);
void loader_reads_tell(struct loader_private *h);

/* loader_reads_pending() - returns whether a read is under way, or is queued and has a slot. */
bool loader_reads_pending(const struct loader_private *h);

/* loader_reads_quiesce() - forget everything queued, and wait for the reads under way.
 * loader_reads_rest() - forget the sweep, too: all that a picture wanted. */
void loader_reads_quiesce(struct loader_private *h);
void loader_reads_rest(struct loader_private *h);

#endif
