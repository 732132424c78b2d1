/* leaf_writer.h - write a treelet file: payloads from many threads in any order, then the directory
 * and the header.
 *
 * The same payloads give the same bytes whatever the order and the threads. A grid's raw payloads
 * go straight to their place; compressed ones and a mesh's, whose sizes place them, only where all
 * before them have been put, else first to a scratch file beside the output. The file appears under
 * its name in leaf_writer_finish() alone, header last.
 *
 * Of a mesh: leaf_writer_create_mesh(); of each treelet leaf_writer_put_topology(), then
 * leaf_writer_put_values() of each set, and gradients of each set and positions of each step behind
 * the first if the file is to have them; leaf_writer_finish(). All else is the same.
 */
#ifndef FORMATS_LEAF_LEAF_WRITER_H
#define FORMATS_LEAF_LEAF_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/leaf/histogram.h"
#include "formats/leaf/leaf.h"
#include "formats/leaf/leaf_layout.h"
#include "formats/leaf/leaf_packer.h"

typedef struct leaf_writer leaf_writer;

/* What a treelet brings to the directory. */
typedef struct leaf_entry {
    float own[2]; /* range over its own finite samples; +inf, -inf without any */
    uint8_t flags;
} leaf_entry;

/* What becomes known as the input is read. */
typedef struct leaf_facts {
    uint64_t non_finite;
    double rounding_error;
    const char *provenance; /* without a path or a time; cut if too long */
    /* Of a mesh, as in leaf_header: */
    uint64_t vertices, flat, inverted, repeated, bad;
} leaf_facts;

/* The sets of values of a grid's file: set = field * steps + step. */
typedef struct leaf_sets {
    uint32_t fields, steps;   /* 1 or more; their product up to LEAF_SETS_MAX */
    const char *const *names; /* of all fields; NULL: untold; cut if too long */
    const double *times;      /* of all steps, ascending; NULL: untold */
    const char *time_unit;    /* "s"; cut if too long; NULL: as the grid's frame has it */
} leaf_sets;

/* What a mesh file is to be; of leaf_parameters, cells_log2 and halo do not matter then. */
typedef struct leaf_mesh {
    const char *name, *field; /* of the data set, of the first field; cut if too long */
    const char *const *names; /* of all fields, the first one's being `field`; NULL: untold */
    const double *times;      /* of all steps, ascending; NULL: untold */
    uint32_t treelets;
    uint32_t treelet_tets;  /* at most so many in a treelet: 1 .. LEAF_TREELET_TETS_MAX */
    uint32_t leaf_tets;     /* at most so many in a leaf: 1 .. LEAF_LEAF_TETS_MAX */
    uint32_t fields, steps; /* 1 or more; sets = fields * steps up to LEAF_SETS_MAX */
    bool gradients;         /* each set has them, too */
    bool moving;            /* steps behind the first have positions; steps is 2 or more then */
    bool coarse;            /* sets may have coarse grids: leaf_writer_embed() */
} leaf_mesh;

/* leaf_writer_create() - begin a file at path; ST_EXISTS unless force. g: as the input has it
 * (checked; copied as far as needed). sets: NULL is one, without a name. leaf_writer_discard()
 * removes what was begun; NULL is fine.
 */
CHECKED status leaf_writer_create(mem *m, const char *path, bool force, const grid *g,
                                  const leaf_sets *sets, const leaf_parameters *p,
                                  leaf_writer **out);
void leaf_writer_discard(leaf_writer *w);

/* leaf_writer_create_mesh() - begin the file of a mesh; else the same. ST_UNSUPPORTED when there
 * were 2^32 - 1 payloads or more. */
CHECKED status leaf_writer_create_mesh(mem *m, const char *path, bool force, const leaf_mesh *mesh,
                                       const leaf_parameters *p, leaf_writer **out);

/* leaf_writer_memory() - bytes that a writer of this layout takes from its mem; for planning.
 * leaf_writer_mesh_memory() - of a mesh; payload_max: bytes of its largest payload. */
