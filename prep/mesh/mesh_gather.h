/* mesh_gather.h - a mesh on its way in: everything a reader hands over, kept for what comes next.
 *
 * In memory up to a ceiling; then tets go to a scratch file first, and points and values when that
 * is not enough.
 *
 * A series is read step after step, each with all its fields: mesh_gather_next() before each but
 * the first. Tets are those of the first step; they must come again, one by one the same. Points
 * are kept from the first step that moves one on; where none moves, but once.
 */
#ifndef PREP_MESH_MESH_GATHER_H
#define PREP_MESH_MESH_GATHER_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/progress.h"
#include "formats/mesh/mesh_input.h"
#include "prep/mesh/mesh_spool.h"

typedef struct mesh_gather {
    mesh_spool points, values, tets; /* float[3], float, uint32_t[4]; of all steps and fields: see
                                        mesh_gather_points(), mesh_gather_values() */
    uint64_t vertices;               /* points of the mesh */
    uint32_t fields, steps;          /* 1 unless set before the first is read */
    bool moving;                     /* points have other places at other steps */
    float bounds[6];                 /* of the first step's points: lo x y z, hi x y z */
    uint64_t non_finite;             /* values that are NaN or inf */
    bool counted;                    /* nothing is kept, but how much there would be */
    const progress *p;
    double share; /* of the job, at the end of reading; 1 unless set before */
    /* What is being read: */
    mesh_input *reading;
    uint32_t step;
    const char *name, *first_name; /* of its file, of the first step's; for messages */
    uint64_t points_seen, values_seen, tets_seen;
} mesh_gather;

/* mesh_gather_init() - ceiling: of what m has in use; 0: none. beside: the path beside which
 * scratch files may be, kept by reference; p may be NULL. */
void mesh_gather_init(mesh_gather *g, mem *m, const char *beside, size_t ceiling,
                      const progress *p);
void mesh_gather_release(mesh_gather *g); /* zeroed is fine */

/* mesh_gather_least() - bytes that it takes at least, with what a mesh_feed takes of them. */
size_t mesh_gather_least(uint32_t fields);

/* mesh_gather_sink() - what to give to mesh_input_read(). */
mesh_sink mesh_gather_sink(mesh_gather *g);

/* mesh_gather_counter() - the same, to count what would come: for a plan alone. Of the spools,
 * `count` and the number of chunks are as if all were held. */
mesh_sink mesh_gather_counter(mesh_gather *g);

/* mesh_gather_next() - what comes next is this step, of the file `name` (kept by reference).
 * mesh_gather_done() - it has all come: as many points, values and tets as the first time, else
 * ST_CORRUPT. */
void mesh_gather_next(mesh_gather *g, uint32_t step, const char *name);
CHECKED status mesh_gather_done(const mesh_gather *g);

/* mesh_gather_read() - mesh_input_read() to a sink of g, with the progress of the whole series. */
CHECKED status mesh_gather_read(mesh_gather *g, mesh_input *x, const mesh_sink *sink,
                                mesh_report *report);

/* The first element of a step in `points`, of a field at a step in `values`. */
static inline uint64_t mesh_gather_points(const mesh_gather *g, uint32_t step) {
    return g->moving ? step * g->vertices : 0;
}
static inline uint64_t mesh_gather_values(const mesh_gather *g, uint32_t step, uint32_t of_field) {
    return ((uint64_t)step * g->fields + of_field) * g->vertices;
}

#endif
