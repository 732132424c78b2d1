#include "render/app/image_helper.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/child.h"
#include "formats/base/sibling.h"

static const char HELPER[] = "leafcast-write-image";
enum { CHUNK_VALUES = 16384, NAME_BYTES = 32, FORMAT_BYTES = 8, ANSWER_BYTES = 12 };

struct image_helper {
    mem *m;
    child process;
    bool ended;
    bool (*stop)(void *);
    void *ctx;
    float buffer[CHUNK_VALUES];
};

static status find(char program[SIBLING_PATH]) {
    if (sibling_find(HELPER, program))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s is not there: EXR needs it (built where OpenImageIO is installed; "
                           "PNG, PPM and PFM do without)",
                           HELPER);
}

status image_helper_check(void) {
    char program[SIBLING_PATH];
    return find(program);
}

static status wait_for(void *ctx) {
    const image_helper *h = ctx;
    return h->stop && h->stop(h->ctx) ? status_describe(ST_STOPPED, "stopped") : ST_OK;
}

status image_helper_start(mem *m, bool (*stop)(void *), void *ctx, image_helper **out) {
    char program[SIBLING_PATH];
    char *argv[] = {program, NULL};
    status st = find(program);
    if (st != ST_OK)
        return st;
    image_helper *h = mem_zalloc(m, sizeof *h);
    if (!h)
        return ST_NOMEM;
    h->m = m;
    h->stop = stop;
    h->ctx = ctx;
    st = child_start(program, argv, true, &h->process);
    if (st != ST_OK) {
        mem_free(m, h);
        return st;
    }
    h->process.wait = wait_for;
    h->process.wait_ctx = h;
    *out = h;
    return ST_OK;
}

void image_helper_end(image_helper *h) {
    int code;
    if (!h)
        return;
    /* Kill the helper: no answer is pending, and it may still be loading its library. */
    if (!h->ended) {
        child_kill(&h->process);
        h->ended = child_end(&h->process, &code) == ST_OK;
    }
    mem_free(h->m, h);
}

/* ---- The stream ---- */

static bool feed_u32(child *c, uint32_t value) {
    const unsigned char bytes[4] = {(unsigned char)value, (unsigned char)(value >> 8),
                                    (unsigned char)(value >> 16), (unsigned char)(value >> 24)};
    return child_feed(c, bytes, sizeof bytes);
}

static bool feed_text(child *c, const char *text) {
    const size_t n = strlen(text);
    return feed_u32(c, (uint32_t)n) && child_feed(c, text, n);
}

typedef enum plane_kind { PLANE_FLOAT, PLANE_DOUBLE, PLANE_INT } plane_kind;

typedef struct plane {
    const char *name;
    const void *data;
    plane_kind kind;
} plane;

enum { PLANES = 11 };

/* List the planes that the image has. Returns their number. */
static int planes_of(const leafcast_image *image, plane out[PLANES]) {
    const plane all[PLANES] = {
        {"R", image->r, PLANE_FLOAT},           {"G", image->g, PLANE_FLOAT},
        {"B", image->b, PLANE_FLOAT},           {"A", image->a, PLANE_FLOAT},
        {"Z", image->z, PLANE_DOUBLE},          {"N.x", image->normal[0], PLANE_FLOAT},
        {"N.y", image->normal[1], PLANE_FLOAT}, {"N.z", image->normal[2], PLANE_FLOAT},
        {"id", image->id, PLANE_INT},           {"error", image->error, PLANE_DOUBLE},
        {"value", image->value, PLANE_DOUBLE},
    };
    int n = 0;
    for (int i = 0; i < PLANES; i++)
        if (all[i].data)
            out[n++] = all[i];
    return n;
}

/* Convert the values first .. first + count - 1 of a plane to floats. */
static void convert(const plane *p, size_t first, size_t count, float *out) {
    for (size_t i = 0; i < count; i++) {
        const size_t at = first + i;
        switch (p->kind) {
        case PLANE_FLOAT: out[i] = ((const float *)p->data)[at]; break;
        case PLANE_DOUBLE: out[i] = (float)((const double *)p->data)[at]; break;
        case PLANE_INT: out[i] = (float)((const int32_t *)p->data)[at]; break;
        }
    }
}

static bool feed_plane(image_helper *h, const plane *p, size_t count) {
    for (size_t first = 0; first < count; first += CHUNK_VALUES) {
        const size_t n = count - first < CHUNK_VALUES ? count - first : CHUNK_VALUES;
        convert(p, first, n, h->buffer);
        if (!child_feed(&h->process, h->buffer, n * sizeof *h->buffer))
            return false;
    }
    return true;
}

