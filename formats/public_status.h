/* public_status.h - for the files that implement the public headers: what becomes of a status and
 * of a struct at the border.
 */
#ifndef FORMATS_PUBLIC_STATUS_H
#define FORMATS_PUBLIC_STATUS_H

#include <stddef.h>

#include <leafcast_status.h>

#include "formats/base/status.h"

/* public_status() - an internal status as the interface has it. */
leafcast_status public_status(status st);

/* public_size() - ST_USAGE where a struct's member `size` is not that of this version. */
CHECKED status public_size(const char *name, size_t given, size_t here);

#endif
