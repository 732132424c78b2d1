/* tet_generate.h - an analytic field on a regular mesh of tets, as a stream. Memory grows neither
 * with the mesh nor with the number of copies.
 */
#ifndef PREP_GENERATE_TET_GENERATE_H
#define PREP_GENERATE_TET_GENERATE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/mesh/mesh_input.h"
#include "prep/generate/field.h"
#include "prep/generate/tet_lattice.h"

typedef struct tet_generate_options {
    const field_info *info;
    uint64_t seed;
    tet_lattice_shape shape;
    int threads;
    uint32_t steps; /* above 0: a time series of this many files */
} tet_generate_options;

/* tet_generate() - hand the mesh over: all points, all values, all tets, in the order of
 * tet_lattice.h. Each copy has the field's values on a grid of shape.dims nodes, sampled at the
 * undeformed nodes. So surfaces deform with the mesh. Works in blocks of 4 MiB (values 32 MiB), or
 * a quarter of m's limit if that is less, and at least a row. Only this thread calls the sink. The
 * data is the same for any number of threads; its chunks depend on the limit. ST_USAGE, before
 * anything is handed over: tet_lattice_check() refuses the shape. Ignores `steps`. */
CHECKED status tet_generate(mem *m, const tet_generate_options *options, const mesh_sink *sink,
                            const progress *p);

/* tet_generate_files() - write mesh streams to output (a path, or "-"). With steps: to as many
 * files of the same tets (generate_steps.h). In step k the deformation is
 * shape.deform sin(2 pi k / steps), a loop that begins with the undeformed mesh. Values differ
 * where the field changes with time: from 0 to 1. All names are checked before the first file is
 * written. */
CHECKED status tet_generate_files(mem *m, const tet_generate_options *options, const char *output,
                                  bool force, const progress *p);

#endif
