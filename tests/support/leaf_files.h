/* leaf_files.h - samples in memory to a treelet file in the scratch folder, for tests of what comes
 * out. */
#ifndef TESTS_SUPPORT_LEAF_FILES_H
#define TESTS_SUPPORT_LEAF_FILES_H

#include <stdint.h>

#include "formats/leaf/leaf_file.h"
#include "prep/grid/convert.h"
#include "prep/grid/grid_series.h"

/* A volume to be converted, and how. */
typedef struct leaf_case {
    uint32_t dims[3];
    sample_type type;
    const void *samples;
    const char *axis_file[3]; /* rectilinear: as in volume_hints */
    world_axes axes;          /* and these likewise */
    const char *unit;
    bool in_place; /* its input stays, and the file is an index of it, compressed, */
    const struct sample_place *place; /* or of samples that lie here; NULL: of its input */
    volume_hints reading; /* big_endian, skip, missing: how the samples of the input are */
    convert_options options;
} leaf_case;

/* leaf_files_case() - dims and type, samples NULL; B = 16, h = 1, raw, 1 GiB, 2 threads. */
leaf_case leaf_files_case(uint32_t nx, uint32_t ny, uint32_t nz, sample_type type);

/* leaf_files_random() - samples for a case, malloc'ed: smooth waves and noise over the type's
 * range, so that treelets differ; for f32 about one in `non_finite` is NaN or inf (0: none). */
void *leaf_files_random(const leaf_case *c, uint64_t seed, int non_finite);

/* leaf_files_try() - convert it to the scratch file of this name: the status. The plan and the
 * result may be NULL. m: what it is done with, its limit set to the budget. */
status leaf_files_try(mem *m, const leaf_case *c, const char *name, convert_plan *plan,
                      convert_result *result);

/* leaf_files_least() - the smallest budget with which it converts. */
uint64_t leaf_files_least(const leaf_case *c);

/* leaf_files_make() - convert it, failing the test on an error and on memory not given back;
 * returns the path. */
const char *leaf_files_make(const leaf_case *c, const char *name);

/* leaf_files_series() - the same of several sets, by o; their files are there. */
const char *leaf_files_series(const grid_series *of, const convert_options *o, const char *name);

/* leaf_files_add() - add sets to the file at a path, by o: the status. */
status leaf_files_add(const grid_series *of, const convert_options *o, const char *path);

/* leaf_files_long() - sixty treelets in a row along x, each with more than is anywhere at y = 2.3,
 * where the greatest value is 5, in the last of them, and 1 elsewhere: more treelets than a ray
 * keeps in order at a time. Returns the path. */
enum { LEAF_FILES_LONG = 60 * 16 + 1 };
const char *leaf_files_long(const char *name);

#endif
