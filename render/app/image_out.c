#include "render/app/image_out.h"

#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/pool.h"
#include "render/app/image_helper.h"
#include "render/app/picture_png.h"
#include "render/app/picture_pnm.h"

typedef struct image_format {
    const char *name; /* of the format; also its files' suffix */
    status (*write)(mem *m, pool *threads, const picture *p,
                    const byte_sink *to);         /* NULL: helper */
    size_t (*bytes)(int threads, uint32_t width); /* memory for writing; NULL: that of one row */
    bool all;                                     /* stores every plane */
    bool parallel;                                /* uses the threads */
} image_format;

static status put_doubles(const picture *p, const byte_sink *to, const double *plane,
                          size_t values) {
    return to->put(to->ctx, plane, (size_t)p->width * p->height * values * sizeof *plane);
}

static status write_depth(mem *m, pool *threads, const picture *p, const byte_sink *to) {
    (void)m, (void)threads;
    return put_doubles(p, to, p->image->z, 1);
}

static status write_rgba(mem *m, pool *threads, const picture *p, const byte_sink *to) {
    (void)m, (void)threads;
    return put_doubles(p, to, p->image->rgba, 4);
}

static status write_error(mem *m, pool *threads, const picture *p, const byte_sink *to) {
    (void)m, (void)threads;
    return put_doubles(p, to, p->image->error, 1);
}

static status write_value(mem *m, pool *threads, const picture *p, const byte_sink *to) {
    (void)m, (void)threads;
    return put_doubles(p, to, p->image->value, 1);
}

static const image_format FORMATS[] = {
    {.name = "png", .write = picture_png_write, .bytes = picture_png_bytes, .parallel = true},
    {.name = "ppm", .write = picture_ppm_write},
    {.name = "pfm", .write = picture_pfm_write},
    {.name = "exr", .all = true}};
static const image_format RAWS[IMAGE_RAWS] = {
    [IMAGE_DEPTH] = {.name = "f64", .write = write_depth},
    [IMAGE_RGBA] = {.name = "f64", .write = write_rgba},
    [IMAGE_ERROR] = {.name = "f64", .write = write_error},
    [IMAGE_VALUE] = {.name = "f64", .write = write_value}};
enum { FORMAT_COUNT = sizeof FORMATS / sizeof *FORMATS };

const char *image_out_suffixes(const char *format) {
    static const char *const all = ".png .ppm .pfm .exr ";
    static const char *const each[FORMAT_COUNT] = {".png ", ".ppm ", ".pfm ", ".exr "};
    for (int i = 0; format && i < FORMAT_COUNT; i++)
        if (strcmp(FORMATS[i].name, format) == 0)
            return each[i];
    return all;
}

struct image_out {
    mem *m;
    image_out_options options;
    pool *threads;
    image_helper *helper;
};

struct image_target {
    image_out *owner;
    const image_format *format;
    out_file *file; /* NULL: standard output */
    char path[];
};

/* ---- Formats ---- */

static bool is_stdout(const char *path) {
    return strcmp(path, "-") == 0;
}

static bool ends_in(const char *path, const char *name) {
    const size_t n = strlen(path), t = strlen(name);
    return n > t + 1 && path[n - t - 1] == '.' && strcasecmp(path + n - t, name) == 0;
}

/* Returns the format of a name, or NULL if it has none. */
static const image_format *format_of(const image_out_options *options, const char *path) {
    for (int i = 0; i < FORMAT_COUNT; i++)
        if (options->format ? strcasecmp(options->format, FORMATS[i].name) == 0
                            : ends_in(path, FORMATS[i].name))
            return &FORMATS[i];
    return is_stdout(path) && !options->format ? &FORMATS[0] : NULL;
}

bool image_out_wants_all(const image_out_options *options, const char *path) {
    const image_format *f = format_of(options, path);
    return f && f->all;
}

size_t image_out_bytes(const image_out_options *options, const char *path, uint32_t width) {
    const image_format *f = format_of(options, path);
    return f && f->bytes ? f->bytes(options->threads, width) : (size_t)width * 3 * sizeof(float);
}

/* ---- Before anything is opened ---- */

status image_out_check_raw(const image_out_options *options, const char *path) {
    struct stat info;
    if (is_stdout(path) && isatty(STDOUT_FILENO))
        return status_describe(ST_USAGE, "standard output is a terminal, which shows no bytes: "
                                         "send it to a file or a program");
    if (!is_stdout(path) && !options->force && stat(path, &info) == 0)
        return status_describe(ST_EXISTS, "%s exists (--force overwrites)", path);
    return ST_OK;
}

