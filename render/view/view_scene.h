/* view_scene.h - the scene file that is shown: its objects, and what it says of the picture.
 *
 * What a page changes of its objects is in view_changes.h, what is drawn then in view_cast.h. An
 * object's flags are those of the file with all that render chooses for them: isovalues that are
 * suggested, colours by the order of objects. So an object that is hidden or changed changes no
 * other one. Constant once it is open; for any thread.
 */
#ifndef RENDER_VIEW_VIEW_SCENE_H
#define RENDER_VIEW_VIEW_SCENE_H

#include <jansson.h>

#include "render/app/render_options.h"

typedef struct view_scene {
    mem m;
    const char *path; /* the caller's, */
    char *name;       /* without its folder, for people */
    bool follow_links;
    json_t *picture; /* what the file says outside of its objects */
    render_options options;
    render_job job;      /* the open files, and the places of objects */
    int count;           /* objects of the file; object 0 is the job's own volume */
    view_options *views; /* their flags, of one volume each; picture_view: of the picture */
    view_options picture_view;
    char **names; /* of objects, for people, with numbers where files have the same name */
    double box[2][3];
} view_scene;

/* view_scene_open() - read a scene file, open its files on a device of their own, and check what it
 * says, as render does. ST_USAGE, and errors of the files. view_scene_close() - NULL is allowed. */
CHECKED status view_scene_open(const char *path, bool follow_links, const leafcast_options *options,
                               view_scene **out);
void view_scene_close(view_scene *s);

/* view_scene_volume(), view_scene_path(), view_scene_places() - of an object. view_scene_keeper() -
 * the first object of the same volume. */
leafcast *view_scene_volume(const view_scene *s, int object);
const char *view_scene_path(const view_scene *s, int object);
const render_places *view_scene_places(const view_scene *s, int object);
int view_scene_keeper(const view_scene *s, int object);

/* view_scene_bit() - returns a flag's bit of view_options.given. view_scene_bits_of_one() - those
 * of all flags of one volume. */
uint64_t view_scene_bit(const char *flag);
uint64_t view_scene_bits_of_one(void);

/* view_scene_told() - a file's name as the scene file gives it: without the scene file's folder. */
const char *view_scene_told(const view_scene *s, const char *path);

/* view_scene_flags() - returns flags of one volume as a scene file has them; NULL: no memory. */
json_t *view_scene_flags(const view_scene *s, const view_options *v);

/* view_scene_json() - returns what a page is told of the scene. view_scene_state() - a state to
 * begin with: what the file says outside of its objects, with render's camera. NULL: no memory. */
json_t *view_scene_json(const view_scene *s);
json_t *view_scene_state(const view_scene *s);

#endif
