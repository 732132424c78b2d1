/* sequence.h - the names of the files of a sequence: pictures, time steps.
 */
#ifndef FORMATS_BASE_SEQUENCE_H
#define FORMATS_BASE_SEQUENCE_H

#include <stddef.h>

#include "formats/base/status.h"

/* sequence_name() - the name of file `index` (not negative), into out of `room` bytes. The number
 * replaces the pattern's %d, %4d or %04d. A pattern without one gets _0000 before its extension.
 * ST_USAGE when the name is too long, or the pattern has any other %. */
CHECKED status sequence_name(const char *pattern, int index, char *out, size_t room);

#endif
