/* vtk_fields.h - the arrays of a VTK piece's points and cells. */
#ifndef FORMATS_VTK_VTK_FIELDS_H
#define FORMATS_VTK_VTK_FIELDS_H

#include "formats/base/mem.h"
#include "formats/vtk/vtk_array.h"

enum { VTK_NAME_MAX = 64 }; /* names are equal if they agree up to this length, the NUL included */

typedef enum vtk_owner { VTK_OF_POINTS, VTK_OF_CELLS, VTK_OWNERS } vtk_owner;

/* Start with all zeros. */
typedef struct vtk_fields {
    vtk_array *items[VTK_OWNERS];
    size_t count[VTK_OWNERS], room[VTK_OWNERS];
} vtk_fields;

/* vtk_fields_add() - add an array, with a copy of its name. */
CHECKED status vtk_fields_add(vtk_fields *f, mem *m, vtk_owner owner, const char *name,
                              const vtk_array *field);

/* Arrays that mark the cells which another part has, too: by bits, in older files by a distance. */
#define VTK_GHOST_TYPE   "vtkGhostType"
#define VTK_GHOST_LEVELS "vtkGhostLevels"

/* vtk_fields_is_one() - returns whether a reader may take an array unasked: it has numbers, and is
 * none of the marks of a parallel grid (vtkGhostType and its like). */
bool vtk_fields_is_one(const vtk_array *a);

/* vtk_fields_find() - find the array of that name; name NULL: the first for which
 * vtk_fields_is_one(). Returns NULL when there is none. */
const vtk_array *vtk_fields_find(const vtk_fields *f, vtk_owner owner, const char *name);

/* vtk_fields_ghosts() - find the cells' array of ghost marks; NULL: there is none. */
const vtk_array *vtk_fields_ghosts(const vtk_fields *f);

void vtk_fields_release(vtk_fields *f, mem *m);

#endif
