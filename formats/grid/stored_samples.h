/* stored_samples.h - how an input stores the samples of a grid, and how they are converted.
 *
 * A sample is one or several numbers of a type, side by side. Of several numbers either one is
 * taken, or all together: the magnitude of a vector, the luminance of a colour. Numbers may be
 * scaled. All of it is computed in double and rounded once, to sample_computed(). A single number
 * that is not scaled keeps its type, but f16 becomes f32, and u64 and i64 become f64.
 */
#ifndef FORMATS_GRID_STORED_SAMPLES_H
#define FORMATS_GRID_STORED_SAMPLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/volume_hints.h"

enum { STORED_SAMPLES_COMPONENTS = 256 };

/* Zeros but for the type: one number a sample, as it is. */
typedef struct stored_samples {
    sample_type type;    /* type of a number: any */
    uint32_t components; /* numbers a sample, at most STORED_SAMPLES_COMPONENTS; 0: 1 */
    uint32_t component;  /* the one to take, from 1; 0: all together */
    bool colours; /* the numbers are red, green, blue, ..: all together are their luminance */
    double slope, intercept; /* value = slope * number + intercept; slope 0: not scaled */
    double *rounding;        /* keeps the largest rounding error of a value; NULL: not kept */
} stored_samples;

/* stored_samples_choose() - apply the hints: set s->component, g->type and g->source. The component
 * stays as it is where the hints name none. ST_USAGE for a component that is not there,
 * ST_UNSUPPORTED for too many. file: for messages. */
CHECKED status stored_samples_choose(stored_samples *s, const char *file, const volume_hints *hints,
                                     grid *g);

/* stored_samples_tell() - say in `to` how many numbers a sample has, and which of them is read. */
void stored_samples_tell(const stored_samples *s, slice_field *to);

/* stored_samples_bytes() - returns the bytes of one stored sample. */
size_t stored_samples_bytes(const stored_samples *s);

/* stored_samples_type() - returns the type that a grid uses for these samples. */
sample_type stored_samples_type(const stored_samples *s);

/* stored_samples_plain() - returns whether a grid takes the samples as they are stored. */
bool stored_samples_plain(const stored_samples *s);

/* stored_samples_take() - convert count samples of native byte order to samples of a grid of type
 * `to`, which stored_samples_choose() set. Destroys in. Returns the index of the first sample with
 * a number that a double cannot hold (u64, i64); count when there is none. */
size_t stored_samples_take(const stored_samples *s, void *in, sample_type to, void *out,
                           size_t count);

#endif
