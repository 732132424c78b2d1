#include "formats/input/byte_stream.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/text.h"
#include "formats/base/wait.h"

struct byte_stream {
    mem *m;
    file *f;          /* a regular file; NULL for all else */
    int fd;           /* a pipe's descriptor, else -1 */
    byte_source from; /* another source */
    char *path, *kind;
    uint64_t taken;    /* bytes handed out: the position of buffer[begin] */
    size_t begin, end; /* filled range of the buffer */
    bool ended;        /* a pipe or a source has reached its end */
    uint8_t buffer[BYTE_STREAM_BUFFER];
};

/* ---- opening ---- */

static bool is_regular(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

static status open_path(byte_stream *s) {
    if (strcmp(s->path, "-") == 0) {
        s->fd = STDIN_FILENO;
        return file_guard_opened(s->m, s->fd, byte_stream_name(s));
    }
    if (is_regular(s->path))
        return file_open(s->m, s->path, &s->f);
    return file_open_pipe(s->path, &s->fd);
}

/* Make a stream of that name, with nothing open. */
static status make(mem *m, const char *path, byte_stream **out) {
    *out = NULL;
    byte_stream *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->fd = -1;
    s->path = mem_copy_text(m, path);
    s->kind = mem_copy_text(m, path);
    if (!s->path || !s->kind) {
        byte_stream_close(s);
        return ST_NOMEM;
    }
    *out = s;
    return ST_OK;
}

status byte_stream_open_stored(mem *m, const char *path, byte_stream **out) {
    status st = make(m, path, out);
    if (st == ST_OK)
        st = open_path(*out);
    if (st != ST_OK) {
        byte_stream_close(*out);
        *out = NULL;
    }
    return st;
}

status byte_stream_open_source(mem *m, const char *name, const byte_source *from,
                               byte_stream **out) {
    status st = make(m, name, out);
    if (st == ST_OK)
        (*out)->from = *from;
    else
        from->close(from->ctx);
    return st;
}

void byte_stream_close(byte_stream *s) {
    if (!s)
        return;
    file_close(s->f);
    if (s->fd > STDERR_FILENO)
        close(s->fd);
    if (s->from.close)
        s->from.close(s->from.ctx);
    mem_free(s->m, s->path);
    mem_free(s->m, s->kind);
    mem_free(s->m, s);
}

/* ---- reading ---- */

const char *byte_stream_name(const byte_stream *s) {
    return strcmp(s->path, "-") == 0 ? "standard input" : s->path;
}

const char *byte_stream_path(const byte_stream *s) {
    return s->path;
}

const char *byte_stream_kind(const byte_stream *s) {
    return s->kind;
}

void byte_stream_drop_suffix(byte_stream *s) {
    *strrchr(s->kind, '.') = 0;
}

bool byte_stream_is_pipe(const byte_stream *s) {
    return s->fd >= 0;
}

uint64_t byte_stream_position(const byte_stream *s) {
    return s->taken;
}

bool byte_stream_is_file(const byte_stream *s) {
    return s->f != NULL;
}

uint64_t byte_stream_left(const byte_stream *s) {
    if (s->f)
        return file_size(s->f) - s->taken;
    return s->ended ? s->end - s->begin : UINT64_MAX;
}

/* Read up to size bytes that come behind the buffered ones; at least one, unless this is the end.
 */
static status fetch(byte_stream *s, void *to, size_t size, size_t *got) {
    *got = 0;
    if (s->f) {
        uint64_t at = s->taken + (s->end - s->begin);
        uint64_t left = file_size(s->f) - at;
        *got = size < left ? size : (size_t)left;
        return *got ? file_read_at(s->f, at, to, *got) : ST_OK;
    }
    if (s->ended)
        return ST_OK;
    if (s->from.read) {
        status st = s->from.read(s->from.ctx, to, size, got);
        s->ended = st == ST_OK && *got == 0;
        return st;
    }
    if (fault_hit(FAULT_READ))
        return file_failed(EIO, byte_stream_name(s), "cannot read");
    ssize_t count;
    do {
        status st = wait_ready(s->fd, POLLIN, byte_stream_name(s));
        if (st != ST_OK)
            return st;
        count = read(s->fd, to, size);
    } while (count < 0 && (errno == EINTR || errno == EAGAIN));
    if (count < 0)
        return file_failed(errno, byte_stream_name(s), "cannot read");
    s->ended = count == 0;
    *got = (size_t)count;
    return ST_OK;
}

status byte_stream_peek(byte_stream *s, size_t want, const uint8_t **data, size_t *size) {
    if (s->end - s->begin < want) {
        memmove(s->buffer, s->buffer + s->begin, s->end - s->begin);
        s->end -= s->begin;
        s->begin = 0;
        size_t got = 1;
        while (s->end < want && got > 0) {
            status st = fetch(s, s->buffer + s->end, sizeof s->buffer - s->end, &got);
            if (st != ST_OK)
                return st;
            s->end += got;
        }
    }
    *data = s->buffer + s->begin;
    *size = s->end - s->begin;
    return ST_OK;
}

void byte_stream_take(byte_stream *s, size_t size) {
    s->begin += size;
    s->taken += size;
}

static size_t take_buffered(byte_stream *s, void *to, size_t size) {
    size_t held = s->end - s->begin;
    size_t count = size < held ? size : held;
    if (to)
        memcpy(to, s->buffer + s->begin, count);
    byte_stream_take(s, count);
    return count;
}

status byte_stream_read(byte_stream *s, void *buffer, size_t size, size_t *got) {
    /* Take buffered bytes first. The rest goes straight to the caller. */
    *got = take_buffered(s, buffer, size);
    while (*got < size) {
        size_t more = 0;
        status st = fetch(s, (uint8_t *)buffer + *got, size - *got, &more);
        if (st != ST_OK)
            return st;
        if (more == 0)
            break;
        s->taken += more;
        *got += more;
    }
    return ST_OK;
}

status byte_stream_skip(byte_stream *s, uint64_t size) {
    if (size > byte_stream_left(s))
        return status_describe(
            ST_CORRUPT, "%s: ends at byte %llu, expected %llu bytes to skip", byte_stream_name(s),
            (unsigned long long)(s->taken + byte_stream_left(s)), (unsigned long long)size);
    if (s->f && size > s->end - s->begin) {
        s->taken += size;
        s->begin = s->end = 0;
        return ST_OK;
    }
    while (size > 0) {
        const uint8_t *data;
        size_t held;
        status st = byte_stream_peek(s, 1, &data, &held);
        if (st != ST_OK)
            return st;
        if (held == 0)
            return status_describe(ST_CORRUPT, "%s: ends at byte %llu, %llu bytes too early",
                                   byte_stream_name(s), (unsigned long long)s->taken,
                                   (unsigned long long)size);
        size -= take_buffered(s, NULL, held < size ? held : (size_t)size);
    }
    return ST_OK;
}

/* Append to a line; doubling keeps the cost linear. */
static status grow_line(byte_stream *s, text_line *line, const uint8_t *data, size_t size) {
    if (line->length + size > TEXT_LINE_MAX || memchr(data, 0, size))
        return status_describe(ST_CORRUPT, "%s: no text around byte %llu", byte_stream_name(s),
                               (unsigned long long)s->taken);
    if (line->length + size + 1 > line->room) {
        size_t room = 2 * line->room + size + 80;
        char *larger = mem_alloc(line->m, room);
        if (!larger)
            return ST_NOMEM;
        if (line->text)
            memcpy(larger, line->text, line->length);
        mem_free(line->m, line->text);
        line->text = larger;
        line->room = room;
    }
    memcpy(line->text + line->length, data, size);
    line->length += size;
    line->text[line->length] = 0;
    return ST_OK;
}

status byte_stream_line(byte_stream *s, text_line *line, bool *got) {
    line->length = 0;
    *got = false;
    for (bool ended = false; !ended;) {
        const uint8_t *data;
        size_t size;
        status st = byte_stream_peek(s, 1, &data, &size);
        if (st != ST_OK)
            return st;
        if (size == 0)
            break;
        const uint8_t *feed = memchr(data, '\n', size);
        size_t length = feed ? (size_t)(feed - data) : size;
        st = grow_line(s, line, data, length);
        if (st != ST_OK)
            return st;
        ended = feed != NULL;
        *got = true;
        byte_stream_take(s, length + ended);
    }
    while (line->length > 0 && strchr(" \t\r", line->text[line->length - 1]))
        line->text[--line->length] = 0;
    return ST_OK;
}

void byte_stream_line_release(text_line *line) {
    mem_free(line->m, line->text);
    *line = (text_line){.m = line->m};
}
