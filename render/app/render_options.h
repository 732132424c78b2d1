/* render_options.h - the flags of `leafcast render`, beside those of the view. */
#ifndef RENDER_APP_RENDER_OPTIONS_H
#define RENDER_APP_RENDER_OPTIONS_H

#include "formats/base/cli.h"
#include "formats/base/step_list.h"
#include "render/app/render_job.h"

/* Most pictures of one run; limited by the digits of a name, and by memory for their statistics. */
enum { PICTURES_MAX = 1000000 };

typedef struct render_options {
    cli_common common;
    view_options view;
    leafcast_options open;
    leafcast_experiments experiments; /* experiments of `open` */
    const char *files[FRAME_FILES];   /* all but the picture, which is -o */
    const char *stats, *script, *iso_list, *camera_path, *font, *format, *state;
    status_note state_read; /* the result of reading it, */
    status_note scene_read; /* and of a scene file */
    step_list steps;        /* --steps */
    render_also *also;      /* --and; later flags are about the last one */
    int also_count;
    size_t also_room;
    render_places places; /* of the first volume, by a scene file, */
    int group;            /* and its group */
    render_group *groups;
    int group_count;
    struct scene_tiles *scene_tiles; /* by which some are placed; a list */
    char **scene_paths;              /* of the scenes in the scene */
    size_t scene_path_count;
    bool follow_links;   /* ... which may name files anywhere */
    bool scene;          /* the input is such a file; common.input is then its first object's */
    char *first_path;    /* that, allocated */
    struct render_flag { /* flags of the view, in their order, for scene_file_load() */
        int key;
        const char *text;
        bool of_one; /* of one volume, before any --and */
    } * flags;
    size_t flag_count, flag_room;
    int repeat;
    int turns;     /* --turntable; 0: none */
    int frames;    /* --frames; 0: a picture for each entry of the path */
    int traversal; /* --traversal: 1 tree, 2 faces; 0: faces where volumes are filled */
    bool fail_empty, certify, progressive;
} render_options;

/* render_options_also() - add a volume without flags to `also`; NULL: no memory.
 * render_options_release() - free what flags have allocated. */
render_also *render_options_also(render_options *o);
void render_options_release(render_options *o);

/* The table of these flags, for argp. */
extern const struct argp_option render_options_table[];

/* render_options_set(), render_options_check() - as of cli_verb; own: render_options. */
CHECKED status render_options_set(void *own, int key, const char *text);
CHECKED status render_options_check(void *own);

/* render_options_check_file() - refuse flags that have no effect on this file. */
CHECKED status render_options_check_file(const render_options *o, const leafcast_info *info);

/* render_options_many() - returns whether the flags describe a sequence of pictures. */
bool render_options_many(const render_options *o);

/* render_options_neighbours() - returns whether meshes need to know which tets are neighbours. */
bool render_options_neighbours(const render_options *o);

#endif