status image_out_check(const image_out_options *options, const char *path) {
    const image_format *f = format_of(options, path);
    if (!f && options->format)
        return status_describe(ST_USAGE, "--format: \"%s\" is none of png, ppm, pfm, exr",
                               options->format);
    if (!f)
        return status_describe(ST_USAGE,
                               "%s: the name of a picture ends in .png, .ppm, .pfm or .exr", path);
    status st = image_out_check_raw(options, path);
    return st == ST_OK && !f->write ? image_helper_check() : st;
}

/* ---- Targets ---- */

static status put(void *ctx, const void *data, size_t size) {
    const image_target *t = ctx;
    return t->file ? out_file_append(t->file, data, size)
                   : file_write_all(STDOUT_FILENO, "standard output", NULL, data, size);
}

static status begin(image_out *o, const char *path, const image_format *f, bool force,
                    image_target **out) {
    const size_t bytes = strlen(path) + 1;
    image_target *t = mem_zalloc(o->m, sizeof *t + bytes);
    if (!t)
        return ST_NOMEM;
    *t = (image_target){.owner = o, .format = f};
    memcpy(t->path, path, bytes);
    status st = ST_OK;
    if (!is_stdout(path))
        st = out_file_create(o->m, path, force, &t->file);
    if (st == ST_OK && !f->write && !o->helper)
        st = image_helper_start(o->m, o->options.stop, o->options.ctx, &o->helper);
    if (st != ST_OK) {
        image_out_discard(t);
        return st;
    }
    *out = t;
    return ST_OK;
}

status image_out_begin(image_out *o, const char *path, image_target **out) {
    status st = image_out_check(&o->options, path);
    return st == ST_OK ? begin(o, path, format_of(&o->options, path), o->options.force, out) : st;
}

status image_out_again(image_out *o, const char *path, image_target **out) {
    return begin(o, path, format_of(&o->options, path), true, out);
}

status image_out_begin_raw(image_out *o, const char *path, image_raw which, image_target **out) {
    status st = image_out_check_raw(&o->options, path);
    return st == ST_OK ? begin(o, path, &RAWS[which], o->options.force, out) : st;
}

void image_out_discard(image_target *t) {
    if (!t)
        return;
    out_file_discard(t->file);
    mem_free(t->owner->m, t);
}

/* Write through the helper. End a helper that failed: the next picture gets a new one. */
static status through_helper(image_target *t, const picture *p, const byte_sink *to) {
    image_out *o = t->owner;
    status st = image_helper_write(o->helper, t->format->name, t->path, p, to);
    if (st != ST_OK) {
        status_note note;
        status_note_take(&note, st);
        image_helper_end(o->helper);
        o->helper = NULL;
        st = status_note_raise(&note);
    }
    return st;
}

status image_out_finish(image_target *t, const picture *p) {
    const byte_sink to = {put, t};
    image_out *o = t->owner;
    status st = ST_OK;
    if (t->format->parallel && !o->threads)
        st = pool_create(o->m, o->options.threads, &o->threads);
    if (st == ST_OK)
        st = t->format->write ? t->format->write(o->m, o->threads, p, &to)
                              : through_helper(t, p, &to);
    if (st == ST_OK && t->file) {
        out_file *f = t->file;
        t->file = NULL;
        st = out_file_commit(f);
    }
    image_out_discard(t);
    return st;
}

/* ---- All of them ---- */

status image_out_open(mem *m, const image_out_options *options, image_out **out) {
    image_out *o = mem_zalloc(m, sizeof *o);
    if (!o)
        return ST_NOMEM;
    o->m = m;
    o->options = *options;
    *out = o;
    return ST_OK;
}

void image_out_close(image_out *o) {
    if (!o)
        return;
    image_helper_end(o->helper);
    pool_destroy(o->threads);
    mem_free(o->m, o);
}

status image_out_write(mem *m, const char *path, bool force, const picture *p) {
    const image_out_options options = {.force = force, .threads = pool_default_threads()};
    image_out *o = NULL;
    image_target *t = NULL;
    status st = image_out_open(m, &options, &o);
    if (st == ST_OK)
        st = image_out_begin(o, path, &t);
    if (st == ST_OK)
        st = image_out_finish(t, p);
    image_out_close(o);
    return st;
}
