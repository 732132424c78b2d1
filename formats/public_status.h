/* public_status.h - for files that implement the public headers: convert a status, and check a
 * struct's size, at the border.
 */
#ifndef FORMATS_PUBLIC_STATUS_H
#define FORMATS_PUBLIC_STATUS_H

#include <stddef.h>

#include <leafcast_status.h>

#include "formats/base/status.h"

/* public_status() - the public status for an internal one. */
leafcast_status public_status(status st);

/* public_size() - ST_USAGE where a struct's member `size` is not that of this version. */
CHECKED status public_size(const char *name, size_t given, size_t here);

#endif
