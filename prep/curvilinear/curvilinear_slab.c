#include "prep/curvilinear/curvilinear_slab.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/curvilinear_zones.h"

static uint64_t most_nodes(const curvilinear_source *source) {
    uint64_t most = 0;
    for (uint32_t z = 0; z < source->zones; z++) {
        const uint32_t *n = source->nodes[z];
        const uint32_t planes = n[2] < CURVILINEAR_SIDE + 1 ? n[2] : CURVILINEAR_SIDE + 1;
        const uint64_t nodes = (uint64_t)n[0] * n[1] * planes;
        most = nodes > most ? nodes : most;
    }
    return most;
}

/* Places and values are not here at the same time. */
uint64_t curvilinear_slab_bytes(const curvilinear_source *source) {
    return most_nodes(source) * (sizeof(float[3]) + (source->blanked ? 1 : 0));
}

status curvilinear_slab_init(curvilinear_slab *s, mem *m, const curvilinear_source *source) {
    const uint64_t nodes = most_nodes(source);
    *s = (curvilinear_slab){.source = source, .m = m};
    s->p = mem_array(m, (size_t)nodes, sizeof *s->p);
    s->values = (float *)s->p;
    s->is_node = source->blanked ? mem_array(m, (size_t)nodes, 1) : NULL;
    return s->p && (s->is_node || !source->blanked) ? ST_OK : ST_NOMEM;
}

void curvilinear_slab_release(curvilinear_slab *s) {
    if (!s->m)
        return;
    mem_free(s->m, s->p);
    mem_free(s->m, s->is_node);
}

/* Of a source of the series that has none, no node is blanked. */
static status read_blanks(const curvilinear_slab *s, uint32_t k, uint32_t count, uint8_t *to) {
    if (s->source->blanked)
        return s->source->blanks(s->source->own, s->zone, k, count, to);
    memset(to, 1, s->plane * count);
    return ST_OK;
}

/* Set s->stand_in to the place of the zone's first node that is not blanked; else of its first. */
static status find_stand_in(curvilinear_slab *s) {
    const curvilinear_source *source = s->source;
    const uint32_t planes = source->nodes[s->zone][2];
    size_t at = s->plane;
    uint32_t k = 0;
    status st = ST_OK;
    for (; k < planes && at == s->plane && st == ST_OK; k++) {
        st = read_blanks(s, k, 1, s->is_node);
        for (at = 0; st == ST_OK && at < s->plane && !s->is_node[at];)
            at++;
    }
    const bool none = at == s->plane;
    if (st == ST_OK)
        st = source->places(source->own, s->zone, none ? 0 : k - 1, 1, s->p);
    if (st == ST_OK)
        memcpy(s->stand_in, s->p[none ? 0 : at], sizeof s->stand_in);
    return st;
}

status curvilinear_slab_begin(curvilinear_slab *s, const curvilinear_source *source,
                              curvilinear_slab_of of, uint32_t zone, uint32_t field) {
    s->source = source;
    s->of = of;
    s->zone = zone;
    s->field = field;
    s->first = s->count = 0;
    s->plane = (size_t)source->nodes[zone][0] * source->nodes[zone][1];
    return of == CURVILINEAR_SLAB_PLACES && s->is_node ? find_stand_in(s) : ST_OK;
}

/* Keep the last plane as the first one. */
static void keep_last(curvilinear_slab *s) {
    const size_t last = s->plane * (s->count - 1);
    if (s->of == CURVILINEAR_SLAB_PLACES)
        memmove(s->p, s->p + last, s->plane * sizeof *s->p);
    else
        memmove(s->values, s->values + last, s->plane * sizeof *s->values);
    if (s->is_node)
        memmove(s->is_node, s->is_node + last, s->plane);
}

static void settle_places(curvilinear_slab *s, size_t from, size_t end) {
    for (size_t n = from; s->is_node && n < end; n++) {
        if (s->is_node[n])
            memcpy(s->stand_in, s->p[n], sizeof s->stand_in);
        else
            memcpy(s->p[n], s->stand_in, sizeof s->stand_in);
    }
}

static void settle_values(curvilinear_slab *s, size_t from, size_t end) {
    for (size_t n = from; n < end; n++) {
        if (s->is_node && !s->is_node[n])
            s->values[n] = NAN;
        s->odd += !isfinite(s->values[n]);
    }
}

status curvilinear_slab_next(curvilinear_slab *s) {
    const curvilinear_source *source = s->source;
    const uint32_t kept = s->count > 0, k = s->first + s->count;
    const uint32_t left = source->nodes[s->zone][2] - k, most = CURVILINEAR_SIDE + !kept;
    const uint32_t fresh = left < most ? left : most;
    const size_t from = kept * s->plane, end = from + fresh * s->plane;
    if (kept)
        keep_last(s);
    status st = s->is_node ? read_blanks(s, k, fresh, s->is_node + from) : ST_OK;
    if (st == ST_OK && s->of == CURVILINEAR_SLAB_PLACES)
        st = source->places(source->own, s->zone, k, fresh, s->p + from);
    else if (st == ST_OK)
        st = source->values(source->own, s->zone, s->field, k, fresh, s->values + from);
    if (st != ST_OK)
        return st;
    if (s->of == CURVILINEAR_SLAB_PLACES)
        settle_places(s, from, end);
    else
        settle_values(s, from, end);
    s->first = k - kept;
    s->count = kept + fresh;
    return ST_OK;
}
