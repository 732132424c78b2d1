#include "formats/grid/volume_files.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/sequence.h"
#include "formats/input/named_file.h"
#include "formats/input/unpack_stream.h"

enum { FILES_MAX = 1 << 20, NAME_MAX_BYTES = 4096 };

typedef struct volume_files {
    mem *m;
    char *header;
    bool follow_links;
    char **path;
    size_t count, room;
    volume_layout shape; /* sizes, type, encoding, and the file that is open */
    uint64_t lines;
    int64_t bytes;
    uint64_t each, left; /* bytes of samples in each file; left: still to come in the open file */
    size_t next;
    unpack_stream *packed;
} volume_files;

bool volume_files_are(const char *word) {
    return strncmp(word, "LIST", 4) == 0 || (strchr(word, '%') && strchr(word, ' '));
}

/* ---- names ---- */

static status add_name(volume_files *f, const char *name) {
    if (f->count == FILES_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: more than %d files", f->header, FILES_MAX);
    status st = mem_grow(f->m, &f->path, sizeof *f->path, f->count, 16, &f->room);
    if (st == ST_OK)
        st = named_file_find(f->m, f->header, name, f->follow_links, &f->path[f->count]);
    f->count += st == ST_OK;
    return st;
}

/* Add the names in the lines behind the header, up to the file's end. */
static status add_lines(volume_files *f, byte_stream *header) {
    text_line line = {.m = f->m};
    status st = ST_OK;
    for (bool got = true; st == ST_OK && got;) {
        st = byte_stream_line(header, &line, &got);
        if (st != ST_OK || !got)
            break;
        const char *name = line.text + strspn(line.text, " \t");
        if (*name)
            st = add_name(f, name);
    }
    byte_stream_line_release(&line);
    return st;
}

static status bad_pattern(const volume_files *f, const char *word) {
    return status_describe(
        ST_CORRUPT,
        "%s: \"%.200s\": expected the pattern of names, with %%d or %%03d, and the "
        "numbers of the first, the last, and from one to the next",
        f->header, word);
}

static status add_pattern(volume_files *f, const char *word) {
    char pattern[NAME_MAX_BYTES], name[NAME_MAX_BYTES];
    int first, last, step = 1;
    if (sscanf(word, "%4000s %9d %9d %9d", pattern, &first, &last, &step) < 3 || step == 0 ||
        first < 0 || last < 0 || (step > 0) != (last >= first))
        return bad_pattern(f, word);
    status st = ST_OK;
    for (int64_t i = first; st == ST_OK && (step > 0 ? i <= last : i >= last); i += step) {
        st = sequence_name(pattern, (int)i, name, sizeof name);
        st = st == ST_OK ? add_name(f, name) : bad_pattern(f, word);
    }
    return st;
}

/* ---- their bytes ---- */

static void close_file(volume_files *f) {
    unpack_stream_close(f->packed);
    byte_stream_close(f->shape.data);
    f->packed = NULL;
    f->shape.data = NULL;
}

/* Read bytes, unpacked if they are packed. */
static status read_some(volume_files *f, void *to, size_t size, size_t *got) {
    return f->packed ? unpack_stream_read(f->packed, to, size, got)
                     : byte_stream_read(f->shape.data, to, size, got);
}

static status too_short(const volume_files *f) {
    return status_describe(ST_CORRUPT, "%s: ends before its %llu bytes of samples do",
                           byte_stream_name(f->shape.data), (unsigned long long)f->each);
}

static status skip_unpacked(volume_files *f) {
    char waste[4096];
    for (uint64_t left = f->shape.skip_decoded; left > 0;) {
        size_t got, want = left < sizeof waste ? (size_t)left : sizeof waste;
        status st = read_some(f, waste, want, &got);
        if (st == ST_OK && got < want)
            st = too_short(f);
        if (st != ST_OK)
            return st;
        left -= got;
    }
    return ST_OK;
}

/* Skip to where the samples start if they end with the file, or -1 - bytes before it. */
static status skip_to_end(const volume_files *f) {
    const uint64_t left = byte_stream_left(f->shape.data), behind = (uint64_t)(-1 - f->bytes);
    if (f->shape.encoding != VOLUME_RAW)
        return status_describe(ST_UNSUPPORTED,
                               "%s: samples counted from the end need the raw encoding", f->header);
    if (behind > left || f->each > left - behind)
        return too_short(f);
    return byte_stream_skip(f->shape.data, left - behind - f->each);
}

/* Open one of the files, up to its first sample. */
static status open_file(volume_files *f, size_t index) {
    const packer *p = volume_layout_packer(&f->shape);
    close_file(f);
    status st = byte_stream_open_stored(f->m, f->path[index], &f->shape.data);
    if (st == ST_OK)
        st = volume_layout_skip(&f->shape, f->lines, f->bytes < 0 ? 0 : f->bytes);
    if (st == ST_OK && f->bytes < 0)
        st = skip_to_end(f);
    if (st == ST_OK && p)
        st = unpack_stream_open(f->m, p, f->shape.data, &f->packed);
    if (st == ST_OK && p)
        st = skip_unpacked(f);
    f->left = f->each;
    return st == ST_OK && !p && byte_stream_left(f->shape.data) < f->each ? too_short(f) : st;
}

static status read_bytes(void *ctx, void *to, size_t size, size_t *got) {
    volume_files *f = ctx;
    *got = 0;
    if (f->left == 0 && f->next == f->count)
        return ST_OK;
    status st = f->left == 0 ? open_file(f, f->next++) : ST_OK;
    if (st == ST_OK)
        st = read_some(f, to, size < f->left ? size : (size_t)f->left, got);
    f->left -= *got;
    return st == ST_OK && *got == 0 ? too_short(f) : st;
}

static void close_files(void *ctx) {
    volume_files *f = ctx;
    close_file(f);
    for (size_t i = 0; i < f->count; i++)
        mem_free(f->m, f->path[i]);
    mem_free(f->m, f->path);
    mem_free(f->m, f->header);
    mem_free(f->m, f);
}

/* ---- opening ---- */

/* Compute how many bytes of each file are samples. The grid's sizes must be sound. */
static status share(volume_files *f) {
    const uint64_t step = volume_layout_step_bytes(&f->shape),
                   steps = f->shape.steps ? f->shape.steps : 1;
    uint64_t all;
    if (f->count == 0)
        return status_describe(ST_CORRUPT, "%s: its list names no file", f->header);
    if (__builtin_mul_overflow(step, steps, &all) || all % f->count != 0)
        return status_describe(ST_CORRUPT, "%s: its samples are not shared equally by %zu files",
                               f->header, f->count);
    f->each = all / f->count;
    return ST_OK;
}

static status look_at_all(volume_files *f) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < f->count; i++)
        st = open_file(f, i);
    close_file(f);
    f->left = 0;
    return st;
}

