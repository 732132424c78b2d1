/* leaf_writer_private.h - the inside of a writer, for the files leaf_writer*.c alone.
 *
 * leaf_writer.c         beginning a file, and what it takes of memory
 * leaf_writer_family.c  putting the payloads of a grid, from many threads
 * leaf_writer_put.c     the same of a mesh
 * leaf_writer_series.c  payloads that earlier sets have; of a grid, or differ little from
 * leaf_writer_finish.c  payloads to their places, the header
 * leaf_writer_directory.c  the sections, before the payloads or behind them
 */
#ifndef FORMATS_LEAF_LEAF_WRITER_PRIVATE_H
#define FORMATS_LEAF_LEAF_WRITER_PRIVATE_H

#include <pthread.h>

#include "formats/base/file.h"
#include "formats/leaf/leaf_writer.h"

struct leaf_writer {
    mem *m;
    leaf_parameters p;
    leaf_layout layout;
    leaf_header header;
    leaf_section table[LEAF_SECTION_LAST + LEAF_ANCILLARY_LAST];
    /* The sections of the directory, see leaf_section_kind. */
    float (*ranges)[2];
    float (*own)[2];
    uint8_t *flags;
    uint64_t *offsets, *sizes, *checksums;
    /* Of several sets, else NULL: as in leaf_links. Of a grid, a hash of the samples of each
     * payload, too, by treelets and shells, then by sets. */
    uint32_t *same, *bases;
    uint64_t *hashes;
    double *axes; /* rectilinear: all three, one behind the other */
    float (*bounds)[6];
    uint32_t (*counts)[4];
    uint32_t (*zones)[4];
    char (*names)[64]; /* or NULL; so are times */
    double *times;
    leaf_part *parts;      /* coarse grids; or NULL */
    histogram *histograms; /* per set; or NULL */
    uint16_t *deviations;  /* codes of coarse treelets' bricks; or NULL */
    world_frame frame;
    bool settled;
    const progress *stop; /* asked while payloads are copied; may be NULL */
    const char *path;     /* the file's name in the end */
    out_file *out;
    /* A mesh's payloads wait here until the sizes of all before them are known. */
    out_file *scratch;
    uint64_t *scratch_at; /* per payload; or NOT_THERE */
    void *copy_buffer;
    leaf_family *families; /* all of them, of a grid */
    leaf_grow *grow;       /* what is written becomes its next segment; or NULL, and so is */
    leaf_file *before;     /* the file of the segments before */
    /* Guarded by the lock: */
    pthread_mutex_t lock;
    pthread_cond_t changed;
    uint64_t scratch_end;
    leaf_order order;     /* the first payload without a place: all before it have been put */
    leaf_placing next;    /* where the next payload goes */
    leaf_family *waiting; /* those that are whole; those before them are not */
    leaf_family *spare;
    bool given_up;
};

/* A family while it is put together. Its payloads are in `bytes` as they will be in the file. */
struct leaf_family {
    leaf_family *all;  /* the next of all */
    leaf_family *next; /* of those that wait, or are spare */
    uint32_t set, index;
    leaf_slab slab;
    char *bytes;
    size_t used;
    bool implied;           /* so are all payloads so far */
    char *earlier, *stored; /* of several sets: an earlier payload, and a code of it; else NULL */
};

#define NOT_THERE    UINT64_MAX
#define UNKNOWN_SIZE UINT64_MAX /* of a size */

/* leaf_writer_put_in_series() - look for payload p of a file of several sets in those before: set
 * same[p] if one of them has it; else code it at `to` with the step before in view, in *bytes. 0:
 * it has none, and is to be made by itself. The rest as of leaf_writer_put(). */
CHECKED status leaf_writer_put_in_series(leaf_writer *w, const leaf_family *f, leaf_packer *k,
                                         uint32_t p, const void *payload, void *to, size_t *bytes);

/* leaf_writer_find_stored() - look for whole payload p, whose stored bytes and checksum are known,
 * in the file that is added to; if it is there, set same[p]. A hash leads there, and the bytes
 * decide.
 * leaf_writer_compare() - whether `size` bytes from `at` on, of a file or, if that is NULL, of what
 * is written, are these. */
CHECKED status leaf_writer_find_stored(leaf_writer *w, uint32_t p, const void *stored, size_t size);
CHECKED status leaf_writer_compare(file *in, out_file *out, uint64_t at, const void *bytes,
                                   uint64_t size, bool *same);

/* leaf_writer_links() - the links so far. leaf_writer_is_same() - whether payload p has another's
 * bytes. */
static inline leaf_links leaf_writer_links(const leaf_writer *w) {
    return (leaf_links){w->same, w->bases};
}
static inline bool leaf_writer_is_same(const leaf_writer *w, uint32_t p) {
    return w->same && w->same[p];
}

/* leaf_writer_place() - give payload p its place, the next one; or where the one is that it is the
 * same as. Returns the bytes that it has of its own. */
uint64_t leaf_writer_place(leaf_writer *w, uint32_t p);

/* leaf_writer_place_sections() - before any payload: list the sections, and set where payloads
 * begin.
 * leaf_writer_write_directory() - once all payloads have their places, up to `end`: write the
 * sections and zeros behind them, and set header.file_bytes.
 * leaf_writer_write_parts() - write section COARSE again. */
void leaf_writer_place_sections(leaf_writer *w);
CHECKED status leaf_writer_write_directory(leaf_writer *w, uint64_t end);
CHECKED status leaf_writer_write_parts(leaf_writer *w);

/* leaf_writer_payloads_at() - where payloads begin. */
uint64_t leaf_writer_payloads_at(const leaf_writer *w);

/* leaf_writer_families_memory() - the bytes of the families of so many threads. in_series: of a
 * file of several sets.
 * leaf_writer_free_families() - free them. */
uint64_t leaf_writer_families_memory(const leaf_layout *l, int threads, bool in_series);
void leaf_writer_free_families(leaf_writer *w);

#endif
