/* sample_place.h - where the samples of a grid lie as they are: in one piece of a file, x fastest,
 * or in the chunks of an array (chunk_array.h).
 *
 * What is read there becomes samples of a treelet file by the same steps as in a conversion: byte
 * order, the chosen number, slope, missing data, the stored type.
 */
#ifndef FORMATS_GRID_SAMPLE_PLACE_H
#define FORMATS_GRID_SAMPLE_PLACE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/grid/stored_samples.h"

struct chunk_array;
struct chunk_entry;
struct slice_file;

typedef struct sample_place {
    const char *path;      /* of the file; lives as long as what it is a place of */
    uint64_t offset;       /* of the first number of the first sample; 0 for chunks */
    bool big_endian;       /* for numbers wider than a byte */
    stored_samples stored; /* without rounding */
    bool has_missing;      /* samples equal to `missing` become NaN */
    double missing;
    /* NULL: one piece. Else path is the file beside the chunks that describes the array, or the one
     * that has them all: */
    const struct chunk_array *chunks;
    uint32_t step;                   /* index along its axis of steps */
    const struct chunk_entry *table; /* of all chunks of the grid, as in chunk_home; NULL: files */
    uint32_t table_count;
    const struct slice_file *slices; /* with a table: its chunks lie in the file of their slice, one
                                        for each slice of the grid, and path is the folder; NULL:
                                        all in one file */
    const char *trusted;             /* the folder in which the user lets chunks lie */
    bool follow_links;               /* or anywhere */
    const char *refused; /* why samples cannot stay in their chunks, and all else means nothing;
                            lives as path does; NULL: they can */
} sample_place;

/* Why samples cannot stay where they are, in a few words, such as "szip". */
#define SAMPLE_PLACE_REFUSED "refused: "

/* sample_place_print() - a place of single numbers, without path, as text; of chunks it says only
 * that there are some; of one that is refused, why.
 * sample_place_parse() - the place in one piece that a text tells; false if it is none. path stays
 * NULL.
 * sample_place_is_chunks() - whether the text says that there are chunks. */
const char *sample_place_print(const sample_place *p, char text[GRID_PLACE_MAX]);
bool sample_place_parse(const char *text, sample_place *out);
bool sample_place_is_chunks(const char *text);

/* sample_place_type() - returns the type that a treelet file stores the samples in. */
sample_type sample_place_type(const sample_place *p);

/* sample_place_take() - convert count samples as they lie in the file to samples of that type.
 * Destroys in. Returns false if one is none that a conversion takes. */
bool sample_place_take(const sample_place *p, void *in, void *out, size_t count);

#endif
