/* laboratory.h - what experiments add to pictures (render/experiments), as a table.
 *
 * Our own programs link it, by LINK_EXPERIMENTS (experiments/experiments.h). The library for
 * others is linked without: there the table has no address, and who asks for an experiment is
 * refused.
 */
#ifndef RENDER_FRAME_LABORATORY_H
#define RENDER_FRAME_LABORATORY_H

#include "render/frame/frame.h"
#include "render/leafcast.h"
#include "render/leafcast_experimental.h"

struct transfer;
struct walk_choice;

/* A medium to be drawn in steps: of one volume, without surfaces. */
typedef struct laboratory_medium {
    const struct transfer *transfer;
    const double *range; /* [2], of the values that are drawn */
    double cell_size;    /* of the volume */
} laboratory_medium;

typedef struct laboratory {
    /* The walk that leafcast_options.isa names; NULL: none. */
    const struct walk_choice *(*walk_named)(const char *name);
    /* The walk through grids with an approximate intersector (leafcast_scene_experiments). */
    const struct walk_choice *(*walk_by)(leafcast_intersector how);
    /* Set what is made of treelets that are read (leafcast_experiments.isopolygons). */
    void (*load)(const leafcast *v, loader_options *o);
    /* Trace the tiles of a volume that was just opened in packets (leafcast_experiments.packets).
     */
    status (*use_packets)(leafcast *v);
    /* Draw a medium as scene->experiments->summing says: set f's integrator and its look, *look,
     * which is made in f->m. end_steps(): free a look, also after an error; NULL is fine. */
    status (*begin_steps)(frame *f, const leafcast_scene *scene, const laboratory_medium *medium,
                          void **look);
    void (*end_steps)(mem *m, void *look);
} laboratory;

extern const laboratory laboratory_table __attribute__((weak, visibility("hidden")));

/* laboratory_find() - the table; NULL: this program has none. */
static inline const laboratory *laboratory_find(void) {
    return &laboratory_table;
}

/* laboratory_needed() - the table in *out. ST_USAGE: this program has none. */
CHECKED status laboratory_needed(const laboratory **out);

#endif