static status prepare(volume_files *f, byte_stream *header, const char *word) {
    if (f->shape.encoding == VOLUME_TEXT)
        return status_describe(ST_UNSUPPORTED,
                               "%s: samples as text in several files: expected raw or "
                               "packed ones",
                               f->header);
    status st = grid_check(&f->shape.g, f->header);
    if (st == ST_OK)
        st = strncmp(word, "LIST", 4) == 0 ? add_lines(f, header) : add_pattern(f, word);
    if (st == ST_OK)
        st = share(f);
    return st == ST_OK ? look_at_all(f) : st;
}

status volume_files_open(volume_layout *l, const char *header, const char *word, bool follow_links,
                         uint64_t lines, int64_t bytes) {
    volume_files *f = mem_zalloc(l->m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    *f = (volume_files){.m = l->m, .follow_links = follow_links, .lines = lines, .bytes = bytes};
    f->shape =
        (volume_layout){.m = l->m, .stored = l->stored, .encoding = l->encoding, .steps = l->steps};
    f->shape.g = l->g;
    for (int a = 0; a < 3; a++)
        f->shape.g.axis[a] = NULL;
    f->header = mem_copy_text(l->m, header);
    status st = f->header ? prepare(f, l->data, word) : ST_NOMEM;
    if (st != ST_OK) {
        close_files(f);
        return st;
    }
    byte_stream *data = NULL;
    st = byte_stream_open_source(l->m, header, &(byte_source){read_bytes, close_files, f}, &data);
    if (st != ST_OK)
        return st;
    byte_stream_close(l->data);
    l->data = data;
    l->encoding = VOLUME_RAW;
    return ST_OK;
}
