/* leaf_grow.h - add a segment to a treelet file: further steps of a series (SERIES.md 4).
 *
 * A segment is written as a file of its own first, then copied behind the others, and counts once
 * the first header says so, which is written last. Until then, and if anything fails or the program
 * is killed, the file is what it was. Who has it open goes on with the segments that it knows
 * (leaf_file_newer() takes in others).
 *
 *     leaf_grow_open(m, "series.leaf", &grow);
 *     ... write a segment with leaf_target.grow, by leaf_writer.h: leaf_writer_finish() adds it
 *     leaf_grow_close(grow);
 */
#ifndef FORMATS_LEAF_LEAF_GROW_H
#define FORMATS_LEAF_LEAF_GROW_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_file.h"

typedef struct leaf_grow leaf_grow;

/* leaf_grow_open() - open a file to add to it, and cut off what a program that was killed may have
 * left behind its end. One program at a time: ST_EXISTS where another one has it. ST_UNSUPPORTED: a
 * file of this kind does not grow, or not one whose samples lie in another file, whose vertices
 * move, or that has coarse grids.
 * leaf_grow_close() - NULL is fine. */
CHECKED status leaf_grow_open(mem *m, const char *path, leaf_grow **out);
void leaf_grow_close(leaf_grow *g);

/* leaf_grow_before() - the file as it was opened: all earlier segments. */
leaf_file *leaf_grow_before(const leaf_grow *g);

/* leaf_grow_head() - say in a new segment's header where it will lie. */
void leaf_grow_head(const leaf_grow *g, leaf_header *h);

/* leaf_grow_publish() - add the segment in this file. Once, at most. */
CHECKED status leaf_grow_publish(leaf_grow *g, const char *segment);

#endif
