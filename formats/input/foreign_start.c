#include "formats/input/foreign_start.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/input/binary_fields.h"

/* ---- lines ---- */

enum { LINE_MAX_BYTES = 256 };

/* The part of the text that is still to be read. */
typedef struct lines {
    const uint8_t *at;
    size_t left;
} lines;

/* Read the next line without blanks in front, cut where it is too long. Returns false at the end.
 */
static bool next_line(lines *l, char line[LINE_MAX_BYTES]) {
    if (l->left == 0)
        return false;
    const uint8_t *end = memchr(l->at, '\n', l->left);
    const size_t size = end ? (size_t)(end - l->at) : l->left;
    size_t blanks = 0;
    while (blanks < size && strchr(" \t\r", l->at[blanks]) && l->at[blanks])
        blanks++;
    const size_t kept = size - blanks < LINE_MAX_BYTES ? size - blanks : LINE_MAX_BYTES - 1;
    memcpy(line, l->at + blanks, kept);
    line[kept] = 0;
    l->at += size + (end != NULL);
    l->left -= size + (end != NULL);
    return true;
}

/* Find the first line that is neither empty nor a comment. */
static bool first_line(const uint8_t *start, size_t size, const char *comment,
                       char line[LINE_MAX_BYTES]) {
    lines l = {start, size};
    while (next_line(&l, line))
        if (*line && strncmp(line, comment, strlen(comment)) != 0)
            return true;
    return false;
}

static bool begins_with(const char *line, const char *word) {
    return strncasecmp(line, word, strlen(word)) == 0;
}

/* Returns whether any line begins with the word, in letters of either case. */
static bool has_line(const uint8_t *start, size_t size, const char *word) {
    char line[LINE_MAX_BYTES];
    lines l = {start, size};
    while (next_line(&l, line))
        if (begins_with(line, word))
            return true;
    return false;
}

/* Returns whether the line begins with "WORD =". */
static bool is_assignment(const char *line, const char *word) {
    if (!begins_with(line, word))
        return false;
    line += strlen(word);
    return line[strspn(line, " \t")] == '=';
}

/* ---- meshes as text ---- */

bool foreign_is_abaqus(const uint8_t *start, size_t size) {
    char line[LINE_MAX_BYTES];
    /* LS-DYNA, too, has nodes behind a star, but begins with *KEYWORD. */
    return first_line(start, size, "**", line) && *line == '*' && !begins_with(line, "*KEYWORD") &&
           (has_line(start, size, "*HEADING") || has_line(start, size, "*NODE"));
}

bool foreign_is_ucd(const uint8_t *start, size_t size) {
    char line[LINE_MAX_BYTES], more;
    unsigned n[5];
    return first_line(start, size, "#", line) &&
           sscanf(line, "%9u %9u %9u %9u %9u %c", &n[0], &n[1], &n[2], &n[3], &n[4], &more) == 5;
}

bool foreign_is_nastran(const uint8_t *start, size_t size) {
    return has_line(start, size, "BEGIN BULK");
}

bool foreign_is_medit(const uint8_t *start, size_t size) {
    /* The binary form begins with 1, the version, and the code of the keyword Dimension. */
    for (int big = 0; big < 2 && size >= 12; big++) {
        const uint64_t version = binary_unsigned(start + 4, 4, big);
        if (binary_unsigned(start, 4, big) == 1 && version >= 1 && version <= 4 &&
            binary_unsigned(start + 8, 4, big) == 3)
            return true;
    }
    return has_line(start, size, "MeshVersionFormatted") ||
           has_line(start, size, "MeshVersionUnformatted");
}

bool foreign_is_su2(const uint8_t *start, size_t size) {
    char line[LINE_MAX_BYTES];
    lines l = {start, size};
    while (next_line(&l, line))
        if (is_assignment(line, "NDIME"))
            return true;
    return false;
}

bool foreign_is_tecplot(const uint8_t *start, size_t size) {
    char line[LINE_MAX_BYTES];
    return first_line(start, size, "#", line) &&
           (is_assignment(line, "TITLE") || is_assignment(line, "VARIABLES") ||
            begins_with(line, "ZONE "));
}

bool foreign_is_foam(const uint8_t *start, size_t size) {
    return has_line(start, size, "FoamFile");
}

bool foreign_is_amrex(const uint8_t *start, size_t size) {
    char line[LINE_MAX_BYTES];
    lines l = {start, size};
    return next_line(&l, line) && begins_with(line, "HyperCLaw");
}

/* ---- grids ---- */

/* A cube file has two lines of title, then atoms and origin, then three times a count and a vector.
 */
bool foreign_is_cube(const uint8_t *start, size_t size) {
    char line[LINE_MAX_BYTES];
    lines l = {start, size};
    for (int i = 0; i < 6; i++) {
        int count;
        double v[3];
        if (!next_line(&l, line))
            return false;
        if (i >= 2 && (sscanf(line, "%9d %lf %lf %lf", &count, &v[0], &v[1], &v[2]) != 4 ||
                       (i > 2 && count == 0)))
            return false;
    }
    return true;
}

/* ---- particles ---- */

bool foreign_is_gadget(const uint8_t *start, size_t size) {
    for (int big = 0; big < 2 && size >= 264; big++)
        if (binary_unsigned(start, 4, big) == 256 && binary_unsigned(start + 260, 4, big) == 256)
            return true;
    return false;
}
