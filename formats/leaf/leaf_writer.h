/* leaf_writer.h - write a treelet file: payloads from many threads in any order, then the directory
 * and the header.
 *
 * The same payloads give the same bytes whatever the order and the threads. The place of a payload
 * depends on the sizes of those before it in the file (leaf_order.h). Of a grid, families are put
 * together in memory, and written when all before them are. A mesh's payloads go to their place if
 * all before them have been put, else first to a scratch file beside the output. The file appears
 * under its name only in leaf_writer_finish(), header last.
 *
 * Grids: call leaf_writer_create(), then leaf_writer_make_families(),
 * and leaf_writer_take_family() once for each thread. For each family
 * of a set call leaf_family_begin(), leaf_writer_put() or leaf_writer_put_implied() for each
 * treelet by octant, leaf_writer_put_shell() if the layout has shells and it is not the root, and
 * leaf_writer_end_family(). Not for families of levels without samples (leaf_layout.sampled).
 *
 * Meshes: call leaf_writer_create_mesh(). For each treelet call leaf_writer_put_topology(), then
 * leaf_writer_put_values() for each set. If the file is to have them, put gradients of each set and
 * positions of each step behind the first. Then call leaf_writer_finish(). All else is the same.
 *
 * Curvilinear grids: the same with leaf_writer_create_curvilinear(), and positions of step 0 in the
 * place of topologies.
 */
#ifndef FORMATS_LEAF_LEAF_WRITER_H
#define FORMATS_LEAF_LEAF_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/base/work_folder.h"
#include "formats/grid/grid.h"
#include "formats/leaf/histogram.h"
#include "formats/leaf/leaf.h"
#include "formats/leaf/leaf_grow.h"
#include "formats/leaf/leaf_layout.h"
#include "formats/leaf/leaf_order.h"
#include "formats/leaf/leaf_packer.h"

typedef struct leaf_writer leaf_writer;

/* What a treelet adds to the directory. */
typedef struct leaf_entry {
    float own[2]; /* range of its own finite samples; +inf, -inf without any */
    uint8_t flags;
} leaf_entry;

/* Facts that become known as the input is read. */
typedef struct leaf_facts {
    uint64_t non_finite;
    double rounding_error;
    const char *provenance; /* without a path or a time; cut if too long */
    /* Meshes, as in leaf_header: */
    uint64_t vertices, flat, inverted, repeated, bad;
} leaf_facts;

/* The sets of values of a grid's file: set = field * steps + step. */
typedef struct leaf_sets {
    uint32_t fields, steps;   /* 1 or more; their product up to LEAF_SETS_MAX */
    const char *const *names; /* of all fields; NULL: unknown; cut if too long */
    const double *times;      /* of all steps, ascending; NULL: unknown */
    const char *time_unit;    /* "s"; cut if too long; NULL: the grid's own */
} leaf_sets;

/* Contents of a mesh file. It does not use cells_log2 and halo of leaf_parameters. */
typedef struct leaf_mesh {
    const char *name, *field; /* of the data set, of the first field; cut if too long */
    const char *const *names; /* of all fields, the first being `field`; NULL: unknown */
    const double *times;      /* of all steps, ascending; NULL: unknown */
    uint32_t treelets;
    uint32_t treelet_tets;  /* at most so many per treelet: 1 .. LEAF_TREELET_TETS_MAX */
    uint32_t leaf_tets;     /* at most so many per leaf: 1 .. LEAF_LEAF_TETS_MAX */
    uint32_t fields, steps; /* 1 or more; sets = fields * steps up to LEAF_SETS_MAX */
    bool gradients;         /* each set has gradients, too */
    bool moving;            /* steps behind the first have positions; steps is 2 or more then */
    bool coarse;            /* sets may have coarse grids: leaf_writer_embed() */
    uint32_t kind;          /* of a leaf_kind: tets, or one whose cells are listed
                               (listed_geometry.h): leaf_tets 0, no gradients */
} leaf_mesh;

/* Contents of the file of a curvilinear grid. It does not use cells_log2 and halo of
 * leaf_parameters. */
typedef struct leaf_curvilinear {
    const char *name;           /* as of leaf_mesh */
    leaf_sets sets;             /* names may be NULL */
    uint32_t zones;             /* 1 or more */
    const uint32_t (*nodes)[3]; /* of each zone along i, j, k: 2 to CURVILINEAR_NODES_MAX */
    bool moving, coarse;        /* as of leaf_mesh */
} leaf_curvilinear;

