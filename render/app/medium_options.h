/* medium_options.h - the flags that say what a volume is filled with: transfer function, colour
 * map, opacities.
 *
 * Colours are those of --colour-map, else of --tf; extinctions those of --opacity V:A, else of
 * --tf; what nothing says is grey, and as --tf auto has it.
 */
#ifndef RENDER_APP_MEDIUM_OPTIONS_H
#define RENDER_APP_MEDIUM_OPTIONS_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

#include "render/app/transfer_list.h"
#include "render/leafcast_experimental.h"

enum { MEDIUM_NAME_MAX = 512, MEDIUM_OPACITIES_MAX = 32 };

/* Keys of the flags; view_options.c has those before them. */
enum {
    MEDIUM_TF = 0x2028,
    MEDIUM_COLOUR_MAP,
    MEDIUM_WINDOW,
    MEDIUM_OPACITY_LENGTH,
    MEDIUM_PROJECT,
    MEDIUM_ERROR,
    MEDIUM_HOMOGENEOUS,
    MEDIUM_LEGEND,
    MEDIUM_CAPS,
    MEDIUM_SUMMING,
    MEDIUM_SHADE,
    MEDIUM_ANNOTATE,
    MEDIUM_TITLE,
    MEDIUM_UNIT
};

/* Start with all zeros. */
typedef struct medium_options {
    char tf[MEDIUM_NAME_MAX];         /* a preset or a file; "": not given */
    char colour_map[MEDIUM_NAME_MAX]; /* likewise, a map or a file */
    bool windowed;                    /* --window: */
    double window[2];
    double opacity[MEDIUM_OPACITIES_MAX][2]; /* --opacity V:A: values, which rise, and opacities */
    int opacities;
    double opacity_length; /* world units; 0: not given */
} medium_options;

/* The table, for argp. */
extern const struct argp_option medium_options_table[];

/* medium_options_set() - one flag: MEDIUM_TF .. MEDIUM_OPACITY_LENGTH; ST_AGAIN: none of
 * them. medium_options_add_opacities() - "V:A,V:A,...", behind those that are there. Both:
 * ST_USAGE. medium_options_clear() - as if it had not been given. */
CHECKED status medium_options_set(medium_options *o, int key, const char *text);
CHECKED status medium_options_add_opacities(medium_options *o, const char *text);
void medium_options_clear(medium_options *o, int key);

/* medium_options_given() - whether any of them is: the volume is filled. */
bool medium_options_given(const medium_options *o);

/* medium_options_check() - ST_USAGE for flags that do not go together. projected: the colours alone
 * are used. */
CHECKED status medium_options_check(const medium_options *o, bool projected);

/* medium_options_caps() - of --caps: NULL, or a name as --colour-map's, which *o becomes. */
CHECKED status medium_options_caps(const char *text, medium_options *o);

/* medium_options_error() - of --error: a number or a fraction such as 1/510. */
CHECKED status medium_options_error(const char *text, double *error);

/* medium_options_shade() - of --shade-medium: NULL (0), or where shading fades. */
CHECKED status medium_options_shade(const char *text, double *fade);

/* medium_options_project() - of --project: max, min, mean or first=V. */
CHECKED status medium_options_project(const char *text, leafcast_project *project, double *value);

/* medium_options_summing() - of --medium: certified, steps=F[,A] or preintegrated=F[,N]. */
CHECKED status medium_options_summing(const char *text, leafcast_scene_experiments *e);

/* medium_options_make() - the transfer function for a field at a step of a volume, into an empty
 * list. projected: as above. ST_USAGE, and what reading a file returns. */
CHECKED status medium_options_make(const medium_options *o, const leafcast *volume, uint32_t field,
                                   uint32_t step, bool projected, transfer_list *out);

/* medium_options_window() - the values of the colour bar of what medium_options_make() made. */
void medium_options_window(const medium_options *o, const transfer_list *made, double window[2]);

#endif
