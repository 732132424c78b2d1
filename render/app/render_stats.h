/* render_stats.h - the time and data that one picture took, as JSON. */
#ifndef RENDER_APP_RENDER_STATS_H
#define RENDER_APP_RENDER_STATS_H

#include <jansson.h>

#include "render/app/certificate.h"
#include "render/app/view_options.h"
#include "render/leafcast.h"

typedef struct render_stats {
    leafcast_stats trace;
    double write_s; /* writing pictures and raw planes */
    double total_s; /* from opening the picture's files to their final names, repeats included */
    uint64_t peak_rss_bytes; /* of the process so far */
    const leafcast *volume;  /* the first one, with the set drawn: */
    uint32_t field, step;
    double between;             /* ... so much of the way to the next step */
    certificate certified;      /* of --certify */
    double first_s;             /* of --progressive: until the first picture had its name; else 0 */
    uint64_t first_provisional; /* its provisional pixels */
    int repeats; /* how often the picture was drawn; trace is the run of median render time */
} render_stats;

/* render_stats_peak_rss() - returns the largest resident size of this process so far, in bytes. */
uint64_t render_stats_peak_rss(void);

/* render_stats_set() - add "field", "step" and "time" to an object, if the volume has several
 * fields or steps; "between" if that is above 0: so much of the way from the step to the next. */
void render_stats_set(json_t *root, const leafcast *volume, uint32_t field, uint32_t step,
                      double between);

/* render_stats_data() - add the treelets and bytes of a trace, and the peaks of memory. visible:
 * with the bytes that the picture shows. */
void render_stats_data(json_t *root, const leafcast_stats *t, uint64_t peak_rss, bool visible);

/* render_stats_median() - returns the index of the median by render time; of an even count, the
 * faster of the two in the middle. */
int render_stats_median(const leafcast_stats *all, int count);

/* render_stats_json() - returns one object, or NULL without memory. output may be "". */
json_t *render_stats_json(const render_stats *s, const view_options *view, const char *output);

#endif