static bool feed_picture(image_helper *h, const char *format, const picture *p) {
    plane planes[PLANES];
    const int count = planes_of(p->image, planes);
    child *c = &h->process;
    char kind[FORMAT_BYTES] = {0};
    snprintf(kind, sizeof kind, "%s", format);
    bool good = child_feed(c, "LFIM", 4) && feed_u32(c, 2) && child_feed(c, kind, sizeof kind) &&
                feed_u32(c, p->width) && feed_u32(c, p->height) && feed_u32(c, (uint32_t)count);
    for (int i = 0; i < count && good; i++) {
        char name[NAME_BYTES] = {0};
        snprintf(name, sizeof name, "%s", planes[i].name);
        good = child_feed(c, name, sizeof name);
    }
    good = good && feed_u32(c, (uint32_t)p->meta_count);
    for (size_t i = 0; i < p->meta_count && good; i++)
        good = feed_text(c, p->meta[i].key) && feed_text(c, p->meta[i].value);
    for (int i = 0; i < count && good; i++)
        good = feed_plane(h, &planes[i], (size_t)p->width * p->height);
    return good;
}

/* ---- The answer ---- */

enum { CODE_NO_MEMORY = 4, CODE_SIGNAL = 128 };

/* Returns the helper's last words without its name in front; NULL if there are none. */
static const char *last_words(const child *c) {
    const size_t name = strlen(HELPER);
    const bool named =
        strncmp(c->words, HELPER, name) == 0 && strncmp(c->words + name, ": ", 2) == 0;
    const char *words = c->words + (named ? name + 2 : 0);
    return *words ? words : NULL;
}

static status ended_by(int signal, const char *path, const char *words) {
    return status_describe(signal == SIGINT || signal == SIGTERM ? ST_STOPPED : ST_FAILED,
                           "%s: %s was ended by signal %d%s%s", path, HELPER, signal,
                           words ? ": " : "", words ? words : "");
}

/* The helper has closed its pipe: wait for its end and describe the cause. */
static status gone(image_helper *h, const char *path) {
    int code;
    h->ended = true;
    status st = child_end(&h->process, &code);
    if (st != ST_OK)
        return st;
    const char *words = last_words(&h->process);
    if (code > CODE_SIGNAL)
        return ended_by(code - CODE_SIGNAL, path, words);
    return status_describe(code == CODE_NO_MEMORY ? ST_NOMEM : ST_IO, "%s: %s", path,
                           words ? words : "the picture's writer gave up");
}

static status kill_it(image_helper *h, status why) {
    status_note note;
    int code;
    status_note_take(&note, why);
    child_kill(&h->process);
    h->ended = true;
    return child_end(&h->process, &code) == ST_OK ? status_note_raise(&note) : why;
}

/* Read exactly `size` bytes of the helper's answer. */
static status take(image_helper *h, const char *path, void *data, size_t size) {
    size_t got = 0;
    status st = child_read(&h->process, data, size, &got, wait_for, h);
    if (st != ST_OK)
        return kill_it(h, st);
    return got == size ? ST_OK : gone(h, path);
}

static uint64_t size_in(const unsigned char *bytes) {
    uint64_t size = 0;
    for (int i = 0; i < 8; i++)
        size |= (uint64_t)bytes[i] << (8 * i);
    return size;
}

static status take_picture(image_helper *h, const char *path, const byte_sink *to) {
    unsigned char head[ANSWER_BYTES];
    status st = take(h, path, head, sizeof head);
    if (st != ST_OK)
        return st;
    if (memcmp(head, "LFOK", 4) != 0)
        return kill_it(h, status_describe(ST_FAILED, "%s: %s gave no picture", path, HELPER));
    for (uint64_t left = size_in(head + 4); left > 0 && st == ST_OK;) {
        const size_t n = left < sizeof h->buffer ? (size_t)left : sizeof h->buffer;
        st = take(h, path, h->buffer, n);
        if (st != ST_OK)
            return st;
        st = to->put(to->ctx, h->buffer, n);
        left -= n;
    }
    return st == ST_OK ? ST_OK : kill_it(h, st);
}

status image_helper_write(image_helper *h, const char *format, const char *path, const picture *p,
                          const byte_sink *to) {
    if (feed_picture(h, format, p))
        return take_picture(h, path, to);
    status st = wait_for(h);
    return st == ST_OK ? gone(h, path) : kill_it(h, st);
}
