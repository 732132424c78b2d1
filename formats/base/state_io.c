#include "formats/base/state_io.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/file.h"
#include "formats/base/hash.h"

enum { BUFFER = 1 << 16, VERSION = 1 };

static const char MAGIC[8] = "leafwork";

typedef struct head {
    char magic[8];
    uint32_t version, zero;
    uint64_t sequence, size, checksum;
    double share;
    uint64_t zero_too;
    uint64_t own; /* checksum of the head, while this is 0 */
} head;

_Static_assert(sizeof(head) == 64, "the head's size");

struct state_io {
    mem *m;
    const char *path;
    int fd;
    bool loads;
    uint64_t size, at; /* of the state; bytes passed to or from the file */
    uint64_t checksum; /* of all blocks so far */
    char *buffer;      /* one block; the last may be shorter */
    size_t used, held;
};

size_t state_io_memory(void) {
    return BUFFER + 1024;
}

bool state_io_loads(const state_io *s) {
    return s->loads;
}

status state_io_fault(const state_io *s) {
    return status_describe(
        ST_CORRUPT, "%s: is not what this program wrote there; --force begins again", s->path);
}

/* Checksums of blocks follow from one another. */
static void sum_block(state_io *s, size_t size) {
    const uint64_t both[2] = {s->checksum, hash_bytes(s->buffer, size)};
    s->checksum = hash_bytes(both, sizeof both);
}

static status flush(state_io *s) {
    const uint64_t offset = sizeof(head) + s->at;
    sum_block(s, s->used);
    status st = file_write_all(s->fd, s->path, &offset, s->buffer, s->used);
    s->at += s->used;
    s->used = 0;
    return st;
}

static status read_all(int fd, const char *path, uint64_t offset, void *to, size_t size) {
    if (fault_hit(FAULT_READ))
        return file_failed(EIO, path, "cannot read");
    for (size_t done = 0; done < size;) {
        const ssize_t got = pread(fd, (char *)to + done, size - done, (off_t)(offset + done));
        if (got == 0)
            return status_describe(ST_CORRUPT, "%s: ends too early", path);
        if (got < 0 && errno != EINTR)
            return file_failed(errno, path, "cannot read");
        done += got > 0 ? (size_t)got : 0;
    }
    return ST_OK;
}

static status fill(state_io *s) {
    const uint64_t left = s->size - s->at;
    s->held = left < BUFFER ? (size_t)left : BUFFER;
    s->used = 0;
    status st = read_all(s->fd, s->path, sizeof(head) + s->at, s->buffer, s->held);
    if (st == ST_OK)
        sum_block(s, s->held);
    s->at += s->held;
    return st;
}

status state_io_bytes(state_io *s, void *bytes, size_t size) {
    char *at = bytes;
    status st = ST_OK;
    while (size > 0 && st == ST_OK) {
        if (s->loads && s->used == s->held) {
            if (s->at == s->size)
                return state_io_fault(s);
            st = fill(s);
        }
        const size_t room = (s->loads ? s->held : BUFFER) - s->used;
        const size_t some = st != ST_OK ? 0 : size < room ? size : room;
        memcpy(s->loads ? at : s->buffer + s->used, s->loads ? s->buffer + s->used : at, some);
        s->used += some;
        at += some;
        size -= some;
        if (!s->loads && s->used == BUFFER)
            st = flush(s);
    }
    return st;
}

status state_io_end(const state_io *s) {
    return s->loads && (s->at < s->size || s->used < s->held) ? state_io_fault(s) : ST_OK;
}

static status begin(state_io *s, int flags) {
    s->buffer = mem_alloc(s->m, BUFFER);
    if (!s->buffer)
        return ST_NOMEM;
    s->fd = open(s->path, flags | O_NOFOLLOW | O_CLOEXEC, 0666);
    return s->fd >= 0 ? ST_OK : file_failed(errno, s->path, "cannot open");
}

static void end(state_io *s) {
    if (s->fd >= 0)
        close(s->fd);
    mem_free(s->m, s->buffer);
}

static uint64_t sum_head(const head *h) {
    head copy = *h;
    copy.own = 0;
    return hash_bytes(&copy, sizeof copy);
}

/* Read the head. Returns whether it is whole. */
static bool read_head(state_io *s, head *h) {
    return read_all(s->fd, s->path, 0, h, sizeof *h) == ST_OK &&
           memcmp(h->magic, MAGIC, sizeof MAGIC) == 0 && h->version == VERSION &&
           h->own == sum_head(h);
}

static status sum_up(state_io *s, const head *h, bool *same) {
    const off_t end_of_file = lseek(s->fd, 0, SEEK_END);
    *same = end_of_file >= 0 && (uint64_t)end_of_file >= sizeof *h + h->size;
    s->size = h->size;
    while (*same && s->at < s->size) {
        status st = fill(s);
        if (st != ST_OK)
            return st;
    }
    *same &= s->checksum == h->checksum;
    return ST_OK;
}

status state_io_look(mem *m, const char *path, state_io_head *out, bool *found) {
    state_io s = {.m = m, .path = path, .fd = -1, .loads = true};
    head h;
    *found = false;
    *out = (state_io_head){0};
    if (access(path, F_OK) != 0)
        return ST_OK;
    status st = begin(&s, O_RDONLY);
    if (st == ST_OK && read_head(&s, &h))
        st = sum_up(&s, &h, found);
    if (*found)
        *out = (state_io_head){.sequence = h.sequence, .share = h.share};
    end(&s);
    return st;
}

status state_io_save(mem *m, const char *path, const state_io_head *info, state_io_part part,
                     void *ctx) {
    state_io s = {.m = m, .path = path, .fd = -1};
    head h = {.version = VERSION, .sequence = info->sequence, .share = info->share};
    const head none = {0};
    const uint64_t start = 0;
    memcpy(h.magic, MAGIC, sizeof MAGIC);
    status st = begin(&s, O_RDWR | O_CREAT);
    if (st == ST_OK)
        st = file_write_all(s.fd, path, &start, &none, sizeof none);
    if (st == ST_OK)
        st = part(ctx, &s);
    if (st == ST_OK && s.used > 0)
        st = flush(&s);
    h.size = s.at;
    h.checksum = s.checksum;
    h.own = sum_head(&h);
    if (st == ST_OK)
        st = file_write_all(s.fd, path, &start, &h, sizeof h);
    if (st == ST_OK && fsync(s.fd) != 0)
        st = file_failed(errno, path, "cannot write");
    end(&s);
    return st;
}

status state_io_load(mem *m, const char *path, state_io_part part, void *ctx) {
    state_io s = {.m = m, .path = path, .fd = -1, .loads = true};
    head h;
    status st = begin(&s, O_RDONLY);
    if (st == ST_OK && !read_head(&s, &h))
        st = state_io_fault(&s);
    if (st == ST_OK) {
        s.size = h.size;
        st = part(ctx, &s);
    }
    end(&s);
    return st;
}
