/* convert_notes.h - what convert says on standard error of an input, a line each: what was taken
 * otherwise than one may think, and the option that says so. */
#ifndef PREP_CONVERT_NOTES_H
#define PREP_CONVERT_NOTES_H

#include <stdbool.h>

#include "formats/base/cli.h"
#include "formats/grid/grid.h"
#include "formats/leaf/histogram.h"

/* convert_note_grid() - the reader's own note; and where lengths along z have another unit than
 * those along x, unless a factor was given, that there is one. */
void convert_note_grid(const cli_common *common, const grid *g, bool exaggerated);

/* convert_note_marker() - what is hardly a value like the others. */
void convert_note_marker(const cli_common *common, const histogram_marker *m);

#endif
