/* ref_load.h - whole volumes from raw files and plain NRRD files, for the reference; reads them by
 * itself. */
#ifndef TESTS_SUPPORT_REF_LOAD_H
#define TESTS_SUPPORT_REF_LOAD_H

#include <stdbool.h>

#include "tests/support/reference.h"

/* What a volume is loaded from; for NRRD only the path, and axes, are looked at. */
typedef struct ref_source {
    const char *path;
    long dims[3];
    const char *type; /* u8 i8 u16 i16 u32 i32 f32 f64 */
    long skip;        /* bytes before the samples */
    bool big_endian;
    double to_world[3][4];
    const char *axis_path[3]; /* text files of node coordinates, or NULL */
} ref_source;

/* ref_source_set() - the samples at origin + i * spacing. */
void ref_source_set(ref_source *s, const double spacing[3], const double origin[3]);

/* ref_load() - samples become floats. false: *why says what is the matter. Release it. */
bool ref_load(ref_source *s, ref_volume *v, const char **why);
void ref_unload(ref_volume *v);

#endif
