/* leafcast_turn.h - a scene whose turn it is on its device: behind the frames, and the rays, of
 * leafcast.h.
 *
 * Frames are drawn in turns. Before each the volumes are told what the frame shows, and the budget
 * is shared out anew: others may have had their turn in between. The device's lock is held
 * throughout.
 */
#ifndef RENDER_DOOR_LEAFCAST_TURN_H
#define RENDER_DOOR_LEAFCAST_TURN_H

#include "render/door/leafcast_device.h"
#include "render/door/leafcast_scene.h"
#include "render/frame/frame.h"

typedef struct turn {
    leafcast_device *device;
    double above;         /* of tracers */
    leafcast_scene scene; /* its experiments, and its volumes, are: */
    leafcast_scene_experiments experiments;
    int volumes;
    leafcast_shown shown[LEAFCAST_VOLUMES_MAX];
    leafcast_surface surfaces[LEAFCAST_VOLUMES_MAX][LEAFCAST_SURFACES_MAX];
    int32_t first_id[LEAFCAST_VOLUMES_MAX]; /* of a volume's surfaces, numbered through */
    interest beside[LEAFCAST_VOLUMES_MAX];  /* values that matter beside those of surfaces */
    leafcast *drawn[LEAFCAST_VOLUMES_MAX];  /* the volume, or in a preview its coarse grid */
    tracer tracers[LEAFCAST_VOLUMES_MAX];   /* of that */
    const tracer
        *coarse[LEAFCAST_VOLUMES_MAX]; /* what a preview draws where treelets are absent, */
    tracer coarse_tracers[LEAFCAST_VOLUMES_MAX]; /* one of these; or NULL */
    frame f;
    size_t reserved; /* of the device's frames_bytes */
    bool begun;      /* this is not the first turn */
} turn;

/* turn_describe() - *t anew, and of t->f all but what is drawn: look, integrator, camera, image and
 * size are the caller's to set. Nothing of volumes changes, but that coarse grids are opened. */
CHECKED status turn_describe(turn *t, leafcast *v, const leafcast_scene *scene);

/* turn_is_instead() - whether a volume's coarse grid is drawn in its place. turn_any_instead() - of
 * any volume. */
static inline bool turn_is_instead(const turn *t, int i) {
    return t->drawn[i] != t->shown[i].volume;
}
bool turn_any_instead(const turn *t);

/* turn_prepare() - the volumes show what this frame does, and have their share of the budget. */
CHECKED status turn_prepare(turn *t);

/* turn_check() - what else decides how a turn ends: sweeps and coarse grids without trouble, files
 * as they were. */
CHECKED status turn_check(const turn *t, bool done, status st);

/* turn_stats() - of the volumes and the device. */
void turn_stats(const turn *t, leafcast_stats *stats);

/* turn_end() - after the last one, also of a turn_describe() that failed: the budget is the
 * others'. */
void turn_end(turn *t);

/* ---- leafcast_budget.c ---- */

/* budget_check() - ST_NOMEM if there is no room for one treelet of each volume beside the frame. */
CHECKED status budget_check(const turn *t);

/* budget_share() - the same; then the rest is records of suspended rays (a quarter, or what one
 * treelet leaves) and treelets. */
CHECKED status budget_share(turn *t);

/* budget_scratch() - what all threads draw in. budget_image() - an image's planes of so many
 * pixels.
 */
size_t budget_scratch(const frame *f);
size_t budget_image(const leafcast_image *image, size_t pixels);

/* budget_slots() - so many bytes for a volume's treelets; SIZE_MAX: as many as it has. */
void budget_slots(leafcast *v, size_t bytes);

static inline size_t frame_pixels(const frame *f) {
    return (size_t)f->width * f->height;
}

#endif
