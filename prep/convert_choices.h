/* convert_choices.h - notes on standard error about choices that convert made by itself: a field, a
 * step, one of several components. Each is one line and names the option that chooses otherwise.
 */
#ifndef PREP_CONVERT_CHOICES_H
#define PREP_CONVERT_CHOICES_H

#include "formats/base/cli.h"
#include "formats/base/name_list.h"
#include "formats/grid/slice_source.h"
#include "prep/convert_sets.h"

/* What an input offers. Set the first four members; the others begin as zeros. */
typedef struct convert_choices {
    const cli_common *common;
    const convert_sets *sets;
    uint32_t component; /* --component; 0: not given */
    bool step;          /* --step or --steps is given */
    name_list taken, others;
    uint32_t count; /* fields in both lists */
} convert_choices;

/* convert_choices_take() - take note of a field that the input has. Prints the notes about its
 * steps and components. convert_choices_note() - the note about all fields. */
void convert_choices_take(convert_choices *c, const slice_field *f);
void convert_choices_note(const convert_choices *c);

#endif
