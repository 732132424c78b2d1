#include "formats/leaf/leaf_between.h"

#include <assert.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/leaf/leaf_geometry.h"

/* A set. */
typedef struct between_set {
    leaf_moment at;
    uint64_t asked; /* when it was last asked for; 0: it stands for nothing */
} between_set;

struct leaf_between {
    between_set set[LEAF_BETWEEN_SETS]; /* from the file's set `first` on */
    uint32_t first;
    uint64_t asked;
    blend_fn *blend;
};

/* What a payload has behind its samples, before scratch memory and the payloads of steps. */
typedef struct between_head {
    uint32_t has[LEAF_BETWEEN_PARTS];
    double made; /* the share that its samples are of; NaN: of none */
} between_head;

_Static_assert(sizeof(between_head) <= LEAF_ALIGN, "the head has its room");

static const leaf_blending *blending_of(const leaf_file *f) {
    return f->geometry->blending;
}

/* ---- Making ---- */

status leaf_between_check(const leaf_file *f) {
    const leaf_blending *b = blending_of(f);
    if (!b)
        return status_describe(ST_UNSUPPORTED,
                               "%s: times between steps are of grids and meshes; this has neither",
                               file_path(f->source));
    if ((uint64_t)f->layout.treelets * b->blocks >= LEAF_NO_TREELET)
        return status_describe(ST_UNSUPPORTED,
                               "%s: %u treelets are too many for times between steps",
                               file_path(f->source), f->layout.treelets);
    return ST_OK;
}

static void fill_header(leaf_file *f) {
    leaf_header *h = &f->header;
    *h = f->below->header;
    h->sample_type = SAMPLE_F32;
    h->codec = LEAF_CODEC_ZSTD; /* as if packed: nothing is used where it lies */
    h->fields = 1;
    h->steps = f->layout.steps;
    h->outside = h->outside_chunks = h->segments = 0;
    h->directory = h->last = 0;
}

static status allocate(leaf_file *f) {
    status st = leaf_file_allocate_changing(f);
    f->between = mem_zalloc(f->m, sizeof *f->between);
    if (st != ST_OK || !f->between)
        return ST_NOMEM;
    st = f->geometry->allocate(f);
    return st == ST_OK ? blending_of(f)->allocate(f) : st;
}

static status make(leaf_file *f, cpu_isa isa) {
    const leaf_file *below = f->below;
    status st = file_open_memory(f->m, file_path(below->source), "", 0, &f->source);
    f->geometry = below->geometry;
    if (st == ST_OK)
        st = blending_of(f)->lay_out(f);
    if (st != ST_OK)
        return st;
    fill_header(f);
    f->frame = below->frame;
    memcpy(f->name, below->name, sizeof f->name);
    st = allocate(f);
    if (st != ST_OK)
        return st;
    f->between->first = blending_of(f)->first_set(&f->layout);
    f->between->blend = blend_rows_for(isa, below->layout.type);
    return ST_OK;
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
    const leaf_between *b = f->between;
    for (uint32_t i = 0; i < LEAF_BETWEEN_SETS; i++) {
        const between_set *s = &b->set[i];
        *set = b->first + i;
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
    }
    blending_of(f)->fill(f, set, sets, at->share);
}

uint32_t leaf_between_select(leaf_file *f, const leaf_moment *at) {
    leaf_between *b = f->between;
    const uint32_t i = choose(b, at), set = b->first + i;
    const leaf_file *below = f->below;
    const double before = leaf_file_step_time(below, at->step);
    const double after = leaf_file_step_time(below, at->step + 1);
    uint32_t there;
    assert(at->field < below->header.fields && at->step + 1 < below->header.steps);
    assert(at->share > 0.0 && at->share < 1.0);
    if (!leaf_between_find(f, at, &there)) {
        b->set[i].at = *at;
        fill_directory(f, set, at);
        f->times[set] = (1.0 - at->share) * before + at->share * after;
        f->versions[set]++;
    }
    b->set[i].asked = ++b->asked;
    return set;
}

