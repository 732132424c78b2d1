/* imported_chunks.h - what an importer tells of the chunks that a grid's samples lie in, on its
 * way through a pipe: their number, a section OUTSIDE (leaf.h) without its file, their table, and
 * the names of the slices' files, if they have some.
 *
 * An importer's library reads hostile files. So what it says is checked as a treelet file is.
 */
#ifndef FORMATS_GRID_IMPORTED_CHUNKS_H
#define FORMATS_GRID_IMPORTED_CHUNKS_H

#include "formats/base/out_stream.h"
#include "formats/grid/chunk_array.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/slice_folder.h"
#include "formats/input/byte_stream.h"

/* imported_chunks_write() - write a place with chunks and a table, of a grid of so many slices. */
CHECKED status imported_chunks_write(const sample_place *at, uint32_t slices, out_stream *out);

typedef struct imported_chunks {
    mem *m;
    chunk_array array;
    chunk_entry *table;
    slice_file *slices;
} imported_chunks;

/* imported_chunks_read() - read what imported_chunks_write() wrote, for a grid of these dims whose
 * samples have that type in a treelet file. path: of the input; the files of slices in this folder
 * are looked at. *at refers to *c. ST_CORRUPT: it makes no sense. Release c in any case. */
CHECKED status imported_chunks_read(byte_stream *from, const char *path, const uint32_t dims[3],
                                    sample_type type, imported_chunks *c, sample_place *at);
void imported_chunks_release(imported_chunks *c);

#endif
