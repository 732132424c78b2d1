#include "formats/grid/imported.h"

#include <dirent.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/child.h"
#include "formats/base/file_guard.h"
#include "formats/base/json_text.h"
#include "formats/base/sibling.h"
#include "formats/base/wait.h"
#include "formats/grid/imported_chunks.h"
#include "formats/grid/layout_slices.h"
#include "formats/grid/nrrd.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/tile_stream.h"
#include "formats/input/foreign.h"

/* ---- the importer's output ---- */

typedef struct import {
    mem *m;
    size_t lent; /* bytes of m's limit that are lent while the source is open */
    char *path;
    char *field; /* the hints' field; NULL: not given */
    char place[GRID_PLACE_MAX], fields[GRID_FIELDS_MAX];
    uint32_t component, step;
    input_trust trust;
    char program[SIBLING_PATH];
    child c;
    bool running;
    uint32_t dims[3];
    sample_type type; /* of the grid's samples in a treelet file */
    imported_chunks chunks;
} import;

/* Returns the importer's last message, without its own name in front. */
static const char *last_words(const child *c) {
    const char *line = strrchr(c->words, '\n');
    line = line ? line + 1 : c->words;
    const char *colon = strncmp(line, "leafcast ", 9) == 0 ? strstr(line, ": ") : NULL;
    return colon ? colon + 2 : line;
}

/* Describe the end by a signal. Crashes are the file's fault; other signals come from a user, or
 * from the system when memory runs out. */
static status verb_ended(const import *x, int number) {
    static const int crashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS};
    const char *program = strrchr(x->program, '/') + 1;
    if (number == SIGKILL)
        return status_describe(ST_NOMEM,
                               "%s: %s was killed over this file (signal 9), as the system does "
                               "when its memory runs out",
                               x->path, program);
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++)
        if (number == crashes[i])
            return status_describe(ST_CORRUPT, "%s: %s was ended by signal %d over this file (%s)",
                                   x->path, program, number, strsignal(number));
    return status_describe(number == SIGXCPU ? ST_NOMEM : ST_FAILED,
                           "%s: %s was ended by signal %d (%s)", x->path, program, number,
                           strsignal(number));
}

enum { EXIT_NOT_LOADED = 127 };

/* Describe a program that cannot be loaded. The system's loader gives its reason in words alone. */
static status verb_not_loaded(const import *x, const child *c) {
    static const char *const memory[] = {"cannot map", "failed to map", "annot allocate"};
    status st = ST_FAILED;
    for (size_t i = 0; i < sizeof memory / sizeof *memory; i++)
        st = strstr(c->words, memory[i]) ? ST_NOMEM : st;
    return status_describe(st, "%s: %s cannot be loaded: %s", x->path, strrchr(x->program, '/') + 1,
                           last_words(c));
}

static status verb_failed(const import *x, const child *c, int code) {
    static const status meaning[] = {[2] = ST_USAGE, [3] = ST_CORRUPT, [4] = ST_NOMEM};
    const bool known = code >= 2 && code <= 4;
    if (code > 128)
        return verb_ended(x, code - 128);
    if (code == EXIT_NOT_LOADED)
        return verb_not_loaded(x, c);
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
            code = 0; /* there is no caller left to tell */
    }
    imported_chunks_release(&x->chunks);
    mem_free(x->m, x->path);
    mem_free(x->m, x->field);
    mem_free(x->m, x);
}

/* ---- starting it ---- */

/* A command line. It owns copies of its words. */
typedef struct command {
    mem *m;
    char **words; /* NULL behind the last word */
    size_t count, room;
} command;

static status add_word(void *ctx, const char *word) {
    command *c = ctx;
    char *copy = mem_copy_text(c->m, word);
    const size_t taken = c->count ? c->count + 1 : 0;
    status st = copy ? mem_grow(c->m, &c->words, sizeof *c->words, taken, 32, &c->room) : ST_NOMEM;
    if (st != ST_OK) {
        mem_free(c->m, copy);
        return st;
    }
    c->words[c->count++] = copy;
    c->words[c->count] = NULL;
    return ST_OK;
}

