#include "prep/import/import_hint.h"

#include "formats/base/shell_line.h"

static bool put_command(const import_request *q, int paths, char text[IMPORT_HINT_MAX]) {
    shell_line l = shell_line_begin(text, IMPORT_HINT_MAX);
    shell_line_put(&l, "leafcast ");
    shell_line_put(&l, q->verb);
    for (int i = 0; i < paths; i++) {
        shell_line_put(&l, " ");
        shell_line_path(&l, q->paths[i]);
    }
    shell_line_put(&l, " --list");
    return !l.full;
}

const char *import_hint_list(const import_request *q, char text[IMPORT_HINT_MAX]) {
    int paths = q->path_count;
    while (paths > 1 && !put_command(q, paths, text))
        paths /= 2;
    return paths > 1 || put_command(q, paths, text) ? text : "--list";
}
