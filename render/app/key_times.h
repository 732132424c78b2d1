/* key_times.h - entries of a camera path that name a time of the data: {"time": 0.25}.
 *
 * A movie goes evenly from time to time (keyframes.h); the step that is drawn is the last one whose
 * time has come. Where any entry names a time, those that name a step stand for its time, and those
 * that name neither for that of the entry before; the first one then for the first step's.
 */
#ifndef RENDER_APP_KEY_TIMES_H
#define RENDER_APP_KEY_TIMES_H

#include <jansson.h>

#include "formats/base/status.h"
#include "render/leafcast.h"

/* key_times_any() - whether an entry names a time. */
bool key_times_any(const json_t *path);

/* key_times_none() - ST_USAGE, with the reason, if an entry names a time or a step. file: the
 * path's, for messages.
 *
 * key_times_unify() - give all entries times for steps, in place, if any has a time; first: that of
 * entries before the first one that has one. ST_USAGE names the entry: one that is no object; a
 * time that is no number, or outside of those of the volume; no such step; both in one. */
CHECKED status key_times_none(const json_t *path, const char *file, const char *why);
CHECKED status key_times_unify(json_t *path, const char *file, const leafcast *volume,
                               double first);

/* key_times_settle() - replace the times of a path that is unified by steps, in place. */
CHECKED status key_times_settle(json_t *path, const leafcast *volume);

#endif
