/* volume_files.h - samples that lie in several files, one behind the other: what NRRD and MetaImage
 * call a list.
 *
 * Each file holds the same number of samples. They are looked for beside the header, as
 * named_file.h has it, and all are looked at before the first sample is read.
 */
#ifndef FORMATS_GRID_VOLUME_FILES_H
#define FORMATS_GRID_VOLUME_FILES_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/grid/volume_layout.h"

/* volume_files_are() - whether a header's word for its data means several files: LIST, whose lines
 * are names, or a pattern "slice%03d.raw FIRST LAST STEP". */
bool volume_files_are(const char *word);

/* volume_files_open() - replace l->data, which stands behind the header, by the samples of all
 * files, unpacked: l->encoding becomes VOLUME_RAW. header: its path. lines, bytes: of each file
 * what is passed over, as volume_layout_skip() has it. ST_CORRUPT for another number of files than
 * fits, or one that is too short; ST_UNSUPPORTED for samples in text; ST_IO for one that is not
 * there. */
CHECKED status volume_files_open(volume_layout *l, const char *header, const char *word,
                                 bool follow_links, uint64_t lines, int64_t bytes);

#endif
