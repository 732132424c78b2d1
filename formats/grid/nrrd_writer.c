#include "formats/grid/nrrd_writer.h"

#include <assert.h>
#include <endian.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/num.h"

struct nrrd_writer {
    mem *m;
    out_file *file; /* NULL: standard output */
    sample_type type;
    uint64_t left; /* samples still to come */
    status st;     /* of the header: the first failure ends it */
};

static status write_bytes(nrrd_writer *w, const void *data, size_t size) {
    if (w->file)
        return out_file_append(w->file, data, size);
    return file_write_all(STDOUT_FILENO, "standard output", NULL, data, size);
}

static void put(nrrd_writer *w, const char *text) {
    if (w->st == ST_OK)
        w->st = write_bytes(w, text, strlen(text));
}

static void put_number(nrrd_writer *w, const char *before, double value) {
    char number[NUM_TEXT_MAX];
    put(w, before);
    put(w, num_print(value, number));
}

/* A column of the map: "(x,y,z)". */
static void put_vector(nrrd_writer *w, const grid *g, int column) {
    static const char *const before[3] = {" (", ",", ","};
    for (int row = 0; row < 3; row++)
        put_number(w, before[row], g->to_world[row][column]);
    put(w, ")");
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

static void put_axis(nrrd_writer *w, const grid *g, int a) {
    char key[32];
    snprintf(key, sizeof key, "leafcast axis %d:=", a);
    for (uint32_t i = 0; i < g->dims[a]; i++)
        put_number(w, i == 0 ? key : " ", g->axis[a][i]);
    put(w, "\n");
}

static status write_header(nrrd_writer *w, const grid *g) {
    put(w, "NRRD0004\ntype: ");
    put(w, type_name(g->type));
    put(w, "\ndimension: 3\nsizes:");
    for (int a = 0; a < 3; a++)
        put_number(w, " ", g->dims[a]);
    put(w, "\nencoding: raw\nendian: little\n");
    if (g->name[0]) {
        put(w, "content: ");
        put(w, g->name);
        put(w, "\n");
    }
    put(w, "space dimension: 3\nspace directions:");
    for (int a = 0; a < 3; a++)
        put_vector(w, g, a);
    put(w, "\nspace origin:");
    put_vector(w, g, 3);
    put(w, "\n");
    for (int a = 0; a < 3 && grid_is_rectilinear(g); a++)
        put_axis(w, g, a);
    put(w, "\n");
    return w->st;
}

status nrrd_writer_create(mem *m, const char *path, bool force, const grid *g, nrrd_writer **out) {
    nrrd_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    w->m = m;
    w->type = g->type;
    w->left = grid_samples(g);
    status st = strcmp(path, "-") == 0 ? ST_OK : out_file_create(m, path, force, &w->file);
    if (st == ST_OK)
        st = write_header(w, g);
    if (st != ST_OK) {
        nrrd_writer_discard(w);
        return st;
    }
    *out = w;
    return ST_OK;
}

/* On a big-endian machine: swapped through a small buffer, so that the caller's samples stay as
 * they are. */
static status write_swapped(nrrd_writer *w, const void *samples, size_t count) {
    uint64_t buffer[512];
    size_t width = sample_size(w->type), step = sizeof buffer / width;
    status st = ST_OK;
    for (size_t done = 0; st == ST_OK && done < count; done += step) {
        size_t part = count - done < step ? count - done : step;
        memcpy(buffer, (const char *)samples + done * width, part * width);
        sample_swap(w->type, buffer, part);
        st = write_bytes(w, buffer, part * width);
    }
    return st;
}

status nrrd_writer_append(nrrd_writer *w, const void *samples, size_t count) {
    assert(count <= w->left);
    w->left -= count;
    if (__BYTE_ORDER == __BIG_ENDIAN)
        return write_swapped(w, samples, count);
    return write_bytes(w, samples, count * sample_size(w->type));
}

status nrrd_writer_commit(nrrd_writer *w) {
    assert(w->left == 0);
    status st = w->file ? out_file_commit(w->file) : ST_OK;
    w->file = NULL;
    nrrd_writer_discard(w);
    return st;
}

void nrrd_writer_discard(nrrd_writer *w) {
    if (!w)
        return;
    out_file_discard(w->file);
    mem_free(w->m, w);
}
