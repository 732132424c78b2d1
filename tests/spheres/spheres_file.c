#include "tests/spheres/spheres_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_check.h"

enum { RUN_LOG2 = 12 };

static const uint32_t kinds[] = {LEAF_SECTION_RANGES,  LEAF_SECTION_OWN,   LEAF_SECTION_FLAGS,
                                 LEAF_SECTION_OFFSETS, LEAF_SECTION_SIZES, LEAF_SECTION_CHECKSUMS,
                                 LEAF_SECTION_BOUNDS,  LEAF_SECTION_COUNTS};
enum { SECTIONS = sizeof kinds / sizeof *kinds };

static leaf_header header_of(uint32_t treelets) {
    leaf_header h = {.version = 1,
                     .kind = SPHERES_KIND,
                     .sample_type = SAMPLE_F32,
                     .source_type = SAMPLE_F32,
                     .levels = 1,
                     .fields = 1,
                     .steps = 1,
                     .run_align_log2 = RUN_LOG2,
                     .sections = SECTIONS,
                     .treelets = treelets,
                     .value_min = INFINITY,
                     .value_max = -INFINITY,
                     .name = "spheres"};
    memcpy(h.magic, LEAF_MAGIC, sizeof h.magic);
    h.to_world[0] = h.to_world[5] = h.to_world[10] = 1.0;
    for (int a = 0; a < 3; a++) {
        h.bounds[a] = INFINITY;
        h.bounds[a + 3] = -INFINITY;
    }
    return h;
}

/* Sections, then payloads; the file's length. */
static uint64_t place(leaf_header *h, leaf_section table[], uint64_t payload_bytes) {
    uint64_t end = LEAF_HEADER_BYTES + SECTIONS * sizeof *table;
    for (int i = 0; i < SECTIONS; i++) {
        table[i] = (leaf_section){.kind = kinds[i],
                                  .version = 1,
                                  .offset = leaf_layout_aligned(end, LEAF_ALIGN_LOG2),
                                  .bytes = leaf_section_bytes(h, kinds[i])};
        end = table[i].offset + table[i].bytes;
    }
    h->payload_bytes = payload_bytes;
    h->file_bytes =
        leaf_layout_aligned(leaf_layout_aligned(end, RUN_LOG2) + payload_bytes, RUN_LOG2);
    return leaf_layout_aligned(end, RUN_LOG2);
}

/* A float beyond x: rounding never brings a ball's rim out of its box. */
static float beyond(double x, float towards) {
    return nextafterf(nextafterf((float)x, towards), towards);
}

static void widen(float bounds[6], const sphere *x) {
    for (int a = 0; a < 3; a++) {
        bounds[a] = fminf(bounds[a], beyond(x->centre[a] - x->radius, -INFINITY));
        bounds[a + 3] = fmaxf(bounds[a + 3], beyond(x->centre[a] + x->radius, INFINITY));
    }
}

/* A treelet's entry in the directory. The value at a rim is 0. */
static void describe(const leaf_image *i, uint32_t t, const sphere spheres[], uint32_t count) {
    float(*own)[2] = leaf_image_section(i, LEAF_SECTION_OWN);
    float(*bounds)[6] = leaf_image_section(i, LEAF_SECTION_BOUNDS);
    uint32_t(*counts)[4] = leaf_image_section(i, LEAF_SECTION_COUNTS);
    float(*ranges)[2] = leaf_image_section(i, LEAF_SECTION_RANGES);
    for (int a = 0; a < 3; a++) {
        bounds[t][a] = INFINITY;
        bounds[t][a + 3] = -INFINITY;
    }
    for (uint32_t k = 0; k < count; k++) {
        widen(bounds[t], &spheres[k]);
        own[t][1] = fmaxf(own[t][1], beyond(spheres[k].peak, INFINITY));
    }
    counts[t][0] = count;
    memcpy(ranges[t], own[t], sizeof own[t]);
    for (int a = 0; a < 3; a++) {
        i->header->bounds[a] = fminf(i->header->bounds[a], bounds[t][a]);
        i->header->bounds[a + 3] = fmaxf(i->header->bounds[a + 3], bounds[t][a + 3]);
    }
    i->header->value_min = 0.0;
    i->header->value_max = fmax(i->header->value_max, (double)own[t][1]);
}

leaf_image spheres_file(const sphere spheres[], const uint32_t counts[], uint32_t treelets) {
    leaf_header h = header_of(treelets);
    leaf_section table[SECTIONS];
    uint64_t all = 0;
    for (uint32_t t = 0; t < treelets; t++)
        all += counts[t];
    uint64_t at = place(&h, table, all * sizeof *spheres);
    char *bytes = calloc(1, (size_t)h.file_bytes);
    if (!bytes)
        abort();
    memcpy(bytes, &h, sizeof h);
    memcpy(bytes + LEAF_HEADER_BYTES, table, sizeof table);
    const leaf_image i = leaf_image_of(bytes, (size_t)h.file_bytes);
    uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
    uint64_t *sizes = leaf_image_section(&i, LEAF_SECTION_SIZES);
    for (uint32_t t = 0; t < treelets; spheres += counts[t++]) {
        offsets[t] = at;
        sizes[t] = counts[t] * sizeof *spheres;
        memcpy(bytes + at, spheres, (size_t)sizes[t]);
        describe(&i, t, spheres, counts[t]);
        at += sizes[t];
    }
    leaf_image_seal_payloads(&i);
    leaf_image_seal(&i);
    return i;
}
