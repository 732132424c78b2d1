/* mesh_gather.h - collects a mesh while it is read: everything that a reader hands over.
 *
 * It is held in memory up to a ceiling. Then tets go to a scratch file first, and points and values
 * if that is not enough.
 *
 * A series is read step after step, each with all its fields. Call mesh_gather_next() before each
 * step but the first. Tets are kept of the first step. Later steps must have the same ones, one by
 * one. Points are kept from the first step that moves one; if none moves, they are kept once.
 */
#ifndef PREP_MESH_MESH_GATHER_H
#define PREP_MESH_MESH_GATHER_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/progress.h"
#include "formats/mesh/mesh_input.h"
#include "prep/mesh/mesh_spool.h"

typedef struct mesh_gather {
    mesh_spool points, values, tets; /* float[3], float, uint32_t[corners]; of all steps and fields,
                                        see mesh_gather_points(), mesh_gather_values() */
    mesh_spool normals;              /* of a surface's vertices: uint32_t, see
                                        mesh_gather_normals(); empty: it has none */
    bool takes_normals;              /* those of the file; set before the first reading */
    uint32_t corners;                /* of a cell: 4, or mesh_gather_cells() */
    uint64_t vertices;               /* points of the mesh */
    uint32_t fields, steps;          /* 1 unless set before the first reading */
    bool moving;                     /* points move between steps */
    float bounds[6];                 /* of the first step's points: lo x y z, hi x y z */
    uint64_t non_finite;             /* values that are NaN or inf */
    bool counted;                    /* nothing is kept: only sizes are counted */
    const progress *p;
    double share;  /* of the job, when reading ends; 1 unless set before */
    uint32_t done; /* steps that were read whole, of those that mesh_gather_done() was told of */
    /* The current reading: */
    mesh_input *reading;
    uint32_t step;
    const char *name, *first_name; /* name of its file, and of the first step's; for messages */
    uint64_t points_seen, values_seen, tets_seen, normals_seen;
} mesh_gather;

/* mesh_gather_init() - ceiling: on the bytes that m has in use; 0: none. beside: path beside which
 * scratch files may lie; kept by reference. p may be NULL. */
void mesh_gather_init(mesh_gather *g, mem *m, const char *beside, size_t ceiling,
                      const progress *p);
void mesh_gather_release(mesh_gather *g); /* a zeroed struct is fine */

/* mesh_gather_cells() - gather cells of so many corners in the place of tets: of all shapes, as
 * they are (CELL_ROW; mesh_sink.cells), or triangles (3). Call it before anything is gathered.
 * mesh_gather_keeps() - whether cells are too wide for a record (mesh_sort.h), and are looked up
 * once they are sorted. */
void mesh_gather_cells(mesh_gather *g, uint32_t corners);
static inline bool mesh_gather_keeps(const mesh_gather *g) {
    return g->corners > 4;
}

/* For another run, between two steps. mesh_gather_keep_in() - keep scratch files in this folder;
 * call it before anything is gathered. mesh_gather_store() - write what is in memory alone to them.
 * mesh_gather_unstore() - empty those again that were made for this, which no state needs.
 * mesh_gather_files() - these files. mesh_gather_keep() - save or load. Fields and steps must be
 * set. ST_CORRUPT: what loads cannot be of such a mesh. */
void mesh_gather_keep_in(mesh_gather *g, work_folder *work);
CHECKED status mesh_gather_store(mesh_gather *g);
void mesh_gather_unstore(mesh_gather *g);
void mesh_gather_files(const mesh_gather *g, out_file *files[WORK_FILES]);
CHECKED status mesh_gather_keep(mesh_gather *g, state_io *io);

/* mesh_gather_least() - least bytes that it takes for so many fields, including those of a
 * mesh_feed. */
size_t mesh_gather_least(const mesh_gather *g, uint32_t fields);

/* mesh_gather_sink() - the sink for mesh_input_read(). */
mesh_sink mesh_gather_sink(mesh_gather *g);

/* mesh_gather_counter() - returns a sink that counts and stores nothing, for a plan. It sets
 * `count` and the number of chunks of the spools as if everything were stored. */
mesh_sink mesh_gather_counter(mesh_gather *g);

/* mesh_gather_next() - begin a step, read from the file `name` (kept by reference).
 * mesh_gather_done() - end it. ST_CORRUPT: there are not as many points, values and tets as in the
 * first step. */
void mesh_gather_next(mesh_gather *g, uint32_t step, const char *name);
CHECKED status mesh_gather_done(mesh_gather *g);

/* mesh_gather_read() - call mesh_input_read() with a sink of g, and report the progress of the
 * whole series. */
CHECKED status mesh_gather_read(mesh_gather *g, mesh_input *x, const mesh_sink *sink,
                                mesh_report *report);

/* First element of a step in `points`; of a field at a step in `values`. */
static inline uint64_t mesh_gather_points(const mesh_gather *g, uint32_t step) {
    return g->moving ? step * g->vertices : 0;
}
static inline uint64_t mesh_gather_values(const mesh_gather *g, uint32_t step, uint32_t of_field) {
    return ((uint64_t)step * g->fields + of_field) * g->vertices;
}
/* Of a step in `normals`: those of the file are kept at each step, those that are made where points
 * move. */
static inline uint64_t mesh_gather_normals(const mesh_gather *g, uint32_t step) {
    return g->moving ? step * g->vertices : 0;
}

#endif
