#include "formats/input/importing.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/child.h"
#include "formats/base/file_guard.h"
#include "formats/base/json_text.h"
#include "formats/base/num.h"
#include "formats/base/wait.h"

/* ---- what it says when it fails ---- */

/* Returns the importer's last message, without its own name in front. */
static const char *last_words(const child *c) {
    const char *line = strrchr(c->words, '\n');
    line = line ? line + 1 : c->words;
    const char *colon = strncmp(line, "leafcast ", 9) == 0 ? strstr(line, ": ") : NULL;
    return colon ? colon + 2 : line;
}

/* Describe the end by a signal. Crashes are the file's fault; other signals come from a user, or
 * from the system when memory runs out. */
static status verb_ended(const importing *x, int number) {
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
static status verb_not_loaded(const importing *x, const child *c) {
    static const char *const memory[] = {"cannot map", "failed to map", "annot allocate"};
    status st = ST_FAILED;
    for (size_t i = 0; i < sizeof memory / sizeof *memory; i++)
        st = strstr(c->words, memory[i]) ? ST_NOMEM : st;
    return status_describe(st, "%s: %s cannot be loaded: %s", x->path, strrchr(x->program, '/') + 1,
                           last_words(c));
}

static status verb_failed(const importing *x, const child *c, size_t lent, int code) {
    static const status meaning[] = {[2] = ST_USAGE, [3] = ST_CORRUPT, [4] = ST_NOMEM};
    const bool known = code >= 2 && code <= 4;
    if (code > 128)
        return verb_ended(x, code - 128);
    if (code == EXIT_NOT_LOADED)
        return verb_not_loaded(x, c);
    if (code == 4 && lent)
        return status_describe(ST_NOMEM, "%s (it has %zu of the budget's %zu MiB)", last_words(c),
                               lent >> 20, (x->m->limit + x->m->lent) >> 20);
    return status_describe(known ? meaning[code] : ST_FAILED, "%s", last_words(c));
}

/* ---- its command line ---- */

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
static status write_command(const importing *x, const char *const first[3], size_t lent,
                            command *c) {
    char text[NUM_TEXT_MAX];
    status st = add_word(c, x->program);
    if (st == ST_OK)
        st = add_word(c, "-q");
    for (int i = 0; i < 3 && first[i] && st == ST_OK; i++)
        st = add_word(c, first[i]);
    for (size_t i = 0; i < x->field_count && st == ST_OK; i++)
        st = add_option(c, "--field", x->fields[i]);
    if (st == ST_OK)
        st = add_number(c, "--component", x->component);
    if (st == ST_OK)
        st = add_number(c, "--step", x->step);
    if (st == ST_OK && x->by_corners)
        st = add_word(c, "--by-corners");
    if (st == ST_OK && x->cells_to_points)
        st = add_word(c, "--cells-to-points");
    if (st == ST_OK && x->zones)
        st = add_word(c, "--zones");
    if (st == ST_OK && x->to)
        st = add_option(c, "--to", x->to);
    if (st == ST_OK && x->exaggerate != 0)
        st = add_option(c, "--exaggerate", num_print(x->exaggerate, text));
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

/* ---- what is asked ---- */

status importing_init(importing *x, mem *m, const foreign_format *f, const char *path) {
    char verb[64];
    *x = (importing){.m = m, .path = mem_copy_text(m, path)};
    snprintf(verb, sizeof verb, "leafcast-import-%s", f->importer);
    if (!x->path)
        return ST_NOMEM;
    if (sibling_find(verb, x->program))
        return ST_OK;
    return status_describe(
        ST_UNSUPPORTED,
        "%s: this is %s, and %s, which reads it, is not there: it is built where "
        "its library is installed (scripts/setup-debian)",
        path, f->name, verb);
}

static void drop_fields(importing *x) {
    for (size_t i = 0; i < x->field_count; i++)
        mem_free(x->m, x->fields[i]);
    mem_free(x->m, x->fields);
    x->fields = NULL;
    x->field_count = 0;
}

void importing_release(importing *x) {
    drop_fields(x);
    mem_free(x->m, x->path);
}

status importing_take(importing *x, const char *const *names, size_t count) {
    drop_fields(x);
    if (count == 1 && !names[0])
        return ST_OK;
    x->fields = mem_array(x->m, count, sizeof *x->fields);
    for (size_t i = 0; x->fields && i < count; i++) {
        char *copy = mem_copy_text(x->m, names[i]);
        if (!copy)
            return ST_NOMEM;
        x->fields[x->field_count++] = copy;
    }
    return x->fields ? ST_OK : ST_NOMEM;
}

/* ---- a run of it ---- */

typedef struct run {
    importing *x;
    size_t lent;
    child c;
    bool runs;
    void (*closed)(void *ctx);
    void *ctx;
} run;

static status begin(run *r, const char *const words[3]) {
    command c = {.m = r->x->m};
    r->lent = mem_lend_half(r->x->m);
    status st = write_command(r->x, words, r->lent, &c);
    if (st == ST_OK)
        st = child_start(r->x->program, c.words, true, &r->c);
    r->runs = st == ST_OK;
    if (st == ST_OK)
        child_fed(&r->c);
    release_command(&c);
    return st;
}

static void end(run *r) {
    int code;
    mem_take_back(r->x->m, r->lent);
    if (!r->runs)
        return;
    child_kill(&r->c);
    if (child_end(&r->c, &code) != ST_OK)
        code = 0; /* there is no caller left to tell */
}

static status keep_on(void *ctx) {
    return wait_stopped(((run *)ctx)->x->path);
}

static status read_output(void *ctx, void *to, size_t size, size_t *got) {
    run *r = ctx;
    int code = 0;
    *got = 0;
    if (!r->runs)
        return ST_OK;
    status st = child_read(&r->c, to, size, got, keep_on, r);
    if (st != ST_OK || *got == size)
        return st;
    r->runs = false;
    st = child_end(&r->c, &code);
    return st == ST_OK && code != 0 ? verb_failed(r->x, &r->c, r->lent, code) : st;
}

static void close_output(void *ctx) {
    run *r = ctx;
    const run last = *r;
    end(r);
    mem_free(last.x->m, r);
    if (last.closed)
        last.closed(last.ctx);
}

status importing_stream(importing *x, const char *const words[3], void (*closed)(void *ctx),
                        void *ctx, byte_stream **out) {
    run *r = mem_zalloc(x->m, sizeof *r);
    if (!r && closed)
        closed(ctx);
    if (!r)
        return ST_NOMEM;
    *r = (run){.x = x, .closed = closed, .ctx = ctx};
    const status st = begin(r, words);
    if (st != ST_OK) {
        close_output(r);
        return st;
    }
    return byte_stream_open_source(x->m, x->path, &(byte_source){read_output, close_output, r},
                                   out);
}

/* ---- the list of its fields ---- */

enum { LIST_MAX = 64 << 20, LIST_LEAST = 1 << 12 };

/* Read the JSON. Nothing of it is left behind LIST_MAX bytes. */
static status read_list(run *r, json_t **out) {
    const importing *x = r->x;
    size_t size = 0, room = 0;
    char *text = NULL;
    status st = ST_OK;
    while (st == ST_OK && size == room && size < LIST_MAX) {
        size_t got = 0;
        st = mem_grow(x->m, &text, 1, size, LIST_LEAST, &room);
        if (st == ST_OK)
            st = read_output(r, text + size, room - size, &got);
        size += got;
    }
    if (st == ST_OK && size >= LIST_MAX)
        st = status_describe(ST_UNSUPPORTED, "%s: its fields take more than %d bytes to tell",
                             x->path, LIST_MAX);
    json_error_t error;
    *out = st == ST_OK ? json_loadb(text, size, 0, &error) : NULL;
    mem_free(x->m, text);
    if (st == ST_OK && !json_is_array(json_object_get(*out, "fields")))
        st = status_describe(*out ? ST_FAILED : json_text_status(&error, ST_FAILED),
                             "%s: %s --list --json: no list of fields", x->path,
                             strrchr(x->program, '/') + 1);
    return st;
}

status importing_list(importing *x, json_t **out) {
    static const char *const list[3] = {"--list", "--json", NULL};
    run r = {.x = x};
    status st = begin(&r, list);
    *out = NULL;
    if (st == ST_OK)
        st = read_list(&r, out);
    end(&r);
    if (st != ST_OK) {
        json_decref(*out);
        *out = NULL;
    }
    return st;
}

uint32_t importing_steps(const json_t *field) {
    const json_int_t steps = json_integer_value(json_array_get(json_object_get(field, "shape"), 3));
    return steps < 1 || steps > UINT32_MAX ? 1 : (uint32_t)steps;
}

status importing_times(mem *m, const json_t *times, uint32_t steps, double **out) {
    *out = NULL;
    if (json_array_size(times) != steps)
        return ST_OK;
    *out = mem_array(m, steps, sizeof **out);
    for (uint32_t i = 0; *out && i < steps; i++)
        (*out)[i] = json_number_value(json_array_get(times, i));
    return *out ? ST_OK : ST_NOMEM;
}
