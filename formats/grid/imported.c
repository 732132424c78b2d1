#include "formats/grid/imported.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/child.h"
#include "formats/base/sibling.h"
#include "formats/base/wait.h"
#include "formats/grid/layout_slices.h"
#include "formats/grid/nrrd.h"
#include "formats/grid/tile_stream.h"
#include "formats/input/foreign.h"

/* ---- the verb's output ---- */

typedef struct import {
    mem *m;
    size_t lent; /* of m's limit, while the verb runs */
    char *path;
    char program[SIBLING_PATH];
    child c;
    bool running;
} import;

/* What the verb said at last, without its own name in front. */
static const char *last_words(const import *x) {
    const char *line = strrchr(x->c.words, '\n');
    line = line ? line + 1 : x->c.words;
    const char *colon = strncmp(line, "leafcast ", 9) == 0 ? strstr(line, ": ") : NULL;
    return colon ? colon + 2 : line;
}

static status verb_failed(const import *x, int code) {
    static const status meaning[] = {[2] = ST_USAGE, [3] = ST_CORRUPT, [4] = ST_NOMEM};
    const bool known = code >= 2 && code <= 4;
    if (code > 128)
        return status_describe(ST_CORRUPT, "%s: %s was ended by signal %d over this file", x->path,
                               strrchr(x->program, '/') + 1, code - 128);
    return status_describe(known ? meaning[code] : ST_FAILED, "%s", last_words(x));
}

static status keep_on(void *ctx) {
    return wait_stopped(((import *)ctx)->path);
}

static status read_output(void *ctx, void *to, size_t size, size_t *got) {
    import *x = ctx;
    int code = 0;
    *got = 0;
    if (!x->running)
        return ST_OK;
    status st = child_read(&x->c, to, size, got, keep_on, x);
    if (st != ST_OK || *got == size)
        return st;
    x->running = false;
    st = child_end(&x->c, &code);
    return st == ST_OK && code != 0 ? verb_failed(x, code) : st;
}

static void close_output(void *ctx) {
    import *x = ctx;
    int code;
    x->m->limit += x->lent;
    if (x->running) {
        child_kill(&x->c);
        if (child_end(&x->c, &code) != ST_OK)
            code = 0; /* nobody is left to tell */
    }
    mem_free(x->m, x->path);
    mem_free(x->m, x);
}

/* ---- starting it ---- */

enum { ARGUMENTS_MAX = 16, NUMBER_MAX = 24 };

static status start(import *x, const volume_hints *h) {
    char component[NUMBER_MAX], step[NUMBER_MAX], memory[NUMBER_MAX];
    const char *argv[ARGUMENTS_MAX] = {x->program, "-q", "--tiles", "-o", "-"};
    int count = 5;
    const struct {
        bool given;
        const char *option, *value;
    } hints[] = {{h->field, "--field", h->field},
                 {h->component, "--component", component},
                 {h->step, "--step", step},
                 {x->lent, "--memory", memory}};
    snprintf(memory, sizeof memory, "%zu", x->lent);
    snprintf(component, sizeof component, "%u", h->component);
    snprintf(step, sizeof step, "%u", h->step);
    for (size_t i = 0; i < sizeof hints / sizeof *hints; i++)
        if (hints[i].given) {
            argv[count++] = hints[i].option;
            argv[count++] = hints[i].value;
        }
    argv[count++] = "--";
    argv[count++] = x->path;
    status st = child_start(x->program, (char *const *)(uintptr_t)argv, true, &x->c);
    x->running = st == ST_OK;
    if (x->running)
        child_fed(&x->c);
    return st;
}

static status find_verb(import *x, const foreign_format *f) {
    char verb[64];
    snprintf(verb, sizeof verb, "leafcast-import-%s", f->importer);
    if (sibling_find(verb, x->program))
        return ST_OK;
    return status_describe(
        ST_UNSUPPORTED,
        "%s: this is %s, and %s, which reads it, is not there: it is built where "
        "its library is installed (scripts/setup-debian)",
        x->path, f->name, verb);
}

