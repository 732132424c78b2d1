/* leaf_writer.h - write a treelet file: payloads from many threads in any order, then the directory
 * and the header.
 *
 * The same payloads give the same bytes whatever the order and the threads. Raw payloads go
 * straight to their place; compressed ones, whose sizes place them, first to a scratch file beside
 * the output. The file appears under its name in leaf_writer_finish() alone, header last.
 */
#ifndef FORMATS_LEAF_WRITER_H
#define FORMATS_LEAF_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid.h"
#include "formats/leaf.h"
#include "formats/leaf_layout.h"

typedef struct leaf_writer leaf_writer;

/* What a file is to be like. */
typedef struct leaf_parameters {
    uint32_t cells_log2;     /* LEAF_CELLS_LOG2_MIN .. MAX; 5 */
    uint32_t halo;           /* 0, 1 */
    uint32_t run_align_log2; /* 12 */
    leaf_codec codec;
    int zstd_level; /* 1 .. ZSTD_maxCLevel() */
} leaf_parameters;

/* leaf_parameters_default() - B = 32, h = 1, runs at 4096, raw. */
leaf_parameters leaf_parameters_default(void);

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
} leaf_facts;

/* leaf_writer_create() - begin a file at path; ST_EXISTS unless force. g: as the input has it
 * (checked; copied as far as needed). leaf_writer_discard() removes what was begun; NULL is fine.
 */
CHECKED status leaf_writer_create(mem *m, const char *path, bool force, const grid *g,
                                  const leaf_parameters *p, leaf_writer **out);
void leaf_writer_discard(leaf_writer *w);

/* leaf_writer_memory() - bytes that a writer of this layout takes from its mem; for planning. */
uint64_t leaf_writer_memory(const leaf_layout *l, leaf_codec codec);

/* leaf_writer_pack_bytes() - room that a thread needs beside a payload to put it: 0 for the raw
 * codec. */
size_t leaf_writer_pack_bytes(const leaf_layout *l, leaf_codec codec);

const leaf_layout *leaf_writer_layout(const leaf_writer *w);

/* What one thread keeps between puts: a compressor, whose state lives outside `mem`; NULL for the
 * raw codec. */
typedef struct leaf_packer leaf_packer;
CHECKED status leaf_packer_create(const leaf_writer *w, leaf_packer **out);
void leaf_packer_destroy(const leaf_writer *w, leaf_packer *k); /* NULL is fine */

/* leaf_packer_memory() - bytes that a packer comes to hold outside `mem`; m lends two payloads'
 * room to find out. */
CHECKED status leaf_packer_memory(mem *m, const leaf_layout *l, const leaf_parameters *p,
                                  uint64_t *out);

/* leaf_writer_put() - treelet t: its directory entry and its payload, leaf_layout_payload(t).bytes.
 * Each treelet exactly once; any thread, with a packer and a pack buffer of its own. */
CHECKED status leaf_writer_put(leaf_writer *w, leaf_packer *k, uint32_t t, const leaf_entry *entry,
                               const void *payload, void *pack);

/* leaf_writer_finish() - all treelets are there: merge ranges, place payloads, write directory and
 * header, publish. Consumes w in any case. header may be NULL; else it becomes the file's. */
CHECKED status leaf_writer_finish(leaf_writer *w, const leaf_facts *facts, leaf_header *header);

#endif
