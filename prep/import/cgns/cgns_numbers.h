/* cgns_numbers.h - whole numbers of a section of elements, read in parts. The library's own calls
 * would read all of them for each part where elements have any number of nodes.
 */
#ifndef PREP_IMPORT_CGNS_CGNS_NUMBERS_H
#define PREP_IMPORT_CGNS_CGNS_NUMBERS_H

#include "prep/import/cgns/cgns_file.h"

typedef struct cgns_numbers {
    int zone;
    double node; /* where they are, for the library's cgio */
    uint64_t count;
    bool as_it_is; /* they are cgsize_t */
} cgns_numbers;

/* cgns_numbers_find() - an array of a zone's section, by the names of both. *there: NULL:
 * ST_CORRUPT if it is not. */
CHECKED status cgns_numbers_find(const cgns_file *f, int zone, const char *section,
                                 const char *array, bool *there, cgns_numbers *n);

/* cgns_numbers_read() - read `count` of them from `first` on, 1 or more that are there. */
CHECKED status cgns_numbers_read(const cgns_file *f, const cgns_numbers *n, uint64_t first,
                                 size_t count, cgsize_t *to);

/* Elements that are lists of numbers of any length: polygons of their nodes (NGON_n), polyhedra of
 * their faces (NFACE_n). */
typedef struct cgns_lists {
    cgns_numbers numbers, starts;
    bool counted;   /* without starts each list has its length in front: files before 3.4 */
    uint64_t count; /* elements */
} cgns_lists;

CHECKED status cgns_lists_find(const cgns_file *f, int zone, const char *section, uint64_t count,
                               cgns_lists *l);

enum { CGNS_LIST_MAX = 4096, CGNS_STARTS = 1024 };

/* A walk over lists, in order. Start with zeros. */
typedef struct cgns_lists_walk {
    uint64_t element, at; /* the next list, and where it begins among the numbers */
    uint64_t begun, starts_begun;
    size_t held, starts_held;
    cgsize_t numbers[2 * CGNS_LIST_MAX], starts[CGNS_STARTS];
} cgns_lists_walk;

/* cgns_lists_next() - the next list, valid until the next call; *list is NULL behind the last one.
 * ST_UNSUPPORTED: it has more than CGNS_LIST_MAX numbers. */
CHECKED status cgns_lists_next(cgns_lists_walk *w, const cgns_file *f, const cgns_lists *l,
                               const cgsize_t **list, size_t *length);

#endif
