/* view_through.h - the value that a ray shows which meets no surface: of a projection, or where a
 * medium is seen most. */
#ifndef RENDER_VIEW_VIEW_THROUGH_H
#define RENDER_VIEW_VIEW_THROUGH_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/transfer_list.h"
#include "render/leafcast.h"

typedef struct view_through {
    bool any;     /* there are data along the ray, and of a medium some that are seen */
    double value; /* the projection's; of a medium, the value in the cell that adds most to the
                     pixel */
    double t;     /* where it is, in lengths of the direction; of a mean, the middle of the data */
} view_through;

/* view_through_find() - look along a ray through the volume that is selected. medium: its transfer
 * function, where the scene has no projection. ST_NOMEM, or an error of reading. */
CHECKED status view_through_find(mem *m, leafcast *volume, const leafcast_scene *scene,
                                 const transfer_list *medium, const double origin[3],
                                 const double direction[3], view_through *out);

#endif
