#include "formats/base/shell_line.h"

#include <string.h>

/* Characters without a special meaning in any shell, wherever they stand in a word. One exception:
 * zsh takes a leading = for a command's path. */
static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                            "_-./+,:=@%";

shell_line shell_line_begin(char *text, size_t room) {
    *text = 0;
    return (shell_line){.text = text, .room = room};
}

void shell_line_put(shell_line *l, const char *text) {
    const size_t size = strlen(text);
    l->full |= l->length + size >= l->room;
    if (l->full)
        return;
    memcpy(l->text + l->length, text, size + 1);
    l->length += size;
}

/* The bytes of a word between single quotes. */
static size_t quoted_size(const char *word) {
    size_t size = 2;
    for (; *word; word++)
        size += *word == '\'' ? 4 : 1;
    return size;
}

void shell_line_word(shell_line *l, const char *word) {
    if (*word && *word != '=' && !word[strspn(word, PLAIN)]) {
        shell_line_put(l, word);
        return;
    }
    l->full |= l->length + quoted_size(word) >= l->room;
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
