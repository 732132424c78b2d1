/* render_stats.h - what drawing one picture took, as JSON. */
#ifndef RENDER_APP_RENDER_STATS_H
#define RENDER_APP_RENDER_STATS_H

#include <jansson.h>

#include "render/app/certificate.h"
#include "render/app/view_options.h"
#include "render/leafcast.h"

typedef struct render_stats {
    leafcast_stats trace;
    double write_s; /* pictures and depth files */
    double total_s; /* from opening the picture's files to their final names, repeats included */
    uint64_t peak_rss_bytes; /* of the process so far */
    const char *field; /* of a mesh with several fields or steps, else NULL: what was drawn, */
    uint32_t step;
    double time;           /* of the step */
    certificate certified; /* of --certify */
    int repeats; /* the picture was drawn so often; trace is the one of median render time */
} render_stats;

/* render_stats_peak_rss() - the largest resident size of this process until now. */
uint64_t render_stats_peak_rss(void);

/* render_stats_median() - the index of the median by render time; of an even count the faster of
 * the two in the middle. */
int render_stats_median(const leafcast_stats *all, int count);

/* render_stats_json() - one object; NULL when there is no memory. output may be "". */
json_t *render_stats_json(const render_stats *s, const view_options *view, const char *output);

#endif
