/* exodus_numbers.h - dimensions, names and numbers of a netCDF file by their names, none of them
 * behind its end.
 */
#ifndef PREP_IMPORT_EXODUS_EXODUS_NUMBERS_H
#define PREP_IMPORT_EXODUS_EXODUS_NUMBERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/file.h"
#include "formats/base/status.h"
#include "prep/import/netcdf/netcdf_storage.h"
#include "prep/import/netcdf/netcdf_variable.h"

/* A variable that was read, and checked. The library keeps a chunk of it. */
typedef struct exodus_use {
    bool any;
    netcdf_variable v;
} exodus_use;

enum { EXODUS_USES = 4 }; /* read in turn: the coordinates, or elements and their values */

typedef struct exodus_numbers {
    const char *path;
    file *f; /* the same file: libnetcdf reads zeros behind the end of a classic one */
    int id;  /* the library's */
    const netcdf_storage *storage;
    bool allow_missing;
    exodus_use uses[EXODUS_USES];
    int oldest;
} exodus_numbers;

/* exodus_numbers_dim() - the length of a dimension; 0: there is none. exodus_numbers_find() - a
 * variable; -1: there is none. */
uint64_t exodus_numbers_dim(const exodus_numbers *n, const char *name);
int exodus_numbers_find(const exodus_numbers *n, const char *name);

/* exodus_numbers_read() - read `count` numbers of one to three dimensions: from `start` on. Numbers
 * are made doubles, NaN where none were written, or int64. ST_CORRUPT: they are not there, or the
 * variable has other dimensions. */
CHECKED status exodus_numbers_read(exodus_numbers *n, int variable, int rank, const size_t start[],
                                   const size_t count[], double *to);
CHECKED status exodus_numbers_cells(exodus_numbers *n, int variable, const size_t start[2],
                                    const size_t count[2], int64_t *to);

/* exodus_numbers_name() - row i of a variable of characters, as text_name() has it, and cut to the
 * room; "": there is none. */
CHECKED status exodus_numbers_name(const exodus_numbers *n, int variable, size_t i, char *to,
                                   size_t room);

CHECKED status exodus_numbers_failed(const exodus_numbers *n, const char *what, int error);

#endif
