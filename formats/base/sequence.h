/* sequence.h - the names of the files of a sequence: pictures, time steps.
 */
#ifndef FORMATS_BASE_SEQUENCE_H
#define FORMATS_BASE_SEQUENCE_H

#include <stddef.h>

#include "formats/base/status.h"

/* sequence_name() - of file `index` (not negative), to out, `room` bytes: the pattern with its %d,
 * %4d or %04d replaced, or with _0000 put before the extension where it has none. ST_USAGE when it
 * is too long or has other %. */
CHECKED status sequence_name(const char *pattern, int index, char *out, size_t room);

#endif
