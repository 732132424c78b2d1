#include "tests/support/export_lab.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/hex_treelet.h"
#include "prep/export/grid_surface.h"
#include "prep/export/hex_surface.h"
#include "prep/export/tet_surface.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_fuzz.h"
#include "tests/support/scratch.h"

static const piece_format *format_of(const char *name) {
    for (int i = 0; i < piece_format_count; i++)
        if (strcmp(piece_formats[i].name, name) == 0)
            return &piece_formats[i];
    fail_msg("no format %s", name);
    return NULL;
}

/* ---- to a file, and back ---- */

status export_lab_pieces(mem *m, const export_how *h, const piece_source *source,
                         piece_info *info) {
    const piece_export e = {.source = source,
                            .format = format_of(h->format),
                            .path = scratch_path("surface"),
                            .beside = scratch_path("surface"),
                            .force = true,
                            .threads = h->threads};
    info->name = "lab";
    info->isovalues = h->count;
    info->floats |= e.format->loose;
    return piece_export_run(m, &e, info);
}

static status try_grid(mem *m, leaf_file *f, const export_how *h, piece_info *info) {
    grid_part part;
    piece_source source = {.ctx = NULL};
    status st = grid_part_of(f, h->level, h->box, &part);
    if (st == ST_OK)
        st = grid_surface_create(m, f, &part, h->isovalues, h->count, h->threads, &source);
    if (st == ST_OK)
        st = export_lab_pieces(m, h, &source, info);
    piece_source_release(&source);
    return st;
}

static status try_cells(mem *m, leaf_file *f, const export_how *h, piece_info *info) {
    const uint32_t first = 0;
    const cell_choice choice = {.f = f, .fields = &first, .count = 1, .gradients = true};
    piece_source source = {.ctx = NULL};
    status st = (f->mesh ? tet_surface_create : hex_surface_create)(m, &choice, h->isovalues,
                                                                    h->count, h->threads, &source);
    if (st == ST_OK)
        st = export_lab_pieces(m, h, &source, info);
    piece_source_release(&source);
    return st;
}

status export_lab_try(mem *m, const char *path, const export_how *h, piece_info *info) {
    leaf_file *f = NULL;
    *info = (piece_info){.floats = false};
    status st = leaf_file_open(m, path, &f);
    if (st == ST_OK) {
        m->limit = h->memory ? mem_used(m) + h->memory : 0;
        st = f->mesh || f->geometry->noded ? try_cells(m, f, h, info) : try_grid(m, f, h, info);
        m->limit = 0;
    }
    leaf_file_close(f);
    return st;
}

/* The file's bytes; free them. */
char *export_lab_bytes(const char *path, const export_how *h, size_t *size) {
    mem m;
    piece_info info;
    mem_init(&m, 0);
    if (export_lab_try(&m, path, h, &info) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(mem_used(&m), 0);
    return scratch_read(scratch_path("surface"), size);
}

ply_surface export_lab_surface(const char *path, const export_how *h) {
    size_t size;
    char *bytes = export_lab_bytes(path, h, &size);
    const ply_surface s = ply_surface_read(bytes, size);
    free(bytes);
    return s;
}

export_how export_lab_plain(double isovalue) {
    return (export_how){.format = "ply", .isovalues = {isovalue}, .count = 1, .threads = 2};
}

/* ---- what it is asked about ---- */

int export_lab_by_point(const void *a, const void *b) {
    const double *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x[i] != y[i])
            return x[i] < y[i] ? -1 : 1;
    return 0;
}

static double volume_of(const ply_surface *s) {
    double sum = 0;
    for (size_t t = 0; t < s->triangles; t++) {
        const double *a = s->at[s->corner[t][0]], *b = s->at[s->corner[t][1]],
                     *c = s->at[s->corner[t][2]];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

void export_lab_check_ball(const ply_surface *s, double middle, double radius, double tolerance) {
    assert_int_equal(ply_surface_euler(s), 2);
    ply_sides sides = ply_surface_sides(s);
    assert_int_equal(sides.open + sides.repeated, 0);
    free(sides.rim);
    assert_true(fabs(volume_of(s) / (4.0 / 3 * M_PI * radius * radius * radius) - 1) < 0.01);
    for (size_t v = 0; v < s->vertices; v++) {
        double dot = 0, length = 0;
        for (int a = 0; a < 3; a++) {
            dot += (double)s->normal[v][a] * (s->at[v][a] - middle) / radius;
            length += (double)s->normal[v][a] * (double)s->normal[v][a];
        }
        assert_true(fabs(length - 1) < 1e-6);
        assert_true(dot > 1 - tolerance);
    }
}

void export_lab_check_same(const char *path, double iso, const char *format, size_t little) {
    export_how h = export_lab_plain(iso);
    size_t size, other;
    h.format = format;
    h.threads = 1;
    char *bytes = export_lab_bytes(path, &h, &size);
    for (int i = 0; i < 3; i++) {
        h.threads = 1 + i;
        h.memory = i == 1 ? 0 : little;
        char *again = export_lab_bytes(path, &h, &other);
        assert_int_equal(size, other);
        assert_memory_equal(bytes, again, size);
        free(again);
    }
    free(bytes);
}

void export_lab_malice(const char *path, const export_how *h, uint64_t seed, int times) {
    field_random r = {seed};
    size_t size;
    char *good = scratch_read(path, &size), *bytes = malloc(size);
    int refused = 0;
    assert_non_null(bytes);
    for (int i = 0; i < times; i++) {
        memcpy(bytes, good, size);
        for (long n = 1 + field_random_below(&r, 4); n > 0; n--)
            bytes[field_random_below(&r, (long)size)] ^= (char)(1 + field_random_below(&r, 255));
        leaf_fuzz_seal(bytes, size);
        mem m;
        piece_info info;
        mem_init(&m, 0);
        const status st = export_lab_try(&m, scratch_write("malice.leaf", bytes, size), h, &info);
        if (st != ST_OK && st != ST_CORRUPT && st != ST_UNSUPPORTED)
            fail_msg("seed %llu, %d: status %d: %s", (unsigned long long)seed, i, st,
                     status_text());
        assert_int_equal(mem_used(&m), 0);
        refused += st != ST_OK;
    }
    assert_true(refused > times / 20 && refused < times);
    free(good);
    free(bytes);
}

const char *export_lab_array(const char *bytes, const char *name) {
    char declared[64];
    snprintf(declared, sizeof declared, "Name=\"%s\"", name);
    const char *at = strstr(bytes, declared),
               *data = strstr(bytes, "<AppendedData encoding=\"raw\">\n_");
    assert_non_null(at);
    assert_non_null(data);
    return data + strlen("<AppendedData encoding=\"raw\">\n_") +
           strtoull(strstr(at, "offset=\"") + 8, NULL, 10) + 8;
}
