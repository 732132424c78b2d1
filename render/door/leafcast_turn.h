/* leafcast_turn.h - a scene that has its turn on its device: behind the frames, and the rays, of
 * leafcast.h.
 *
 * Frames are drawn in turns. Each turn first selects the frame's interest in its volumes and shares
 * the budget out anew, since other frames may have had a turn in between. The device's lock is held
 * throughout.
 */
#ifndef RENDER_DOOR_LEAFCAST_TURN_H
#define RENDER_DOOR_LEAFCAST_TURN_H

#include "render/door/leafcast_device.h"
#include "render/door/leafcast_scene.h"
#include "render/door/live_steps.h"
#include "render/door/scene_groups.h"
#include "render/frame/frame.h"

typedef struct turn {
    leafcast_device *device;
    double above;         /* tracer.above of all tracers */
    leafcast_scene scene; /* its experiments and volumes are copied below: */
    leafcast_scene_experiments experiments;
    scene_groups groups;   /* placed often; their volumes are among these: */
    int volumes;           /* objects, */
    int lookups;           /* and volumes by which they are coloured, behind them: of each */
    leafcast **of;         /* its volume as the scene lists it, and in its place: */
    leafcast_shown *shown; /* without `place` */
    int *by;               /* the lookup that colours the object; -1: none does */
    int *first;            /* the first object of the same volume, perhaps this one, */
    int *next;             /* and the next one; -1: there is none */
    live_hold *holds;      /* of live volumes, from first to last */
    leafcast_surface (*surfaces)[LEAFCAST_SURFACES_MAX];
    double (*isovalues)[LEAFCAST_SURFACES_MAX]; /* the same */
    placement *place;
    int32_t *first_id;      /* its surfaces have ids from here on */
    interest *beside;       /* the interest beside isovalues */
    leafcast **drawn;       /* the volume, or in a preview its coarse grid */
    tracer *tracers;        /* of drawn[i] */
    const tracer **coarse;  /* where a preview's treelets are absent: */
    tracer *coarse_tracers; /* one of these; or NULL */
    /* In a preview of isosurfaces: the level that is drawn, at least the one that is asked for. */
    uint32_t *level;
    bool *reads_on; /* in such a preview: more than it needs is read meanwhile */
    object_tree objects;
    frame f;
    bool coarser;    /* a volume is drawn coarser than asked for */
    size_t reserved; /* this frame's part of the device's frames_bytes */
    bool begun;      /* this is not the first turn */
} turn;

/* turn_is_first() - whether no object before i is of the same volume. turn_shows() - whether any
 * object is of v. */
static inline bool turn_is_first(const turn *t, int i) {
    return t->first[i] == i;
}
bool turn_shows(const turn *t, const leafcast *v);

/* turn_grouped() - whether i is a volume of a group: many objects. */
static inline bool turn_grouped(const turn *t, int i) {
    return i >= t->groups.singles && i < t->volumes;
}

/* turn_all() - how many objects and lookups there are. turn_is_lookup() - whether i is a lookup. */
static inline int turn_all(const turn *t) {
    return t->volumes + t->lookups;
}
static inline bool turn_is_lookup(const turn *t, int i) {
    return i >= t->volumes;
}

/* turn_describe() - set *t up from a scene. coloured: also what colours surfaces by other volumes.
 * The caller sets the look, integrator, camera, image and size of t->f. Changes nothing in the
 * volumes, except that it may open coarse grids. */
CHECKED status turn_describe(turn *t, leafcast *v, const leafcast_scene *scene, bool coloured);

/* turn_is_instead() - returns whether volume i's coarse grid is drawn in its place.
 * turn_any_instead() - returns whether that is so for any volume. */
static inline bool turn_is_instead(const turn *t, int i) {
    return t->drawn[i] != t->shown[i].volume;
}
bool turn_any_instead(const turn *t);

/* turn_is_provisional() - returns whether every pixel is provisional: a coarse grid or a coarser
 * level is drawn in a volume's place. */
static inline bool turn_is_provisional(const turn *t) {
    return t->coarser || turn_any_instead(t);
}

/* turn_prepare() - begin a turn: select this frame's interest in its volumes, share the budget, and
 * begin loading. */
CHECKED status turn_prepare(turn *t);

/* turn_check() - returns how a turn ends: `st`, or what failed in a sweep or a coarse grid, or
 * ST_CORRUPT where a file has changed. */
CHECKED status turn_check(const turn *t, bool done, status st);

/* turn_read_on() - call when a frame is done, behind turn_stats(). Behind the first preview of a
 * selection, read for the next one what is left of its bytes; and what is expected of another set.
 * Steps and times between them belong to two volumes: without a memory budget, of which only those
 * that are shown have a share, also what is expected of the other one. Waits for nothing. */
void turn_read_on(const turn *t);

/* turn_stats() - add the figures of the volumes and the device. */
void turn_stats(const turn *t, leafcast_stats *stats);

/* turn_end() - call after the last turn, also after a turn_describe() that failed. Gives the
 * frame's part of the budget back. */
void turn_end(turn *t);

/* ---- leafcast_budget.c ---- */

/* budget_check() - ST_NOMEM if the budget cannot hold the frame and one treelet of each volume. */
CHECKED status budget_check(const turn *t);

/* budget_share() - check that, too. Then share the rest out to records of suspended rays (a quarter
 * of it, or what one treelet of each volume leaves) and to treelets. */
CHECKED status budget_share(turn *t);

/* budget_scratch() - bytes of scratch of all threads. budget_image() - bytes of an image's planes
 * with that many pixels. */
size_t budget_scratch(const frame *f);
size_t budget_image(const leafcast_image *image, size_t pixels);

/* budget_enough() - returns a budget that does where `needed` bytes are, under the present one:
 * what loaders take besides treelets may grow with it. */
size_t budget_enough(const leafcast_device *d, size_t needed);

/* budget_slots() - allow `bytes` for a volume's treelets; SIZE_MAX: enough for all of them. */
void budget_slots(leafcast *v, size_t bytes);

static inline size_t frame_pixels(const frame *f) {
    return (size_t)f->width * f->height;
}

#endif
