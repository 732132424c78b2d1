/* curvilinear_files.h - the steps of a curvilinear grid: in files, one a step, of which one is open
 * beside the first; or those of one input.
 */
#ifndef PREP_CURVILINEAR_CURVILINEAR_FILES_H
#define PREP_CURVILINEAR_CURVILINEAR_FILES_H

#include "formats/curvilinear/curvilinear_input.h"
#include "formats/mesh/mesh_sink.h"
#include "prep/curvilinear/curvilinear_convert.h"
#include "prep/step_series.h"

typedef struct curvilinear_files {
    mem *m;
    step_series of; /* fields, and the paths of the steps */
    curvilinear_hints hints;
    curvilinear_input *first; /* of step 0, or with all steps; the caller's */
    /* Inside: */
    curvilinear_input *later;
    char field[MESH_NAME_MAX + 1]; /* the one that the hints choose */
    const char *names[1];
} curvilinear_files;

/* curvilinear_files_check() - ST_UNSUPPORTED if the first one has no field at all.
 * curvilinear_files_series() - the series of these files. f must not be moved then.
 * curvilinear_files_release() - after all use of the series. */
CHECKED status curvilinear_files_check(const curvilinear_files *f);
curvilinear_series curvilinear_files_series(curvilinear_files *f);
void curvilinear_files_release(curvilinear_files *f);

#endif
