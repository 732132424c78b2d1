/* scene_groups.h - groups of a scene: objects that are placed together, many times (M08 5.2).
 *
 * A turn lists the volumes of all groups behind those of the scene, level by level, as if they were
 * the scene's own. Where they are, trees over the places say (render/frame/object_tree.h).
 */
#ifndef RENDER_DOOR_SCENE_GROUPS_H
#define RENDER_DOOR_SCENE_GROUPS_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/frame/object_tree.h"
#include "render/leafcast.h"

typedef struct scene_groups {
    int volumes; /* of the scene and all groups, */
    int singles; /* and the first ones of these, the scene's own */
    leafcast_shown *shown;
    leafcast_medium *media; /* NULL: there are none */
    int own;                /* groups of the scene itself, */
    int count;              /* and all groups, level by level: */
    struct scene_group *groups;
    object_group *links;  /* the same, as trees have them, */
    object_tree *members; /* and what is in each */
} scene_groups;

/* scene_groups_check() - whether a scene can be drawn with its groups. scene_groups_list() - list
 * all volumes of a scene with groups; leaves *g empty for one without. scene_groups_release() - an
 * empty one, too; m: as for the list. */
CHECKED status scene_groups_check(const leafcast *v, const leafcast_scene *scene);
CHECKED status scene_groups_list(scene_groups *g, mem *m, const leafcast_scene *scene);
void scene_groups_release(scene_groups *g, mem *m);

/* scene_groups_join() - make the trees of all groups, from the boxes of all volumes in the worlds
 * in which they lie, and join them with *top, the tree over the boxes of the scene's own volumes,
 * which this makes. place: of each volume. */
CHECKED status scene_groups_join(scene_groups *g, mem *m, const double (*boxes)[2][3],
                                 const placement *place, object_tree *top);

#endif
