/* ray_profile.h - what a field does along a ray: its pieces as a table, as CSV, as a plot in SVG.
 */
#ifndef RENDER_APP_RAY_PROFILE_H
#define RENDER_APP_RAY_PROFILE_H

#include <stdio.h>

#include "render/leafcast.h"

typedef struct ray_profile {
    const leafcast_segment *segments; /* in order */
    int count;
    bool is_mesh;
    const char *title;       /* of the plot */
    const double *isovalues; /* marked there, and where the ray meets them: */
    int isos;
    const leafcast_hit *hits;
    int hit_count;
} ray_profile;

/* ray_profile_sum() - of all pieces together: how long they are, the extremes and where, the mean
 * over t; exactly those of the interpolants, but for rounding. NaN where there is no piece. */
typedef struct ray_profile_total {
    double length, least, least_t, most, most_t, mean;
} ray_profile_total;
ray_profile_total ray_profile_sum(const ray_profile *p);

/* Each to a stream; the pointer is to a ray_profile, as printed_file_write() hands it on. */
void ray_profile_text(const void *profile, FILE *out);
void ray_profile_csv(const void *profile, FILE *out);
void ray_profile_svg(const void *profile, FILE *out);

#endif
