/* convert_choices.h - notes on standard error about choices that convert made by itself: a field, a
 * step, one of several components. Each is one line and names the option that chooses otherwise.
 */
#ifndef PREP_CONVERT_CHOICES_H
#define PREP_CONVERT_CHOICES_H

#include "formats/base/cli.h"
#include "formats/grid/volume.h"
#include "formats/mesh/mesh_input.h"
#include "prep/convert_sets.h"

/* convert_note_volume(), convert_note_mesh() - print the notes for an open input that has not been
 * read. step: the user chose a step. If the fields cannot be listed, a note says so instead. */
void convert_note_volume(const cli_common *common, const volume *v, const volume_hints *hints,
                         bool step, const convert_sets *sets);
void convert_note_mesh(const cli_common *common, const mesh_input *x, const mesh_hints *hints,
                       bool step, const convert_sets *sets);

#endif
