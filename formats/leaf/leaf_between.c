#include "formats/leaf/leaf_between.h"

#include <assert.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/leaf/deviation.h"
#include "formats/leaf/grid_codes.h"
#include "formats/leaf/leaf_geometry.h"

/* A set. */
typedef struct between_set {
    leaf_moment at;
    uint64_t asked; /* when it was last asked for; 0: it stands for nothing */
} between_set;

struct leaf_between {
    between_set set[LEAF_BETWEEN_SETS];
    uint64_t asked;
    blend_fn *blend;
};

/* What a payload has behind its samples, before the payloads of steps: this, and room for
 * grid_codes.h. */
typedef struct between_head {
    uint32_t has[LEAF_BETWEEN_PARTS];
    double made; /* the share that its samples are of; NaN: of none */
} between_head;

enum { HEAD = LEAF_ALIGN };
_Static_assert(sizeof(between_head) <= HEAD, "the head has its room");

/* ---- Making ---- */

status leaf_between_check(const leaf_file *f) {
    if (!f->geometry->blends)
        return status_describe(ST_UNSUPPORTED,
                               "%s: times between steps are of grids; this is no grid",
                               file_path(f->source));
    if ((uint64_t)f->layout.treelets * LEAF_BETWEEN_SETS >= LEAF_NO_TREELET)
        return status_describe(ST_UNSUPPORTED,
                               "%s: %u treelets are too many for times between steps",
                               file_path(f->source), f->layout.treelets);
    return ST_OK;
}

static status lay_out(leaf_file *f) {
    const leaf_layout *of = &f->below->layout;
    leaf_layout *l = &f->layout;
    const status st =
        leaf_layout_init(l, f->m, f->below->header.dims, of->cells_log2, of->halo, SAMPLE_F32);
    if (st != ST_OK)
        return st;
    (void)leaf_layout_repeat(l, 1, LEAF_BETWEEN_SETS, false); /* checked */
    if (of->sampled < of->levels)
        leaf_layout_bare(l);
    leaf_layout_keep_beside(l, (uint32_t)sample_size(of->type));
    assert(HEAD + grid_codes_scratch_bytes(leaf_node_levels(l)) <=
           LEAF_BESIDE_ROOM(leaf_node_levels(l)));
    return ST_OK;
}

static void fill_header(leaf_file *f) {
    leaf_header *h = &f->header;
    *h = f->below->header;
    h->sample_type = SAMPLE_F32;
    h->codec = LEAF_CODEC_ZSTD; /* as if packed: nothing is used where it lies */
    h->fields = 1;
    h->steps = LEAF_BETWEEN_SETS;
    h->outside = h->outside_chunks = h->segments = 0;
    h->directory = h->last = 0;
}

/* Copy the coordinates of all axes into one block, which axis[0] owns. */
static status take_axes(leaf_file *f) {
    const uint32_t *dims = f->header.dims;
    const size_t count = (size_t)dims[0] + dims[1] + dims[2];
    double *at = f->axis[0] = mem_array(f->m, count, sizeof *at);
    for (int a = 0; a < 3 && at; at += dims[a++]) {
        f->axis[a] = at;
        memcpy(at, f->below->axis[a], dims[a] * sizeof *at);
    }
    return at ? ST_OK : ST_NOMEM;
}

static status allocate(leaf_file *f) {
    const size_t deviations = deviation_count(&f->layout);
    const status st = leaf_file_allocate_changing(f);
    f->between = mem_zalloc(f->m, sizeof *f->between);
    if (st != ST_OK || !f->between)
        return ST_NOMEM;
    if (!f->below->deviations || !deviations)
        return ST_OK;
    f->deviations = mem_array(f->m, deviations, sizeof *f->deviations);
    return f->deviations ? ST_OK : ST_NOMEM;
}

static status make(leaf_file *f, cpu_isa isa) {
    const leaf_file *below = f->below;
    status st = file_open_memory(f->m, file_path(below->source), "", 0, &f->source);
    if (st == ST_OK)
        st = lay_out(f);
    if (st != ST_OK)
        return st;
    fill_header(f);
    f->geometry = below->geometry;
    f->frame = below->frame;
    memcpy(f->name, below->name, sizeof f->name);
    st = take_axes(f);
    if (st == ST_OK)
        st = allocate(f);
    if (st == ST_OK)
        f->between->blend = blend_rows_for(isa, below->layout.type);
    return st;
}

