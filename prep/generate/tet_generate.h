/* tet_generate.h - an analytic field on a regular mesh of tets, as a stream: memory grows neither
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
    uint32_t steps; /* a time series of so many files, when above 0 */
} tet_generate_options;

/* tet_generate() - hand the mesh over: all points, all values, all tets, in the order of
 * tet_lattice.h. Each copy has the values of the field on a grid of shape.dims nodes, taken where
 * its nodes lie undeformed, so that surfaces deform with the mesh. Works in blocks of 4 MiB (values
 * 32 MiB), or a quarter of m's limit where that is less, and at least a row. The sink is called by
 * this thread alone; it gets the same for any number of threads, though in chunks that depend on
 * the limit. ST_USAGE for a shape that tet_lattice_check() refuses, before anything is handed over.
 * steps is of no matter here. */
CHECKED status tet_generate(mem *m, const tet_generate_options *options, const mesh_sink *sink,
                            const progress *p);

/* tet_generate_files() - as mesh streams: to output (a path, or "-"). With steps, to as many files
 * of the same values and tets, named after output with _0000, _0001, ... before its suffix, or in
 * the place of its %04d: in step k the deformation is shape.deform sin(2 pi k / steps), a loop that
 * begins with the mesh as it is. All names are looked at before the first file is written. */
CHECKED status tet_generate_files(mem *m, const tet_generate_options *options, const char *output,
                                  bool force, const progress *p);

#endif
