/* leafcast_device.h - what open volumes share: threads, memory, kernels.
 *
 * Calls on one device take turns: a call that uses treelets holds the device's lock. All memory
 * comes out of one budget. It holds the base (volumes without their treelets), the most that begun
 * frames may need, and treelets in the rest.
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
    const char *isa_name;             /* as the caller named it */
    const struct walk_choice *choice; /* an experiment's, or NULL */
    pid_t process;                    /* made the device, and has its threads */
    pthread_mutex_t lock;
    /* Guarded by lock: */
    leafcast *volumes;    /* open on this device, linked by `next` */
    int users;            /* the volumes, and the caller that made it */
    size_t base_bytes;    /* of the budget: volumes without treelets */
    size_t frames_bytes;  /* ... the most that begun frames may need */
    size_t beside;        /* ... the caller's own: leafcast_check_room() */
    void *scratch;        /* of all threads, for the frame that has its turn */
    size_t scratch_bytes; /* counted in frames_bytes */
};

/* device_is_here() - returns whether this process made the device. In a child of fork() a device
 * has no threads, and its lock may be held for ever. */
static inline bool device_is_here(const leafcast_device *d) {
    return d->process == getpid();
}

void device_lock(leafcast_device *d);
void device_unlock(leafcast_device *d);

/* device_release() - drop one user; the last one destroys the device. Call it without the lock, in
 * the process that made the device. */
void device_release(leafcast_device *d);

/* device_clear() - evict the treelets of all volumes, if the device has a budget. Needs the lock,
 * as does device_make_room(). */
void device_clear(leafcast_device *d);

/* device_make_room() - make room for one treelet of v: evict all volumes' treelets if need be. */
void device_make_room(leafcast *v);

/* device_scratch() - allocate scratch for all threads; the next frame reuses it. Needs the lock.
 * device_drop_scratch() - free it; false: there was none. */
CHECKED status device_scratch(leafcast_device *d, size_t bytes);
bool device_drop_scratch(leafcast_device *d);

#endif
