/* curvilinear_stream.h - the curvilinear stream: the simplest format of curvilinear grids, for
 * pipes and for everything else.
 *
 * A header of text, then arrays, little endian; see CURVILINEAR_STREAM.md. The same calls give the
 * same bytes on every machine.
 */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_STREAM_H
#define FORMATS_CURVILINEAR_CURVILINEAR_STREAM_H

#include "formats/curvilinear/curvilinear_reader.h"

enum { CURVILINEAR_STREAM_FIELDS_MAX = 1000, CURVILINEAR_STREAM_ZONES_MAX = 1 << 16 };

typedef struct curvilinear_stream_header {
    const char *name;          /* of the data set; "": none; printable, one line */
    const char *const *fields; /* names, each once; 1 to CURVILINEAR_NAME_MAX bytes */
    uint32_t field_count;
    const uint32_t (*nodes)[3]; /* of each zone, along i, j, k; 2 or more */
    uint32_t zones;
    bool blanked;
} curvilinear_stream_header;

typedef struct curvilinear_stream_writer curvilinear_stream_writer;

/* curvilinear_stream_create() - begin the file `path` ("-": standard output) and write its header.
 * force: see out_file_create(). */
CHECKED status curvilinear_stream_create(mem *m, const char *path, bool force,
                                         const curvilinear_stream_header *h,
                                         curvilinear_stream_writer **out);

/* Write the places of all nodes, zone by zone; then, if some are blanked, what each is
 * (curvilinear_source.h); then the values, field by field, in runs of any length. Another order, or
 * more than the header says, fails an assert. Places are finite, also where there is no node. */
CHECKED status curvilinear_stream_places(curvilinear_stream_writer *w, size_t count,
                                         const float (*p)[3]);
CHECKED status curvilinear_stream_blanks(curvilinear_stream_writer *w, size_t count,
                                         const uint8_t *is_node);
CHECKED status curvilinear_stream_values(curvilinear_stream_writer *w, size_t count,
                                         const float *values);

/* curvilinear_stream_commit() - give the file its name. Everything must have been written (an
 * assert). Consumes w in any case. curvilinear_stream_discard() - leave nothing behind. NULL is
 * fine. */
CHECKED status curvilinear_stream_commit(curvilinear_stream_writer *w);
void curvilinear_stream_discard(curvilinear_stream_writer *w);

/* curvilinear_stream_known() - returns whether a file begins as a stream does. */
bool curvilinear_stream_known(const uint8_t *start, size_t size);

/* An open stream, whose planes are read in any order. What is no regular file, or packed, goes
 * first into a file without a name: beside the program's output, else in $TMPDIR. */
typedef struct curvilinear_stream curvilinear_stream;

/* curvilinear_stream_open() - read a stream's header, and look whether all of it is there.
 * ST_CORRUPT naming the line, or the bytes expected. data is read to its end and stays the
 * caller's; it may be closed afterwards. */
CHECKED status curvilinear_stream_open(mem *m, byte_stream *data, curvilinear_stream **out);
void curvilinear_stream_close(curvilinear_stream *s); /* NULL is fine */

/* curvilinear_stream_header_of() - its header; valid until it is closed. */
curvilinear_stream_header curvilinear_stream_header_of(const curvilinear_stream *s);

/* Read planes, as curvilinear_source.h says. */
CHECKED status curvilinear_stream_read_places(curvilinear_stream *s, uint32_t zone, uint32_t first,
                                              uint32_t count, float (*p)[3]);
CHECKED status curvilinear_stream_read_blanks(curvilinear_stream *s, uint32_t zone, uint32_t first,
                                              uint32_t count, uint8_t *is_node);
CHECKED status curvilinear_stream_read_values(curvilinear_stream *s, uint32_t zone, uint32_t field,
                                              uint32_t first, uint32_t count, float *values);

extern const curvilinear_reader curvilinear_stream_reader;

#endif
