/* convert_request.h - what the command line of convert asks for. */
#ifndef PREP_CONVERT_REQUEST_H
#define PREP_CONVERT_REQUEST_H

#include "formats/base/cli.h"
#include "formats/input_kind.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/convert_sets.h"

typedef struct convert_request {
    cli_common common;
    input_hints hints;
    convert_sets sets;
    leaf_parameters file;
    /* For inputs that list their cells: */
    uint32_t treelet_tets, leaf_tets, coarse_dims;
    bool coarse, sah, gradients;

    bool dry_run, allow_empty;
    bool step; /* --step is given */
} convert_request;

/* convert_request_steps() - returns how many steps the treelet file gets. */
static inline uint32_t convert_request_steps(const convert_request *a) {
    return convert_sets_count_steps(&a->sets, a->common.input_count);
}

/* convert_request_sets() - returns the fields and steps that are asked for. */
static inline leaf_sets convert_request_sets(const convert_request *a) {
    return (leaf_sets){.fields = a->sets.count ? (uint32_t)a->sets.count : 1,
                       .steps = convert_request_steps(a),
                       .names = a->sets.count ? a->sets.names : NULL,
                       .times = a->sets.parsed,
                       .time_unit = a->sets.time_unit[0] ? a->sets.time_unit : NULL};
}

#endif
