/* step_list.h - which time steps: all, or a list of numbers and ranges, as --steps takes it. Pure.
 */
#ifndef FORMATS_BASE_STEP_LIST_H
#define FORMATS_BASE_STEP_LIST_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/status.h"

/* How it is written, for tables of options and for messages. */
#define STEP_LIST_FORM "all|A:B[:S][,..]"

enum { STEP_RANGES_MAX = 64 };

/* first, first + stride, .. up to last. */
typedef struct step_range {
    uint32_t first, last, stride;
} step_range;

/* Zeros: none is asked for. */
typedef struct step_list {
    bool all; /* of a file that is not known yet */
    int count;
    step_range of[STEP_RANGES_MAX];
} step_list;

/* step_list_parse() - "all", or entries divided by commas: a number, A:B, or A:B:S. ST_USAGE
 * naming `option`. */
CHECKED status step_list_parse(const char *text, const char *option, step_list *out);

/* step_list_given() - whether any is asked for. */
bool step_list_given(const step_list *l);

/* step_list_settle() - of a file `name` that has so many steps, which `all` becomes. ST_USAGE where
 * one is not there. */
CHECKED status step_list_settle(step_list *l, const char *option, const char *name, uint32_t steps);

/* step_list_ascends() - whether each comes but once, after smaller ones. */
bool step_list_ascends(const step_list *l);

/* step_list_count() - how many; step_list_at() - the i-th. Not of `all`. */
uint64_t step_list_count(const step_list *l);
uint32_t step_list_at(const step_list *l, uint64_t i);

#endif
