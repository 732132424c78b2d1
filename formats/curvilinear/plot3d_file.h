/* plot3d_file.h - an open file of PLOT3D: its layout is found, and its numbers are read where they
 * lie.
 *
 * Holds the place of each zone and a buffer of fixed size; of text the marks of plot3d_text.h. One
 * thread per file.
 */
#ifndef FORMATS_CURVILINEAR_PLOT3D_FILE_H
#define FORMATS_CURVILINEAR_PLOT3D_FILE_H

#include "formats/base/file.h"
#include "formats/curvilinear/plot3d_layout.h"
#include "formats/curvilinear/plot3d_text.h"

enum { PLOT3D_CHUNK = 4096 }; /* nodes read at once */

typedef struct plot3d_file {
    mem *m;
    file *f;
    plot3d_text *text; /* NULL: it is none */
    unsigned layout;
    uint32_t zones;
    uint32_t (*nodes)[3]; /* of each zone, along i, j, k */
    plot3d_block *blocks;
    uint32_t numbers; /* of each node: 3 of a grid, 5 of a solution, the functions */
    uint64_t behind;  /* bytes behind the numbers: zeros */
    void *buffer;
} plot3d_file;

/* plot3d_file_open() - open a file and find its layout. grid: the open grid that it goes with,
 * whose zones it must have; NULL for a grid, which has 2 nodes or more along each axis. Zeros of
 * less than 4096 bytes may lie behind the numbers, but only if no layout fits without. ST_CORRUPT
 * where no layout fits, or the lengths of a record differ; ST_UNSUPPORTED for a grid of two
 * dimensions; ST_USAGE where several layouts fit, naming the words that decide. Release *out in any
 * case. */
CHECKED status plot3d_file_open(mem *m, const char *path, plot3d_content content,
                                const plot3d_words *words, const plot3d_file *grid,
                                plot3d_file *out);
void plot3d_file_release(plot3d_file *p); /* all zeros are fine */

/* plot3d_file_read() - read one of the numbers of nodes first to first + count - 1 of a zone.
 * plot3d_file_blanks() - read their IBLANK. count: up to PLOT3D_CHUNK.
 * plot3d_file_conditions() - read what a solution says of the first zone. */
CHECKED status plot3d_file_read(plot3d_file *p, uint32_t zone, uint32_t number, uint64_t first,
                                size_t count, double *out);
CHECKED status plot3d_file_blanks(plot3d_file *p, uint32_t zone, uint64_t first, size_t count,
                                  int32_t *out);
CHECKED status plot3d_file_conditions(plot3d_file *p, double out[PLOT3D_CONDITIONS]);

#endif
