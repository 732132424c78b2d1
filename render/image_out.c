#include "render/image_out.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/child.h"
#include "formats/base/file.h"
#include "formats/base/sibling.h"

static const char HELPER[] = "leafcast-write-image";
enum { CHUNK_VALUES = 16384, NAME_BYTES = 32 };

/* ---- the helper process ---- */

static status no_helper(void) {
    return status_describe(ST_UNSUPPORTED,
                           "%s is not there: pictures need it (built where OpenImageIO is "
                           "installed; --depth-f64 does without)",
                           HELPER);
}

static status start_helper(child *h, const char *path, bool force) {
    char program[SIBLING_PATH];
    if (!sibling_find(HELPER, program))
        return no_helper();
    /* A path that starts with a dash is no flag. */
    char *target = NULL;
    if (asprintf(&target, "%s%s", path[0] == '-' ? "./" : "", path) < 0)
        return file_failed(ENOMEM, program, "cannot start");
    char overwrite[] = "--force";
    char *argv[] = {program, target, force ? overwrite : NULL, NULL};
    status st = child_start(program, argv, false, h);
    free(target);
    return st;
}

/* Wait for the helper's end and translate what became of it. */
static status end_helper(child *h, const char *path, bool fed) {
    int code;
    status st = child_end(h, &code);
    if (st != ST_OK || (code == 0 && fed))
        return st;
    if (code > 128)
        return status_describe(code == 128 + SIGINT || code == 128 + SIGTERM ? ST_STOPPED
                                                                             : ST_FAILED,
                               "%s: %s was ended by signal %d", path, HELPER, code - 128);
    const size_t prefix = strlen(HELPER) + 2;
    const bool named = strncmp(h->words, HELPER, prefix - 2) == 0 && h->said > prefix;
    return status_describe(code == 2 ? ST_USAGE : ST_IO, "%s: %s", path,
                           h->said == 0 ? "the picture's writer gave up"
                           : named      ? h->words + prefix
                                        : h->words);
}

/* ---- the stream ---- */

static bool feed_u32(child *h, uint32_t value) {
    const unsigned char bytes[4] = {(unsigned char)value, (unsigned char)(value >> 8),
                                    (unsigned char)(value >> 16), (unsigned char)(value >> 24)};
    return child_feed(h, bytes, sizeof bytes);
}

static bool feed_text(child *h, const char *text) {
    const size_t n = strlen(text);
    return feed_u32(h, (uint32_t)n) && child_feed(h, text, n);
}

typedef enum plane_kind { PLANE_FLOAT, PLANE_DOUBLE, PLANE_INT, PLANE_COLOUR } plane_kind;

typedef struct plane {
    const char *name;
    const void *data;
    plane_kind kind;
} plane;

enum { PLANES = 9 };

/* The planes that the file's kind takes and that are there. */
static int planes_of(const leafcast_image *image, bool png, plane out[PLANES]) {
    const plane_kind colour = png && image->a ? PLANE_COLOUR : PLANE_FLOAT;
    const plane all[PLANES] = {
        {"R", image->r, colour},
        {"G", image->g, colour},
        {"B", image->b, colour},
        {"A", image->a, PLANE_FLOAT},
        {"Z", image->z, PLANE_DOUBLE},
        {"N.x", image->normal[0], PLANE_FLOAT},
        {"N.y", image->normal[1], PLANE_FLOAT},
        {"N.z", image->normal[2], PLANE_FLOAT},
        {"id", image->id, PLANE_INT},
    };
    int n = 0;
    for (int i = 0; i < (png ? 4 : PLANES); i++)
        if (all[i].data)
            out[n++] = all[i];
    return n;
}

/* Values first .. first + count of a plane as floats. */
static void convert(const plane *p, const float *alpha, size_t first, size_t count, float *out) {
    for (size_t i = 0; i < count; i++) {
        const size_t at = first + i;
        switch (p->kind) {
        case PLANE_FLOAT: out[i] = ((const float *)p->data)[at]; break;
        case PLANE_DOUBLE: out[i] = (float)((const double *)p->data)[at]; break;
        case PLANE_INT: out[i] = (float)((const int32_t *)p->data)[at]; break;
        case PLANE_COLOUR:
            out[i] = alpha[at] > 0.0f ? ((const float *)p->data)[at] / alpha[at] : 0.0f;
            break;
        }
    }
}

static bool feed_plane(child *h, const plane *p, const float *alpha, size_t count, float *buffer) {
    for (size_t first = 0; first < count; first += CHUNK_VALUES) {
        const size_t n = count - first < CHUNK_VALUES ? count - first : CHUNK_VALUES;
        convert(p, alpha, first, n, buffer);
        if (!child_feed(h, buffer, n * sizeof *buffer))
            return false;
    }
    return true;
}

static bool feed_header(child *h, uint32_t width, uint32_t height, const plane *planes,
                        int plane_count, const image_meta *meta, size_t meta_count) {
    bool good = child_feed(h, "LFIM", 4) && feed_u32(h, 1) && feed_u32(h, width) &&
                feed_u32(h, height) && feed_u32(h, (uint32_t)plane_count);
    for (int i = 0; i < plane_count && good; i++) {
        char name[NAME_BYTES] = {0};
        snprintf(name, sizeof name, "%s", planes[i].name);
        good = child_feed(h, name, sizeof name);
    }
    good = good && feed_u32(h, (uint32_t)meta_count);
    for (size_t i = 0; i < meta_count && good; i++)
        good = feed_text(h, meta[i].key) && feed_text(h, meta[i].value);
    return good;
}

/* ---- files ---- */

static bool ends_in(const char *path, const char *tail) {
    const size_t n = strlen(path), t = strlen(tail);
    return n > t && strcmp(path + n - t, tail) == 0;
}

status image_out_check(const char *path, bool force) {
    char program[SIBLING_PATH];
    if (!ends_in(path, ".png") && !ends_in(path, ".exr"))
        return status_describe(ST_USAGE, "%s: the name of a picture ends in .png or .exr", path);
    if (!force && access(path, F_OK) == 0)
        return status_describe(ST_EXISTS, "%s exists (--force overwrites)", path);
    return sibling_find(HELPER, program) ? ST_OK : no_helper();
}

status image_out_write(mem *m, const char *path, bool force, uint32_t width, uint32_t height,
                       const leafcast_image *image, const image_meta *meta, size_t meta_count) {
    plane planes[PLANES];
    const int n = planes_of(image, ends_in(path, ".png"), planes);
    const size_t count = (size_t)width * height;
    float *buffer = mem_array(m, CHUNK_VALUES, sizeof *buffer);
    if (!buffer)
        return ST_NOMEM;
    child h;
    status st = start_helper(&h, path, force);
    if (st == ST_OK) {
        bool fed = feed_header(&h, width, height, planes, n, meta, meta_count);
        for (int i = 0; i < n && fed; i++)
            fed = feed_plane(&h, &planes[i], image->a, count, buffer);
        st = end_helper(&h, path, fed);
    }
    mem_free(m, buffer);
    return st;
}

status image_out_depth(mem *m, const char *path, bool force, const double *z, size_t count) {
    out_file *f = NULL;
    status st = out_file_create(m, path, force, &f);
    if (st)
        return st;
    st = out_file_append(f, z, count * sizeof *z);
    if (st) {
        out_file_discard(f);
        return st;
    }
    return out_file_commit(f);
}