/* Where a file comes to be. */
typedef struct leaf_target {
    const char *path;  /* must outlive the writer */
    bool force;        /* replace another */
    work_folder *work; /* the path's own; NULL: nothing is to be gone on with */
    bool grows;        /* steps may be added to it later */
    leaf_grow *grow;   /* `path`, opened: what is written becomes its next segment; or NULL */
} leaf_target;

/* leaf_writer_create() - begin a file; ST_EXISTS unless force. g: the input's grid (checked; copied
 * as far as needed). sets: NULL means one set without a name.
 * leaf_writer_discard() - remove what was begun, unless it is in a work folder; NULL is fine. */
CHECKED status leaf_writer_create(mem *m, const leaf_target *to, const grid *g,
                                  const leaf_sets *sets, const leaf_parameters *p,
                                  leaf_writer **out);
void leaf_writer_discard(leaf_writer *w);

/* leaf_writer_create_mesh() - begin the file of a mesh; else the same. ST_UNSUPPORTED if it would
 * have 2^32 - 1 payloads or more. */
CHECKED status leaf_writer_create_mesh(mem *m, const leaf_target *to, const leaf_mesh *mesh,
                                       const leaf_parameters *p, leaf_writer **out);

/* leaf_writer_create_curvilinear() - begin the file of a curvilinear grid; likewise. */
CHECKED status leaf_writer_create_curvilinear(mem *m, const leaf_target *to,
                                              const leaf_curvilinear *g, const leaf_parameters *p,
                                              leaf_writer **out);

/* leaf_writer_memory() - the bytes that a writer of this layout takes from its mem, with the
 * families of so many threads; for planning. grow: it adds to a file. leaf_writer_mesh_memory() -
 * the same for a mesh; payload_max: bytes of its largest payload. leaf_writer_curvilinear_memory()
 * - the same for a curvilinear grid; ST_UNSUPPORTED as leaf_writer_create_curvilinear(). */
uint64_t leaf_writer_memory(const leaf_layout *l, int threads, bool grow);
uint64_t leaf_writer_mesh_memory(const leaf_mesh *mesh, size_t payload_max, bool grow);
CHECKED status leaf_writer_curvilinear_memory(const leaf_curvilinear *g, bool grow,
                                              uint64_t *bytes);

const leaf_layout *leaf_writer_layout(const leaf_writer *w);

/* leaf_writer_histograms() - the file's histograms, one for each set. Fill them before
 * leaf_writer_settle() and leaf_writer_finish(). NULL where it is to have none, or too many sets.
 * leaf_writer_range() - the range of a set's finite values, once all payloads are put; lo > hi:
 * there are none. */
histogram *leaf_writer_histograms(leaf_writer *w);
void leaf_writer_range(const leaf_writer *w, uint32_t set, double range[2]);

/* leaf_writer_deviations() - likewise the codes of a grid's file (deviation_at()), at first all
 * zero. NULL where it is to have none, or has one level. */
uint16_t *leaf_writer_deviations(leaf_writer *w);

/* leaf_family - the payloads of a family, which one thread puts together. */
typedef struct leaf_family leaf_family;

/* leaf_writer_make_families() - make room for those of so many threads, which belongs to the
 * writer. leaf_writer_take_family() - an empty one for a thread; once each, before any begins one.
 * leaf_family_begin() - begin family `index` of a slab of a set: each once. Other threads
 * must have begun, or be about to begin, all families of the set before it; then none waits
 * forever.
 * leaf_writer_end_family() - write it, or leave it to the thread that writes those before it. It
 * may wait for that. *f: in, out: an empty one to go on with.
 * leaf_writer_give_up() - a family that was begun will not be ended, as something failed: nobody
 * waits from now on, and nothing is written. */
CHECKED status leaf_writer_make_families(leaf_writer *w, int threads);
leaf_family *leaf_writer_take_family(leaf_writer *w);
void leaf_family_begin(leaf_family *f, uint32_t set, const leaf_slab *slab, uint32_t index);
CHECKED status leaf_writer_end_family(leaf_writer *w, leaf_family **f);
void leaf_writer_give_up(leaf_writer *w);

/* leaf_family_room() - where the next payload may be made, if the codec is raw: leaf_writer_put()
 * then copies nothing. leaf_family_is_implied() - whether all that was put so far was implied. */
