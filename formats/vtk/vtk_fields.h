/* vtk_fields.h - the arrays that a piece of a VTK grid has of its points and of its cells.
 */
#ifndef FORMATS_VTK_VTK_FIELDS_H
#define FORMATS_VTK_VTK_FIELDS_H

#include "formats/base/mem.h"
#include "formats/vtk/vtk_array.h"

enum { VTK_NAME_MAX = 64 }; /* names are the same that agree so far, the NUL included */

typedef enum vtk_owner { VTK_OF_POINTS, VTK_OF_CELLS, VTK_OWNERS } vtk_owner;

/* Start with all zeros. */
typedef struct vtk_fields {
    vtk_array *items[VTK_OWNERS];
    size_t count[VTK_OWNERS], room[VTK_OWNERS];
} vtk_fields;

/* vtk_fields_add() - one more, with a copy of its name. */
CHECKED status vtk_fields_add(vtk_fields *f, mem *m, vtk_owner owner, const char *name,
                              const vtk_array *field);

/* What says which cells are another part's, too: bits, and in older files a distance. */
#define VTK_GHOST_TYPE   "vtkGhostType"
#define VTK_GHOST_LEVELS "vtkGhostLevels"

/* vtk_fields_is_one() - whether an array is of numbers, and says nothing about the parts of a
 * parallel grid (vtkGhostType and its like): one that a reader may take unasked. */
bool vtk_fields_is_one(const vtk_array *a);

/* vtk_fields_find() - the array of that name; for NULL the first that vtk_fields_is_one(). NULL:
 * there is none. */
const vtk_array *vtk_fields_find(const vtk_fields *f, vtk_owner owner, const char *name);

/* vtk_fields_ghosts() - that array of the cells; NULL: there is none. */
const vtk_array *vtk_fields_ghosts(const vtk_fields *f);

void vtk_fields_release(vtk_fields *f, mem *m);

#endif
