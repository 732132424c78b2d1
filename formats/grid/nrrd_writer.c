#include "formats/grid/nrrd_writer.h"

#include <assert.h>
#include <stdint.h>
#include <stdio.h>

#include "formats/base/num.h"

struct nrrd_writer {
    mem *m;
    out_stream *out;
    sample_type type;
    uint64_t left; /* samples still to come */
};

/* A header that is being written. The first failure ends it. */
typedef struct header {
    out_stream *out;
    status st;
} header;

static void put(header *h, const char *text) {
    if (h->st == ST_OK)
        h->st = out_stream_text(h->out, text);
}

static void put_number(header *h, const char *before, double value) {
    char number[NUM_TEXT_MAX];
    put(h, before);
    put(h, num_print(value, number));
}

/* Write a column of the map: "(x,y,z)". */
static void put_vector(header *h, const grid *g, int column) {
    static const char *const before[3] = {" (", ",", ","};
    for (int row = 0; row < 3; row++)
        put_number(h, before[row], g->to_world[row][column]);
    put(h, ")");
}

static const char *type_name(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return "uint8";
    case SAMPLE_I8: return "int8";
    case SAMPLE_U16: return "uint16";
    case SAMPLE_I16: return "int16";
    case SAMPLE_U32: return "uint32";
    case SAMPLE_I32: return "int32";
    case SAMPLE_F32: return "float";
    case SAMPLE_F64: return "double";
    default: return "?"; /* no grid has it */
    }
}

static void put_axis(header *h, const grid *g, int a) {
    char key[32];
    snprintf(key, sizeof key, "leafcast axis %d:=", a);
    for (uint32_t i = 0; i < g->dims[a]; i++)
        put_number(h, i == 0 ? key : " ", g->axis[a][i]);
    put(h, "\n");
}

static void put_pair(header *h, const char *key, const char *value) {
    if (!value[0])
        return;
    put(h, key);
    put(h, ":=");
    put(h, value);
    put(h, "\n");
}

/* Write the space by its name, or just its dimension where NRRD has no name. */
static void put_frame(header *h, const world_frame *frame) {
    static const char *const names[WORLD_AXES] = {
        [WORLD_LPS] = "left-posterior-superior", [WORLD_RAS] = "right-anterior-superior"};
    put(h, names[frame->axes] ? "space: " : "space dimension: 3");
    put(h, names[frame->axes] ? names[frame->axes] : "");
    const char *before = "\nspace units: \"";
    char text[WORLD_UNITS_TEXT];
    for (int a = 0; a < 3 && world_frame_units_print(frame, text)[0]; a++) {
        put(h, before);
        put(h, frame->unit[a]);
        put(h, "\"");
        before = " \"";
    }
}

status nrrd_write_header(out_stream *out, const grid *g) {
    header written = {out, ST_OK}, *h = &written;
    put(h, "NRRD0004\ntype: ");
    put(h, type_name(g->type));
    put(h, "\ndimension: 3\nsizes:");
    for (int a = 0; a < 3; a++)
        put_number(h, " ", g->dims[a]);
    put(h, "\nencoding: raw\nendian: little\n");
    if (g->name[0]) {
        put(h, "content: ");
        put(h, g->name);
        put(h, "\n");
    }
    put_frame(h, &g->frame);
    put(h, "\nspace directions:");
    for (int a = 0; a < 3; a++)
        put_vector(h, g, a);
    put(h, "\nspace origin:");
    put_vector(h, g, 3);
    put(h, "\n");
    for (int a = 0; a < 3 && grid_is_rectilinear(g); a++)
        put_axis(h, g, a);
    char absent[ABSENT_TEXT] = "";
    if (g->absent.count)
        absent_pair(&g->absent, absent);
    put_pair(h, "leafcast absent", absent);
    char missing[NUM_TEXT_MAX] = "";
    if (g->has_missing)
        num_print(g->missing, missing);
    put_pair(h, "leafcast missing", missing);
    put_pair(h, "leafcast terrain", g->terrain ? "yes" : "");
    put_pair(h, "leafcast note", g->note);
    put_pair(h, "leafcast place", g->place);
    put_pair(h, "leafcast fields", g->fields);
    put(h, "\n");
    return h->st;
}

status nrrd_writer_create(mem *m, const char *path, bool force, const grid *g, nrrd_writer **out) {
    nrrd_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    w->m = m;
    w->type = g->type;
    w->left = grid_samples(g);
    status st = out_stream_create(m, path, force, false, &w->out);
    if (st == ST_OK)
        st = nrrd_write_header(w->out, g);
    if (st != ST_OK) {
        nrrd_writer_discard(w);
        return st;
    }
    *out = w;
    return ST_OK;
}

status nrrd_writer_append(nrrd_writer *w, const void *samples, size_t count) {
    assert(count <= w->left);
    w->left -= count;
    return out_stream_samples(w->out, w->type, samples, count);
}

status nrrd_writer_commit(nrrd_writer *w) {
    assert(w->left == 0);
    status st = out_stream_commit(w->out);
    w->out = NULL;
    nrrd_writer_discard(w);
    return st;
}

void nrrd_writer_discard(nrrd_writer *w) {
    if (!w)
        return;
    out_stream_discard(w->out);
    mem_free(w->m, w);
}
