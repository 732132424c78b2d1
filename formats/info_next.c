#include "formats/info_next.h"

#include "formats/base/text.h"

enum { SHOWN_MAX = 4 * INFO_NEXT_MAX }; /* a byte may take four */

void info_next_tell(const fact_sheet *to, const char *command) {
    char shown[SHOWN_MAX];
    if (!command)
        return;
    fact_sheet_line(to, "next", "%s", text_printable(shown, sizeof shown, command));
    fact_sheet_text(to, "next", text_printable(shown, sizeof shown, command));
}
