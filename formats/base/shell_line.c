#include "formats/base/shell_line.h"

#include <string.h>

/* What no shell gives a meaning to, wherever it stands in a word. */
static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                            "_-./+,:=@%";

shell_line shell_line_begin(char *text, size_t room) {
    *text = 0;
    return (shell_line){text, room, 0};
}

void shell_line_put(shell_line *l, const char *text) {
    const size_t size = strlen(text);
    if (l->length + size >= l->room)
        return;
    memcpy(l->text + l->length, text, size + 1);
    l->length += size;
}

/* Bytes of a word between single quotes. */
static size_t quoted_size(const char *word) {
    size_t size = 2;
    for (; *word; word++)
        size += *word == '\'' ? 4 : 1;
    return size;
}

void shell_line_word(shell_line *l, const char *word) {
    if (*word && !word[strspn(word, PLAIN)]) {
        shell_line_put(l, word);
        return;
    }
    if (l->length + quoted_size(word) >= l->room)
        return;
    shell_line_put(l, "'");
    for (; *word; word++)
        shell_line_put(l, *word == '\'' ? "'\\''" : (const char[]){*word, 0});
    shell_line_put(l, "'");
}

void shell_line_path(shell_line *l, const char *path) {
    if (*path == '-')
        shell_line_put(l, "./");
    shell_line_word(l, path);
}
