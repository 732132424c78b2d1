/* hdf5_text.h - helpers for libhdf5: attributes, and error messages. */
#ifndef PREP_IMPORT_HDF5_HDF5_TEXT_H
#define PREP_IMPORT_HDF5_HDF5_TEXT_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>

#include "formats/base/status.h"

/* hdf5_failed() - describe the library's last error as "file: what: its words". Returns ST_NOMEM if
 * it had no memory, else ST_CORRUPT. */
status hdf5_failed(const char *file, const char *what);

/* hdf5_words() - only the library's words. */
void hdf5_words(char *to, size_t room);

/* hdf5_numbers() - read an attribute of at most `most` numbers, as doubles. Returns how many; 0:
 * there is no such attribute. */
int hdf5_numbers(hid_t object, const char *name, double *out, int most);
/* hdf5_has_more() - whether there is such an attribute with more values than that. */
bool hdf5_has_more(hid_t object, const char *name, int most);

/* hdf5_string() - read a text attribute, or the i-th of several texts. Returns false if there is
 * none. */
bool hdf5_string(hid_t object, const char *name, size_t i, char *to, size_t room);

#endif
