/* outside_chunks.h - samples of level 0 that lie in the chunks of an array: what section OUTSIDE
 * says of them (leaf_outside.form and what follows, OUTSIDE.md), and reading boxes.
 *
 * Thread-safe.
 */
#ifndef FORMATS_LEAF_OUTSIDE_CHUNKS_H
#define FORMATS_LEAF_OUTSIDE_CHUNKS_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/chunk_array.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/slice_folder.h"
#include "formats/leaf/leaf.h"

/* Chunks of more bytes are refused, before room is made for one. */
#define OUTSIDE_CHUNK_MAX ((uint64_t)1 << 32)
/* And so are larger files that describe an array. */
enum { OUTSIDE_JSON_MAX = 1 << 22 };

/* outside_chunks_put() - fill the part of a section that concerns chunks, but for its sum.
 * at: a place with chunks. folder: where files of chunks lie, without links. ST_UNSUPPORTED: they
 * are larger than OUTSIDE_CHUNK_MAX. outside_chunks_array() - the array that a section describes,
 * whose numbers are in range. dims: the grid's; NULL: `rows` is left
 * out. */
CHECKED status outside_chunks_put(const sample_place *at, const char *folder, leaf_outside *out);
chunk_array outside_chunks_array(const leaf_outside *o, const uint32_t dims[3]);

/* outside_chunks_count() - the chunks that a grid of these dims meets, of a section that is sound:
 * those of section CHUNKS. UINT64_MAX: more. */
uint64_t outside_chunks_count(const leaf_outside *o, const uint32_t dims[3]);

/* outside_chunks_fault() - NULL, or what cannot be in such a section, whose numbers are in range:
 * roles, filters, sizes. */
const char *outside_chunks_fault(const leaf_outside *o);

/* outside_chunks_in_slice() - the chunks of a slice, of one number of a sample, where chunks have
 * one slice each: as many of section CHUNKS, one behind the other.
 * outside_chunks_entry_fault() - as outside_chunks_fault(), of an entry of section CHUNKS, whose
 * file has so many bytes. */
uint32_t outside_chunks_in_slice(const leaf_outside *o, const uint32_t dims[3]);
const char *outside_chunks_entry_fault(const leaf_outside *o, uint64_t bytes, const chunk_entry *e);

typedef struct outside_chunks outside_chunks;

/* Where an array's chunks are looked for. */
typedef struct outside_chunks_in {
    file *f; /* the one that the section names: it describes the array, beside its chunks, or has
                them all; */
    const chunk_entry *table;   /* then section CHUNKS, else NULL; */
    const slice_folder *slices; /* in the place of f, the files of slices; NULL: none */
    const uint32_t *dims;       /* of the grid */
} outside_chunks_in;

/* outside_chunks_open() - files and table must outlive it. */
CHECKED status outside_chunks_open(mem *m, const leaf_outside *o, const outside_chunks_in *in,
                                   outside_chunks **out);
void outside_chunks_close(outside_chunks *c); /* NULL is fine */

/* outside_chunks_are_wide() - whether a chunk meets several boxes of this side along x and y. */
bool outside_chunks_are_wide(const outside_chunks *c, uint32_t side);

const char *outside_chunks_path(const outside_chunks *c); /* of their folder, or file */

/* outside_chunks_load() - read the numbers of count[a] nodes from first[a] on, those that are taken
 * side by side, then x fastest, in native byte order. The bytes read of files are added to *read.
 */
CHECKED status outside_chunks_load(outside_chunks *c, const uint32_t first[3],
                                   const uint32_t count[3], void *numbers, uint64_t *read);

/* outside_chunks_print() - names the chunks that hold these nodes, and which file is not there. */
enum { OUTSIDE_CHUNKS_TEXT = 3 * CHUNK_NAME + 96 };
const char *outside_chunks_print(const outside_chunks *c, const uint32_t first[3],
                                 const uint32_t count[3], char text[OUTSIDE_CHUNKS_TEXT]);

#endif
