/* hdf5_text.h - small things asked of libhdf5: attributes, and why it failed. */
#ifndef PREP_IMPORT_HDF5_HDF5_TEXT_H
#define PREP_IMPORT_HDF5_HDF5_TEXT_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>

#include "formats/base/status.h"

/* hdf5_failed() - describe what the library said last: "file: what: its words". ST_NOMEM where it
 * had no memory, else ST_CORRUPT. */
status hdf5_failed(const char *file, const char *what);

/* hdf5_words() - the same words alone. */
void hdf5_words(char *to, size_t room);

/* hdf5_numbers() - an attribute of at most `most` numbers, as doubles; returns how many, 0 where
 * there is no such attribute. */
int hdf5_numbers(hid_t object, const char *name, double *out, int most);

/* hdf5_string() - an attribute that is a text, or the i-th of several; false where it is none. */
bool hdf5_string(hid_t object, const char *name, size_t i, char *to, size_t room);

#endif
