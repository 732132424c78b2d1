/* scene_file.h - pictures of many objects, from a JSON file: see scripts/man/leafcast-scene.5.
 *
 * The keys outside of "objects" are render's flags about the picture (render_script.h). An object
 * has a file, the flags about one volume, surfaces, and places. What a file says ends in what flags
 * and --and say: view_options and render_also.
 */
#ifndef RENDER_APP_SCENE_FILE_H
#define RENDER_APP_SCENE_FILE_H

#include "render/app/render_options.h"

/* scene_file_is() - whether a file is one: its first byte that is no blank is '{'. */
bool scene_file_is(const char *path);

/* scene_file_load() - read the file o->common.input. Its first object becomes o->common.input and
 * o->view, under the flags that were given, and the others come before those of --and. Files that
 * it names lie in its folder or below, unless o->follow_links. ST_USAGE and ST_CORRUPT name the
 * file, and the place in it. */
CHECKED status scene_file_load(render_options *o);

/* scene_file_take_first() - put what one object shows into the flags of the picture, which are
 * about its first volume, too. */
void scene_file_take_first(view_options *to, const view_options *of);

#endif
