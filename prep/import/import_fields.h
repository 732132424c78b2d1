/* import_fields.h - the fields of a mesh that an importer reads, and which of them are taken. */
#ifndef PREP_IMPORT_IMPORT_FIELDS_H
#define PREP_IMPORT_IMPORT_FIELDS_H

#include "formats/base/mem.h"
#include "formats/mesh/mesh_stream.h"
#include "prep/import/importer.h"

typedef enum import_owner { IMPORT_POINTS, IMPORT_CELLS, IMPORT_OWNERS } import_owner;

typedef struct import_fields {
    mem *m;
    const char *path;
    const char *of[IMPORT_OWNERS]; /* "of the nodes", for --list */
    struct import_names {
        char (*names)[MESH_NAME_MAX + 1];
        size_t count, room;
    } all[IMPORT_OWNERS];
    uint64_t steps;
    double *times; /* of the steps, of m; NULL: unknown */
    /* What is taken: */
    import_owner owner;
    uint32_t step;
    uint32_t *taken; /* which of the owner's */
    uint32_t count;
    const char **further; /* names of all but the first */
} import_fields;

/* import_fields_add() - add a field. ST_UNSUPPORTED: there are MESH_STREAM_FIELDS_MAX.
 * import_fields_has() - whether there is one of this name. */
CHECKED status import_fields_add(import_fields *x, import_owner owner, const char *name);
bool import_fields_has(const import_fields *x, import_owner owner, const char *name);

/* import_fields_take() - take what is asked for: fields of points or cells, by default the first of
 * the points, none if there is no step; and a step. ST_USAGE: there is no such field, or step. */
CHECKED status import_fields_take(import_fields *x, const import_request *q);

/* import_fields_taken() - the name of taken field k. import_fields_describe() - set them in the
 * header, which points into x. */
const char *import_fields_taken(const import_fields *x, uint32_t k);
void import_fields_describe(const import_fields *x, mesh_stream_header *h);

/* import_fields_list() - list all fields of a mesh of so many points. */
CHECKED status import_fields_list(import_fields *x, const import_request *q, const char *title,
                                  uint64_t points, const import_list *to);

/* import_fields_release() - a zeroed one may be released, too. */
void import_fields_release(import_fields *x);

#endif
