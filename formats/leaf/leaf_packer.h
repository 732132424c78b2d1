/* leaf_packer.h - the parameters of a treelet file, and the compression of payloads that they ask
 * for. */
#ifndef FORMATS_LEAF_LEAF_PACKER_H
#define FORMATS_LEAF_LEAF_PACKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_coder.h"
#include "formats/leaf/leaf_layout.h"

/* Parameters of a file. */
typedef struct leaf_parameters {
    uint32_t cells_log2;     /* LEAF_CELLS_LOG2_MIN .. MAX; default 5 */
    uint32_t halo;           /* 0, 1; default 1 */
    uint32_t run_align_log2; /* default 12 */
    leaf_codec codec;
    int zstd_level;              /* 1 .. ZSTD_maxCLevel() */
    bool histograms;             /* one for each set: leaf_writer_histograms() */
    const leaf_outside *outside; /* samples of level 0 stay in that file (outside_samples.h), which
                                    must outlive the writer; compressed, one set; NULL: in none */
    const struct chunk_entry *chunks; /* of `outside`, if it has a table of them; likewise */
    uint32_t chunk_count;
    const struct slice_file *slices; /* of `outside`, if they lie in a file a slice; likewise */
    bool deviations;                 /* of a grid's coarse levels: leaf_writer_deviations() */
    bool bare;                       /* a grid's levels above 0 get no samples */
} leaf_parameters;

/* leaf_parameters_default() - B = 32, h = 1, runs at 4096, raw, no histograms, no deviations. */
leaf_parameters leaf_parameters_default(void);

/* leaf_parameters_compress() - compress by zstd at a level. Runs are small then, and need no pages
 * of their own: they begin at multiples of 64. */
void leaf_parameters_compress(leaf_parameters *p, int level);

/* What one thread keeps between payloads: a compressor, whose state lives outside `mem`. NULL for
 * the raw codec. */
typedef struct leaf_packer leaf_packer;

/* leaf_packer_create() - for payloads of this layout. coder: of a kind that has one, NULL for a
 * grid. counts: the most of a treelet, for a coder. */
CHECKED status leaf_packer_create(mem *m, const leaf_layout *l, const leaf_coder *coder,
                                  const uint32_t counts[4], const leaf_parameters *p,
                                  leaf_packer **out);
void leaf_packer_destroy(mem *m, leaf_packer *k); /* NULL is fine */

/* leaf_packer_memory() - the bytes that a packer will hold, also outside `mem`. To find out, it
 * makes one, and room for two payloads, for a while. l: may be NULL with a coder. */
CHECKED status leaf_packer_memory(mem *m, const leaf_layout *l, const leaf_coder *coder,
                                  const uint32_t counts[4], const leaf_parameters *p,
                                  uint64_t *out);

/* leaf_packer_pack() - compress payload p of a grid (grid_coding.h) into pack, of
 * leaf_layout_stored_max() bytes. Returns its bytes. leaf_packer_boxes() - its coder.
 * leaf_packer_pack_streams() - the same by a coder (stream_coding.h), where that makes it smaller,
 * into pack, of as many bytes as it has. *stored: out, the result or the payload itself. */
size_t leaf_packer_pack(leaf_packer *k, uint32_t p, const void *payload, void *pack);
struct box_coder *leaf_packer_boxes(leaf_packer *k);
size_t leaf_packer_pack_streams(leaf_packer *k, leaf_block block, const uint32_t counts[4],
                                const float bounds[6], const void *payload, void *pack,
                                const void **stored);

#endif
