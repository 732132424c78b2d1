/* named_file.h - the rule for files that a file names: where they may lie, and what they must be.
 *
 * Whoever wrote an input chose the names in it. Followed blindly, a header that names /etc/passwd
 * puts that into a treelet file, and one that names a pipe waits for ever. So one rule serves all
 * readers:
 *
 *   - The file lies in the folder of the file that names it, or below. Symbolic links are resolved
 *     first, in both: an archive brings its links along, so that a link in the folder is as much
 *     the stranger's word as the name in the header. Where the naming file is itself a link, the
 *     folder of the file that it leads to serves as well: that link is the user's.
 *   - It is a regular file.
 *
 * --follow-links (input_trust.h) also allows other places, but no other kinds of files.
 * Files whose names follow from a path that the user gave (x.ele for x.node, x.json for x.raw) may
 * lie anywhere, and must be regular.
 */
#ifndef FORMATS_INPUT_NAMED_FILE_H
#define FORMATS_INPUT_NAMED_FILE_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* named_file_find() - find the path to open of the file `name` that the file or folder `by` names.
 * A relative name is looked for beside `by`; by "-": in the working folder. A missing file is no
 * fault here: opening it fails. ST_UNSUPPORTED where the rule forbids it, naming both. */
CHECKED status named_file_find(mem *m, const char *by, const char *name, bool follow_links,
                               char **path);

/* named_file_check() - check the same rule for a complete path. If `by` is a folder, such as a Zarr
 * array's, the file must lie below it. */
CHECKED status named_file_check(const char *by, const char *path, bool follow_links);

/* named_file_implied() - check a file whose name follows from a path that the user gave: it must be
 * regular, or not there. */
CHECKED status named_file_implied(const char *path);

#endif
