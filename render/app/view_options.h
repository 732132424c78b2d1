/* view_options.h - the flags that say what a picture shows: isosurfaces, media, camera, light,
 * shading, clipping, level of detail, field and time step.
 *
 * One table for all verbs that look at a volume, and for the JSON of render --script, whose keys
 * are the flags' names.
 */
#ifndef RENDER_APP_VIEW_OPTIONS_H
#define RENDER_APP_VIEW_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "formats/base/status.h"
#include "render/app/annotate.h"
#include "render/app/medium_options.h"
#include "render/leafcast_experimental.h"

enum { VIEW_FIELD_MAX = 64 };

typedef struct view_options {
    leafcast_surface
        surfaces[LEAFCAST_SURFACES_MAX]; /* view_options_check() has filled in what was not given */
    int isos, colours, opacities;        /* how often each flag was given */
    leafcast_scene scene;                /* without experiments: view_options_scene() */
    leafcast_scene_experiments experiments;
    leafcast_camera camera; /* width and height, and what the flags below say was given */
    bool eye, look_at, up, fov;
    uint64_t given;              /* which flags: a bit each, of view_options.c */
    int normals;                 /* of --normals: as view_options.c numbers them */
    bool fit;                    /* --view fit, else */
    double distance;             /* of --view, in longest edges */
    const leafcast_camera *hold; /* instead of one that is fitted anew; NULL */
    char field[VIEW_FIELD_MAX];  /* "": the first */
    uint32_t step;
    int painted; /* surfaces of other volumes in the picture: colours begin behind theirs */
    bool others_transparent;             /* some of theirs are: view_options_transparent() */
    bool others_surfaces, others_filled; /* some volume has isosurfaces, or a medium */
    bool takes_media;                    /* the verb draws media: set before flags are */
    medium_options medium;
    medium_options caps; /* colours of --caps; colour_map "": surfaces' own */
    bool legend;
    annotation annotation;
} view_options;

/* The table, for argp. */
extern const struct argp_option view_options_table[];

/* view_options_join() - a verb's own options, then the table but for what has the name of one of
 * them, for argp; media: with medium_options_table. basic: names, divided by blanks, of the tables'
 * options that the verb's --help shows, too. */
enum { VIEW_OPTIONS_ROOM = 96 };
void view_options_join(struct argp_option out[VIEW_OPTIONS_ROOM], const struct argp_option *own,
                       bool media, const char *basic);

void view_options_init(view_options *v);

/* view_options_set() - one flag, text NULL where it takes none. ST_USAGE with a description;
 * ST_AGAIN when the key is not in the table. */
CHECKED status view_options_set(view_options *v, int key, const char *text);

/* view_options_of_one() - whether a flag is about one volume of several: its isosurfaces, field,
 * step.
 */
bool view_options_of_one(int key);

/* view_options_clear() - forget what was given for a flag, as if it had not been on the command
 * line. */
void view_options_clear(view_options *v, int key);

/* view_options_inherit() - what was given so far is what a line of a script or an entry of a path
 * starts from: its eye may then be said instead of the --view that was. */
void view_options_inherit(view_options *v);

/* view_options_key() - a flag's key by its long name, as cli_options_same() takes it; 0 when there
 * is none such. *repeats: it may be given several times; *value: it takes one. */
typedef enum view_value { VIEW_VALUE_NONE, VIEW_VALUE_OPTIONAL, VIEW_VALUE_NEEDED } view_value;
int view_options_key(const char *name, bool *repeats, view_value *value);

/* view_options_transparent() - whether --opacity makes a surface transparent. */
bool view_options_transparent(const view_options *v);

/* view_options_filled() - whether the volume is: a medium or a projection, with isosurfaces or
 * without any. */
bool view_options_filled(const view_options *v);

/* view_options_any_filled(), view_options_any_medium() - likewise of all volumes in the picture;
 * the second: a medium is seen. */
bool view_options_any_filled(const view_options *v);
bool view_options_any_medium(const view_options *v);

/* view_options_check() - what must hold over all flags: at least one isovalue, unless the volume is
 * filled, no more colours or
 * opacities than isovalues, no flag that would change nothing. */
CHECKED status view_options_check(view_options *v);

/* view_options_check_camera() - likewise, of what says where the camera is. */
CHECKED status view_options_check_camera(const view_options *v);

/* view_options_only() - ST_USAGE for a flag that was given and is none of these names, divided by
 * blanks; who: what would not change by it. */
CHECKED status view_options_only(const view_options *v, const char *names, const char *who);

/* view_options_check_volume() - likewise, of this volume: ST_USAGE for a flag that is of no meaning
 * for its kind. */
CHECKED status view_options_check_volume(const view_options *v, const leafcast *volume);

/* view_options_scene() - the scene, with experiments that are *e. */
leafcast_scene view_options_scene(const view_options *v, leafcast_scene_experiments *e);

/* view_options_field() - the number of the field that is meant. */
CHECKED status view_options_field(const view_options *v, const leafcast *volume, uint32_t *field);

#endif
