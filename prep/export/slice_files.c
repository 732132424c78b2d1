#include "prep/export/slice_files.h"

#include <limits.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/sequence.h"

struct slice_files {
    mem *m;
    const char *pattern;
    bool force;
    const sample_format *format;
    const grid *g;
    uint32_t complete; /* files completed */
};

static status check_files(const slice_files *s) {
    char path[PATH_MAX];
    status st = ST_OK;
    for (uint32_t z = 0; z < s->g->dims[2] && st == ST_OK; z++) {
        st = sequence_name(s->pattern, (int)z, path, sizeof path);
        if (st == ST_OK)
            st = out_file_check(s->m, path, s->force);
    }
    return st;
}

status slice_files_create(mem *m, const char *pattern, bool force, const sample_format *format,
                          const grid *g, slice_files **out) {
    slice_files *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (slice_files){.m = m, .pattern = pattern, .force = force, .format = format, .g = g};
    const status st = check_files(s);
    if (st == ST_OK)
        *out = s;
    else
        mem_free(m, s);
    return st;
}

/* The grid of slice z alone. */
static grid slice_of(const grid *g, uint32_t z) {
    grid one = *g;
    one.dims[2] = 1;
    for (int row = 0; row < 3; row++)
        one.to_world[row][3] += z * g->to_world[row][2];
    return one;
}

static status fill_file(const slice_files *s, out_stream *out, const void *samples, size_t count) {
    const grid one = slice_of(s->g, s->complete);
    status st = s->format->head ? s->format->head(s->m, out, &one) : ST_OK;
    if (st == ST_OK)
        st = out_stream_samples(out, one.type, samples, count);
    return st == ST_OK && s->format->tail ? s->format->tail(out) : st;
}

static status write_file(slice_files *s, const void *samples, size_t count) {
    char path[PATH_MAX];
    out_stream *out = NULL;
    status st = sequence_name(s->pattern, (int)s->complete, path, sizeof path);
    if (st == ST_OK)
        st = out_stream_create(s->m, path, s->force, false, &out);
    if (st == ST_OK) {
        st = fill_file(s, out, samples, count);
        if (st == ST_OK)
            st = out_stream_commit(out);
        else
            out_stream_discard(out);
    }
    s->complete += st == ST_OK;
    return st;
}

status slice_files_take(void *files, const void *samples, size_t count) {
    slice_files *s = files;
    const size_t slice = (size_t)s->g->dims[0] * s->g->dims[1], width = sample_size(s->g->type);
    status st = ST_OK;
    for (size_t done = 0; done < count && st == ST_OK; done += slice)
        st = write_file(s, (const char *)samples + done * width, slice);
    return st;
}

status slice_files_end(slice_files *s, status st) {
    char path[PATH_MAX];
    if (!s)
        return st;
    for (uint32_t z = 0; st != ST_OK && z < s->complete; z++)
        if (sequence_name(s->pattern, (int)z, path, sizeof path) == ST_OK)
            unlink(path);
    mem_free(s->m, s);
    return st;
}
