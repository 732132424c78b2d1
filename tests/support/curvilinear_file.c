#include "tests/support/curvilinear_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/hexahedron.h"

enum { RUN_LOG2 = 12 };

static const uint32_t kinds[] = {LEAF_SECTION_RANGES,  LEAF_SECTION_OWN,   LEAF_SECTION_FLAGS,
                                 LEAF_SECTION_OFFSETS, LEAF_SECTION_SIZES, LEAF_SECTION_CHECKSUMS,
                                 LEAF_SECTION_BOUNDS,  LEAF_SECTION_ZONES};
enum { SECTIONS = sizeof kinds / sizeof *kinds };

/* Of all treelets of all zones, what is to be written. */
typedef struct work {
    const curvilinear_zone *zone;
    leaf_image *image;
    uint32_t treelet, treelets;
    uint64_t places_at, values_at; /* where the next payloads go */
} work;

static void count_one(void *ctx, const uint32_t first[3], const uint32_t cells[3]) {
    work *w = ctx;
    (void)first;
    w->treelet++;
    w->places_at += curvilinear_place_bytes(cells);
    w->values_at += curvilinear_value_bytes(cells);
}

size_t curvilinear_file_stands(const curvilinear_zone *z, size_t n) {
    const size_t all = (size_t)z->nodes[0] * z->nodes[1] * z->nodes[2];
    size_t at = n, first = 0;
    if (!z->blank || z->blank[n])
        return n;
    while (first < all && !z->blank[first])
        first++;
    if (first == all)
        return 0;
    while (at > first && !z->blank[at])
        at--;
    return at > first ? at : first;
}

static size_t node_of(const curvilinear_zone *z, const uint32_t first[3], uint32_t i, uint32_t j,
                      uint32_t k) {
    return first[0] + i +
           (size_t)z->nodes[0] * (first[1] + j + (size_t)z->nodes[1] * (first[2] + k));
}

static unsigned code_of(const curvilinear_zone *z, const uint32_t first[3], uint32_t i, uint32_t j,
                        uint32_t k) {
    double p[HEX_CORNERS][3];
    for (uint32_t c = 0; c < HEX_CORNERS; c++) {
        const size_t n = node_of(z, first, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        if (z->blank && (!z->blank[n] || (c == 0 && z->blank[n] & 2)))
            return HEX_NONE;
        for (int a = 0; a < 3; a++)
            p[c][a] = (double)z->p[n][a];
    }
    const int sense = hexahedron_sense((const double(*)[3])p);
    return sense > 0 ? HEX_RIGHT : sense < 0 ? HEX_LEFT : HEX_FOLDED;
}

static void write_codes(const curvilinear_zone *z, const uint32_t first[3], const uint32_t cells[3],
                        uint8_t *codes) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < cells[2]; k++)
        for (uint32_t j = 0; j < cells[1]; j++)
            for (uint32_t i = 0; i < cells[0]; i++, n++)
                codes[n / 4] |= (uint8_t)(code_of(z, first, i, j, k) << 2 * (n % 4));
}

static void widen(float lo[], float hi[], int a, float x) {
    lo[a] = fminf(lo[a], x);
    hi[a] = fmaxf(hi[a], x);
}

static void write_one(void *ctx, const uint32_t first[3], const uint32_t cells[3]) {
    work *w = ctx;
    const leaf_image *i = w->image;
    const curvilinear_zone *z = w->zone;
    const uint32_t t = w->treelet++, nodes = curvilinear_nodes(cells);
    uint64_t *offsets = leaf_image_section(i, LEAF_SECTION_OFFSETS);
    uint64_t *sizes = leaf_image_section(i, LEAF_SECTION_SIZES);
    float *bounds = ((float(*)[6])leaf_image_section(i, LEAF_SECTION_BOUNDS))[t];
    float *own = ((float(*)[2])leaf_image_section(i, LEAF_SECTION_OWN))[t];
    float *places = (float *)(i->bytes + w->places_at),
          *values = (float *)(i->bytes + w->values_at);
    offsets[t] = w->places_at;
    offsets[w->treelets + t] = w->values_at;
    sizes[t] = curvilinear_place_bytes(cells);
    sizes[w->treelets + t] = curvilinear_value_bytes(cells);
    for (int a = 0; a < 3; a++) {
        bounds[a] = INFINITY;
        bounds[a + 3] = -INFINITY;
    }
    own[0] = INFINITY;
    own[1] = -INFINITY;
    uint32_t n = 0;
    for (uint32_t k = 0; k <= cells[2]; k++)
        for (uint32_t j = 0; j <= cells[1]; j++)
            for (uint32_t c = 0; c <= cells[0]; c++, n++) {
                const size_t node = node_of(z, first, c, j, k);
                const float *p = z->p[curvilinear_file_stands(z, node)];
                for (uint32_t a = 0; a < 3; a++) {
                    places[a * nodes + n] = p[a];
                    widen(bounds, bounds + 3, (int)a, p[a]);
                }
                values[n] = z->blank && !z->blank[node] ? NAN : z->values[node];
                if (isfinite(values[n]))
                    widen(own, own + 1, 0, values[n]);
                else
                    ((uint8_t *)leaf_image_section(i, LEAF_SECTION_FLAGS))[t] =
                        LEAF_FLAG_NON_FINITE;
            }
    write_codes(z, first, cells, (uint8_t *)(places + 3 * (size_t)nodes));
    memcpy(((float(*)[2])leaf_image_section(i, LEAF_SECTION_RANGES))[t], own, sizeof(float[2]));
    for (int a = 0; a < 3; a++) {
        widen(i->header->bounds, i->header->bounds + 3, a, bounds[a]);
        widen(i->header->bounds, i->header->bounds + 3, a, bounds[a + 3]);
    }
    i->header->value_min = fmin(i->header->value_min, (double)own[0]);
    i->header->value_max = fmax(i->header->value_max, (double)own[1]);
    w->places_at += sizes[t];
    w->values_at += sizes[w->treelets + t];
}

