/* leaf_damage.h - which payloads of a treelet file are damaged: all of them, by name. */
#ifndef FORMATS_LEAF_LEAF_DAMAGE_H
#define FORMATS_LEAF_LEAF_DAMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/progress.h"
#include "formats/leaf/leaf_file.h"

/* The first names are kept, as many as the text has room for, LEAF_DAMAGE_NAMED at most. The others
 * are counted. */
enum { LEAF_DAMAGE_NAMED = 20, LEAF_DAMAGE_TEXT = 800 };
typedef struct leaf_damage {
    uint64_t count, named; /* all parts; those in the text */
    size_t used;           /* of text */
    char text[LEAF_DAMAGE_TEXT];
} leaf_damage;

/* leaf_damage_add() - add a damaged part of a file. where: put before the name, as "coarse grid of
 * set 2: "; or "".
 * leaf_damage_names() - the names, separated by commas, and how many more there are. Valid until
 * the next call. */
void leaf_damage_add(leaf_damage *d, const char *where, const char *name);
const char *leaf_damage_names(leaf_damage *d);

/* leaf_damage_where() - what to put before the names in the coarse grid of a set.
 * leaf_damage_segment() - in segment i of a growing file. Both return text. */
enum { LEAF_WHERE_MAX = 40 };
const char *leaf_damage_where(uint32_t set, char text[LEAF_WHERE_MAX]);
const char *leaf_damage_segment(uint32_t i, char text[LEAF_WHERE_MAX]);

/* leaf_damage_find() - add all payloads of f, and of its coarse grids, whose stored bytes cannot be
 * read or have another checksum. Reads the whole file, through a buffer of one payload. ST_OK
 * whatever it finds; ST_NOMEM, ST_STOPPED. p may be NULL. */
CHECKED status leaf_damage_find(mem *m, leaf_file *f, const progress *p, leaf_damage *d);

/* leaf_damage_tell() - describe all damaged payloads of f, which leaf_verify() has refused with
 * ST_CORRUPT. Where fewer than two are damaged, its description stays. Returns ST_CORRUPT, or
 * ST_STOPPED. */
CHECKED status leaf_damage_tell(mem *m, leaf_file *f, const progress *p);

#endif
