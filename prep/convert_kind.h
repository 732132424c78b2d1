/* convert_kind.h - how inputs of one kind are converted by the verb: a row each, for
 * convert_main.c. */
#ifndef PREP_CONVERT_KIND_H
#define PREP_CONVERT_KIND_H

#include "formats/input_open.h"
#include "prep/convert_request.h"

typedef struct convert_kind {
    const input_kind *of;
    /* Returns whether the input is a list of steps, which are all taken as if they were given one
     * by one. */
    bool (*is_collection)(const void *own);
    /* Print notes about the open input: what was chosen for the user, what may surprise. */
    void (*note)(const convert_request *a, const void *own);
    /* Convert or plan, then report. May close the input: then in->kind is NULL. start: when the
     * verb began, see clock_seconds(). */
    status (*run)(convert_request *a, mem *m, input *in, double start);
} convert_kind;

#endif
