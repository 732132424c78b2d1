/* step_list.h - a choice of time steps: all, or a list of numbers and ranges, as --steps takes it.
 * Pure.
 */
#ifndef FORMATS_BASE_STEP_LIST_H
#define FORMATS_BASE_STEP_LIST_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/status.h"

/* The syntax, for tables of options and for messages. */
#define STEP_LIST_FORM "all|A:B[:S][,..]"

enum { STEP_RANGES_MAX = 64 };

/* first, first + stride, .. up to last. */
typedef struct step_range {
    uint32_t first, last, stride;
} step_range;

/* All zeros: no step is asked for. */
typedef struct step_list {
    bool all; /* all steps, as long as their number is unknown; step_list_settle() replaces it */
    int count;
    step_range of[STEP_RANGES_MAX];
} step_list;

/* step_list_parse() - parse "all", or entries separated by commas: a number, A:B, or A:B:S.
 * ST_USAGE naming `option`. */
CHECKED status step_list_parse(const char *text, const char *option, step_list *out);

/* step_list_given() - whether any step is asked for. */
bool step_list_given(const step_list *l);

/* step_list_settle() - apply the list to a file `name` of so many steps: `all` becomes these.
 * ST_USAGE where a step does not exist. */
CHECKED status step_list_settle(step_list *l, const char *option, const char *name, uint32_t steps);

/* step_list_ascends() - whether each step comes once, after all smaller ones. */
bool step_list_ascends(const step_list *l);

/* step_list_count() - the number of steps. step_list_at() - the i-th step. Settle `all` first. */
uint64_t step_list_count(const step_list *l);
uint32_t step_list_at(const step_list *l, uint64_t i);

#endif
