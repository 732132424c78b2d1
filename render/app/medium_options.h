/* medium_options.h - the flags that choose a volume's medium: transfer function, colour map,
 * opacities.
 *
 * Colours come from --colour-map, else from --tf, else they are grey. Extinctions come from
 * --opacity V:A, else from --tf, else from --tf auto.
 */
#ifndef RENDER_APP_MEDIUM_OPTIONS_H
#define RENDER_APP_MEDIUM_OPTIONS_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

#include "render/app/transfer_list.h"
#include "render/leafcast_experimental.h"

enum { MEDIUM_NAME_MAX = 512, MEDIUM_OPACITIES_MAX = 32 };

/* Keys of the flags; the keys before them are in view_options.c. */
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
    double opacity[MEDIUM_OPACITIES_MAX][2]; /* --opacity V:A: rising values, and their opacities */
    int opacities;
    double opacity_length; /* world units; 0: not given */
} medium_options;

/* The table of these flags, for argp. */
extern const struct argp_option medium_options_table[];

/* medium_options_set() - apply one flag, MEDIUM_TF .. MEDIUM_OPACITY_LENGTH; ST_AGAIN for any
 * other. medium_options_add_opacities() - append "V:A,V:A,..." to the opacities. Both may return
 * ST_USAGE. medium_options_clear() - reset a flag as if it had not been given. */
CHECKED status medium_options_set(medium_options *o, int key, const char *text);
CHECKED status medium_options_add_opacities(medium_options *o, const char *text);
void medium_options_clear(medium_options *o, int key);

/* medium_options_given() - returns whether any of these flags is given, so that the volume has a
 * medium. */
bool medium_options_given(const medium_options *o);

/* medium_options_check() - returns ST_USAGE for flags that contradict each other. projected: only
 * the colours are used. */
CHECKED status medium_options_check(const medium_options *o, bool projected);

/* medium_options_caps() - read the value of --caps into *o: NULL, or a name as for --colour-map. */
CHECKED status medium_options_caps(const char *text, medium_options *o);

/* medium_options_error() - read the value of --error: a number or a fraction such as 1/510. */
CHECKED status medium_options_error(const char *text, double *error);

/* medium_options_shade() - read the value of --shade-medium: NULL (0), or the threshold at which
 * shading fades. */
CHECKED status medium_options_shade(const char *text, double *fade);

/* medium_options_project() - read the value of --project: max, min, mean or first=V. */
CHECKED status medium_options_project(const char *text, leafcast_project *project, double *value);

/* medium_options_summing() - read the value of --medium: certified, steps=F[,A] or
 * preintegrated=F[,N]. */
CHECKED status medium_options_summing(const char *text, leafcast_scene_experiments *e);

/* medium_options_make() - make the transfer function for a field and step of a volume, into an
 * empty list. projected: as for medium_options_check(). Returns ST_USAGE, or an error of reading a
 * file. */
CHECKED status medium_options_make(const medium_options *o, const leafcast *volume, uint32_t field,
                                   uint32_t step, bool projected, transfer_list *out);

/* medium_options_window() - get the value range for the colour bar of a function that
 * medium_options_make() has made. */
void medium_options_window(const medium_options *o, const transfer_list *made, double window[2]);

#endif
