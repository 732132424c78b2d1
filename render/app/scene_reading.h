/* scene_reading.h - a scene file that is being read: where in it, its keys, the files it names. */
#ifndef RENDER_APP_SCENE_READING_H
#define RENDER_APP_SCENE_READING_H

#include <jansson.h>

#include "render/app/render_job.h"
#include "render/app/view_options.h"

enum { SCENE_WHAT_MAX = 512 };

typedef struct scene_reading {
    mem m;            /* outside of all budgets */
    const char *path; /* of the file that is read now: the scene's, or that of a scene in it */
    bool follow_links;
    view_options picture; /* the keys outside of "objects" */
    render_also *objects; /* of the scene itself, then of each group, in order */
    int count;
    size_t room;
    render_group *groups; /* level by level */
    int group_count;
    size_t group_room;
    struct scene_tiles *tiles; /* a list */
    char **paths;              /* of the scenes in it: objects point to them */
    size_t path_count, path_room;
} scene_reading;

/* scene_place_in() - where in the file: its name, and a path of keys. Returns `what`. */
const char *scene_place_in(const scene_reading *r, char what[SCENE_WHAT_MAX], const char *form,
                           ...);

/* scene_unknown() - refuse a key. known: those that are no flags of render's; flags: there are
 * such, too. scene_is_flag() - whether a key is a flag of one volume (of_one), or of the picture.
 */
CHECKED status scene_unknown(const char *what, const char *key, const char *known, bool flags);
bool scene_is_flag(const char *key, bool of_one);

/* scene_find_file() - find the path of a file that the scene names. scene_lead_medium() - let names
 * of transfer functions and maps lead where the scene file says, unless they are known by name;
 * FILE#NAME is a map in a file. */
CHECKED status scene_find_file(const scene_reading *r, const char *name, const char *what,
                               char **out);
CHECKED status scene_lead_medium(const scene_reading *r, medium_options *medium, const char *what);

#endif
