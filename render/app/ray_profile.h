/* ray_profile.h - print the values of a field along a ray: as a table, as CSV, as a plot in SVG. */
#ifndef RENDER_APP_RAY_PROFILE_H
#define RENDER_APP_RAY_PROFILE_H

#include <stdio.h>

#include "render/app/cell_text.h"

typedef struct ray_profile {
    const leafcast_segment *segments; /* in order along the ray */
    int count;
    const cell_text *cells;  /* of the segments */
    bool indexed;            /* cells have indices */
    const char *cell;        /* what one is called */
    const char *title;       /* of the plot */
    const double *isovalues; /* drawn as lines, with the ray's hits */
    int isos;
    const leafcast_hit *hits;
    int hit_count;
} ray_profile;

/* ray_profile_sum() - sum up all segments: total length, extremes and where they are, mean over t.
 * Exact for the interpolants, but for rounding. NaN where there is no segment. */
typedef struct ray_profile_total {
    double length, least, least_t, most, most_t, mean;
} ray_profile_total;
ray_profile_total ray_profile_sum(const ray_profile *p);

/* Print the profile to a stream. The pointer is to a ray_profile, as printed_file_write() passes
 * it. */
void ray_profile_text(const void *profile, FILE *out);
void ray_profile_csv(const void *profile, FILE *out);
void ray_profile_svg(const void *profile, FILE *out);

#endif
