/* analytic.h - fields given by a formula, evaluated in strips of a row.
 *
 * Terms of one coordinate alone are tabulated per axis. So a sample costs additions,
 * multiplications and at most a square root or an exponential. All is elementwise in a fixed order:
 * results do not depend on strips, vectors or threads.
 */
#ifndef PREP_GENERATE_ANALYTIC_H
#define PREP_GENERATE_ANALYTIC_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "prep/generate/field.h"

enum { ANALYTIC_STRIP = 128, ANALYTIC_PARAMETERS = 192 };

typedef struct analytic_kind analytic_kind;

typedef struct analytic {
    const analytic_kind *kind;
    uint32_t dims[3];
    double *table[3]; /* [column][node] per axis */
    double parameters[ANALYTIC_PARAMETERS];
} analytic;

/* The samples i .. i + width - 1 of row (j, k). */
typedef struct analytic_strip {
    uint32_t i, width; /* width <= ANALYTIC_STRIP */
    uint32_t j, k;
} analytic_strip;

struct analytic_kind {
    field_info info;
    int columns; /* of each axis' table */
    /* time: 0 .. 1, for kinds that change with it. May be NULL. */
    void (*set_up)(double *parameters, uint64_t seed, double time);
    /* Compute the table's columns at coordinate x of an axis: out[c * stride]. */
    void (*tabulate)(const double *parameters, int axis, double x, double *out, size_t stride);
    /* Compute terms that strips of the same i, width and j share for all k: shared[ANALYTIC_STRIP].
     * May be NULL.
     */
    void (*prepare)(const analytic *a, const analytic_strip *s, double *shared);
    void (*evaluate)(const analytic *a, const analytic_strip *s, const double *shared, double *out);
};

/* analytic_kinds() - all kinds; *count: how many. */
const analytic_kind *analytic_kinds(size_t *count);

/* analytic_init() - set up and tabulate. Release a in any case. */
CHECKED status analytic_init(analytic *a, mem *m, const analytic_kind *kind, const uint32_t dims[3],
                             uint64_t seed, double time);
void analytic_release(analytic *a, mem *m);

#endif
