#include "formats/grid/imported.h"

#include <dirent.h>
#include <jansson.h>
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
    size_t lent; /* of m's limit, while the source is open */
    char *path;
    char *field; /* of the hints; NULL: not given */
    uint32_t component, step;
    char program[SIBLING_PATH];
    child c;
    bool running;
} import;

/* What the verb said at last, without its own name in front. */
static const char *last_words(const child *c) {
    const char *line = strrchr(c->words, '\n');
    line = line ? line + 1 : c->words;
    const char *colon = strncmp(line, "leafcast ", 9) == 0 ? strstr(line, ": ") : NULL;
    return colon ? colon + 2 : line;
}

static status verb_failed(const import *x, const child *c, int code) {
    static const status meaning[] = {[2] = ST_USAGE, [3] = ST_CORRUPT, [4] = ST_NOMEM};
    const bool known = code >= 2 && code <= 4;
    if (code > 128)
        return status_describe(ST_CORRUPT, "%s: %s was ended by signal %d over this file", x->path,
                               strrchr(x->program, '/') + 1, code - 128);
    if (code == 4 && x->lent)
        return status_describe(ST_NOMEM, "%s (it has %zu of the budget's %zu MiB)", last_words(c),
                               x->lent >> 20, (x->m->limit + x->m->lent) >> 20);
    return status_describe(known ? meaning[code] : ST_FAILED, "%s", last_words(c));
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
    return st == ST_OK && code != 0 ? verb_failed(x, &x->c, code) : st;
}

static void close_output(void *ctx) {
    import *x = ctx;
    int code;
    mem_take_back(x->m, x->lent);
    if (x->running) {
        child_kill(&x->c);
        if (child_end(&x->c, &code) != ST_OK)
            code = 0; /* nobody is left to tell */
    }
    mem_free(x->m, x->path);
    mem_free(x->m, x->field);
    mem_free(x->m, x);
}

/* ---- starting it ---- */

enum { ARGUMENTS_MAX = 16, NUMBER_MAX = 24 };

/* first: up to three words that say what is wanted. */
static status start(const import *x, const char *const first[3], size_t lent, child *c) {
    char component[NUMBER_MAX], step[NUMBER_MAX], memory[NUMBER_MAX];
    const char *argv[ARGUMENTS_MAX] = {x->program, "-q"};
    int count = 2;
    for (int i = 0; i < 3 && first[i]; i++)
        argv[count++] = first[i];
    const struct {
        bool given;
        const char *option, *value;
    } hints[] = {{x->field, "--field", x->field},
                 {x->component, "--component", component},
                 {x->step, "--step", step},
                 {lent, "--memory", memory}};
    snprintf(memory, sizeof memory, "%zu", lent);
    snprintf(component, sizeof component, "%u", x->component);
    snprintf(step, sizeof step, "%u", x->step);
    for (size_t i = 0; i < sizeof hints / sizeof *hints; i++)
        if (hints[i].given) {
            argv[count++] = hints[i].option;
            argv[count++] = hints[i].value;
        }
    argv[count++] = "--";
    argv[count++] = x->path;
    status st = child_start(x->program, (char *const *)(uintptr_t)argv, true, c);
    if (st == ST_OK)
        child_fed(c);
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

static status copy_hints(import *x, const char *path, const volume_hints *hints) {
    x->path = mem_copy_text(x->m, path);
    x->field = hints->field ? mem_copy_text(x->m, hints->field) : NULL;
    x->component = hints->component;
    x->step = hints->step;
    return x->path && (x->field || !hints->field) ? ST_OK : ST_NOMEM;
}

static status open_import(mem *m, const foreign_format *f, const char *path,
                          const volume_hints *hints, import **out, byte_stream **data) {
    static const char *const samples[3] = {"--tiles", "-o", "-"};
    import *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    x->m = m;
    x->lent = mem_lend_half(m);
    status st = copy_hints(x, path, hints);
    if (st == ST_OK)
        st = find_verb(x, f);
    if (st == ST_OK)
        st = start(x, samples, x->lent, &x->c);
    x->running = st == ST_OK;
    if (st != ST_OK) {
        close_output(x);
        return st;
    }
    *out = x;
    return byte_stream_open_source(m, path, &(byte_source){read_output, close_output, x}, data);
}

/* ---- what fields there are ---- */

enum { LIST_MAX = 1 << 20 };

/* What the verb prints, JSON; it has ended then. */
static status read_list(const import *x, child *c, json_t **out) {
    int code = 0;
    size_t got = 0;
    char *text = mem_alloc(x->m, LIST_MAX);
    status st =
        text ? child_read(c, text, LIST_MAX, &got, keep_on, (void *)(uintptr_t)x) : ST_NOMEM;
    if (st != ST_OK || got == LIST_MAX)
        child_kill(c);
    const status end = child_end(c, &code);
    st = st == ST_OK ? end : st;
    if (st == ST_OK && got == LIST_MAX)
        st = status_describe(ST_UNSUPPORTED, "%s: its fields take more than %d bytes to tell",
                             x->path, LIST_MAX);
    if (st == ST_OK && code != 0)
        st = verb_failed(x, c, code);
    *out = st == ST_OK ? json_loadb(text, got, 0, NULL) : NULL;
    mem_free(x->m, text);
    if (st == ST_OK && !json_is_array(json_object_get(*out, "fields")))
        st = status_describe(ST_FAILED, "%s: %s --list --json: no list of fields", x->path,
                             strrchr(x->program, '/') + 1);
    return st;
}

/* Those that can be read. */
static status tell_items(const json_t *items, const slice_fields *to) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < json_array_size(items); i++) {
        const json_t *item = json_array_get(items, i);
        const char *name = json_string_value(json_object_get(item, "name"));
        const json_int_t steps =
            json_integer_value(json_array_get(json_object_get(item, "shape"), 3));
        const slice_field one = {.name = name,
                                 .steps = steps < 1 || steps > UINT32_MAX ? 1 : (uint32_t)steps,
                                 .taken = json_is_true(json_object_get(item, "taken"))};
        if (name && json_is_true(json_object_get(item, "readable")))
            st = to->take(to->ctx, &one);
    }
    return st;
}

static status tell_fields(void *ctx, const slice_fields *to) {
    static const char *const list[3] = {"--list", "--json", NULL};
    const import *x = ctx;
    json_t *root = NULL;
    child c;
    const size_t lent = mem_lend_half(x->m);
    status st = start(x, list, lent, &c);
    if (st == ST_OK)
        st = read_list(x, &c, &root);
    mem_take_back(x->m, lent);
    if (st == ST_OK)
        st = tell_items(json_object_get(root, "fields"), to);
    json_decref(root);
    return st;
}

/* The verb writes NRRD, or where it knows of quiet parts a tile stream. */
static status open_slices(mem *m, const foreign_format *f, const char *path,
                          const volume_hints *hints, slice_source *out) {
    volume_layout l = {.m = m};
    uint8_t quiet[SLICE_SAMPLE_MAX];
    bool tiles = false;
    import *x = NULL;
    status st = open_import(m, f, path, hints, &x, &l.data);
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
    out->fields = tell_fields;
    out->fields_ctx = x;
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