void *leaf_family_room(const leaf_family *f);
bool leaf_family_is_implied(const leaf_family *f);

/* leaf_writer_put() - put treelet t: its directory entry and its payload of
 * leaf_layout_payload(t).bytes. An implied payload takes no bytes of the file, nor does one that an
 * earlier set has. Those are read back to see that, so sets must be put one after the other. k: a
 * packer of the thread's own; NULL for the raw codec.
 * leaf_writer_put_implied() - the same for a treelet whose payload is known to be implied
 * (implied_payload.h). */
CHECKED status leaf_writer_put(leaf_writer *w, leaf_family *f, leaf_packer *k, uint32_t t,
                               const leaf_entry *entry, const void *payload);
void leaf_writer_put_implied(leaf_writer *w, leaf_family *f, uint32_t t, const leaf_entry *entry);

/* leaf_writer_put_shell() - put what the children of a treelet share (grid_family.h), behind them.
 * samples: NULL, and only then, if there is one child, or all are implied. */
CHECKED status leaf_writer_put_shell(leaf_writer *w, leaf_family *f, leaf_packer *k,
                                     uint32_t parent, const void *samples);

/* leaf_writer_put_topology() - put treelet t of a mesh: its bounds (exact), its counts (without a
 * mesh_leaf_counts_fault(), or its kind's), and its topology. Sizes follow from the
 * counts: mesh_leaf_shape(), mixed_shape_of(), triangle_shape_of().
 * leaf_writer_keep_topology() - instead, where a file is added to: it is the one that the file has.
 * leaf_writer_put_values() - its values in a set, .values_bytes, after its topology; entry->own:
 * the range of its vertices' finite values.
 * leaf_writer_put_gradients() - its gradients in a set, .gradients_bytes, likewise.
 * leaf_writer_put_positions() - its positions at a step behind the first, .positions_bytes, and
 * their bounds. Of a curvilinear grid: also those at the first, before its values; sizes follow
 * from its zones (curvilinear_geometry.h). Put each exactly once; threads as for leaf_writer_put().
 */
CHECKED status leaf_writer_put_topology(leaf_writer *w, leaf_packer *k, uint32_t t,
                                        const float bounds[6], const uint32_t counts[4],
                                        const void *payload, void *pack);
void leaf_writer_keep_topology(leaf_writer *w, uint32_t t);
CHECKED status leaf_writer_put_values(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                                      const leaf_entry *entry, const void *payload, void *pack);
CHECKED status leaf_writer_put_gradients(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                                         const void *payload, void *pack);
CHECKED status leaf_writer_put_positions(leaf_writer *w, leaf_packer *k, uint32_t step, uint32_t t,
                                         const float bounds[6], const void *payload, void *pack);

/* leaf_writer_keep() - save or load what was put, which is on the disk by then. No family may have
 * begun, and no payload of a mesh may be on its way. What loads is new, for the same input and
 * parameters. What the files hold beyond that is cut off.
 * leaf_writer_files() - the files of its work, for work_folder_save(). */
CHECKED status leaf_writer_keep(leaf_writer *w, state_io *io);
void leaf_writer_files(const leaf_writer *w, out_file *files[WORK_FILES]);

/* leaf_writer_stop_by() - ask p now and then whether to go on while a mesh is finished; kept by
 * reference. */
void leaf_writer_stop_by(leaf_writer *w, const progress *p);

/* leaf_writer_settle() - call it when all treelets of a mesh or curvilinear grid are put. Does what
 * leaf_writer_finish() does, except publishing. Then leaf_writer_path() is a treelet file without
 * coarse grids, which may be opened and read.
 * leaf_writer_embed() - add the treelet file of a grid as a set's coarse grid. Sets in ascending
 * order, each once; its runs must be aligned like this file's. */
CHECKED status leaf_writer_settle(leaf_writer *w, const leaf_facts *facts);
const char *leaf_writer_path(const leaf_writer *w);
CHECKED status leaf_writer_embed(leaf_writer *w, uint32_t set, const char *path);

/* leaf_writer_finish() - call it when all treelets are put: merge ranges, place payloads, write
 * directory and header, publish. Consumes w in any case. header: out, the file's; may be NULL.
 * After leaf_writer_settle(), its facts hold, and these are not used. */
CHECKED status leaf_writer_finish(leaf_writer *w, const leaf_facts *facts, leaf_header *header);

#endif
