/* convert_request.h - what the command line of convert asks for. */
#ifndef PREP_CONVERT_REQUEST_H
#define PREP_CONVERT_REQUEST_H

#include "formats/base/cli.h"
#include "formats/input_kind.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/convert_sets.h"
#include "prep/convert_work.h"
#include "prep/step_series.h"

enum { CONVERT_TOLD_MAX = 256 };

typedef struct convert_request {
    cli_common common;
    input_hints hints;
    convert_sets sets;
    leaf_parameters file;
    /* For inputs that list their cells: */
    uint32_t treelet_tets, leaf_tets, coarse_dims;
    bool coarse, sah, gradients;
    bool whole;  /* cells are not split */
    int normals; /* of vertices: file, smooth or flat, from 0 (convert_main.c) */
    bool normals_are_given;

    bool dry_run, allow_empty;
    bool in_place; /* leave the samples of level 0 where they are */
    /* Whether --compress, --treelet, --halo, --levels, --treelet-tets, --leaf-tets are: */
    bool codec_is_given, treelet_is_given, halo_is_given, levels_are_given;
    bool treelet_tets_is_given, leaf_tets_is_given;
    bool step; /* --step is given */

    /* Further steps of the output (convert_append.h): */
    bool append;
    leaf_grow *grow;   /* NULL: the output is new */
    size_t grow_bytes; /* of memory that it takes */

    /* Further steps as their files come (convert_watch.h): */
    struct {
        bool on;
        uint32_t until; /* steps of the output that are enough; 0: go on until stopped */
        double settle;  /* seconds without a change after which a file counts as whole */
    } watch;

    /* Unfinished work: */
    bool resume;
    double checkpoint; /* seconds between two saved states */
    convert_work work;
    /* The options that the output depends on, as they were given, of this table. */
    const struct argp_option *options;
    struct {
        int key;
        const char *text; /* NULL: it takes none */
    } told[CONVERT_TOLD_MAX];
    size_t told_count;
} convert_request;

/* convert_request_steps() - returns how many steps the treelet file gets. */
static inline uint32_t convert_request_steps(const convert_request *a) {
    return convert_sets_count_steps(&a->sets, a->common.input_count);
}

/* convert_request_times() - take the times that the command line gives, and tell if a file's own do
 * not ascend. */
static inline status convert_request_times(convert_request *a) {
    if (a->sets.times_fall)
        cli_note(&a->common, 1, "%s: its times do not ascend: 0, 1, .. instead", a->common.input);
    return convert_sets_times(&a->sets, convert_request_steps(a));
}

/* convert_request_beside() - give `take` each file that an option names, beside the inputs. Stops
 * at an error, which it returns. */
static inline status convert_request_beside(const convert_request *a,
                                            status (*take)(void *ctx, const char *path),
                                            void *ctx) {
    const path_list *lists[] = {&a->hints.curvilinear.solutions, &a->hints.curvilinear.functions};
    status st = ST_OK;
    for (int i = 0; i < 3 && st == ST_OK; i++)
        if (a->hints.grid.axis_file[i])
            st = take(ctx, a->hints.grid.axis_file[i]);
    for (int l = 0; l < 2; l++)
        for (int i = 0; i < lists[l]->count && st == ST_OK; i++)
            st = take(ctx, lists[l]->paths[i]);
    return st;
}

/* convert_request_series() - returns the fields and steps that are asked for, and their files. */
static inline step_series convert_request_series(const convert_request *a) {
    const bool named = a->sets.count > 0;
    return (step_series){.paths = (const char *const *)a->common.inputs,
                         .in_file = a->sets.steps > 0 ? &a->sets.taken : NULL,
                         .sets = {.fields = named ? (uint32_t)a->sets.count : 1,
                                  .steps = convert_request_steps(a),
                                  .names = named ? a->sets.names : NULL,
                                  .times = a->sets.parsed,
                                  .time_unit = a->sets.time_unit[0] ? a->sets.time_unit : NULL},
                         .fields = named ? a->sets.asked : NULL};
}

#endif
