#include "formats/base/sequence.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

status sequence_name(const char *pattern, int index, char *out, size_t room) {
    const char *percent = strchr(pattern, '%'), *rest = percent;
    char digits[16] = "";
    int head = 0;
    if (percent) {
        head = (int)(percent - pattern);
        const char *at = percent + 1;
        const bool zeros = *at == '0';
        int width = 0;
        for (; *at >= '0' && *at <= '9' && width < 10; at++)
            width = width * 10 + (*at - '0');
        if (*at != 'd' || width > 9 || strchr(at, '%'))
            return status_describe(ST_USAGE, "%s: a sequence's name has one %%04d", pattern);
        snprintf(digits, sizeof digits, zeros ? "%0*d" : "%*d", width, index);
        rest = at + 1;
    } else {
        const char *slash = strrchr(pattern, '/'), *name = slash ? slash + 1 : pattern;
        const char *dot = strrchr(name, '.');
        rest = dot && dot > name ? dot : pattern + strlen(pattern);
        head = (int)(rest - pattern);
        snprintf(digits, sizeof digits, "_%04d", index);
    }
    if (snprintf(out, room, "%.*s%s%s", head, pattern, digits, rest) < (int)room)
        return ST_OK;
    return status_describe(ST_USAGE, "the name of a file is longer than %zu bytes", room - 1);
}
