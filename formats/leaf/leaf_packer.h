/* leaf_packer.h - the parameters of a treelet file, and the compression of payloads that they ask
 * for. */
#ifndef FORMATS_LEAF_LEAF_PACKER_H
#define FORMATS_LEAF_LEAF_PACKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf.h"

/* Parameters of a file. */
typedef struct leaf_parameters {
    uint32_t cells_log2;     /* LEAF_CELLS_LOG2_MIN .. MAX; default 5 */
    uint32_t halo;           /* 0, 1; default 1 */
    uint32_t run_align_log2; /* default 12 */
    leaf_codec codec;
    int zstd_level;  /* 1 .. ZSTD_maxCLevel() */
    bool histograms; /* one for each set: leaf_writer_histograms() */
    bool deviations; /* of a grid's coarse levels: leaf_writer_deviations() */
} leaf_parameters;

/* leaf_parameters_default() - B = 32, h = 1, runs at 4096, raw, no histograms, no deviations. */
leaf_parameters leaf_parameters_default(void);

/* What one thread keeps between payloads: a compressor, whose state lives outside `mem`. NULL for
 * the raw codec. */
typedef struct leaf_packer leaf_packer;
CHECKED status leaf_packer_create(mem *m, const leaf_parameters *p, leaf_packer **out);
void leaf_packer_destroy(mem *m, leaf_packer *k); /* NULL is fine */

/* leaf_packer_memory() - the bytes that a packer will hold outside `mem` for payloads of up to
 * payload_max bytes. To find out, it takes room for two payloads from m for a while. */
CHECKED status leaf_packer_memory(mem *m, size_t payload_max, const leaf_parameters *p,
                                  uint64_t *out);

/* leaf_packer_pack() - compress a payload where that makes it smaller, into pack, a buffer of as
 * many bytes. *stored: out, the result or the payload itself. Returns its bytes. */
size_t leaf_packer_pack(leaf_packer *k, const void *payload, size_t bytes, void *pack,
                        const void **stored);

#endif
