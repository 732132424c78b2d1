/* view_options.h - the flags that say what a picture shows: isosurfaces, media, camera, light,
 * shading, clipping, level of detail, field and time step.
 *
 * One table serves all verbs that draw a volume, and the JSON of render --script, whose keys are
 * the flags' names.
 */
#ifndef RENDER_APP_VIEW_OPTIONS_H
#define RENDER_APP_VIEW_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "formats/base/status.h"
#include "render/app/annotate.h"
#include "render/app/medium_options.h"
#include "render/app/time_options.h"
#include "render/leafcast_experimental.h"

enum { VIEW_FIELD_MAX = 64 };

typedef struct view_options {
    leafcast_surface
        surfaces[LEAFCAST_SURFACES_MAX]; /* view_options_check() fills in what was not given */
    int isos, colours, opacities, reflects, refracts; /* how often each flag was given */
    int reflect_bounces, refract_bounces; /* the most that each flag asks for; 0: none does */
    leafcast_scene scene;                 /* without experiments; view_options_scene() adds them */
    leafcast_scene_experiments experiments;
    leafcast_camera camera; /* width and height; other fields if flags gave them, see below */
    bool eye, look_at, up, fov;
    uint64_t given;              /* one bit for each flag given, view_options_bit() */
    int normals;                 /* --normals, as numbered in view_options.c */
    bool fit;                    /* --view fit; else `distance` counts */
    double distance;             /* of --view, in longest edges of the volume */
    const leafcast_camera *hold; /* view to use instead of a new one; or NULL */
    double hold_diagonal;        /* of a box around what that view shows; 0: around the volume */
    char field[VIEW_FIELD_MAX];  /* "": the first field */
    char colour_by[MEDIUM_NAME_MAX]; /* what colours surfaces (colour_by.h); "": nothing else */
    const char *colour_by_from;      /* the scene file that names it, or NULL, */
    bool colour_by_links;            /* and whether that may name files anywhere */
    uint32_t step;
    time_options time;       /* or a time: picture_scene_choose() finds its step */
    int painted;             /* surfaces of other volumes; default colours begin behind theirs */
    bool others_transparent; /* some of theirs are transparent */
    /* It is of a volume that is a surface itself (picture_scene_choose()): its one surface needs no
     * --iso, and the flags of media are colours by the value there. */
    bool is_surface;
    bool iso_unused;                     /* it is, but an isovalue was given */
    bool unopened;                       /* it is not known yet whether it is of such a volume */
    bool others_surfaces, others_filled; /* some other volume has isosurfaces, or a medium, */
    bool others_coloured;                /* or colours by value */
    bool takes_media;                    /* the verb draws media; set it before flags are applied */
    medium_options medium;
    medium_options caps; /* colours of --caps; colour_map "": surfaces' own */
    bool legend;
    annotation annotation;
} view_options;

/* The table of these flags, for argp. */
extern const struct argp_option view_options_table[];

/* view_options_join() - join a verb's own options with the table, for argp. A verb's option hides
 * one of the same name. media: add medium_options_table. basic: names, separated by blanks, of the
 * tables' options that the verb's --help also shows. */
enum { VIEW_OPTIONS_ROOM = 96 };
void view_options_join(struct argp_option out[VIEW_OPTIONS_ROOM], const struct argp_option *own,
                       bool media, const char *basic);

void view_options_init(view_options *v);

/* view_options_set() - apply one flag; text is NULL if it has no value. ST_USAGE with a
 * description; ST_AGAIN: the key is not in the table. */
CHECKED status view_options_set(view_options *v, int key, const char *text);

/* view_options_of_one() - returns whether a flag is about one volume of several: its isosurfaces,
 * medium, field, step.
 */
bool view_options_of_one(int key);

/* view_options_clear() - reset a flag as if it had not been given. */
void view_options_clear(view_options *v, int key);

/* view_options_bounces() - returns the bounces of a picture: the most that reflections ask for, or
 * refractions. These (bends: there are some) have LIGHT_OPTIONS_BENDS if none of them, of any
 * object, asks for any.
 * view_options_bounce() - let reflections and refractions ask for at least so many. */
int view_options_bounces(int reflect, int refract, bool bends);
void view_options_bounce(view_options *v, int reflect, int refract);

/* view_options_inherit() - let a line of a script or an entry of a path start from the flags given
 * so far. Its eye may then replace an earlier --view, which would otherwise contradict. */
void view_options_inherit(view_options *v);

/* view_options_key() - returns a flag's key by its long name, in the spellings of
 * cli_options_same(); 0: there is none. *repeats: whether it may be given several times; *value:
 * whether it takes one. */
typedef enum view_value { VIEW_VALUE_NONE, VIEW_VALUE_OPTIONAL, VIEW_VALUE_NEEDED } view_value;
int view_options_key(const char *name, bool *repeats, view_value *value);

/* view_options_transparent() - returns whether --opacity makes a surface transparent. */
bool view_options_transparent(const view_options *v);

/* view_options_filled() - returns whether flags give a medium or a projection, with or without
 * isosurfaces. */
bool view_options_filled(const view_options *v);

/* view_options_coloured() - returns whether flags of media colour a surface: a given one, or all of
 * a volume with --colour-by. view_options_medium() - whether they are of a medium. */
bool view_options_coloured(const view_options *v);
bool view_options_medium(const view_options *v);

/* view_options_any_filled() - the same for any volume of the picture. view_options_any_medium() -
 * returns whether any has a medium that is drawn, not a projection. */
bool view_options_any_filled(const view_options *v);
bool view_options_any_medium(const view_options *v);

/* view_options_check() - check all flags together and fill in defaults. ST_USAGE without an
 * isovalue, unless the volume is filled; for more colours or opacities than isovalues; for a flag
 * without effect. */
CHECKED status view_options_check(view_options *v);

/* view_options_check_either() - check for flags that exclude each other. */
CHECKED status view_options_check_either(const view_options *v);

/* view_options_only() - returns ST_USAGE for a given flag that is not in `names`, separated by
 * blanks. who: what the flag would not change, for the description. */
CHECKED status view_options_only(const view_options *v, const char *names, const char *who);

/* view_options_check_volume() - returns ST_USAGE for a flag without meaning for this kind of
 * volume. */
CHECKED status view_options_check_volume(const view_options *v, const leafcast *volume);

/* view_options_scene() - returns the scene; its experiments are copied to *e and point there. */
leafcast_scene view_options_scene(const view_options *v, leafcast_scene_experiments *e);

/* view_options_field() - get the number of the field that --field names. */
CHECKED status view_options_field(const view_options *v, const leafcast *volume, uint32_t *field);

#endif
