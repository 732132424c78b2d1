#include "tests/support/leaf_fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/histogram_text.h"
#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/leaf_stats.h"
#include "formats/leaf/leaf_verify.h"
#include "render/leafcast.h"
#include "tests/support/leaf_image.h"

enum { SIDE = 12, MEMORY = 1 << 26, SETS_SEEN = 4 };

static bool is_of_a_file(status st) {
    return st == ST_OK || st == ST_CORRUPT || st == ST_UNSUPPORTED || st == ST_NOMEM;
}

static bool is_described(status st) {
    return st == ST_OK || *status_text();
}

/* Each histogram for people and for programs, as `leafcast info` does: before anything is verified.
 */
static status print_histograms(mem *m, const leaf_file *f) {
    const uint32_t sets = f->layout.sets;
    status st = ST_OK;
    for (uint32_t set = 0; set < sets && set < SETS_SEEN && st == ST_OK; set++) {
        char *text = NULL;
        size_t size = 0;
        histogram h;
        st = leaf_histogram_get(m, f, set, &h);
        FILE *to = st == ST_OK ? open_memstream(&text, &size) : NULL;
        if (!to)
            continue;
        histogram_print(to, &h, "cells", true);
        histogram_print_isovalues(to, &h, true);
        fclose(to);
        free(text);
        json_decref(histogram_json(&h, true));
    }
    return st;
}

/* The container by itself. */
static const char *read_file(const char *bytes, size_t size, leaf_fuzz_result *r) {
    mem m;
    leaf_file *f = NULL;
    leaf_activity levels[LEAF_LEVELS_MAX];
    mem_init(&m, MEMORY);
    r->open = leaf_file_open_memory(&m, "fuzz", bytes, size, &f);
    bool described = is_described(r->open);
    if (r->open == ST_OK) {
        const double middle = f->header.value_min + (f->header.value_max - f->header.value_min) / 2;
        status st = leaf_stats_activity(&m, f, 0, isfinite(middle) ? middle : 0, 1, NULL, levels);
        described = is_described(st) && is_described(print_histograms(&m, f));
        r->verify = leaf_verify(&m, f, 1, NULL);
        described = described && is_described(r->verify) && is_of_a_file(st);
    }
    leaf_file_close(f);
    if (mem_used(&m))
        return "memory is left";
    return described ? NULL : "an error without a description, or of another kind";
}

/* The first status that is none of success. */
static leafcast_status draw_set(leafcast *v, const leafcast_camera *camera, uint32_t field,
                                uint32_t step) {
    static double z[SIDE * SIDE];
    static float normal[3][SIDE * SIDE];
    const leafcast_info info = leafcast_describe(v);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {
        .size = sizeof(leafcast_image), .z = z, .normal = {normal[0], normal[1], normal[2]}};
    leafcast_surface surfaces[2];
    for (int i = 0; i < 2; i++) {
        const double iso = info.value_min + (i + 1) * (info.value_max - info.value_min) / 3;
        surfaces[i] = leafcast_surface_default(isfinite(iso) ? iso : 0);
    }
    leafcast_status st = leafcast_select_set(v, field, step);
    if (st == LEAFCAST_OK)
        st = leafcast_select(v, surfaces, 2);
    return st == LEAFCAST_OK ? leafcast_trace(v, &scene, camera, &image, NULL, NULL, NULL) : st;
}

static bool is_finite(const leafcast_camera *c) {
    double sum = 0;
    for (int a = 0; a < 3; a++)
        sum += fabs(c->eye[a]) + fabs(c->look_at[a]);
    return sum < 1e30;
}

/* Across the middle, where there is one. */
static leafcast_status slice_file(leafcast *v, const double middle[3]) {
    static double value[SIDE * SIDE];
    const double plane[4] = {0.0, 0.0, 1.0, -middle[2]};
    leafcast_slice_pixels s = {.size = sizeof s};
    if (leafcast_plane_slice(v, plane, &s) != LEAFCAST_OK)
        return LEAFCAST_OK;
    s.width = s.height = SIDE;
    return leafcast_sample_slice(v, &s, value, NULL, NULL, NULL);
}

