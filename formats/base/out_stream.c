#include "formats/base/out_stream.h"

#include <assert.h>
#include <endian.h>
#include <limits.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "formats/base/file.h"

enum { PACKED_BYTES = 64 << 10, GZIP_FORM = 15 + 16 };

struct out_stream {
    mem *m;
    out_file *file;        /* NULL: standard output */
    unsigned char *packed; /* PACKED_BYTES; NULL: no compression */
    z_stream z;
};

static status pass(out_stream *s, const void *data, size_t size) {
    if (s->file)
        return out_file_append(s->file, data, size);
    return file_write_all(STDOUT_FILENO, "standard output", NULL, data, size);
}

static status begin_packing(out_stream *s) {
    s->z = (z_stream){.zalloc = mem_zlib_alloc, .zfree = mem_zlib_free, .opaque = s->m};
    s->packed = mem_alloc(s->m, PACKED_BYTES);
    if (!s->packed)
        return ST_NOMEM;
    if (deflateInit2(&s->z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, GZIP_FORM, 8, Z_DEFAULT_STRATEGY) ==
        Z_OK)
        return ST_OK;
    mem_free(s->m, s->packed);
    s->packed = NULL;
    return ST_NOMEM;
}

/* Compress what is in z.next_in, and with Z_FINISH the end; write out the result. */
static status pack(out_stream *s, int flush) {
    int more;
    do {
        s->z.next_out = s->packed;
        s->z.avail_out = PACKED_BYTES;
        more = deflate(&s->z, flush);
        status st = pass(s, s->packed, PACKED_BYTES - s->z.avail_out);
        if (st != ST_OK)
            return st;
    } while (flush == Z_FINISH ? more != Z_STREAM_END : s->z.avail_out == 0);
    return ST_OK;
}

status out_stream_create(mem *m, const char *path, bool force, bool gzip, out_stream **out) {
    out_stream *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    status st = strcmp(path, "-") == 0 ? ST_OK : out_file_create(m, path, force, &s->file);
    if (st == ST_OK && gzip)
        st = begin_packing(s);
    if (st != ST_OK) {
        out_stream_discard(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

status out_stream_write(out_stream *s, const void *data, size_t size) {
    if (!s->packed)
        return pass(s, data, size);
    status st = ST_OK;
    for (size_t done = 0, part; st == ST_OK && done < size; done += part) {
        part = size - done < INT_MAX ? size - done : INT_MAX;
        s->z.next_in = (z_const Bytef *)data + done;
        s->z.avail_in = (uInt)part;
        st = pack(s, Z_NO_FLUSH);
    }
    return st;
}

status out_stream_text(out_stream *s, const char *text) {
    return out_stream_write(s, text, strlen(text));
}

/* For big-endian machines: swap through a small buffer, so that the caller's samples stay
 * unchanged. */
static status write_swapped(out_stream *s, sample_type type, const void *samples, size_t count) {
    uint64_t buffer[512];
    const size_t width = sample_size(type), step = sizeof buffer / width;
    status st = ST_OK;
    for (size_t done = 0; st == ST_OK && done < count; done += step) {
        const size_t part = count - done < step ? count - done : step;
        memcpy(buffer, (const char *)samples + done * width, part * width);
        sample_swap(type, buffer, part);
        st = out_stream_write(s, buffer, part * width);
    }
    return st;
}

status out_stream_samples(out_stream *s, sample_type type, const void *samples, size_t count) {
    if (__BYTE_ORDER == __BIG_ENDIAN)
        return write_swapped(s, type, samples, count);
    return out_stream_write(s, samples, count * sample_size(type));
}

bool out_stream_is_file(const out_stream *s) {
    return s->file && !s->packed;
}

status out_stream_patch(out_stream *s, uint64_t offset, const void *data, size_t size) {
    assert(out_stream_is_file(s));
    return out_file_write_at(s->file, offset, data, size);
}

status out_stream_commit(out_stream *s) {
    status st = s->packed ? pack(s, Z_FINISH) : ST_OK;
    if (st == ST_OK && s->file) {
        st = out_file_commit(s->file);
        s->file = NULL;
    }
    out_stream_discard(s);
    return st;
}

void out_stream_discard(out_stream *s) {
    if (!s)
        return;
    out_file_discard(s->file);
    if (s->packed)
        (void)deflateEnd(&s->z);
    mem_free(s->m, s->packed);
    mem_free(s->m, s);
}
