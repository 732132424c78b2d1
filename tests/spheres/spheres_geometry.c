#include "tests/spheres/spheres_geometry.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tests/spheres/spheres.h"

/* ---- The header ---- */

static status check_parameters(const char *path, const leaf_header *h) {
    const leaf_field fields[] = {
        LEAF_FIELD(h, sample_type, SAMPLE_F32, SAMPLE_F32),
        LEAF_FIELD(h, levels, 1, 1),
        LEAF_FIELD(h, fields, 1, 1),
        LEAF_FIELD(h, steps, 1, 1),
    };
    return leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
}

static status check_values(const char *path, const leaf_header *h) {
    if (h->treelets < 1 || h->treelets >= LEAF_NO_TREELET)
        return leaf_check_corrupt(path, offsetof(leaf_header, treelets),
                                  "expected 1 to 2^32 - 2 treelets, found %llu",
                                  (unsigned long long)h->treelets);
    for (size_t i = 0; i < 12; i++)
        if (h->to_world[i] != (i % 5 == 0))
            return leaf_check_corrupt(path, offsetof(leaf_header, to_world) + sizeof(double) * i,
                                      "expected the identity, found %g", h->to_world[i]);
    return ST_OK;
}

static status check_rest(const char *path, const leaf_header *h) {
    const size_t bounds = offsetof(leaf_header, bounds), end = bounds + sizeof h->bounds;
    status st = leaf_check_zero(path, &h->tets, bounds - offsetof(leaf_header, tets),
                                offsetof(leaf_header, tets));
    return st == ST_OK ? leaf_check_zero(path, (const char *)h + end, sizeof *h - end, end) : st;
}

static status check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    if (leaf_check_directory_bytes(h) > h->file_bytes)
        return leaf_check_corrupt(
            path, offsetof(leaf_header, treelets), "a file of %llu bytes cannot hold %llu treelets",
            (unsigned long long)h->file_bytes, (unsigned long long)h->treelets);
    leaf_layout_flat(l, &spheres_geometry, (uint32_t)h->treelets, (uint32_t)h->treelets);
    return ST_OK;
}

/* ---- The directory ---- */

static uint64_t sets(const leaf_header *h) {
    (void)h;
    return 1;
}

static uint64_t payloads(const leaf_header *h) {
    return h->treelets;
}

static bool labels(const leaf_header *h) {
    (void)h;
    return false;
}

static uint64_t section_bytes(const leaf_header *h, uint32_t kind) {
    return kind == LEAF_SECTION_BOUNDS   ? h->treelets * sizeof(float[6])
           : kind == LEAF_SECTION_COUNTS ? h->treelets * sizeof(uint32_t[4])
                                         : 0;
}

static status allocate(leaf_file *f) {
    spheres_directory *d = f->besides = mem_zalloc(f->m, sizeof *d);
    if (!d)
        return ST_NOMEM;
    d->bounds = mem_array(f->m, f->layout.treelets, sizeof *d->bounds);
    d->counts = mem_array(f->m, f->layout.treelets, sizeof *d->counts);
    d->first = mem_array(f->m, (size_t)f->layout.treelets + 1, sizeof *d->first);
    return d->bounds && d->counts && d->first ? ST_OK : ST_NOMEM;
}

static void *section(const leaf_file *f, uint32_t kind) {
    const spheres_directory *d = spheres_directory_of(f);
    return kind == LEAF_SECTION_BOUNDS   ? (void *)d->bounds
           : kind == LEAF_SECTION_COUNTS ? (void *)d->counts
                                         : NULL;
}

static void release(leaf_file *f) {
    spheres_directory *d = f->besides;
    if (!d)
        return;
    mem_free(f->m, d->bounds);
    mem_free(f->m, d->counts);
    mem_free(f->m, d->first);
    mem_free(f->m, d);
}

static status lay_out(leaf_file *f, leaf_directory *d) {
    spheres_directory *own = f->besides;
    uint32_t most = 0;
    d->bounds = (const float(*)[6])own->bounds;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint32_t *c = own->counts[t];
        if (c[0] < 1 || c[0] > SPHERES_TREELET_MAX || c[1] || c[2] || c[3])
            return leaf_check_corrupt(file_path(f->source),
                                      d->at[LEAF_SECTION_COUNTS - 1] + t * sizeof *own->counts,
                                      "treelet %u cannot have %u spheres", t, c[0]);
        own->first[t + 1] = own->first[t] + c[0];
        most = c[0] > most ? c[0] : most;
    }
    f->layout.counts = (const uint32_t(*)[4])own->counts;
    f->layout.payload_max = most * (uint32_t)sizeof(sphere);
    return leaf_layout_init_flat(&f->layout, f->m);
}

static status check_bounds(const char *path, const leaf_header *h, const leaf_layout *l,
                           const leaf_directory *d) {
    for (int a = 0; a < 3; a++) {
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t t = 0; t < l->treelets; t++) {
            const float *b = d->bounds[t];
            if (!isfinite(b[a]) || !isfinite(b[a + 3]) || b[a] > b[a + 3])
                return leaf_check_corrupt(path,
                                          d->at[LEAF_SECTION_BOUNDS - 1] + t * sizeof *d->bounds,
                                          "treelet %u's bounds are none", t);
            lo = fminf(lo, b[a]);
            hi = fmaxf(hi, b[a + 3]);
        }
        if (h->bounds[a] != lo || h->bounds[a + 3] != hi)
            return leaf_check_corrupt(path, offsetof(leaf_header, bounds),
                                      "expected the treelets' bounds along %c", "xyz"[a]);
    }
    return ST_OK;
}

static status check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d) {
    double range[2] = {(double)INFINITY, -(double)INFINITY};
    for (uint32_t t = 0; t < l->treelets; t++) {
        const float *own = d->own[t];
        if (!leaf_check_well_formed((double)own[0], (double)own[1]) ||
            memcmp(own, d->ranges[t], sizeof *d->own) != 0)
            return leaf_check_corrupt(path, d->at[LEAF_SECTION_OWN - 1] + t * sizeof *d->own,
                                      "treelet %u's ranges are none", t);
        const status st = leaf_check_flags(path, h, d, t);
        if (st != ST_OK)
            return st;
        leaf_check_widen(range, own);
    }
    const status st = leaf_check_union(path, h, range, 0);
    return st == ST_OK ? check_bounds(path, h, l, d) : st;
}

/* ---- Payloads ---- */

static uint32_t payload_bytes(const leaf_layout *l, uint32_t p) {
    return l->counts[p][0] * (uint32_t)sizeof(sphere);
}

static bool begins_run(const leaf_layout *l, uint32_t p) {
    (void)l;
    return p == 0;
}

static const char *payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    (void)l;
    snprintf(text, LEAF_NAME_MAX, "treelet %u's spheres", p);
    return text;
}

const leaf_geometry spheres_geometry = {.holds_indices = false,
                                        .check_parameters = check_parameters,
                                        .check_values = check_values,
                                        .check_rest = check_rest,
                                        .check_layout = check_layout,
                                        .sets = sets,
                                        .payloads = payloads,
                                        .labels = labels,
                                        .section_bytes = section_bytes,
                                        .allocate = allocate,
                                        .section = section,
                                        .release = release,
                                        .lay_out = lay_out,
                                        .check_directory = check_directory,
                                        .payload_bytes = payload_bytes,
                                        .begins_run = begins_run,
                                        .payload_name = payload_name};