/* ---- Payloads ---- */

leaf_blend leaf_between_needs(const leaf_file *f, uint32_t p) {
    const leaf_blending *blending = blending_of(f);
    const leaf_layout *l = &f->layout, *of = &f->below->layout;
    const uint32_t set = blending->set_of(l, p);
    if (set == LEAF_NO_SET)
        return (leaf_blend){{p, LEAF_NO_TREELET}, 0.0};
    const leaf_moment *at = &f->between->set[set - f->between->first].at;
    uint32_t sets[2];
    sets_of(f, at, sets);
    const uint32_t a = blending->alike(l, p, of, sets[0]), b = blending->alike(l, p, of, sets[1]);
    if (a != LEAF_NO_TREELET && leaf_file_same(f->below, a, b))
        return (leaf_blend){{a, LEAF_NO_TREELET}, 0.0};
    return (leaf_blend){{a, b}, at->share};
}

bool leaf_between_is_made_of(const leaf_file *f, uint32_t p) {
    return blending_of(f)->set_of(&f->layout, p) != LEAF_NO_SET;
}

static leaf_beside beside_of(const leaf_file *f, uint32_t p) {
    return blending_of(f)->beside(&f->layout, p);
}

static const between_head *const_head_of(const leaf_file *f, uint32_t p, const void *payload) {
    return (const between_head *)((const char *)payload + beside_of(f, p).at);
}

static between_head *head_of(const leaf_file *f, uint32_t p, void *payload) {
    return (between_head *)((char *)payload + beside_of(f, p).at);
}

void leaf_between_begin(const leaf_file *f, uint32_t p, void *payload) {
    *head_of(f, p, payload) = (between_head){{LEAF_NO_TREELET, LEAF_NO_TREELET}, (double)NAN};
}

static char *part_at(const leaf_beside *b, void *payload, int part) {
    return (char *)payload + b->parts_at + (size_t)part * b->each;
}

void *leaf_between_part(const leaf_file *f, uint32_t p, void *payload, int part, uint32_t **has) {
    const leaf_beside b = beside_of(f, p);
    between_head *head = (between_head *)((char *)payload + b.at);
    *has = &head->has[part];
    head->made = (double)NAN;
    return part_at(&b, payload, part);
}

const void *leaf_between_part_of(const leaf_file *f, uint32_t p, const void *payload, int part) {
    const leaf_beside b = beside_of(f, p);
    return part_at(&b, (void *)(uintptr_t)payload, part);
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
    const leaf_blend needs = leaf_between_needs(f, p);
    const uint32_t needed = needs.of[part], has = const_head_of(f, p, payload)->has[part];
    if (needed == LEAF_NO_TREELET) /* the room of what is not there must be empty */
        return needs.share != 0.0 && has != LEAF_NO_TREELET;
    return !is_part(f, has, needed);
}

bool leaf_between_is_made(const leaf_file *f, uint32_t p, const void *payload) {
    return const_head_of(f, p, payload)->made == leaf_between_needs(f, p).share &&
           !leaf_between_lacks(f, p, payload, 0) && !leaf_between_lacks(f, p, payload, 1);
}

void leaf_between_make(const leaf_file *f, uint32_t p, const void *shared, void *payload) {
    const leaf_blend needs = leaf_between_needs(f, p);
    const leaf_beside b = beside_of(f, p);
    between_head *head = (between_head *)((char *)payload + b.at);
    if (head->made == needs.share)
        return;
    leaf_mix m = {.set = blending_of(f)->set_of(&f->layout, p),
                  .treelet = p % f->layout.treelets,
                  .share = needs.share,
                  .blend = f->between->blend,
                  .shared = shared,
                  .scratch = (char *)head + LEAF_ALIGN,
                  .payload = payload};
    for (int i = 0; i < LEAF_BETWEEN_PARTS; i++)
        m.part[i] = needs.of[i] == LEAF_NO_TREELET ? NULL : part_at(&b, payload, i);
    blending_of(f)->make(f, p, &m);
    head->made = needs.share;
}
