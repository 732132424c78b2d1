#include "formats/base/name_list.h"

#include <stdio.h>
#include <string.h>

void name_list_add(name_list *names, const char *name) {
    static const char more[] = ", ..";
    char quoted[NAME_LIST_TEXT];
    int length = snprintf(quoted, sizeof quoted, "%s\"%s\"", names->length ? ", " : "", name);
    if (names->full || strstr(names->text, names->length ? quoted + 2 : quoted))
        return;
    names->full = names->length + (size_t)length + sizeof more > sizeof names->text;
    strcpy(names->text + names->length, names->full ? more : quoted);
    names->length = strlen(names->text);
}

const char *name_list_print(const name_list *names) {
    return names->text[0] ? names->text : "none";
}