static const char *draw_file(const char *bytes, size_t size, bool in_place, leaf_fuzz_result *r) {
    const leafcast_options o = {.size = sizeof(leafcast_options),
                                .memory = MEMORY,
                                .threads = 1,
                                .backend =
                                    in_place ? LEAFCAST_BACKEND_AUTO : LEAFCAST_BACKEND_ARENA};
    leafcast *v = NULL;
    leafcast_status st = leafcast_open_memory(bytes, size, &o, &v);
    if (st == LEAFCAST_OK) {
        const leafcast_info info = leafcast_describe(v);
        const leafcast_camera camera = leafcast_standard_view(v, 1.1, SIDE, SIDE);
        leafcast_sample sample;
        for (uint32_t set = 0; st == LEAFCAST_OK && set < SETS_SEEN && set < info.fields;
             set++) /* steps: the last, then those before it */
            st = is_finite(&camera)
                     ? draw_set(v, &camera, set, set < info.steps ? info.steps - 1 - set : 0)
                     : LEAFCAST_OK;
        const bool given = info.abilities & LEAFCAST_ABILITY_GIVEN; /* nothing beside its cells */
        if (st == LEAFCAST_OK && is_finite(&camera) && !given)
            st = leafcast_probe_point(v, camera.look_at, &sample);
        if (st == LEAFCAST_OK && is_finite(&camera) && !given)
            st = slice_file(v, camera.look_at);
    }
    r->trace = (status)st;
    leafcast_close(v);
    if (!is_of_a_file(r->trace))
        return "a picture fails with an error of another kind";
    return is_described(r->trace) ? NULL : "a picture fails without a description";
}

const char *leaf_fuzz_try(const char *bytes, size_t size, bool in_place, leaf_fuzz_result *r) {
    *r = (leaf_fuzz_result){ST_AGAIN, ST_AGAIN, ST_AGAIN};
    const char *wrong = read_file(bytes, size, r);
    if (!wrong && (!is_of_a_file(r->open) || (r->open == ST_OK && !is_of_a_file(r->verify))))
        wrong = "an error of another kind";
    if (!wrong)
        wrong = draw_file(bytes, size, in_place, r);
    if (!wrong && r->verify == ST_OK && r->trace != ST_OK && r->trace != ST_NOMEM)
        wrong = "a sound file cannot be drawn";
    return wrong;
}

char *leaf_fuzz_alloc(size_t size) {
    void *bytes = NULL;
    if (posix_memalign(&bytes, LEAF_ALIGN, size ? size : 1) != 0)
        abort(); /* a test without memory has nothing to say */
    return bytes;
}

/* Make what is said of a segment right again, but for its payloads' checksums: those of some are
 * elsewhere. */
static void seal_segment(char *bytes, size_t size) {
    leaf_image i = {.bytes = bytes, .size = size, .header = (leaf_header *)bytes};
    const uint64_t table = leaf_table_at(i.header);
    if (table >= size || table % 8)
        return;
    i.table = (leaf_section *)(bytes + table);
    leaf_image_seal(&i);
}

uint64_t leaf_fuzz_segment(const char *bytes, size_t size, int i) {
    uint64_t at;
    memcpy(&at, bytes + offsetof(leaf_header, last), sizeof at);
    while (at >= LEAF_HEADER_BYTES && at % LEAF_ALIGN == 0 && at <= size - LEAF_HEADER_BYTES &&
           i-- > 0)
        memcpy(&at, bytes + at + offsetof(leaf_header, before), sizeof at);
    return at % LEAF_ALIGN == 0 && at <= size - LEAF_HEADER_BYTES ? at : 0;
}

void leaf_fuzz_seal(char *bytes, size_t size) {
    enum { SEGMENTS = 4 };
    if (size < LEAF_HEADER_BYTES)
        return;
    for (int i = 0; i < SEGMENTS; i++) {
        const uint64_t at = leaf_fuzz_segment(bytes, size, i);
        if (at >= LEAF_HEADER_BYTES)
            seal_segment(bytes + at, size - at);
    }
    leaf_image i = {.bytes = bytes, .size = size, .header = (leaf_header *)bytes};
    const uint64_t table = leaf_table_at(i.header);
    /* At a place that cannot be, nothing is looked at. */
    i.table = (leaf_section *)(bytes + (table < size && table % 8 == 0 ? table : 0));
    if (table >= size || table % 8)
        return;
    leaf_image_seal_payloads(&i);
    leaf_image_seal(&i);
}
