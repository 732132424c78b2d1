#include "prep/convert_job.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "0"
#endif

enum { TEXT_MAX = 1 << 22, VALUE_ROOM = 128 };

/* A line: what it is about, then its value. */
#define BETWEEN '\t'

/* ---- writing it ---- */

static status add(convert_job *j, const char *text) {
    for (; *text; text++) {
        status st = mem_grow(j->m, &j->text, 1, j->length, 256, &j->room);
        if (st != ST_OK)
            return st;
        j->text[j->length++] = *text;
    }
    return ST_OK;
}

/* Line feeds and tabs in a name or value become blanks. */
static status add_plain(convert_job *j, const char *text) {
    const size_t from = j->length;
    status st = add(j, text);
    for (size_t i = from; i < j->length; i++)
        if (j->text[i] == '\n' || j->text[i] == BETWEEN)
            j->text[i] = ' ';
    return st;
}

static status add_line(convert_job *j, const char *prefix, const char *name, const char *value) {
    status st = add(j, prefix);
    if (st == ST_OK)
        st = add_plain(j, name);
    if (st == ST_OK)
        st = add(j, (const char[]){BETWEEN, '\0'});
    if (st == ST_OK)
        st = add_plain(j, value);
    return st == ST_OK ? add(j, "\n") : st;
}

status convert_job_init(convert_job *j, mem *m, const char *output) {
    *j = (convert_job){.m = m, .output = output};
    return add_line(j, "", "the program", "leafcast " LEAFCAST_VERSION);
}

void convert_job_release(convert_job *j) {
    if (j->m)
        mem_free(j->m, j->text);
    *j = (convert_job){0};
}

status convert_job_option(convert_job *j, const char *name, const char *value) {
    return add_line(j, "--", name, value);
}

status convert_job_input(convert_job *j, const char *path) {
    char value[VALUE_ROOM] = "";
    struct stat s;
    if (strcmp(path, "-") != 0 && stat(path, &s) == 0)
        snprintf(value, sizeof value, "%lld bytes, written at %lld.%09ld s",
                 (long long)(S_ISDIR(s.st_mode) ? 0 : s.st_size), (long long)s.st_mtim.tv_sec,
                 s.st_mtim.tv_nsec);
    return add_line(j, "input ", path, value);
}

/* ---- comparing ---- */

typedef struct line {
    const char *name, *value;
    int name_length, value_length;
} line;

/* Take the line at `at`. Returns where the next one is. */
static const char *take_line(const char *at, const char *end, line *l) {
    const char *stop = memchr(at, '\n', (size_t)(end - at));
    stop = stop ? stop : end;
    const char *tab = memchr(at, BETWEEN, (size_t)(stop - at));
    tab = tab ? tab : stop;
    *l = (line){at, tab < stop ? tab + 1 : stop, (int)(tab - at),
                (int)(tab < stop ? stop - tab - 1 : 0)};
    return stop < end ? stop + 1 : end;
}

static bool same_name(const line *a, const line *b) {
    return a->name_length == b->name_length &&
           memcmp(a->name, b->name, (size_t)a->name_length) == 0;
}

static bool has_name(const char *text, const char *end, const line *name) {
    line l;
    while (text < end) {
        text = take_line(text, end, &l);
        if (same_name(&l, name))
            return true;
    }
    return false;
}

enum { VALUE_TEXT = 160 };

static const char *value_text(const line *l, char text[VALUE_TEXT]) {
    if (!l->name_length)
        return "not given";
    snprintf(text, VALUE_TEXT, "%s%.*s%s", l->value_length ? "\"" : "given", l->value_length,
             l->value, l->value_length ? "\"" : "");
    return text;
}

/* One of them may be no line: there is none of this name. */
static status differs(const convert_job *j, const line *then, const line *now) {
    const line *l = then->name_length ? then : now;
    char was[VALUE_TEXT], is[VALUE_TEXT];
    return status_describe(
        strncmp(l->name, "--", 2) == 0 ? ST_USAGE : ST_CORRUPT,
        "%s: %.*s was %s when the unfinished work began, and is %s now: --resume "
        "needs the same, --force begins again",
        j->output, l->name_length, l->name, value_text(then, was), value_text(now, is));
}

/* Find the first line that differs. */
static status compare(const convert_job *j, const char *then, size_t size) {
    const char *a = then, *a_end = then + size, *b = j->text, *b_end = b + j->length;
    while (a < a_end || b < b_end) {
        line before = {"", "", 0, 0}, now = before;
        const line none = before;
        const char *next_a = a < a_end ? take_line(a, a_end, &before) : a;
        const char *next_b = b < b_end ? take_line(b, b_end, &now) : b;
        if (!same_name(&before, &now))
            return before.name_length && !has_name(b, b_end, &before) ? differs(j, &before, &none)
                   : now.name_length                                  ? differs(j, &none, &now)
                                                                      : differs(j, &before, &none);
        if (before.value_length != now.value_length ||
            memcmp(before.value, now.value, (size_t)now.value_length) != 0)
            return differs(j, &before, &now);
        a = next_a;
        b = next_b;
    }
    return ST_OK;
}

status convert_job_keep(convert_job *j, state_io *io) {
    uint64_t size = j->length;
    status st = STATE_IO(io, size);
    if (st != ST_OK)
        return st;
    if (!state_io_loads(io))
        return state_io_bytes(io, j->text, j->length);
    if (size > TEXT_MAX)
        return state_io_fault(io);
    char *then = mem_alloc(j->m, (size_t)size + 1);
    st = then ? state_io_bytes(io, then, (size_t)size) : ST_NOMEM;
    if (st == ST_OK)
        st = compare(j, then, (size_t)size);
    mem_free(j->m, then);
    return st;
}
