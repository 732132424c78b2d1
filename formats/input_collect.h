/* input_collect.h - for the rows of input_facts_kind.h: put what an input says into its facts. */
#ifndef FORMATS_INPUT_COLLECT_H
#define FORMATS_INPUT_COLLECT_H

#include "formats/input_facts.h"

/* input_collect_value() - count a value: into the range, or as not finite. */
void input_collect_value(input_facts *x, double value);

/* input_collect_name() - take the input's own name, or else the file's without the suffix. */
void input_collect_name(input_facts *x, const char *own);

/* input_collect_field() - add a field of one step, or change its components. "": it has no name.
 * input_collect_listed() - returns the field of this name, adding it if needed; NULL: no room is
 * left. */
void input_collect_field(input_facts *x, const char *name, uint32_t components);
input_field *input_collect_listed(input_facts *x, const char *name);

/* input_collect_times() - take the times of so many steps. */
void input_collect_times(input_facts *x, uint32_t steps, const double *times);

#endif
