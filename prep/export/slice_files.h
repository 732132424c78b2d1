/* slice_files.h - writes each slice of samples to a file of its own.
 *
 * A file appears under its name when it is complete. If the last slice does not come, all files are
 * removed.
 */
#ifndef PREP_EXPORT_SLICE_FILES_H
#define PREP_EXPORT_SLICE_FILES_H

#include <stddef.h>

#include "prep/export/sample_format.h"

typedef struct slice_files slice_files;

/* slice_files_create() - pattern: for sequence_name(), slice 0 first. Writes nothing yet, but
 * checks each file with out_file_check(). g must outlive it. */
CHECKED status slice_files_create(mem *m, const char *pattern, bool force,
                                  const sample_format *format, const grid *g, slice_files **out);

/* slice_files_take() - write the next count samples, whole slices; a grid_slices_take(). */
CHECKED status slice_files_take(void *files, const void *samples, size_t count);

/* slice_files_end() - st: status of the slices. Unless it is ST_OK, remove the files. Returns st.
 * NULL is fine. */
CHECKED status slice_files_end(slice_files *s, status st);

#endif
