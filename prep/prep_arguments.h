/* prep_arguments.h - checks what callers of leafcast_prep.h pass before it is used: by tables of
 * its structs (formats/public_fields.h) and more rules. A fault is described and is ST_USAGE. */
#ifndef PREP_PREP_ARGUMENTS_H
#define PREP_PREP_ARGUMENTS_H

#include "formats/public_fields.h"
#include "prep/leafcast_prep.h"

/* prep_arguments_tables() - the tables of the structs of leafcast_prep.h; *count: how many. */
const public_fields *const *prep_arguments_tables(int *count);

CHECKED status prep_arguments_check_options(const leafcast_convert_options *options);
CHECKED status prep_arguments_check_tets(const leafcast_tets *tets);

/* prep_arguments_check_paths() - check one path per step. */
CHECKED status prep_arguments_check_paths(const char *const *paths, uint32_t steps);

#endif
