/* view_map.h - describe where treelets are wanted, resident and seen, and of which steps, for a
 * page that shows it. */
#ifndef RENDER_VIEW_VIEW_MAP_H
#define RENDER_VIEW_VIEW_MAP_H

#include <jansson.h>

#include "formats/base/mem.h"
#include "render/leafcast.h"

enum { VIEW_MAP_SIDE = 16 }; /* blocks along the longest axis */

/* view_map_describe() - returns leafcast_map_treelets() of a level as the message `treelets`.
 * Blocks are about cubes, at most VIEW_MAP_SIDE along an axis. stats: of the last picture. NULL: no
 * memory, or no such level. */
json_t *view_map_describe(mem *m, leafcast *volume, uint32_t level, const leafcast_stats *stats);

/* view_map_steps() - returns leafcast_map_steps() of all steps of a field as the message `steps`.
 * NULL: no memory, or no such field. */
json_t *view_map_steps(mem *m, leafcast *volume, uint32_t field);

/* Isovalues of a field, of which a page marks the steps. */
typedef struct view_marks {
    const leafcast *volume;
    uint32_t field, steps;
    int count;
    double isovalues[LEAFCAST_SURFACES_MAX];
} view_marks;

/* view_map_marks() - returns the first `steps` steps that have any of them, by
 * leafcast_find_steps(), as the message `present`. NULL: no memory, or no such field or steps. */
json_t *view_map_marks(mem *m, const view_marks *marks);

#endif
