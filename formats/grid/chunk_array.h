/* chunk_array.h - an array whose numbers lie in chunks of one shape: how they are stored, reading
 * one, and gathering a box from those that it meets.
 *
 * Each chunk is packed by a codec, behind filters. It is a file of its own, named by its indices,
 * as in Zarr of version 2; or bytes of one file, as in HDF5, which a table tells. One that is not
 * there is the fill value. At the array's far ends chunks are whole, too, but for the last strips
 * of TIFF's pages.
 *
 * Thread-safe: the description is only read.
 */
#ifndef FORMATS_GRID_CHUNK_ARRAY_H
#define FORMATS_GRID_CHUNK_ARRAY_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/file.h"
#include "formats/base/mem.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"
#include "formats/grid/sample_order.h"
#include "formats/grid/zarr_chunk.h"
#include "formats/grid/zarr_filter.h"

enum {
    CHUNK_AXES = 8,
    CHUNK_FOLDER = 4096,         /* bytes of the path of the folder of chunks, its NUL included */
    CHUNK_NAME = CHUNK_AXES * 12 /* and of a chunk's name */
};

typedef struct chunk_array {
    int axes;
    uint32_t chunk[CHUNK_AXES]; /* numbers along each axis */
    int role[CHUNK_AXES];       /* ORDER_X .. ORDER_STEP, each at most once; -1: none */
    bool fortran;               /* the first axis is the fastest, else the last */
    char separator;             /* '.' or '/', between the indices of a chunk's name */
    sample_type type;           /* of a number */
    bool big_endian;
    zarr_codec codec;
    zarr_filters filters;
    bool summed;     /* 4 bytes of a checksum lie behind the packed ones; they are not looked at */
    uint8_t fill[8]; /* one number, native byte order */
    uint32_t rows;   /* along ORDER_Y, of the grid: those behind need not be in a chunk, nor are its
                        further bytes looked at; 0: a chunk has all */
} chunk_array;

/* What follows from the description. */
typedef struct chunk_shape {
    uint32_t along[ORDER_AXES]; /* numbers of a chunk along a role; 1 where no axis has it */
    size_t stride[ORDER_AXES];  /* distance in a chunk, in numbers, from one to the next */
    size_t width;               /* bytes of a number */
    size_t bytes;               /* of a chunk */
    size_t coded;               /* of a chunk before its filters are undone */
    size_t room;                /* that both need on the way: at least `bytes` */
} chunk_shape;

/* chunk_array_measure() - false: no memory holds a chunk.
 * chunk_array_cuts() - whether chunks may lack rows: those in front must be their first bytes, and
 * the codec must be one that can end early. */
bool chunk_array_measure(const chunk_array *a, chunk_shape *out);
bool chunk_array_cuts(const chunk_array *a, const chunk_shape *s);

/* Where a chunk's bytes lie in a file. Treelet files store it. */
typedef struct chunk_entry {
    uint64_t offset;
    uint32_t bytes;   /* 0: it is not there, and all is 0 */
    uint32_t skipped; /* bits of what was not applied to it: filter i; then the codec, if the array
                         has one; then the checksum */
} chunk_entry;

/* The chunks that a box meets: indices first .. first + count - 1 along each role. */
typedef struct chunk_range {
    uint32_t first[ORDER_AXES], count[ORDER_AXES];
} chunk_range;

/* chunk_array_range() - the chunks that hold the numbers first .. end - 1 along each role. Returns
 * how many; UINT64_MAX: more than that. */
uint64_t chunk_array_range(const chunk_shape *s, const uint32_t first[ORDER_AXES],
                           const uint32_t end[ORDER_AXES], chunk_range *out);

/* Where chunks lie: files in a folder, entries of one file, or entries of the files of slices. */
typedef struct chunk_home {
    const char *path;    /* of the folder, or of the file */
    const char *trusted; /* the folder that the user gave: files must lie in it (named_file.h), */
    bool follow_links;   /* or anywhere; */
    bool is_index;       /* this was said in a conversion, and those who read cannot say it */
    const chunk_entry *table; /* of the chunks in range, ORDER_X fastest, ORDER_STEP slowest; NULL:
                                 files */
    chunk_range range;
    file *in;                         /* with a table; */
    const struct slice_folder *files; /* NULL, or the files of slices, in the place of `in`; a chunk
                                        has one slice */
} chunk_home;

/* chunk_array_path() - the path of the chunk of these indices, one a role. */
const char *chunk_array_path(const chunk_array *a, const char *folder,
                             const uint32_t index[ORDER_AXES],
                             char path[CHUNK_FOLDER + CHUNK_NAME]);

/* chunk_array_read() - read the chunk of these indices, one a role: unpacked, in native byte order.
 *
 * chunk  s->room bytes; the chunk is the first s->bytes of them, of which rows behind a->rows are
 *        not written to
 * coded  likewise, NULL without filters
 * there  out: false: it is not there; chunk is then not written to
 * read   the bytes that were read are added
 *
 * ST_CORRUPT, ST_UNSUPPORTED, ST_IO, naming the chunk's file, or its byte. */
CHECKED status chunk_array_read(mem *m, const chunk_array *a, const chunk_shape *s,
                                const chunk_home *in, const uint32_t index[ORDER_AXES], void *chunk,
                                void *coded, bool *there, uint64_t *read);

/* Who has the chunks. A hold that succeeds is followed by a release, before the next hold. */
typedef struct chunk_supply {
    /* *numbers: the chunk in native byte order; NULL: all of it is the fill value. */
    status (*hold)(void *ctx, const uint32_t index[ORDER_AXES], const uint8_t **numbers);
    void (*release)(void *ctx, const uint32_t index[ORDER_AXES]); /* NULL: nothing to do */
    void *ctx;
} chunk_supply;

/* chunk_array_gather() - put the numbers first .. end - 1 along each role into out, in the order of
 * a grid: components side by side, then x fastest. Each chunk is held once. Along ORDER_STEP the
 * box has one number. */
CHECKED status chunk_array_gather(const chunk_array *a, const chunk_shape *s,
                                  const uint32_t first[ORDER_AXES], const uint32_t end[ORDER_AXES],
                                  const chunk_supply *from, void *out);

#endif
