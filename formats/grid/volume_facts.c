#include "formats/grid/volume_facts.h"

#include <math.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/grid/volume.h"
#include "formats/grid/volume_kind.h"
#include "formats/input_collect.h"
#include "formats/leaf/histogram_draw.h"

enum { BLOCK_BYTES = 32 << 20 };

_Static_assert(sizeof(volume_facts) <= sizeof((input_facts *)NULL)->own, "there is room");

const volume_facts *volume_facts_of(const input_facts *x) {
    return (const volume_facts *)(const void *)x->own.bytes;
}

/* ---- the values ---- */

/* Slices as read, and as they would be stored. `held` stored slices begin at slice `first`. */
typedef struct slices {
    volume *v;
    const grid *g;
    void *read, *stored;
    uint64_t count; /* samples per slice */
    uint32_t room, first, held;
} slices;

static status make_slices(mem *m, volume *v, slices *s) {
    *s = (slices){.v = v, .g = volume_grid(v)};
    s->count = (uint64_t)s->g->dims[0] * s->g->dims[1];
    const uint64_t left = m->limit ? m->limit - mem_used(m) : UINT64_MAX;
    const uint64_t bytes = left / 4 < BLOCK_BYTES ? left / 4 : BLOCK_BYTES;
    const uint64_t room = bytes / grid_slice_bytes(s->g);
    s->room = room < 2 ? 2 : room < s->g->dims[2] ? (uint32_t)room : s->g->dims[2];
    s->read = mem_alloc(m, s->room * grid_slice_bytes(s->g));
    s->stored = mem_alloc(m, s->room * s->count * sample_size(sample_stored(s->g->type)));
    return s->read && s->stored ? ST_OK : ST_NOMEM;
}

/* Read slices behind those held, until the room is full or the grid ends. */
static status read_more(slices *s, input_facts *x) {
    const uint32_t left = s->g->dims[2] - s->first - s->held;
    const uint32_t more = s->room - s->held < left ? s->room - s->held : left;
    const sample_type type = sample_stored(s->g->type);
    char *to = (char *)s->stored + s->held * s->count * sample_size(type);
    status st = volume_read(s->v, more, s->read);
    if (st != ST_OK)
        return st;
    sample_to_stored(s->g->type, s->read, to, more * s->count);
    for (uint64_t i = 0; i < more * s->count; i++)
        input_collect_value(x, (double)sample_get(type, to, i));
    s->held += more;
    return ST_OK;
}

/* Draw nodes of all slices held but the last. That one stays, as it belongs to the next block,
 * too. */
static void draw_held(slices *s, const histogram_draw *d, const histogram_space *space,
                      histogram_cell *cells) {
    const sample_type type = sample_stored(s->g->type);
    const bool last = s->first + s->held == s->g->dims[2];
    const uint32_t drawn = s->held - !last;
    const histogram_block b = {.first = {0, 0, s->first},
                               .end = {s->g->dims[0], s->g->dims[1], s->first + drawn},
                               .type = type,
                               .samples = s->stored,
                               .row = s->g->dims[0],
                               .slice = s->count};
    histogram_draw_take(d, space, &b, cells);
    const size_t bytes = s->count * sample_size(type);
    if (!last)
        memmove(s->stored, (char *)s->stored + drawn * bytes, bytes);
    s->first += drawn;
    s->held = !last;
}

static status count_slices(slices *s, const histogram_draw *d, histogram_cell *cells,
                           const progress *p, input_facts *x) {
    histogram_space space = histogram_space_of(&s->g->to_world[0][0]);
    for (int a = 0; a < 3; a++)
        space.axis[a] = s->g->axis[a];
    while (s->first < s->g->dims[2]) {
        status st = read_more(s, x);
        if (st == ST_OK)
            st = progress_step(p, "reading", (double)(s->first + s->held) / s->g->dims[2]);
        if (st != ST_OK)
            return st;
        draw_held(s, d, &space, cells);
    }
    return volume_finish(s->v, &x->trailing);
}

static status count_volume(mem *m, volume *v, const progress *p, input_facts *x) {
    const grid *g = volume_grid(v);
    const histogram_draw d = histogram_draw_grid(g->dims);
    slices s;
    status st = make_slices(m, v, &s);
    histogram_cell *cells = mem_array(m, d.count, sizeof *cells);
    if (!cells)
        st = ST_NOMEM;
    if (st == ST_OK)
        st = count_slices(&s, &d, cells, p, x);
    if (st == ST_OK)
        histogram_build(&x->values, cells, d.count, sample_stored(g->type), x->range,
                        grid_samples(g));
    mem_free(m, cells);
    mem_free(m, s.read);
    mem_free(m, s.stored);
    return st;
}

