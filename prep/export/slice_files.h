/* slice_files.h - slices of samples as files of their own, one after the other.
 *
 * Each appears under its name when it is complete. Where the last one does not come, those before
 * it are removed.
 */
#ifndef PREP_EXPORT_SLICE_FILES_H
#define PREP_EXPORT_SLICE_FILES_H

#include <stddef.h>

#include "prep/export/sample_format.h"

typedef struct slice_files slice_files;

/* slice_files_create() - pattern: as sequence_name() has it, slice 0 first. Nothing is written, but
 * each file is checked as out_file_check() does. g must outlive it. */
CHECKED status slice_files_create(mem *m, const char *pattern, bool force,
                                  const sample_format *format, const grid *g, slice_files **out);

/* slice_files_take() - the next count samples, whole slices; a grid_slices_take(). */
CHECKED status slice_files_take(void *files, const void *samples, size_t count);

/* slice_files_end() - st: what became of the slices; unless ST_OK, removes those that are there.
 * Returns st. NULL is fine. */
CHECKED status slice_files_end(slice_files *s, status st);

#endif