status leaf_between_open(mem *m, leaf_file *below, cpu_isa isa, leaf_file **out) {
    leaf_file *f = mem_zalloc(m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->m = m;
    f->below = below;
    const status st = make(f, isa);
    if (st != ST_OK) {
        leaf_file_close(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

/* ---- Moments ---- */

bool leaf_between_find(const leaf_file *f, const leaf_moment *at, uint32_t *set) {
    for (*set = 0; *set < LEAF_BETWEEN_SETS; ++*set) {
        const between_set *s = &f->between->set[*set];
        if (s->asked && s->at.field == at->field && s->at.step == at->step &&
            s->at.share == at->share)
            return true;
    }
    return false;
}

/* The set that shall stand for a moment. */
static uint32_t choose(const leaf_between *b, const leaf_moment *at) {
    uint32_t oldest = 0;
    for (uint32_t i = 0; i < LEAF_BETWEEN_SETS; i++) {
        const between_set *s = &b->set[i];
        if (s->asked && s->at.field == at->field && s->at.step == at->step)
            return i;
        oldest = s->asked < b->set[oldest].asked ? i : oldest;
    }
    return oldest;
}

/* A range that holds the blends of samples in two ranges, where both are finite. */
static void blend_range(const float a[2], const float b[2], double share, float range[2]) {
    const bool any = a[0] <= a[1] && b[0] <= b[1];
    range[0] = any ? blend_sample(a[0], b[0], share) + 0.0F : INFINITY; /* no -0 */
    range[1] = any ? blend_sample(a[1], b[1], share) + 0.0F : -INFINITY;
}

/* Deviations of a coarse treelet. Blends that are not rounded deviate by the blend of deviations,
 * at most. Each sample is rounded by less than 2^-24 + 2^-50 of the greatest magnitude, or by
 * 2^-150, and the interpolants of two levels differ by such samples. */
static void blend_deviations(leaf_file *f, uint32_t set, const uint32_t sets[2], double share,
                             uint32_t t) {
    const leaf_layout *l = &f->layout, *of = &f->below->layout;
    const float *range = f->ranges[leaf_layout_samples(l, set, t)];
    const double most = fmax(fabs((double)range[0]), fabs((double)range[1]));
    const double rounding = range[0] <= range[1] ? most * 0x1p-22 + 0x1p-148 : INFINITY;
    const uint16_t *a = f->below->deviations + deviation_at(of, sets[0], t);
    const uint16_t *b = f->below->deviations + deviation_at(of, sets[1], t);
    uint16_t *to = f->deviations + deviation_at(l, set, t);
    for (uint32_t i = 0; i < deviation_bricks(l); i++)
        to[i] = deviation_code((1.0 - share) * deviation_value(a[i]) +
                               share * deviation_value(b[i]) + rounding);
}

/* The sets of the file below that a moment lies between. */
static void sets_of(const leaf_file *f, const leaf_moment *at, uint32_t sets[2]) {
    sets[0] = leaf_layout_set(&f->below->layout, at->field, at->step);
    sets[1] = sets[0] + 1;
}

static void fill_directory(leaf_file *f, uint32_t set, const leaf_moment *at) {
    const leaf_layout *l = &f->layout;
    const leaf_file *below = f->below;
    uint32_t sets[2];
    sets_of(f, at, sets);
    for (uint32_t t = 0; t < l->treelets; t++) {
        const uint32_t p = leaf_layout_samples(l, set, t);
        const uint32_t a = leaf_layout_samples(&below->layout, sets[0], t);
        const uint32_t b = leaf_layout_samples(&below->layout, sets[1], t);
        blend_range(below->own[a], below->own[b], at->share, f->own[p]);
        blend_range(below->ranges[a], below->ranges[b], at->share, f->ranges[p]);
        f->flags[p] = below->flags[a] | below->flags[b];
        if (f->deviations && l->level_of[t] > 0)
            blend_deviations(f, set, sets, at->share, t);
    }
}

uint32_t leaf_between_select(leaf_file *f, const leaf_moment *at) {
    leaf_between *b = f->between;
    const uint32_t set = choose(b, at);
    const leaf_file *below = f->below;
    const double before = leaf_file_step_time(below, at->step);
    const double after = leaf_file_step_time(below, at->step + 1);
    uint32_t there;
    assert(at->field < below->header.fields && at->step + 1 < below->header.steps);
    assert(at->share > 0.0 && at->share < 1.0);
    if (!leaf_between_find(f, at, &there)) {
        b->set[set].at = *at;
        fill_directory(f, set, at);
        f->times[set] = (1.0 - at->share) * before + at->share * after;
        f->versions[set]++;
    }
    b->set[set].asked = ++b->asked;
    return set;
}

/* ---- Payloads ---- */

leaf_blend leaf_between_needs(const leaf_file *f, uint32_t p) {
    const leaf_layout *of = &f->below->layout;
    const uint32_t t = p % f->layout.treelets;
    const leaf_moment *at = &f->between->set[p / f->layout.treelets].at;
    uint32_t sets[2];
    sets_of(f, at, sets);
    const uint32_t a = leaf_layout_samples(of, sets[0], t), b = leaf_layout_samples(of, sets[1], t);
    if (leaf_file_same(f->below, a, b))
        return (leaf_blend){{a, LEAF_NO_TREELET}, 0.0};
    return (leaf_blend){{a, b}, at->share};
}

static leaf_payload shape_of(const leaf_file *f, uint32_t p) {
    return leaf_layout_payload(&f->layout, p % f->layout.treelets);
}

static between_head *head_of(const leaf_file *f, uint32_t p, void *payload) {
    return (between_head *)((char *)payload + shape_of(f, p).beside_at);
}

static const between_head *const_head_of(const leaf_file *f, uint32_t p, const void *payload) {
    return (const between_head *)((const char *)payload + shape_of(f, p).beside_at);
}

void leaf_between_begin(const leaf_file *f, uint32_t p, void *payload) {
    *head_of(f, p, payload) = (between_head){{LEAF_NO_TREELET, LEAF_NO_TREELET}, (double)NAN};
}

static char *part_at(const leaf_payload *shape, void *payload, int part) {
    return (char *)payload + shape->beside_at + LEAF_BESIDE_ROOM(shape->node_levels) +
           (size_t)part * shape->beside_bytes;
}

void *leaf_between_part(const leaf_file *f, uint32_t p, void *payload, int part, uint32_t **has) {
    const leaf_payload shape = shape_of(f, p);
    between_head *head = head_of(f, p, payload);
    *has = &head->has[part];
    head->made = (double)NAN;
    return part_at(&shape, payload, part);
}

static bool is_part(const leaf_file *f, uint32_t has, uint32_t needed) {
    return has != LEAF_NO_TREELET && needed != LEAF_NO_TREELET &&
           leaf_file_same(f->below, has, needed);
}

bool leaf_between_helps(const leaf_file *f, uint32_t p, const void *payload) {
    const leaf_blend needs = leaf_between_needs(f, p);
    const between_head *head = const_head_of(f, p, payload);
    bool any = false;
    for (int i = 0; i < LEAF_BETWEEN_PARTS; i++)
        for (int k = 0; k < LEAF_BETWEEN_PARTS; k++)
            any |= is_part(f, head->has[i], needs.of[k]);
    return any;
}

bool leaf_between_lacks(const leaf_file *f, uint32_t p, const void *payload, int part) {
    const uint32_t needed = leaf_between_needs(f, p).of[part];
    return needed != LEAF_NO_TREELET &&
           !is_part(f, const_head_of(f, p, payload)->has[part], needed);
}

bool leaf_between_is_made(const leaf_file *f, uint32_t p, const void *payload) {
    return const_head_of(f, p, payload)->made == leaf_between_needs(f, p).share &&
           !leaf_between_lacks(f, p, payload, 0) && !leaf_between_lacks(f, p, payload, 1);
}

void leaf_between_make(const leaf_file *f, uint32_t p, void *payload) {
    const leaf_blend needs = leaf_between_needs(f, p);
    const uint32_t t = p % f->layout.treelets;
    const leaf_payload shape = leaf_layout_payload(&f->layout, t);
    const uint32_t from = leaf_layout_payload(&f->below->layout, t).samples_at;
    between_head *head = head_of(f, p, payload);
    if (head->made == needs.share)
        return;
    f->between->blend(part_at(&shape, payload, 0) + from, part_at(&shape, payload, 1) + from,
                      needs.share, (float *)((char *)payload + shape.samples_at),
                      (size_t)shape.samples[0] * shape.samples[1] * shape.samples[2]);
    grid_codes_make_within(&f->layout, t, f->own[p], (grid_codes_scratch *)((char *)head + HEAD),
                           payload);
    head->made = needs.share;
}
