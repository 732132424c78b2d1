/* leafcast_device.h - what volumes that are open together share: threads, memory, kernels.
 *
 * Calls on one device take turns: whoever looks at treelets holds its lock. All memory comes out of
 * one budget: what is always there (volumes without their treelets), what frames that are under way
 * may need, and treelets, in what is left.
 */
#ifndef RENDER_DOOR_LEAFCAST_DEVICE_H
#define RENDER_DOOR_LEAFCAST_DEVICE_H

#include <pthread.h>
#include <unistd.h>

#include "formats/base/cpu.h"
#include "formats/base/pool.h"
#include "render/leafcast.h"
#include "stream/readers.h"

struct leafcast_device {
    mem budget;
    leafcast_options options;
    pool *threads;
    readers *readers;
    cpu_isa isa;
    const char *isa_name;             /* as it was asked for */
    const struct walk_choice *choice; /* of an experiment, or NULL */
    pid_t process;                    /* that made it, and has its threads */
    pthread_mutex_t lock;
    /* Guarded by lock: */
    leafcast *volumes;    /* open on it, by their `next` */
    int users;            /* those, and whoever made it */
    size_t base_bytes;    /* of the budget: what is always there */
    size_t frames_bytes;  /* ... may be needed by frames that are begun and not ended */
    size_t beside;        /* ... is the caller's: leafcast_check_room() */
    void *scratch;        /* that threads draw in, for the frame whose turn it is */
    size_t scratch_bytes; /* counted in frames_bytes */
};

/* device_is_here() - whether this is the process that made it. In a child of fork() it has no
 * threads, and its lock may be held for ever. */
static inline bool device_is_here(const leafcast_device *d) {
    return d->process == getpid();
}

void device_lock(leafcast_device *d);
void device_unlock(leafcast_device *d);

/* device_release() - one user less; without any, it ends. With the lock not held, by the process
 * that made it. */
void device_release(leafcast_device *d);

/* device_clear() - all volumes give their treelets back, if the device has a budget. With the lock
 * held, as the next one. */
void device_clear(leafcast_device *d);

/* device_make_room() - for a treelet of v that may come: the others give theirs back, if need be.
 */
void device_make_room(leafcast *v);

/* device_scratch() - room for all threads, which stays for the next frame. With the lock held. */
CHECKED status device_scratch(leafcast_device *d, size_t bytes);

#endif
