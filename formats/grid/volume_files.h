/* volume_files.h - samples that lie in several files, one behind the other; NRRD and MetaImage call
 * this a list.
 *
 * Each file holds the same number of samples. Files are looked for beside the header, by the rule
 * of named_file.h. All are checked before the first sample is read.
 */
#ifndef FORMATS_GRID_VOLUME_FILES_H
#define FORMATS_GRID_VOLUME_FILES_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/grid/volume_layout.h"

/* volume_files_are() - returns whether a header's word for its data means several files: LIST,
 * whose lines are names, or a pattern "slice%03d.raw FIRST LAST STEP". */
bool volume_files_are(const char *word);

/* volume_files_open() - replace l->data, which stands behind the header, by the unpacked samples of
 * all files: l->encoding becomes VOLUME_RAW. header: its path. lines, bytes: skipped in each file,
 * as by volume_layout_skip(). ST_CORRUPT if the number of files does not fit, or one is too short;
 * ST_UNSUPPORTED for samples in text; ST_IO for a missing file. */
CHECKED status volume_files_open(volume_layout *l, const char *header, const char *word,
                                 bool follow_links, uint64_t lines, int64_t bytes);

#endif
