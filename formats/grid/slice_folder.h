/* slice_folder.h - a folder of files that hold a slice of a grid each, such as the TIFFs of a
 * scanner: their names, and which files they were when an index was made of them.
 *
 * There may be thousands, so none is kept open: a file is opened for each chunk that is read of it,
 * and must have the size and time of then each time.
 *
 * Thread-safe: the table is only read.
 */
#ifndef FORMATS_GRID_SLICE_FOLDER_H
#define FORMATS_GRID_SLICE_FOLDER_H

#include <stdint.h>

#include "formats/base/file.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"

enum { SLICE_FILE_NAME = 256 };

/* The file of a slice. Treelet files store it. */
typedef struct slice_file {     /* offset size */
    uint64_t bytes;             /*    0    8  its length, */
    int64_t modified_s;         /*    8    8    and its time of last modification, since 1970, */
    uint32_t modified_ns;       /*   16    4    with nanoseconds below a second */
    uint32_t reserved;          /*   20    4  zero */
    char name[SLICE_FILE_NAME]; /*   24  256  in the folder; NUL-padded */
} slice_file;

_Static_assert(sizeof(slice_file) == 280, "slice_file is 280 bytes");

typedef struct slice_folder {
    const char *folder;
    const slice_file *of; /* `count` of them, by slice; the same file may have several slices */
    uint32_t count;
    const char *by; /* who keeps sizes and times of then, for messages */
} slice_folder;

/* slice_folder_fault() - NULL, or what cannot be in an entry, such as a name that leads out of the
 * folder. */
const char *slice_folder_fault(const slice_file *f);

/* slice_folder_mark() - fill in the sizes and times of now. ST_IO: one cannot be opened. */
CHECKED status slice_folder_mark(mem *m, const char *folder, slice_file *of, uint32_t count);

/* slice_folder_open() - open the file of a slice. slice_folder_check() - look at all of them.
 * ST_IO: it cannot be opened; ST_CORRUPT: it is another one than then. Both name it. */
CHECKED status slice_folder_open(mem *m, const slice_folder *s, uint32_t slice, file **out);
CHECKED status slice_folder_check(mem *m, const slice_folder *s);

#endif
