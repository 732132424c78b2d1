/* convert_choices.h - what convert says on standard error of each choice that nobody asked for: a
 * field, a step, a component of several that an input has. A line each, with the option that
 * chooses otherwise.
 */
#ifndef PREP_CONVERT_CHOICES_H
#define PREP_CONVERT_CHOICES_H

#include "formats/base/cli.h"
#include "formats/grid/volume.h"
#include "formats/mesh/mesh_input.h"
#include "prep/convert_sets.h"

/* convert_note_volume(), convert_note_mesh() - of an input that is open and has not been read.
 * step: one was asked for. Where its fields cannot be listed, this is said instead. */
void convert_note_volume(const cli_common *common, const volume *v, const volume_hints *hints,
                         bool step, const convert_sets *sets);
void convert_note_mesh(const cli_common *common, const mesh_input *x, const mesh_hints *hints,
                       bool step, const convert_sets *sets);

#endif