uint64_t leaf_writer_memory(const leaf_layout *l, leaf_codec codec);
uint64_t leaf_writer_mesh_memory(const leaf_mesh *mesh, size_t payload_max);

/* leaf_writer_pack_bytes() - room that a thread needs beside a payload to put it: 0 for the raw
 * codec. For a mesh: the bytes of the payload, likewise. */
size_t leaf_writer_pack_bytes(const leaf_layout *l, leaf_codec codec);

const leaf_layout *leaf_writer_layout(const leaf_writer *w);

/* leaf_writer_histograms() - the file's, one for each set, to be filled before
 * leaf_writer_settle() and leaf_writer_finish(); NULL where it is to have none, or too many sets.
 * leaf_writer_range() - of the finite values of a set, once all is put; lo > hi: there are none. */
histogram *leaf_writer_histograms(leaf_writer *w);
void leaf_writer_range(const leaf_writer *w, uint32_t set, double range[2]);

/* leaf_writer_deviations() - likewise the codes of a grid's file (deviation_at()), all zero; NULL
 * where it is to have none, or one level. */
uint16_t *leaf_writer_deviations(leaf_writer *w);

/* leaf_writer_put() - treelet t of a grid in a set: its directory entry and its payload,
 * leaf_layout_payload(t).bytes, of which nothing is kept if it is implied. Each exactly once; any
 * thread, with a packer and a pack buffer of its own. */
CHECKED status leaf_writer_put(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                               const leaf_entry *entry, const void *payload, void *pack);

/* leaf_writer_put_implied() - the same of a grid's treelet whose payload is known to be implied
 * (implied_payload.h). */
void leaf_writer_put_implied(leaf_writer *w, uint32_t set, uint32_t t, const leaf_entry *entry);

/* leaf_writer_put_topology() - treelet t of a mesh: its bounds (exact), its counts (without a
 * mesh_leaf_counts_fault()), and its topology, mesh_leaf_shape(counts).topology_bytes.
 * leaf_writer_put_values() - its values in a set, .values_bytes, after its topology; entry->own is
 * the range of its vertices' finite values. leaf_writer_put_gradients() - its gradients in a set,
 * .gradients_bytes, likewise. leaf_writer_put_positions() - its positions at a step behind the
 * first, .positions_bytes, and their bounds. Each exactly once; threads as leaf_writer_put(). */
CHECKED status leaf_writer_put_topology(leaf_writer *w, leaf_packer *k, uint32_t t,
                                        const float bounds[6], const uint32_t counts[4],
                                        const void *payload, void *pack);
CHECKED status leaf_writer_put_values(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                                      const leaf_entry *entry, const void *payload, void *pack);
CHECKED status leaf_writer_put_gradients(leaf_writer *w, leaf_packer *k, uint32_t set, uint32_t t,
                                         const void *payload, void *pack);
CHECKED status leaf_writer_put_positions(leaf_writer *w, leaf_packer *k, uint32_t step, uint32_t t,
                                         const float bounds[6], const void *payload, void *pack);

/* leaf_writer_settle() - all treelets of a mesh are there: what leaf_writer_finish() does, but for
 * publishing; then leaf_writer_path() is a treelet file, open to be read, that has no coarse grids
 * yet. leaf_writer_embed() - the treelet file of a grid as a set's; sets in ascending order, each
 * once; its runs are aligned as this file's. */
CHECKED status leaf_writer_settle(leaf_writer *w, const leaf_facts *facts);
const char *leaf_writer_path(const leaf_writer *w);
CHECKED status leaf_writer_embed(leaf_writer *w, uint32_t set, const char *path);

/* leaf_writer_finish() - all treelets are there: merge ranges, place payloads, write directory and
 * header, publish. Consumes w in any case. header may be NULL; else it becomes the file's. After
 * leaf_writer_settle(), facts are those. */
CHECKED status leaf_writer_finish(leaf_writer *w, const leaf_facts *facts, leaf_header *header);

#endif
