#include "formats/base/path_pattern.h"

#include <ctype.h>
#include <glob.h>
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/sequence.h"

static status add(path_list *l, const char *path) {
    char *copy = strdup(path);
    char **more = copy ? realloc(l->paths, (size_t)(l->count + 1) * sizeof *more) : NULL;
    if (!more) {
        free(copy);
        return status_describe(ST_NOMEM, "no room for the names of inputs");
    }
    l->paths = more;
    l->paths[l->count++] = copy;
    return ST_OK;
}

void path_pattern_release(char **paths, int count) {
    for (int i = 0; i < count; i++)
        free(paths[i]);
    free(paths);
}

void path_list_release(path_list *l) {
    path_pattern_release(l->paths, l->count);
    *l = (path_list){0};
}

/* ---- the order of names ---- */

static size_t digits_of(const char *text) {
    return strspn(text, "0123456789");
}

/* Compare the numbers that two texts begin with. */
static int compare_numbers(const char *a, const char *b) {
    const char *x = a + strspn(a, "0"), *y = b + strspn(b, "0");
    const size_t m = digits_of(x), n = digits_of(y);
    if (m != n)
        return m < n ? -1 : 1;
    return strncmp(x, y, m);
}

static int compare_names(const char *a, const char *b) {
    while (*a && *b) {
        const size_t m = digits_of(a), n = digits_of(b);
        const int order = m && n ? compare_numbers(a, b) : *a != *b ? (*a < *b ? -1 : 1) : 0;
        if (order)
            return order;
        a += m && n ? m : 1;
        b += m && n ? n : 1;
    }
    return *a ? 1 : *b ? -1 : 0;
}

/* Names that differ in zeros before a number alone come as they are. */
int path_pattern_compare(const char *a, const char *b) {
    const int order = compare_names(a, b);
    return order ? order : strcmp(a, b);
}

static int by_name(const void *a, const void *b) {
    return path_pattern_compare(*(char *const *)a, *(char *const *)b);
}

/* ---- patterns ---- */

/* Where the only %d of a pattern is, and how long; NULL: there is none. */
static const char *number_in(const char *path, size_t *length) {
    const char *at = strchr(path, '%');
    if (!at || strchr(at + 1, '%'))
        return NULL;
    *length = 1 + digits_of(at + 1);
    return at[(*length)++] == 'd' ? at : NULL;
}

/* Write a text that glob() takes literally. */
static char *put_literally(char *to, const char *from, size_t length) {
    for (size_t i = 0; i < length; i++) {
        if (strchr("*?[\\", from[i]))
            *to++ = '\\';
        *to++ = from[i];
    }
    return to;
}

/* Whether a path is the pattern with a number in the place of %d, in the pattern's own way. */
static bool is_of_sequence(const char *pattern, const char *path, size_t before) {
    char name[PATH_MAX], *end;
    const unsigned long number = strtoul(path + before, &end, 10);
    return isdigit((unsigned char)path[before]) && number <= INT_MAX &&
           sequence_name(pattern, (int)number, name, sizeof name) == ST_OK &&
           strcmp(name, path) == 0;
}

static status take_found(path_list *l, const char *pattern, const glob_t *found, size_t before) {
    const int first = l->count;
    status st = ST_OK;
    for (size_t i = 0; i < found->gl_pathc && st == ST_OK; i++)
        if (before == SIZE_MAX || is_of_sequence(pattern, found->gl_pathv[i], before))
            st = add(l, found->gl_pathv[i]);
    if (st == ST_OK && l->count == first)
        return add(l, pattern);
    if (st == ST_OK)
        qsort(l->paths + first, (size_t)(l->count - first), sizeof *l->paths, by_name);
    return st;
}

/* number: where %d is; NULL: a pattern of glob(). */
static status find(path_list *l, const char *pattern, const char *number, size_t length) {
    char text[2 * PATH_MAX + 8];
    size_t before = SIZE_MAX;
    glob_t found;
    if (strlen(pattern) >= PATH_MAX)
        return add(l, pattern);
    if (number) {
        before = (size_t)(number - pattern);
        char *end = put_literally(text, pattern, before);
        end = stpcpy(end, "*");
        end = put_literally(end, number + length, strlen(number + length));
        *end = '\0';
    }
    const int failed = glob(number ? text : pattern, GLOB_NOSORT, NULL, &found);
    if (failed && failed != GLOB_NOMATCH)
        return status_describe(ST_NOMEM, "no room to look for the inputs of a pattern");
    if (failed)
        return take_found(l, pattern, &(glob_t){0}, before);
    const status st = take_found(l, pattern, &found, before);
    globfree(&found);
    return st;
}

status path_list_add(path_list *l, const char *path) {
    size_t length = 0;
    const char *number = number_in(path, &length);
    const bool pattern = number || strpbrk(path, "*?[");
    if (!pattern || access(path, F_OK) == 0)
        return add(l, path);
    return find(l, path, number, length);
}

status path_pattern_expand(char ***paths, int *count) {
    path_list l = {0};
    status st = ST_OK;
    for (int i = 0; i < *count && st == ST_OK; i++)
        st = path_list_add(&l, (*paths)[i]);
    if (st != ST_OK) {
        path_list_release(&l);
        return st;
    }
    *paths = l.paths;
    *count = l.count;
    return ST_OK;
}