static leaf_header header_of(uint32_t zones, uint32_t treelets) {
    leaf_header h = {.version = LEAF_VERSION,
                     .kind = LEAF_KIND_CURVILINEAR,
                     .sample_type = SAMPLE_F32,
                     .source_type = SAMPLE_F32,
                     .levels = 1,
                     .cells_log2 = CURVILINEAR_LOG2,
                     .block_log2 = LEAF_BLOCK_LOG2,
                     .fields = 1,
                     .steps = 1,
                     .run_align_log2 = RUN_LOG2,
                     .sections = SECTIONS,
                     .treelets = treelets,
                     .zones = zones,
                     .value_min = INFINITY,
                     .value_max = -INFINITY};
    memcpy(h.magic, LEAF_MAGIC, sizeof h.magic);
    strcpy(h.name, "curvilinear");
    h.to_world[0] = h.to_world[5] = h.to_world[10] = 1.0;
    for (int a = 0; a < 3; a++) {
        h.bounds[a] = INFINITY;
        h.bounds[a + 3] = -INFINITY;
    }
    return h;
}

static uint64_t place_sections(const leaf_header *h, leaf_section table[SECTIONS]) {
    uint64_t end = LEAF_HEADER_BYTES + SECTIONS * sizeof *table;
    for (int i = 0; i < SECTIONS; i++) {
        table[i] = (leaf_section){.kind = kinds[i],
                                  .version = 1,
                                  .offset = leaf_layout_aligned(end, LEAF_ALIGN_LOG2),
                                  .bytes = leaf_section_bytes(h, kinds[i])};
        end = table[i].offset + table[i].bytes;
    }
    return leaf_layout_aligned(end, RUN_LOG2);
}

leaf_image curvilinear_file(const curvilinear_zone zones[], uint32_t count) {
    work w = {0};
    for (uint32_t z = 0; z < count; z++)
        curvilinear_zones_walk(zones[z].nodes, count_one, &w);
    leaf_header h = header_of(count, w.treelet);
    leaf_section table[SECTIONS];
    const uint64_t at = place_sections(&h, table);
    const uint64_t values_at = leaf_layout_aligned(at + w.places_at, RUN_LOG2);
    h.payload_bytes = w.places_at + w.values_at;
    h.file_bytes = leaf_layout_aligned(values_at + w.values_at, RUN_LOG2);
    char *bytes = calloc(1, (size_t)h.file_bytes);
    if (!bytes)
        abort();
    memcpy(bytes, &h, sizeof h);
    memcpy(bytes + LEAF_HEADER_BYTES, table, sizeof table);
    leaf_image image = leaf_image_of(bytes, (size_t)h.file_bytes);
    uint32_t(*nodes)[4] = leaf_image_section(&image, LEAF_SECTION_ZONES);
    w = (work){.image = &image, .treelets = w.treelet, .places_at = at, .values_at = values_at};
    for (uint32_t z = 0; z < count; z++) {
        memcpy(nodes[z], zones[z].nodes, sizeof zones[z].nodes);
        w.zone = &zones[z];
        curvilinear_zones_walk(zones[z].nodes, write_one, &w);
        for (size_t n = 0; n < (size_t)nodes[z][0] * nodes[z][1] * nodes[z][2]; n++)
            image.header->non_finite +=
                (zones[z].blank && !zones[z].blank[n]) || !isfinite(zones[z].values[n]);
    }
    leaf_image_seal_payloads(&image);
    leaf_image_seal(&image);
    return image;
}
