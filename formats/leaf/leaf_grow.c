#include "formats/leaf/leaf_grow.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/file_guard.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_geometry.h"

struct leaf_grow {
    mem *m;
    const char *path;
    int fd;
    leaf_file *before;
    leaf_header first; /* as it is in the file */
    uint64_t end;      /* of the last segment: the next one's place */
    bool published;    /* what is behind `end` counts, or may */
};

static status cannot(const leaf_grow *g, const char *doing) {
    return file_failed(errno, g->path, doing);
}

/* ---- opening ---- */

/* The lock belongs to the open file, and ends with the program however that ends. */
static status lock(leaf_grow *g) {
    g->fd = open(g->path, O_RDWR | O_CLOEXEC | O_NOCTTY);
    if (g->fd < 0)
        return cannot(g, "cannot open");
    if (flock(g->fd, LOCK_EX | LOCK_NB) == 0)
        return ST_OK;
    if (errno != EWOULDBLOCK)
        return cannot(g, "cannot lock");
    return status_describe(ST_EXISTS, "%s: another program is adding to it", g->path);
}

static status open_before(leaf_grow *g) {
    file_guard_look(true);
    const status st = leaf_file_open(g->m, g->path, &g->before);
    file_guard_look(false);
    if (st != ST_OK)
        return st;
    const leaf_growth *growth = g->before->geometry->growth;
    const char *why = "it is of a kind that does not grow";
    bool may = growth && growth->may(&g->before->header, &why);
    for (uint32_t set = 0; may && set < g->before->layout.sets; set++)
        if (leaf_file_has_coarse(g->before, set)) {
            may = false;
            why = "it has coarse grids, as convert --coarse makes them";
        }
    if (!may)
        return status_describe(ST_UNSUPPORTED, "%s: no step can be added: %s", g->path, why);
    struct stat locked;
    if (fstat(g->fd, &locked) != 0)
        return cannot(g, "cannot look at");
    if (g->before->mark.device != locked.st_dev || g->before->mark.inode != locked.st_ino)
        return status_describe(ST_EXISTS, "%s: another file has taken its place just now", g->path);
    g->end = g->before->header.file_bytes;
    return ST_OK;
}

static status write_first(const leaf_grow *g, leaf_header *h) {
    h->checksum = leaf_header_checksum(h);
    uint64_t at = 0;
    const status st = file_write_all(g->fd, g->path, &at, h, sizeof *h);
    if (st != ST_OK)
        return st;
    return fdatasync(g->fd) == 0 ? ST_OK : cannot(g, "cannot write");
}

/* Cut off what was left behind the end. A file that never grew has nothing there. */
static status begin(leaf_grow *g) {
    status st = file_read_at(g->before->source, 0, &g->first, sizeof g->first);
    if (st == ST_OK && g->first.segments && ftruncate(g->fd, (off_t)g->end) != 0)
        st = cannot(g, "cannot cut");
    return st;
}

/* From now on the file may be longer than its segments. */
static status allow_more(leaf_grow *g) {
    if (g->first.segments)
        return ST_OK;
    g->first.segments = 1;
    return write_first(g, &g->first);
}

status leaf_grow_open(mem *m, const char *path, leaf_grow **out) {
    leaf_grow *g = mem_zalloc(m, sizeof *g);
    if (!g)
        return ST_NOMEM;
    g->m = m;
    g->path = path;
    status st = lock(g);
    if (st == ST_OK)
        st = open_before(g);
    if (st == ST_OK)
        st = begin(g);
    if (st != ST_OK) {
        leaf_grow_close(g);
        return st;
    }
    *out = g;
    return ST_OK;
}

void leaf_grow_close(leaf_grow *g) {
    if (!g)
        return;
    if (g->first.segments && !g->published)
        (void)!ftruncate(g->fd, (off_t)g->end); /* else the next program does */
    leaf_file_close(g->before);
    if (g->fd >= 0)
        close(g->fd);
    mem_free(g->m, g);
}

leaf_file *leaf_grow_before(const leaf_grow *g) {
    return g->before;
}

/* ---- adding ---- */

void leaf_grow_head(const leaf_grow *g, leaf_header *h) {
    const leaf_file *f = g->before;
    h->steps_before = f->header.steps;
    h->before = f->segments ? f->segments[f->header.segments - 1].base : 0;
}

static status copy(const leaf_grow *g, file *from) {
    enum { PIECE = 1 << 20 };
    const uint64_t size = file_size(from);
    char *piece = mem_alloc(g->m, PIECE);
    status st = piece ? ST_OK : ST_NOMEM;
    for (uint64_t at = 0; at < size && st == ST_OK; at += PIECE) {
        const size_t bytes = size - at < PIECE ? (size_t)(size - at) : PIECE;
        uint64_t to = g->end + at;
        st = file_read_at(from, at, piece, bytes);
        if (st == ST_OK)
            st = file_write_all(g->fd, g->path, &to, piece, bytes);
    }
    mem_free(g->m, piece);
    if (st == ST_OK && fsync(g->fd) != 0)
        st = cannot(g, "cannot write");
    return st;
}

/* Check that a reader opens the file as it will be: join its segments with this first header. */
static status prove(const leaf_grow *g, const leaf_header *first) {
    leaf_file *f = NULL;
    file_guard_look(true);
    status st = leaf_file_open_first(g->m, g->path, first, &f);
    file_guard_look(false);
    leaf_file_close(f);
    return st;
}

/* The new header may be in the file, or not, or in part: write the old one again. */
static status take_back(leaf_grow *g, status st) {
    status_note note;
    status_note_take(&note, st);
    g->published = write_first(g, &g->first) != ST_OK; /* then nothing is cut off */
    return status_note_raise(&note);
}

status leaf_grow_publish(leaf_grow *g, const char *segment) {
    file *from = NULL;
    status st = file_open(g->m, segment, &from);
    if (st == ST_OK)
        st = allow_more(g);
    if (st == ST_OK)
        st = copy(g, from);
    file_close(from);
    file_guard_forget(segment);
    leaf_header first = g->first;
    first.last = g->end;
    first.segments++;
    first.checksum = leaf_header_checksum(&first);
    if (st == ST_OK)
        st = prove(g, &first);
    if (st != ST_OK)
        return st;
    g->published = true;
    st = write_first(g, &first);
    return st == ST_OK ? ST_OK : take_back(g, st);
}
