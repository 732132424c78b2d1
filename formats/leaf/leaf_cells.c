#include "formats/leaf/leaf_cells.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

const leaf_cells *leaf_cells_of(const leaf_file *f) {
    return f->geometry->cells;
}

uint32_t leaf_cells_treelet(const uint64_t *first, uint32_t treelets, uint64_t number) {
    uint32_t lo = 0, hi = treelets;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (first[middle] <= number)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

/* ---- The header ---- */

status leaf_cells_check_parameters(const char *path, const leaf_header *h) {
    const leaf_field fields[] = {
        LEAF_FIELD(h, sample_type, SAMPLE_F32, SAMPLE_F32),
        LEAF_FIELD(h, levels, 1, 1),
        LEAF_FIELD(h, fields, 1, LEAF_SETS_MAX),
        LEAF_FIELD(h, steps, 1, LEAF_SETS_MAX / (h->fields ? h->fields : 1)),
    };
    return leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
}

status leaf_cells_check_values(const char *path, const leaf_header *h) {
    if (h->treelets < 1 || h->treelets >= LEAF_NO_TREELET ||
        leaf_cells_payloads(h) >= LEAF_NO_TREELET)
        return leaf_check_corrupt(path, offsetof(leaf_header, treelets),
                                  "expected 1 to 2^32 - 2 treelets of all sets, found %llu a set",
                                  (unsigned long long)h->treelets);
    for (size_t i = 0; i < 12; i++)
        if (h->to_world[i] != (i % 5 == 0))
            return leaf_check_corrupt(path, offsetof(leaf_header, to_world) + sizeof(double) * i,
                                      "expected the identity, found %g", h->to_world[i]);
    return ST_OK;
}

status leaf_cells_check_rest(const char *path, const leaf_header *h) {
    const size_t bounds = offsetof(leaf_header, bounds), end = bounds + sizeof h->bounds;
    status st = leaf_check_zero(path, &h->tets, bounds - offsetof(leaf_header, tets),
                                offsetof(leaf_header, tets));
    return st == ST_OK ? leaf_check_zero(path, (const char *)h + end, sizeof *h - end, end) : st;
}

status leaf_cells_check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    if (!leaf_check_may_hold(h))
        return leaf_check_corrupt(
            path, offsetof(leaf_header, treelets), "a file of %llu bytes cannot hold %llu treelets",
            (unsigned long long)h->file_bytes, (unsigned long long)h->treelets);
    leaf_layout_flat(l, leaf_geometry_of(h->kind), (uint32_t)h->treelets,
                     (uint32_t)leaf_cells_payloads(h));
    l->sets = h->fields * h->steps;
    l->steps = h->steps;
    l->places = h->steps;
    return ST_OK;
}

/* ---- The directory ---- */

uint64_t leaf_cells_sets(const leaf_header *h) {
    return (uint64_t)h->fields * h->steps;
}

uint64_t leaf_cells_payloads(const leaf_header *h) {
    return h->treelets * leaf_cells_sets(h);
}

bool leaf_cells_labels(const leaf_header *h) {
    (void)h;
    return true;
}

uint64_t leaf_cells_section_bytes(const leaf_header *h, uint32_t kind) {
    return kind == LEAF_SECTION_BOUNDS   ? h->treelets * h->steps * sizeof(float[6])
           : kind == LEAF_SECTION_COUNTS ? h->treelets * sizeof(uint32_t[4])
                                         : 0;
}

status leaf_cells_allocate(leaf_file *f) {
    const size_t treelets = f->layout.treelets;
    leaf_cells_directory *d = f->besides = mem_zalloc(f->m, sizeof *d);
    if (!d)
        return ST_NOMEM;
    d->bounds = mem_array(f->m, treelets * f->layout.places, sizeof *d->bounds);
    d->counts = mem_array(f->m, treelets, sizeof *d->counts);
    d->first = mem_array(f->m, treelets + 1, sizeof *d->first);
    return d->bounds && d->counts && d->first ? ST_OK : ST_NOMEM;
}

void *leaf_cells_section(const leaf_file *f, uint32_t kind) {
    const leaf_cells_directory *d = leaf_cells_directory_of(f);
    return kind == LEAF_SECTION_BOUNDS   ? (void *)d->bounds
           : kind == LEAF_SECTION_COUNTS ? (void *)d->counts
                                         : NULL;
}

void leaf_cells_release(leaf_file *f) {
    leaf_cells_directory *d = f->besides;
    if (!d)
        return;
    mem_free(f->m, d->bounds);
    mem_free(f->m, d->counts);
    mem_free(f->m, d->first);
    mem_free(f->m, d);
}

status leaf_cells_lay_out(leaf_file *f, leaf_directory *d) {
    const leaf_cells *cells = leaf_cells_of(f);
    leaf_cells_directory *own = f->besides;
    uint32_t most = 0;
    d->bounds = (const float(*)[6])own->bounds;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint32_t *c = own->counts[t];
        if (c[0] < 1 || c[0] > cells->most || c[1] || c[2] || c[3])
            return leaf_check_corrupt(file_path(f->source),
                                      d->at[LEAF_SECTION_COUNTS - 1] + t * sizeof *own->counts,
                                      "treelet %u cannot have %u %ss", t, c[0], cells->name);
        own->first[t + 1] = own->first[t] + c[0];
        most = c[0] > most ? c[0] : most;
    }
    f->layout.counts = (const uint32_t(*)[4])own->counts;
    f->layout.payload_max = most * cells->bytes;
    return leaf_layout_init_flat(&f->layout, f->m);
}

status leaf_cells_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                                  const leaf_directory *d) {
    double range[2] = {(double)INFINITY, -(double)INFINITY};
    unsigned flags = 0;
    for (size_t i = 0; i < (size_t)l->treelets * l->sets; i++) {
        const float *own = d->own[i];
        if (!leaf_check_well_formed((double)own[0], (double)own[1]) ||
            memcmp(own, d->ranges[i], sizeof *d->own) != 0)
            return leaf_check_corrupt(path, d->at[LEAF_SECTION_OWN - 1] + i * sizeof *d->own,
                                      "treelet %zu's ranges of set %zu are none", i % l->treelets,
                                      i / l->treelets);
        const status st = leaf_check_flags(path, h, d, i);
        if (st != ST_OK)
            return st;
        leaf_check_widen(range, own);
        flags |= d->flags[i];
    }
    const status st = leaf_check_union(path, h, range, flags);
    return st == ST_OK ? leaf_check_bounds(path, h, l, d) : st;
}

/* ---- Payloads ---- */

uint32_t leaf_cells_payload_bytes(const leaf_layout *l, uint32_t p) {
    return l->counts[p % l->treelets][0] * l->geometry->cells->bytes;
}

bool leaf_cells_begins_run(const leaf_layout *l, uint32_t p) {
    return p % l->treelets == 0;
}

leaf_series leaf_cells_series(const leaf_layout *l, uint32_t p) {
    return leaf_series_of(p, 0, l->treelets);
}

const char *leaf_cells_payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    snprintf(text, LEAF_NAME_MAX, "treelet %u's %ss of set %u", p % l->treelets,
             l->geometry->cells->name, p / l->treelets);
    return text;
}

int leaf_cells_parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
                     uint32_t payloads[LEAF_PARTS_MAX]) {
    payloads[0] = leaf_layout_samples(l, set, treelet);
    return 1;
}