static status take_slice_field(void *ctx, const slice_field *f) {
    input_facts *x = ctx;
    input_collect_field(x, f->name, f->components);
    input_field *listed = *f->name ? input_collect_listed(x, f->name) : NULL;
    if (listed)
        listed->steps = f->steps;
    if (!f->taken)
        return ST_OK;
    text_name(x->field, sizeof x->field, f->name);
    x->steps = f->steps;
    x->components = f->components > 1 ? f->components : 1;
    x->component = f->component;
    x->colours = f->colours;
    if (f->times)
        input_collect_times(x, f->steps, f->times);
    if (f->times && f->time_unit)
        text_name(x->frame.time_unit, sizeof x->frame.time_unit, f->time_unit);
    return ST_OK;
}

static void take_grid(volume_facts *own, const grid *g) {
    own->type = g->type;
    own->source = grid_source(g);
    own->rectilinear = grid_is_rectilinear(g);
    own->absent = g->absent;
    memcpy(own->note, g->note, sizeof own->note);
    memcpy(own->dims, g->dims, sizeof own->dims);
    memcpy(own->to_world, g->to_world, sizeof own->to_world);
}

static status ask(mem *m, void *input, const input_question *q, const progress *p, input_facts *x) {
    volume *v = input;
    status st = ST_OK;
    const grid *g = volume_grid(v);
    take_grid((volume_facts *)(void *)x->own.bytes, g);
    x->frame = g->frame;
    x->is_surface = g->heights;
    input_collect_name(x, g->name);
    if (q->opened)
        st = q->opened(q->ctx, x);
    if (st == ST_OK)
        st = volume_fields(v, &(slice_fields){take_slice_field, x});
    if (st == ST_OK && !q->header_only)
        st = count_volume(m, v, p, x);
    return st;
}

/* ---- what is told ---- */

static double spacing_of(const volume_facts *own, int a) {
    const double *w = own->to_world;
    return sqrt(w[a] * w[a] + w[a + 4] * w[a + 4] + w[a + 8] * w[a + 8]);
}

static void print_samples(const volume_facts *own, const fact_sheet *to) {
    char absent[ABSENT_TEXT];
    const uint32_t *dims = own->dims;
    const double bytes = (double)dims[0] * dims[1] * dims[2] * (double)sample_size(own->type);
    const bool other = own->source != own->type;
    fact_sheet_line(to, "grid", "%u x %u x %u %s, %.1f MiB%s%s%s", dims[0], dims[1], dims[2],
                    sample_name(own->type), bytes / 0x1p20, other ? " (of " : "",
                    other ? sample_name(own->source) : "", other ? ")" : "");
    if (own->absent.count)
        fact_sheet_line(to, "absent", "%s", absent_print(&own->absent, absent));
    if (own->note[0])
        fact_sheet_line(to, "note", "%s", own->note);
}

static void print_place(const input_facts *x, const fact_sheet *to) {
    const volume_facts *own = volume_facts_of(x);
    char n[3][NUM_TEXT_MAX], axes[WORLD_FRAME_TEXT];
    fact_sheet_line(to, "spacing", "%s %s %s%s", num_print(spacing_of(own, 0), n[0]),
                    num_print(spacing_of(own, 1), n[1]), num_print(spacing_of(own, 2), n[2]),
                    own->rectilinear ? ", times the coordinates of its axes (rectilinear)" : "");
    fact_sheet_line(to, "origin", "%s %s %s", num_print(own->to_world[3], n[0]),
                    num_print(own->to_world[7], n[1]), num_print(own->to_world[11], n[2]));
    if (world_frame_print(&x->frame, axes)[0])
        fact_sheet_line(to, "axes", "%s", axes);
}

static void tell(const input_facts *x, const fact_sheet *to) {
    const volume_facts *own = volume_facts_of(x);
    print_samples(own, to);
    print_place(x, to);
    fact_sheet_wholes(to, "dims", own->dims, 3);
    fact_sheet_text(to, "sample_type", sample_name(sample_stored(own->type)));
    fact_sheet_text(to, "source_type", sample_name(own->source));
    fact_sheet_flag(to, "rectilinear", own->rectilinear);
    fact_sheet_reals(to, "to_world", own->to_world, 12);
    fact_sheet_text(to, "note", own->note);
    fact_sheet_whole(to, "trailing_bytes", x->trailing);
    fact_sheet_whole(to, "absent", own->absent.count);
    fact_sheet_whole(to, "absent_of", own->absent.of);
    fact_sheet_frame(to, &x->frame);
}

const input_facts_kind volume_facts_kind = {
    .of = &volume_kind, .drawn = "samples", .ask = ask, .tell = tell};