static status add_option(command *c, const char *option, const char *value) {
    status st = add_word(c, option);
    return st == ST_OK ? add_word(c, value) : st;
}

static status add_number(command *c, const char *option, size_t value) {
    char text[24];
    snprintf(text, sizeof text, "%zu", value);
    return value ? add_option(c, option, text) : ST_OK;
}

/* Name a file that this process writes. The importer reads files unknown to this process, and must
 * not read this one. */
static status add_output(void *ctx, const char *path) {
    return add_option(ctx, "--guard", path);
}

static void release_command(command *c) {
    for (size_t i = 0; i < c->count; i++)
        mem_free(c->m, c->words[i]);
    mem_free(c->m, c->words);
}

/* Write the command line. first: up to three words that say what is wanted. */
static status write_command(const import *x, const char *const first[3], size_t lent, command *c) {
    status st = add_word(c, x->program);
    if (st == ST_OK)
        st = add_word(c, "-q");
    for (int i = 0; i < 3 && first[i] && st == ST_OK; i++)
        st = add_word(c, first[i]);
    if (st == ST_OK && x->field)
        st = add_option(c, "--field", x->field);
    if (st == ST_OK)
        st = add_number(c, "--component", x->component);
    if (st == ST_OK)
        st = add_number(c, "--step", x->step);
    if (st == ST_OK)
        st = add_number(c, "--memory", lent);
    if (st == ST_OK && x->trust.follow_links)
        st = add_word(c, "--follow-links");
    if (st == ST_OK && x->trust.allow_missing)
        st = add_word(c, "--allow-missing");
    if (st == ST_OK)
        st = file_guard_each_output(x->m, add_output, c);
    return st == ST_OK ? add_option(c, "--", x->path) : st;
}

static status start(const import *x, const char *const first[3], size_t lent, child *out) {
    command c = {.m = x->m};
    status st = write_command(x, first, lent, &c);
    if (st == ST_OK)
        st = child_start(x->program, c.words, true, out);
    if (st == ST_OK)
        child_fed(out);
    release_command(&c);
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
    x->trust = hints->trust;
    return x->path && (x->field || !hints->field) ? ST_OK : ST_NOMEM;
}

/* Let go of a child that was asked for something. */
static void end_asking(void *ctx) {
    import *x = ctx;
    int code;
    if (!x->running)
        return;
    child_kill(&x->c);
    if (child_end(&x->c, &code) != ST_OK)
        code = 0; /* what was read has been judged */
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

/* Read the JSON that the importer prints. It has ended then. */
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
    json_error_t error;
    *out = st == ST_OK ? json_loadb(text, got, 0, &error) : NULL;
    mem_free(x->m, text);
    if (st == ST_OK && !json_is_array(json_object_get(*out, "fields")))
        st = status_describe(*out ? ST_FAILED : json_text_status(&error, ST_FAILED),
                             "%s: %s --list --json: no list of fields", x->path,
                             strrchr(x->program, '/') + 1);
    return st;
}

/* Read one time for each step; *out is NULL where there are none. */
static status read_times(mem *m, const json_t *item, uint32_t steps, double **out) {
    const json_t *times = json_object_get(item, "times");
    *out = NULL;
    if (json_array_size(times) != steps)
        return ST_OK;
    *out = mem_array(m, steps, sizeof **out);
    for (uint32_t i = 0; *out && i < steps; i++)
        (*out)[i] = json_number_value(json_array_get(times, i));
    return *out ? ST_OK : ST_NOMEM;
}

