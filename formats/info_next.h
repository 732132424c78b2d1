/* info_next.h - the line of leafcast info about the next command, in both forms. */
#ifndef FORMATS_INFO_NEXT_H
#define FORMATS_INFO_NEXT_H

#include "formats/base/fact_sheet.h"

enum { INFO_NEXT_MAX = 6000 }; /* room for a command */

/* info_next_tell() - tell the command; NULL: there is none. Bytes that do not print are escaped. */
void info_next_tell(const fact_sheet *to, const char *command);

#endif
