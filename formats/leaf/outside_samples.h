/* outside_samples.h - the samples of level 0 that a grid's treelet file leaves in others (section
 * OUTSIDE, formats/OUTSIDE.md).
 *
 * In one piece of a file: they are read row by row, or slice by slice where rows lie close
 * together. That file must have the size and time that it had then, as the directory tells what
 * need not be read. In chunks (outside_chunks.h): the file that describes them must have the
 * same bytes, whatever its time; of chunks, whoever reads samples compares their checksum. In files
 * of a slice each (slice_folder.h): all must have the size and time of then when this is opened,
 * and each whenever it is read.
 *
 * Thread-safe: any number of loads at once, each with a room of its own.
 */
#ifndef FORMATS_LEAF_OUTSIDE_SAMPLES_H
#define FORMATS_LEAF_OUTSIDE_SAMPLES_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/slice_folder.h"
#include "formats/leaf/leaf.h"

/* outside_samples_describe() - fill the section from a place that volume_place() told: its file's
 * size and time as they are now, and its path from the folder of `leaf`, which need not exist yet.
 * ST_UNSUPPORTED if the path is too long, or chunks are too large.
 * outside_samples_place() - the place that a section tells, without its chunks. */
CHECKED status outside_samples_describe(mem *m, const sample_place *at, const char *leaf,
                                        leaf_outside *out);
sample_place outside_samples_place(const leaf_outside *o);

typedef struct outside_samples outside_samples;

/* Sections CHUNKS and SLICES; NULL: there is none. */
typedef struct outside_tables {
    const struct chunk_entry *chunks;
    const struct slice_file *slices;
} outside_tables;

/* outside_samples_open() - open the file that a checked section names, or look at those of all
 * slices. leaf: the path of the treelet file, whose level 0 has these dims. The tables must outlive
 * it. ST_CORRUPT: a file is another one than then. */
CHECKED status outside_samples_open(mem *m, const char *leaf, const leaf_outside *o,
                                    const outside_tables *tables, const uint32_t dims[3],
                                    outside_samples **out);
void outside_samples_close(outside_samples *s); /* NULL is fine */

/* outside_samples_path() - of the file, or of the folder of chunks or slices. */
const char *outside_samples_path(const outside_samples *s);

/* outside_samples_changed() - ST_CORRUPT if the file has changed since it was opened. Those of
 * slices are looked at when they are read, and not here. */
CHECKED status outside_samples_changed(const outside_samples *s);

/* A box of nodes: of those that do not exist, it has copies of the nearest ones. */
typedef struct outside_box {
    int64_t first[3]; /* -1 or more */
    uint32_t size[3];
} outside_box;

/* outside_samples_room() - the bytes of a room for boxes of up to `side` nodes along x.
 * outside_samples_bytes() - returns how many bytes of numbers a box takes: in one piece as many are
 * read of the file; of chunks it depends on what is packed, and kept from other boxes. */
size_t outside_samples_room(const outside_samples *s, uint32_t side);
uint64_t outside_samples_bytes(const outside_samples *s, const outside_box *b);

/* outside_samples_are_shared() - whether boxes of this side that lie side by side along x or y are
 * best read one after the other, as they need the same chunks, which have much else. */
bool outside_samples_are_shared(const outside_samples *s, uint32_t side);

/* outside_samples_load() - make the samples of a box, x fastest, of sample_place_type(). The bytes
 * that were read are added to *read. */
CHECKED status outside_samples_load(outside_samples *s, const outside_box *b, void *room,
                                    void *samples, uint64_t *read);

/* outside_samples_print() - say where a box lies, for messages: the file, or the folder and its
 * chunks, or its slices' files. */
enum { OUTSIDE_SAMPLES_TEXT = 4096 + 3 * SLICE_FILE_NAME };
const char *outside_samples_print(const outside_samples *s, const outside_box *b,
                                  char text[OUTSIDE_SAMPLES_TEXT]);

/* outside_samples_sum() - the checksum of a treelet's samples; never 0. */
uint64_t outside_samples_sum(const void *samples, size_t bytes);

#endif