/* Tell the fields that can be read. */
static status tell_items(mem *m, const json_t *items, const slice_fields *to) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < json_array_size(items); i++) {
        const json_t *item = json_array_get(items, i);
        const char *name = json_string_value(json_object_get(item, "name"));
        const json_int_t steps =
            json_integer_value(json_array_get(json_object_get(item, "shape"), 3));
        slice_field one = {.name = name,
                           .steps = steps < 1 || steps > UINT32_MAX ? 1 : (uint32_t)steps,
                           .taken = json_is_true(json_object_get(item, "taken"))};
        one.components = (uint32_t)json_integer_value(json_object_get(item, "components"));
        one.component = (uint32_t)json_integer_value(json_object_get(item, "component"));
        one.colours = json_is_true(json_object_get(item, "colours"));
        double *times = NULL;
        if (!name || !json_is_true(json_object_get(item, "readable")))
            continue;
        st = read_times(m, item, one.steps, &times);
        one.times = times;
        one.time_unit = json_string_value(json_object_get(item, "time_unit"));
        if (st == ST_OK)
            st = to->take(to->ctx, &one);
        if (times)
            mem_free(m, times);
    }
    return st;
}

/* Start the importer again, which lists the fields. */
static status ask_for_fields(const import *x, json_t **out) {
    static const char *const list[3] = {"--list", "--json", NULL};
    child c;
    const size_t lent = mem_lend_half(x->m);
    status st = start(x, list, lent, &c);
    if (st == ST_OK)
        st = read_list(x, &c, out);
    mem_take_back(x->m, lent);
    return st;
}

static status tell_fields(void *ctx, const slice_fields *to) {
    const import *x = ctx;
    json_t *root = json_loads(x->fields, 0, NULL);
    status st = ST_OK;
    if (!json_is_array(json_object_get(root, "fields"))) {
        json_decref(root);
        root = NULL;
        st = ask_for_fields(x, &root);
    }
    if (st == ST_OK)
        st = tell_items(x->m, json_object_get(root, "fields"), to);
    json_decref(root);
    return st;
}

/* Start the importer again, which tells where the chunks are. */
static status ask_for_chunks(import *x, sample_place *out) {
    static const char *const words[3] = {"--chunks", "-o", "-"};
import again = {.m = x->m, .path = x->path, .field = x->field };
    byte_stream *s = NULL;
    again.component = x->component;
    again.step = x->step;
    again.trust = x->trust;
    memcpy(again.program, x->program, sizeof again.program);
    again.lent = mem_lend_half(x->m);
    status st = start(&again, words, again.lent, &again.c);
    again.running = st == ST_OK;
    if (st == ST_OK)
        st = byte_stream_open_source(x->m, x->path, &(byte_source){read_output, end_asking, &again},
                                     &s);
    x->chunks.m = x->m;
    if (st == ST_OK)
        st = imported_chunks_read(s, x->path, x->dims, x->type, &x->chunks, out);
    byte_stream_close(s);
    mem_take_back(x->m, again.lent);
    return st;
}

static bool find_place(void *ctx, sample_place *out) {
    import *x = ctx;
    const size_t refused = sizeof SAMPLE_PLACE_REFUSED - 1;
    *out = (sample_place){.path = x->path};
    if (strncmp(x->place, SAMPLE_PLACE_REFUSED, refused) == 0)
        out->refused = x->place + refused;
    else if (sample_place_is_chunks(x->place) && ask_for_chunks(x, out) != ST_OK)
        out->refused = status_text();
    else if (!out->chunks && !sample_place_parse(x->place, out))
        return false;
    out->path = x->path;
    return true;
}

/* Open what the importer writes: NRRD, or a tile stream where it knows of quiet parts. */
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
    if (st == ST_OK) /* the importer has applied the hints */
        st = volume_layout_settle(&l, &(volume_hints){0});
    if (st == ST_OK)
        st = volume_layout_check(&l);
    if (st == ST_OK) {
        memcpy(x->place, l.g.place, sizeof x->place);
        memcpy(x->fields, l.g.fields, sizeof x->fields);
        memcpy(x->dims, l.g.dims, sizeof x->dims);
        x->type = sample_stored(l.g.type);
    }
    if (st == ST_OK)
        st = tiles ? tile_stream_open(&l, quiet, out) : layout_slices_open(&l, out);
    volume_layout_release(&l);
    out->format = f->name;
    out->importer = f->importer;
    out->has_fields = true;
    out->fields = tell_fields;
    out->fields_ctx = x;
    out->place = find_place;
    out->place_ctx = x;
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
