/* convert_notes.h - notes of convert on standard error about an input: what was read in a way that
 * users may not expect, and the option that changes it. Each is one line. */
#ifndef PREP_GRID_CONVERT_NOTES_H
#define PREP_GRID_CONVERT_NOTES_H

#include <stdbool.h>

#include "formats/base/cli.h"
#include "formats/grid/grid.h"
#include "formats/leaf/histogram.h"

/* convert_note_grid() - print the reader's own note. If lengths along z have another unit than
 * those along x and no factor was given, also say that --exaggerate exists. */
void convert_note_grid(const cli_common *common, const grid *g, bool exaggerated);

/* convert_note_marker() - tell of a value that probably stands for no data. */
void convert_note_marker(const cli_common *common, const histogram_marker *m);

#endif