static status open_import(mem *m, const foreign_format *f, const char *path,
                          const volume_hints *hints, byte_stream **out) {
    import *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    x->m = m;
    x->path = mem_copy_text(m, path);
    x->lent = m->limit / 2;
    m->limit -= x->lent;
    status st = x->path ? find_verb(x, f) : ST_NOMEM;
    if (st == ST_OK)
        st = start(x, hints);
    if (st != ST_OK) {
        close_output(x);
        return st;
    }
    return byte_stream_open_source(m, path, &(byte_source){read_output, close_output, x}, out);
}

/* The verb writes NRRD, or where it knows of quiet parts a tile stream. */
static status open_slices(mem *m, const foreign_format *f, const char *path,
                          const volume_hints *hints, slice_source *out) {
    volume_layout l = {.m = m};
    uint8_t quiet[SLICE_SAMPLE_MAX];
    bool tiles = false;
    status st = open_import(m, f, path, hints, &l.data);
    if (st == ST_OK)
        st = tile_stream_known(&l, &tiles, quiet);
    if (st == ST_OK)
        st = nrrd_reader.layout(&l, hints);
    if (st == ST_OK) /* the verb has made the choice */
        st = volume_layout_settle(&l, &(volume_hints){0});
    if (st == ST_OK)
        st = volume_layout_check(&l);
    if (st == ST_OK)
        st = tiles ? tile_stream_open(&l, quiet, out) : layout_slices_open(&l, out);
    volume_layout_release(&l);
    out->format = f->name;
    out->importer = f->importer;
    out->has_fields = true;
    return st;
}

/* ---- a file ---- */

static bool known(const char *path, const uint8_t *start_, size_t size) {
    const foreign_format *f = foreign_find(path, start_, size, UINT64_MAX);
    return f && f->importer;
}

static status open_file(volume_layout *l, const volume_hints *hints, slice_source *out) {
    const uint8_t *bytes;
    size_t size;
    status st = byte_stream_peek(l->data, FOREIGN_PEEK, &bytes, &size);
    if (st != ST_OK)
        return st;
    const char *kind = byte_stream_kind(l->data);
    const foreign_format *f = foreign_find(kind, bytes, size, UINT64_MAX);
    if (strcmp(l->path, "-") == 0 || strcmp(l->path, kind) != 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: this is %s, whose library needs a file that is not packed",
                               byte_stream_name(l->data), f->name);
    return open_slices(l->m, f, l->path, hints, out);
}

const grid_reader imported_reader = {.format = "imported", .known = known, .slices = open_file};

/* ---- a folder ---- */

static const foreign_format *format_of(mem *m, const char *folder, const char *name) {
    char path[SIBLING_PATH];
    const foreign_format *f = NULL;
    const uint8_t *bytes;
    size_t size;
    byte_stream *s = NULL;
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
        return NULL;
    if (byte_stream_open_stored(m, path, &s) == ST_OK &&
        byte_stream_peek(s, FOREIGN_PEEK, &bytes, &size) == ST_OK)
        f = foreign_find(path, bytes, size, UINT64_MAX);
    byte_stream_close(s);
    return f && f->importer ? f : NULL;
}

static int visible(const struct dirent *entry) {
    return entry->d_name[0] != '.' && entry->d_type != DT_DIR && entry->d_type != DT_FIFO;
}

status imported_folder(mem *m, const char *path, const volume_hints *hints, slice_source *out) {
    struct dirent **names = NULL;
    const foreign_format *f = NULL;
    const int count = scandir(path, &names, visible, alphasort);
    for (int i = 0; i < count; i++) {
        f = f ? f : format_of(m, path, names[i]->d_name);
        free(names[i]);
    }
    free(names);
    if (f)
        return open_slices(m, f, path, hints, out);
    return status_describe(ST_UNSUPPORTED,
                           "%s: a folder without a file of a known format: expected the slices of "
                           "an image stack or of a DICOM series",
                           path);
}
