/* prep_arguments.h - what callers of leafcast_prep.h pass, before it is used: the tables of its
 * structs (formats/public_fields.h), and what else is looked at. A fault is described, ST_USAGE. */
#ifndef PREP_PREP_ARGUMENTS_H
#define PREP_PREP_ARGUMENTS_H

#include "formats/public_fields.h"
#include "prep/leafcast_prep.h"

/* prep_arguments_tables() - of the structs of leafcast_prep.h, *count of them. */
const public_fields *const *prep_arguments_tables(int *count);

CHECKED status prep_arguments_check_options(const leafcast_convert_options *options);
CHECKED status prep_arguments_check_grid(const leafcast_grid *from);
CHECKED status prep_arguments_check_tets(const leafcast_tets *tets);

/* prep_arguments_check_strides() - of an array of such a grid: no node is further from the first
 * than a pointer may be. */
CHECKED status prep_arguments_check_strides(const leafcast_grid *from, const ptrdiff_t strides[3]);

/* prep_arguments_check_paths() - of so many steps. */
CHECKED status prep_arguments_check_paths(const char *const *paths, uint32_t steps);

#endif
