/* path_pattern.h - arguments that stand for many files: step_*.nrrd where no shell has expanded it,
 * step_%04d.nrrd.
 */
#ifndef FORMATS_BASE_PATH_PATTERN_H
#define FORMATS_BASE_PATH_PATTERN_H

#include "formats/base/status.h"

/* path_pattern_expand() - replace what is a pattern among *count paths by the files that fit. "-",
 * what names a file or folder, what has neither %d (%4d, %04d) nor *, ? or [, and what nothing fits
 * stays. Files that fit a pattern come in the order of their names, digits in them compared as
 * numbers; %d takes names with the number alone, written as the pattern says.
 *
 * *paths is another array then, with texts of its own, for path_pattern_release(). ST_NOMEM:
 * nothing has changed. */
CHECKED status path_pattern_expand(char ***paths, int *count);

/* A list that grows. Zero-initialize it. */
typedef struct path_list {
    char **paths;
    int count;
} path_list;

/* path_list_add() - add what an argument stands for, likewise. ST_NOMEM: the list stays valid.
 * path_list_release() - free it; zeros are fine. */
CHECKED status path_list_add(path_list *l, const char *path);
void path_list_release(path_list *l);

/* path_pattern_compare() - the order of two such names: below 0, 0, above 0. */
int path_pattern_compare(const char *a, const char *b);

/* path_pattern_release() - free what path_pattern_expand() has made. */
void path_pattern_release(char **paths, int count);

#endif
