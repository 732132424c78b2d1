/* curvilinear_convert.h - converts curvilinear grids: zones of nodes into a treelet file.
 *
 * A layer of treelets of a zone is in memory at a time, of places or of one field's values. All
 * threads make its treelets: nodes in their order, the two bits of each cell, boxes and ranges.
 * Each set is a pass over the zones. The file depends on the input alone.
 */
#ifndef PREP_CURVILINEAR_CURVILINEAR_CONVERT_H
#define PREP_CURVILINEAR_CURVILINEAR_CONVERT_H

#include "formats/base/progress.h"
#include "formats/curvilinear/curvilinear_source.h"
#include "formats/leaf/leaf_writer.h"

/* The steps of a curvilinear grid: sources with the same zones. */
typedef struct curvilinear_series {
    void *ctx;
    /* open(): *out is valid until the next call, and has all fields of the sets. path(): the name
     * of the step that was opened last, for messages. */
    status (*open)(void *ctx, uint32_t step, const curvilinear_source **out);
    const char *(*path)(void *ctx, uint32_t step);
    leaf_sets sets;
    bool still; /* nodes are known to be the same at all steps, so nobody looks */
} curvilinear_series;

typedef struct curvilinear_options {
    leaf_parameters file; /* alignment, compression and histograms are used */
    uint64_t memory;      /* budget in bytes */
    int threads;          /* 1 or more */
    bool force;           /* replace an existing output */
    bool grows;           /* steps may be added to the output later */
    leaf_grow *grow;      /* the output, opened: these are further steps of it; or NULL */
    bool refuse_empty;    /* ST_UNSUPPORTED if no value is a number */
    bool coarse;          /* add a coarse grid for each set (curvilinear_coarse.h), */
    bool coarse_regular;  /* a regular one alone, as coarse_grids.inside; also regular: */
    uint32_t coarse_dims; /* as coarse_grids.dims */
} curvilinear_options;

typedef struct curvilinear_plan {
    uint64_t treelets, cells, nodes; /* nodes: zone by zone */
    uint64_t memory;                 /* bytes of the conversion, with what is in use already */
    uint64_t file_bytes;             /* at most, without the directory */
} curvilinear_plan;

typedef struct curvilinear_result {
    leaf_header header;
    uint64_t cells[4]; /* of each hex_code, at step 0 */
} curvilinear_result;

/* curvilinear_plan_make() - what a conversion takes. first: a source of the series. ST_NOMEM if
 * that is more than o->memory; the text says how much. ST_UNSUPPORTED: too many treelets. */
CHECKED status curvilinear_plan_make(mem *m, const curvilinear_series *s,
                                     const curvilinear_source *first, const curvilinear_options *o,
                                     curvilinear_plan *plan);

/* curvilinear_convert() - plan, convert, and publish `output`. name: of the data set. ST_CORRUPT
 * names a step whose zones are not those of the first; ST_USAGE what is no further step. */
CHECKED status curvilinear_convert(mem *m, const curvilinear_series *s, const char *name,
                                   const char *output, const curvilinear_options *o,
                                   const progress *p, curvilinear_result *result);

#endif
