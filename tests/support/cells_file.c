#include "tests/support/cells_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RUN_LOG2 = 12 };

static const uint32_t kinds[] = {LEAF_SECTION_RANGES,  LEAF_SECTION_OWN,   LEAF_SECTION_FLAGS,
                                 LEAF_SECTION_OFFSETS, LEAF_SECTION_SIZES, LEAF_SECTION_CHECKSUMS,
                                 LEAF_SECTION_BOUNDS,  LEAF_SECTION_COUNTS};
enum { SECTIONS = sizeof kinds / sizeof *kinds };

static leaf_header header_of(const cells_input *in) {
    leaf_header h = {.version = LEAF_VERSION,
                     .kind = in->kind,
                     .sample_type = SAMPLE_F32,
                     .source_type = SAMPLE_F32,
                     .levels = 1,
                     .fields = 1,
                     .steps = in->steps,
                     .run_align_log2 = RUN_LOG2,
                     .sections = SECTIONS,
                     .treelets = in->treelets,
                     .value_min = INFINITY,
                     .value_max = -INFINITY};
    memcpy(h.magic, LEAF_MAGIC, sizeof h.magic);
    strncpy(h.name, in->name, sizeof h.name - 1);
    h.to_world[0] = h.to_world[5] = h.to_world[10] = 1.0;
    for (int a = 0; a < 3; a++) {
        h.bounds[a] = INFINITY;
        h.bounds[a + 3] = -INFINITY;
    }
    return h;
}

/* Place sections, then payloads. Returns where these begin. */
static uint64_t place(leaf_header *h, leaf_section table[], uint64_t payload_bytes) {
    uint64_t end = LEAF_HEADER_BYTES + SECTIONS * sizeof *table;
    for (int i = 0; i < SECTIONS; i++) {
        table[i] = (leaf_section){.kind = kinds[i],
                                  .version = 1,
                                  .offset = leaf_layout_aligned(end, LEAF_ALIGN_LOG2),
                                  .bytes = leaf_section_bytes(h, kinds[i])};
        end = table[i].offset + table[i].bytes;
    }
    const uint64_t at = leaf_layout_aligned(end, RUN_LOG2);
    h->payload_bytes = payload_bytes;
    h->file_bytes = leaf_layout_aligned(at + payload_bytes, RUN_LOG2);
    return at;
}

static void widen(float to[6], const float box[6]) {
    for (int a = 0; a < 3; a++) {
        to[a] = fminf(to[a], box[a]);
        to[a + 3] = fmaxf(to[a + 3], box[a + 3]);
    }
}

/* Write entry p of the directory: a treelet at a step. */
static void describe(const leaf_image *i, const leaf_cells *cells, uint32_t p, const char *record,
                     uint32_t count) {
    float(*own)[2] = leaf_image_section(i, LEAF_SECTION_OWN);
    float(*bounds)[6] = leaf_image_section(i, LEAF_SECTION_BOUNDS);
    float(*ranges)[2] = leaf_image_section(i, LEAF_SECTION_RANGES);
    for (uint32_t k = 0; k < count; k++, record += cells->bytes) {
        float box[6], range[2];
        if (cells->measure(record, box, range))
            abort();
        if (k == 0) {
            memcpy(bounds[p], box, sizeof box);
            memcpy(own[p], range, sizeof range);
        }
        widen(bounds[p], box);
        own[p][0] = fminf(own[p][0], range[0]);
        own[p][1] = fmaxf(own[p][1], range[1]);
    }
    memcpy(ranges[p], own[p], sizeof own[p]);
    widen(i->header->bounds, bounds[p]);
    i->header->value_min = fmin(i->header->value_min, (double)own[p][0]);
    i->header->value_max = fmax(i->header->value_max, (double)own[p][1]);
}

/* Write the records of treelet after treelet, step after step, from byte `at` on. */
static void write_payloads(const leaf_image *i, const leaf_cells *cells, const cells_input *in,
                           uint64_t at) {
    uint64_t *offsets = leaf_image_section(i, LEAF_SECTION_OFFSETS);
    uint64_t *sizes = leaf_image_section(i, LEAF_SECTION_SIZES);
    const char *record = in->records;
    for (uint32_t p = 0; p < in->treelets * in->steps; p++) {
        const uint32_t count = in->counts[p % in->treelets];
        if (p % in->treelets == 0)
            at = leaf_layout_aligned(at, RUN_LOG2);
        offsets[p] = at;
        sizes[p] = (uint64_t)count * cells->bytes;
        memcpy(i->bytes + at, record, (size_t)sizes[p]);
        describe(i, cells, p, record, count);
        record += sizes[p];
        at += sizes[p];
    }
}

leaf_image cells_file(const cells_input *in) {
    const leaf_cells *cells = leaf_geometry_of(in->kind)->cells;
    leaf_header h = header_of(in);
    leaf_section table[SECTIONS];
    uint64_t all = 0;
    for (uint32_t t = 0; t < in->treelets; t++)
        all += (uint64_t)in->counts[t] * cells->bytes;
    /* Each step begins a run. */
    const uint64_t step = leaf_layout_aligned(all, RUN_LOG2);
    const uint64_t at = place(&h, table, step * (in->steps - 1) + all);
    h.payload_bytes = all * in->steps;
    char *bytes = calloc(1, (size_t)h.file_bytes);
    if (!bytes)
        abort();
    memcpy(bytes, &h, sizeof h);
    memcpy(bytes + LEAF_HEADER_BYTES, table, sizeof table);
    const leaf_image i = leaf_image_of(bytes, (size_t)h.file_bytes);
    uint32_t(*counts)[4] = leaf_image_section(&i, LEAF_SECTION_COUNTS);
    for (uint32_t t = 0; t < in->treelets; t++)
        counts[t][0] = in->counts[t];
    write_payloads(&i, cells, in, at);
    leaf_image_seal_payloads(&i);
    leaf_image_seal(&i);
    return i;
}
