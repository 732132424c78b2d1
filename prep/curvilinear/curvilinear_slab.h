/* curvilinear_slab.h - the planes of a zone that a layer of treelets needs, in memory; as a zone is
 * gone through from its first plane to its last.
 *
 * A node that is blanked has the value NaN, and the place of the last one before it in the zone
 * that is not blanked; of those before all, of the first. So what a file has there widens neither
 * ranges nor boxes.
 */
#ifndef PREP_CURVILINEAR_CURVILINEAR_SLAB_H
#define PREP_CURVILINEAR_CURVILINEAR_SLAB_H

#include "formats/base/mem.h"
#include "formats/curvilinear/curvilinear_source.h"

/* What is read; blanks always are. */
typedef enum curvilinear_slab_of {
    CURVILINEAR_SLAB_PLACES,
    CURVILINEAR_SLAB_VALUES
} curvilinear_slab_of;

typedef struct curvilinear_slab {
    const curvilinear_source *source;
    curvilinear_slab_of of;
    uint32_t zone, field;  /* field: of values */
    uint32_t first, count; /* planes that are here, along k */
    size_t plane;          /* nodes of one */
    float (*p)[3];         /* per node, if places are read */
    float *values;         /* per node, if values are */
    uint8_t *is_node;      /* per node, as the source's blanks(); NULL: all are nodes */
    uint64_t odd;          /* values that are not finite, of all planes so far in all zones */
    float stand_in[3];     /* the place that a blanked node gets next */
    mem *m;
} curvilinear_slab;

/* curvilinear_slab_bytes() - the memory that one takes, for sources like this one.
 * curvilinear_slab_init() - with room for any layer of any zone. */
uint64_t curvilinear_slab_bytes(const curvilinear_source *source);
CHECKED status curvilinear_slab_init(curvilinear_slab *s, mem *m, const curvilinear_source *source);
void curvilinear_slab_release(curvilinear_slab *s); /* zeros are fine */

/* curvilinear_slab_begin() - go to before the first layer of a zone of a source like the first.
 * curvilinear_slab_next() - read the next layer, of up to CURVILINEAR_SIDE cells: the plane that it
 * shares with the one before stays. */
CHECKED status curvilinear_slab_begin(curvilinear_slab *s, const curvilinear_source *source,
                                      curvilinear_slab_of of, uint32_t zone, uint32_t field);
CHECKED status curvilinear_slab_next(curvilinear_slab *s);

/* curvilinear_slab_more() - whether the zone has another layer. */
static inline bool curvilinear_slab_more(const curvilinear_slab *s) {
    return s->first + s->count < s->source->nodes[s->zone][2];
}

/* curvilinear_slab_hides() - whether the cell that begins at node n is hidden by itself. */
static inline bool curvilinear_slab_hides(const curvilinear_slab *s, size_t n) {
    return s->is_node && s->is_node[n] & CURVILINEAR_HIDDEN;
}

/* curvilinear_slab_node() - the number here of node (i, j, k) of the zone. */
static inline size_t curvilinear_slab_node(const curvilinear_slab *s, uint32_t i, uint32_t j,
                                           uint32_t k) {
    return i + s->source->nodes[s->zone][0] * (size_t)j + s->plane * (k - s->first);
}

#endif
