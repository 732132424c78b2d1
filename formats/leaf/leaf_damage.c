#include "formats/leaf/leaf_damage.h"

#include <stdio.h>

#include "formats/leaf/leaf_order.h"

enum { MORE_TEXT = 36 }; /* ", and N more" */

void leaf_damage_add(leaf_damage *d, const char *where, const char *name) {
    const size_t room = sizeof d->text - d->used;
    if (d->count++ > d->named || d->named == LEAF_DAMAGE_NAMED)
        return;
    const int length =
        snprintf(d->text + d->used, room, "%s%s%s", d->named > 0 ? ", " : "", where, name);
    if ((size_t)length + MORE_TEXT > room) {
        d->text[d->used] = '\0';
        return;
    }
    d->used += (size_t)length;
    d->named++;
}

const char *leaf_damage_names(leaf_damage *d) {
    if (d->count > d->named)
        snprintf(d->text + d->used, sizeof d->text - d->used, ", and %llu more",
                 (unsigned long long)(d->count - d->named));
    return d->text;
}

const char *leaf_damage_where(uint32_t set, char text[LEAF_WHERE_MAX]) {
    snprintf(text, LEAF_WHERE_MAX, "coarse grid of set %u: ", set);
    return text;
}

const char *leaf_damage_segment(uint32_t i, char text[LEAF_WHERE_MAX]) {
    snprintf(text, LEAF_WHERE_MAX, "segment %u: ", i);
    return text;
}

static status find_in(mem *m, leaf_file *f, const progress *p, const char *where, leaf_damage *d) {
    char name[LEAF_NAME_MAX];
    char *stored = mem_alloc(m, leaf_layout_stored_max(&f->layout));
    status st = stored ? ST_OK : ST_NOMEM;
    for (leaf_order o = leaf_order_begin(&f->layout); st == ST_OK && o.p < f->layout.payloads;
         leaf_order_next(&o, &f->layout)) {
        st = progress_step(p, "checksums", (double)f->offsets[o.p] / (double)f->header.file_bytes);
        if (st == ST_OK && leaf_file_is_home(f, o.p) && leaf_file_fetch(f, o.p, stored) != ST_OK)
            leaf_damage_add(d, where, leaf_layout_payload_name(&f->layout, o.p, name));
    }
    mem_free(m, stored);
    return st;
}

static status find_in_all(mem *m, leaf_file *f, const progress *p, const char *where,
                          leaf_damage *d);

/* where: of f. What a coarse grid has inside is told as part of it. */
static status find_in_coarse(mem *m, leaf_file *f, uint32_t set, const progress *p,
                             const char *where, leaf_damage *d) {
    char text[LEAF_WHERE_MAX];
    leaf_file *coarse = NULL;
    status st = leaf_file_open_coarse(m, f, set, &coarse);
    if (st == ST_NOMEM)
        return st;
    if (!f->stands_in)
        where = leaf_damage_where(set, text);
    if (st != ST_OK) {
        leaf_damage_add(d, where, "its directory");
        return ST_OK;
    }
    st = find_in_all(m, coarse, p, where, d);
    leaf_file_close(coarse);
    return st;
}

static status find_in_all(mem *m, leaf_file *f, const progress *p, const char *where,
                          leaf_damage *d) {
    status st = find_in(m, f, p, where, d);
    for (uint32_t set = 0; set < f->layout.sets && st == ST_OK; set++)
        if (leaf_file_has_coarse(f, set))
            st = find_in_coarse(m, f, set, p, where, d);
    return st;
}

status leaf_damage_find(mem *m, leaf_file *f, const progress *p, leaf_damage *d) {
    return find_in_all(m, f, p, "", d);
}

status leaf_damage_tell(mem *m, leaf_file *f, const progress *p) {
    status_note first;
    leaf_damage d = {0};
    status_note_take(&first, ST_CORRUPT);
    const status st = leaf_damage_find(m, f, p, &d);
    if (st == ST_STOPPED)
        return st;
    if (st != ST_OK || d.count < 2)
        return status_note_raise(&first);
    return status_describe(ST_CORRUPT, "%s: %llu parts are damaged: %s", file_path(f->source),
                           (unsigned long long)d.count, leaf_damage_names(&d));
}
