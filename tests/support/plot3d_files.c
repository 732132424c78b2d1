#include "tests/support/plot3d_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/scratch.h"

plot3d_form plot3d_form_of(unsigned bits) {
    return (plot3d_form){.records = bits & 1,
                         .little = bits & 2,
                         .wide = bits & 4,
                         .blanks = bits & 8,
                         .multi = bits & 16,
                         .planes = bits & 32,
                         .zones = bits & 16 ? 2 : 1,
                         .nodes = {{3, 4, 5}, {2, 3, 2}, {2, 2, 2}}};
}

const char *plot3d_form_words(const plot3d_form *f) {
    static char text[80];
    char bytes[40] = "text";
    if (!f->text)
        snprintf(bytes, sizeof bytes, "%s,%s,%s", f->records ? "records" : "binary",
                 f->little ? "little" : "big", f->wide ? "f64" : "f32");
    snprintf(text, sizeof text, "%s,%s,%s,%s", bytes, f->blanks ? "blanks" : "no-blanks",
             f->multi ? "multi" : "single", f->planes ? "planes" : "whole");
    return text;
}

double plot3d_number(const plot3d_form *f, uint32_t zone, uint64_t node, uint32_t number) {
    const double x = 1 + 0.5 * (double)node + 64 * zone + 0.015625 * number;
    return f->wide ? x + 1e-9 * (double)(node + 1) : x;
}

int32_t plot3d_blank(uint32_t zone, uint64_t node) {
    static const int32_t blanks[] = {1, 0, -2, 1};
    return blanks[(node + zone) % 4];
}

/* ---- writing ---- */

typedef struct writing {
    const plot3d_form *f;
    uint8_t *bytes;
    size_t size, record;
    unsigned words; /* of text */
} writing;

static void put(writing *w, const void *value, size_t size) {
    for (size_t i = 0; i < size; i++) /* value is little endian */
        w->bytes[w->size + i] = ((const uint8_t *)value)[w->f->little ? i : size - 1 - i];
    w->size += size;
    if (w->size > PLOT3D_FILES_ROOM)
        abort();
}

/* Words as Fortran writes them, in several ways. */
static void put_word(writing *w, const char *format, double value) {
    static const char *const gaps[] = {" ", "\n", ",", "  \t", ", ", "\r\n"};
    char text[64];
    snprintf(text, sizeof text, format, value);
    char *e = strchr(text, 'e');
    if (e)
        *e = "edDE"[w->words % 4];
    w->size += (size_t)sprintf((char *)w->bytes + w->size, "%s%s", text, gaps[w->words++ % 6]);
    if (w->size > PLOT3D_FILES_ROOM - 128)
        abort();
}

static void put_whole(writing *w, int32_t value) {
    if (w->f->text) {
        put_word(w, "%.0f", value);
        return;
    }
    const uint32_t v = (uint32_t)value;
    const uint8_t little[4] = {(uint8_t)v, (uint8_t)(v >> 8), (uint8_t)(v >> 16),
                               (uint8_t)(v >> 24)};
    put(w, little, 4);
}

static void put_real(writing *w, double value) {
    if (w->f->text) {
        put_word(w, w->words % 3 ? "%.17g" : "%.16e", value);
        return;
    }
    const float narrow = (float)value;
    uint64_t bits = 0;
    uint32_t narrow_bits;
    memcpy(&bits, &value, 8);
    memcpy(&narrow_bits, &narrow, 4);
    bits = w->f->wide ? bits : narrow_bits;
    uint8_t little[8];
    for (int i = 0; i < 8; i++)
        little[i] = (uint8_t)(bits >> 8 * i);
    put(w, little, w->f->wide ? 8 : 4);
}

static void begin_record(writing *w) {
    w->record = w->size;
    if (w->f->records)
        put_whole(w, 0);
}

static void end_record(writing *w) {
    if (!w->f->records)
        return;
    const size_t end = w->size, length = end - w->record - 4;
    w->size = w->record;
    put_whole(w, (int32_t)length);
    w->size = end;
    put_whole(w, (int32_t)length);
}

/* Nodes from `first` on, all of a number, then all of the next. */
static void put_nodes(writing *w, uint32_t zone, plot3d_part part, uint64_t first, uint64_t count) {
    static const uint32_t from[] = {0, 3, 8, 8 + PLOT3D_FILES_FUNCTIONS};
    begin_record(w);
    for (uint32_t number = from[part]; number < from[part + 1]; number++)
        for (uint64_t n = first; n < first + count; n++)
            put_real(w, plot3d_number(w->f, zone, n, number));
    for (uint64_t n = first; part == PLOT3D_PART_GRID && w->f->blanks && n < first + count; n++)
        put_whole(w, plot3d_blank(zone, n));
    end_record(w);
}

static void put_zone(writing *w, uint32_t zone, plot3d_part part) {
    const uint32_t *n = w->f->nodes[zone];
    const uint64_t plane = (uint64_t)n[0] * n[1];
    if (part == PLOT3D_PART_SOLUTION) {
        begin_record(w);
        for (int i = 0; i < 4; i++)
            put_real(w, 2.5 + i + 10 * zone);
        end_record(w);
    }
    for (uint32_t k = 0; k < (w->f->planes ? n[2] : 1); k++)
        put_nodes(w, zone, part, k * plane, w->f->planes ? plane : plane * n[2]);
}

uint8_t *plot3d_bytes(const plot3d_form *f, plot3d_part part, size_t *size) {
    static uint8_t bytes[PLOT3D_FILES_ROOM + 8];
    writing w = {.f = f, .bytes = bytes};
    if (f->multi) {
        begin_record(&w);
        put_whole(&w, (int32_t)f->zones);
        end_record(&w);
    }
    begin_record(&w);
    for (uint32_t z = 0; z < f->zones; z++) {
        for (int a = 0; a < 3; a++)
            put_whole(&w, (int32_t)f->nodes[z][a]);
        if (part == PLOT3D_PART_FUNCTIONS)
            put_whole(&w, PLOT3D_FILES_FUNCTIONS);
    }
    end_record(&w);
    for (uint32_t z = 0; z < f->zones; z++)
        put_zone(&w, z, part);
    *size = w.size;
    return bytes;
}

const char *plot3d_write(const plot3d_form *f, plot3d_part part, const char *name) {
    size_t size;
    const uint8_t *bytes = plot3d_bytes(f, part, &size);
    return scratch_write(name, bytes, size);
}

path_list plot3d_one(const char *path) {
    static char kept[8][4096], *paths[8];
    static int at;
    at = (at + 1) % 8;
    snprintf(kept[at], sizeof kept[at], "%s", path);
    paths[at] = kept[at];
    return (path_list){&paths[at], 1};
}
