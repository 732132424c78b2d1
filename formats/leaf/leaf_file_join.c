/* leaf_file_join.c - one file of several segments: the directories of all of them, as if they were
 * one. See SERIES.md 4.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_geometry.h"

/* ---- where segments lie ---- */

static status no_segment(const leaf_file *f, uint64_t at, uint32_t i) {
    return leaf_check_corrupt(file_path(f->source), at, "expected the header of segment %u", i);
}

/* Check that each segment has steps, which begin where those before end: no room is made, and
 * nothing taken, by numbers that say otherwise. */
static status check_steps(const leaf_file *f) {
    uint64_t steps = f->header.steps;
    for (uint32_t i = 1; i < f->header.segments; i++) {
        const leaf_segment *s = &f->segments[i];
        if (s->first != steps || !s->steps)
            return no_segment(f, s->base, i);
        steps += s->steps;
    }
    return ST_OK;
}

/* Find all segments, from the last one's header back to the first. */
static status find_segments(leaf_file *f) {
    const uint32_t count = f->header.segments;
    uint64_t at = f->header.last;
    f->segments = mem_array(f->m, count, sizeof *f->segments);
    if (!f->segments)
        return ST_NOMEM;
    for (uint32_t i = count; i-- > 1;) {
        leaf_header head;
        const status st = file_read_at(f->source, at, &head, sizeof head);
        if (st != ST_OK)
            return st;
        if (memcmp(head.magic, LEAF_MAGIC, sizeof head.magic) || head.before >= at)
            return no_segment(f, at, i);
        f->segments[i] =
            (leaf_segment){at, head.steps_before, head.steps, {head.id[0], head.id[1]}};
        at = head.before;
    }
    f->segments[0] = (leaf_segment){0, 0, f->header.steps, {f->first_id[0], f->first_id[1]}};
    return at == 0 || count == 1 ? check_steps(f) : no_segment(f, at, 0);
}

static const leaf_segment *last_of(const leaf_file *f) {
    return &f->segments[f->header.segments - 1];
}

/* Check that a segment lies where the one before it ends, and that it has the same cells, with the
 * same parameters. */
static status check_segment(const leaf_file *f, const leaf_file *part, uint32_t i, uint64_t end) {
    const struct {
        size_t at, size;
    } fields[] = {
        {offsetof(leaf_header, kind), offsetof(leaf_header, steps) - offsetof(leaf_header, kind)},
        {offsetof(leaf_header, treelets), sizeof f->header.treelets},
        {offsetof(leaf_header, to_world), sizeof f->header.to_world},
        {offsetof(leaf_header, tets),
         offsetof(leaf_header, repeated) - offsetof(leaf_header, tets)},
        {offsetof(leaf_header, field),
         offsetof(leaf_header, outside_chunks) - offsetof(leaf_header, field)},
    };
    const leaf_segment *s = &f->segments[i], *before = s - 1;
    if (s->base != end || part->header.steps != s->steps || part->header.before != before->base ||
        part->header.steps_before != s->first)
        return no_segment(f, end, i);
    bool same =
        part->has_times == f->has_times && memcmp(&part->frame, &f->frame, sizeof f->frame) == 0;
    for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
        same = same && memcmp((const char *)&part->header + fields[k].at,
                              (const char *)&f->header + fields[k].at, fields[k].size) == 0;
    /* From here on they have as many fields and cells. */
    same = same && memcmp(part->names, f->names, f->header.fields * sizeof *f->names) == 0;
    if (same && f->geometry->growth->alike(f, part))
        return ST_OK;
    return leaf_check_corrupt(file_path(f->source), s->base,
                              "segment %u has not the fields or the cells of the first", i);
}

/* ---- arrays ---- */

/* A file to be: the first segment's, with arrays for all steps. */
typedef struct joining {
    leaf_file *f;       /* the first segment; its header is not touched until the end */
    leaf_layout layout; /* f's, with all steps */
    leaf_row rows[LEAF_ROWS_MAX], own_rows[LEAF_ROWS_MAX]; /* of all; of the current segment */
    int row_count;
    leaf_file to; /* the arrays */
    uint32_t *same, *bases;
} joining;

static const struct {
    size_t at, size;
    bool of_payloads; /* else of treelets, in all sets */
} arrays[] = {
    {offsetof(leaf_file, ranges), sizeof(float[2]), false},
    {offsetof(leaf_file, own), sizeof(float[2]), false},
    {offsetof(leaf_file, flags), sizeof(uint8_t), false},
    {offsetof(leaf_file, offsets), sizeof(uint64_t), true},
    {offsetof(leaf_file, sizes), sizeof(uint64_t), true},
    {offsetof(leaf_file, checksums), sizeof(uint64_t), true},
};
enum { ARRAYS = sizeof arrays / sizeof *arrays };

static void **array_of(leaf_file *f, int i) {
    return (void **)((char *)f + arrays[i].at);
}

static status allocate(joining *j) {
    const leaf_file *f = j->f;
    const leaf_layout *l = &j->layout;
    bool room = true;
    for (int i = 0; i < ARRAYS; i++) {
        const size_t count = arrays[i].of_payloads ? l->payloads : (size_t)l->sets * l->treelets;
        *array_of(&j->to, i) = mem_array(f->m, count, arrays[i].size);
        room = room && *array_of(&j->to, i);
    }
    j->same = mem_array(f->m, l->payloads, sizeof *j->same);
    j->bases = mem_array(f->m, l->payloads, sizeof *j->bases);
    j->to.times = mem_array(f->m, l->steps, sizeof *j->to.times);
    room = room && j->same && j->bases && j->to.times;
    if (f->histograms && l->sets <= LEAF_HISTOGRAMS_MAX) {
        j->to.histograms = mem_array(f->m, l->sets, sizeof *j->to.histograms);
        room = room && j->to.histograms;
    }
    if (f->deviations) {
        j->to.deviations = mem_array(f->m, deviation_count(l), sizeof *j->to.deviations);
        room = room && j->to.deviations;
    }
    return room ? ST_OK : ST_NOMEM;
}

static void release(joining *j) {
    mem *m = j->f->m;
    for (int i = 0; i < ARRAYS; i++)
        mem_free(m, *array_of(&j->to, i));
    mem_free(m, j->same);
    mem_free(m, j->bases);
    mem_free(m, j->to.times);
    mem_free(m, j->to.histograms);
    mem_free(m, j->to.deviations);
}

/* Copy the rows of a segment's sets, of `row` bytes each, to their places among all sets. */
static void copy_sets(const joining *j, const leaf_segment *s, void *to, const void *from,
                      size_t row) {
    for (uint32_t field = 0; field < j->f->header.fields; field++)
        memcpy((char *)to + ((size_t)field * j->layout.steps + s->first) * row,
               (const char *)from + (size_t)field * s->steps * row, s->steps * row);
}

/* The same of an array of payloads. Those of no set are the first segment's. */
static void copy_payloads(const joining *j, const leaf_segment *s, void *to, const void *from,
                          size_t size) {
    if (s == j->f->segments)
        memcpy(to, from, j->rows[0].first * size);
    for (int i = 0; i < j->row_count; i++)
        copy_sets(j, s, (char *)to + j->rows[i].first * size,
                  (const char *)from + j->own_rows[i].first * size, j->rows[i].width * size);
}

/* Say that no treelet of these sets is known to differ from the finer ones by little. */
static void forget_deviations(const joining *j, const leaf_segment *s) {
    const leaf_layout *l = &j->layout;
    for (uint32_t field = 0; field < j->f->header.fields; field++) {
        const uint32_t set = leaf_layout_set(l, field, s->first);
        for (size_t i = deviation_at(l, set, 0); i < deviation_at(l, set + s->steps, 0); i++)
            j->to.deviations[i] = DEVIATION_UNKNOWN;
    }
}

static void copy_arrays(const joining *j, const leaf_segment *s, leaf_file *part) {
    const leaf_layout *l = &j->layout;
    leaf_file *to = (leaf_file *)(uintptr_t)&j->to;
    for (int i = 0; i < ARRAYS; i++)
        if (arrays[i].of_payloads)
            copy_payloads(j, s, *array_of(to, i), *array_of(part, i), arrays[i].size);
        else
            copy_sets(j, s, *array_of(to, i), *array_of(part, i), l->treelets * arrays[i].size);
    memcpy(to->times + s->first, part->times, s->steps * sizeof *to->times);
    if (part->links.same)
        copy_payloads(j, s, j->same, part->links.same, sizeof *j->same);
    if (part->links.bases)
        copy_payloads(j, s, j->bases, part->links.bases, sizeof *j->bases);
    if (to->histograms && part->histograms)
        copy_sets(j, s, to->histograms, part->histograms, sizeof *to->histograms);
    if (to->deviations && part->deviations)
        copy_sets(j, s, to->deviations, part->deviations,
                  deviation_at(l, 1, 0) * sizeof *to->deviations);
    else if (to->deviations)
        forget_deviations(j, s);
}

/* ---- links ---- */

/* The set, of so many steps, that set `number` of segment s is. */
static uint32_t set_of(const leaf_segment *s, uint32_t steps, uint32_t number) {
    return number / s->steps * steps + s->first + number % s->steps;
}

/* The segment that a step of all is in. */
static const leaf_segment *segment_of(const leaf_segment *s, uint32_t count, uint32_t step) {
    uint32_t low = 0;
    for (uint32_t high = count; high - low > 1;) {
        const uint32_t middle = low + (high - low) / 2;
        if (s[middle].first <= step)
            low = middle;
        else
            high = middle;
    }
    return s + low;
}

/* The set of all that an entry of segment s leads to. */
static uint32_t entry_set(const joining *j, const leaf_segment *s, uint32_t entry) {
    if (!(entry & LEAF_LINK_BEFORE))
        return set_of(s, j->layout.steps, entry - 1);
    const uint32_t number = entry ^ LEAF_LINK_BEFORE, fields = j->f->header.fields;
    const leaf_segment *in = segment_of(j->f->segments, j->f->header.segments, number / fields);
    return set_of(in, j->layout.steps, number - fields * in->first);
}

static status no_link(const joining *j, const leaf_segment *s, uint32_t p, const char *what) {
    char name[LEAF_NAME_MAX];
    return leaf_check_corrupt(file_path(j->f->source), s->base, "%s cannot have such a %s",
                              leaf_layout_payload_name(&j->layout, p, name), what);
}

/* Make payload p's entry of SAME one of the whole file, and give it the place that it leads to. */
static status join_same(joining *j, const leaf_segment *s, uint32_t p) {
    const bool before = j->same[p] & LEAF_LINK_BEFORE;
    const leaf_series series = leaf_layout_series(&j->layout, p);
    const uint32_t set = entry_set(j, s, j->same[p]);
    const uint32_t q = leaf_series_payload(&series, set);
    leaf_file *to = &j->to;
    j->same[p] = set + 1;
    if (before && (!to->sizes[q] || j->same[q] || to->sizes[p] != to->sizes[q] ||
                   to->checksums[p] != to->checksums[q]))
        return no_link(j, s, p, "payload of an earlier segment");
    to->offsets[p] = to->offsets[q];
    return ST_OK;
}

/* Check that a reader comes from p to a whole code, by a few bases. Those of earlier segments are
 * sound. */
static status check_chain(const joining *j, const leaf_segment *s, uint32_t p) {
    const leaf_series series = leaf_layout_series(&j->layout, p);
    int codes = 1;
    for (uint32_t q = p; j->bases[q]; codes++) {
        q = leaf_series_payload(&series, j->bases[q] - 1);
        if (codes == LEAF_CHAIN_MAX || !j->to.sizes[q] || j->same[q])
            return no_link(j, s, p, "base");
    }
    return ST_OK;
}

/* Call take() for the payloads of a segment's sets, row by row, steps ascending. */
static status each_payload(joining *j, const leaf_segment *s,
                           status (*take)(joining *j, const leaf_segment *s, uint32_t p)) {
    status st = ST_OK;
    for (uint32_t i = 0; i < s->steps * j->f->header.fields; i++) {
        const uint32_t set = set_of(s, j->layout.steps, i);
        for (const leaf_row *row = j->rows; row < j->rows + j->row_count; row++)
            for (uint32_t k = 0; k < row->width && st == ST_OK; k++)
                st = take(j, s, row->first + set * row->width + k);
    }
    return st;
}

/* Payloads lie behind the header of their segment; what is the same as another is elsewhere. */
static status join_payload(joining *j, const leaf_segment *s, uint32_t p) {
    j->to.offsets[p] += s->base;
    status st = j->same[p] ? join_same(j, s, p) : ST_OK;
    if (st == ST_OK && j->bases[p])
        j->bases[p] = entry_set(j, s, j->bases[p]) + 1;
    return st;
}

static status check_payload(joining *j, const leaf_segment *s, uint32_t p) {
    return j->bases[p] ? check_chain(j, s, p) : ST_OK;
}

/* Check that a later segment's payloads of no set are the first one's. */
static status check_shared(const joining *j, const leaf_segment *s, const leaf_file *part) {
    const leaf_file *to = &j->to;
    for (uint32_t p = 0; p < j->rows[0].first && s != j->f->segments; p++)
        if (!part->links.same || part->links.same[p] != LEAF_LINK_BEFORE ||
            part->sizes[p] != to->sizes[p] || part->checksums[p] != to->checksums[p])
            return no_link(j, s, p, "payload of its own");
    return ST_OK;
}

static status take_segment(joining *j, const leaf_segment *s, leaf_file *part) {
    (void)j->f->geometry->growth->rows(&part->layout, j->own_rows);
    status st = check_shared(j, s, part);
    if (st != ST_OK)
        return st;
    copy_arrays(j, s, part);
    st = each_payload(j, s, join_payload);
    return st == ST_OK ? each_payload(j, s, check_payload) : st;
}

/* ---- all of it ---- */

/* Add what a segment's header says to that of all. */
static void sum_up(leaf_header *h, const leaf_header *own) {
    h->payload_bytes += own->payload_bytes;
    h->non_finite += own->non_finite;
    h->value_min = fmin(h->value_min, own->value_min);
    h->value_max = fmax(h->value_max, own->value_max);
    h->rounding_error = fmax(h->rounding_error, own->rounding_error);
    memcpy(h->id, own->id, sizeof h->id);
}

/* Open segment i, and add it. *end: where the one before ends, and this one does. */
static status add_segment(joining *j, leaf_header *h, uint32_t i, uint64_t *end) {
    leaf_file *f = j->f, *part = NULL;
    const leaf_segment *s = &f->segments[i];
    status st = leaf_file_open_segment(f->m, f, s, &part);
    if (st != ST_OK)
        return st;
    st = check_segment(f, part, i, *end);
    if (st == ST_OK)
        st = take_segment(j, s, part);
    sum_up(h, &part->header);
    *end += part->header.file_bytes;
    f->directory_bytes += part->directory_bytes;
    leaf_file_close(part);
    return st;
}

#define SWAP(type, a, b)  \
    do {                  \
        type swapped = a; \
        a = b;            \
        b = swapped;      \
    } while (0)

/* Exchange the arrays of sets and steps of two files. */
static void exchange_arrays(leaf_file *f, leaf_file *other) {
    for (int i = 0; i < ARRAYS; i++)
        SWAP(void *, *array_of(f, i), *array_of(other, i));
    SWAP(double *, f->times, other->times);
    SWAP(histogram *, f->histograms, other->histograms);
    SWAP(uint16_t *, f->deviations, other->deviations);
}

/* Move the arrays of all segments into the file. */
static void settle(joining *j, const leaf_header *h) {
    leaf_file *f = j->f;
    const leaf_links old = f->links;
    exchange_arrays(f, &j->to);
    f->links = (leaf_links){j->same, j->bases};
    j->same = (uint32_t *)(uintptr_t)old.same;
    j->bases = (uint32_t *)(uintptr_t)old.bases;
    f->layout = j->layout;
    f->header = *h;
}

/* Make the layout of all steps, as the last segment's header tells them; whether it may be right.
 * The directories of a file are at least a 1024th of what they decompress to. */
static bool lay_out(joining *j, leaf_header *h) {
    const leaf_segment *last = last_of(j->f);
    const uint64_t steps = (uint64_t)last->first + last->steps;
    if (steps > LEAF_SETS_MAX / h->fields)
        return false;
    h->steps = (uint32_t)steps;
    leaf_header all = *h;
    all.file_bytes = all.directory = file_size(j->f->source);
    const leaf_growth *growth = j->f->geometry->growth;
    if (!leaf_check_may_hold(&all) || !growth->repeat(&j->layout, h->steps))
        return false;
    j->row_count = growth->rows(&j->layout, j->rows);
    return true;
}

status leaf_file_join(leaf_file *f) {
    leaf_header h = f->header;
    uint64_t end = h.file_bytes;
    status st = file_look_again(f->source);
    if (st == ST_OK)
        st = find_segments(f);
    if (st != ST_OK || h.segments == 1)
        return st;
    joining j = {.f = f, .layout = f->layout};
    if (!lay_out(&j, &h))
        return no_segment(f, last_of(f)->base, h.segments - 1);
    st = allocate(&j);
    if (st == ST_OK)
        st = take_segment(&j, &f->segments[0], f);
    for (uint32_t i = 1; i < h.segments && st == ST_OK; i++)
        st = add_segment(&j, &h, i, &end);
    h.file_bytes = end;
    if (st == ST_OK && f->has_times)
        st = leaf_check_axis(file_path(f->source), j.to.times, h.steps, last_of(f)->base);
    for (uint32_t i = 0; st == ST_OK && !f->has_times && i < h.steps; i++)
        j.to.times[i] = i;
    if (st == ST_OK)
        settle(&j, &h);
    release(&j);
    return st;
}

/* ---- taking in segments that have come ---- */

/* Whether all segments of f are still there, at the beginning of another one. */
static bool is_continued(const leaf_file *f, const leaf_file *by) {
    bool same = memcmp(f->first_id, by->first_id, sizeof f->first_id) == 0 &&
                by->header.segments > f->header.segments && by->header.steps > f->header.steps;
    for (uint32_t i = 1; i < f->header.segments && same; i++)
        same = memcmp(&f->segments[i], &by->segments[i], sizeof *f->segments) == 0;
    return same && f->mark.device == by->mark.device && f->mark.inode == by->mark.inode;
}

status leaf_file_newer(const leaf_file *f, leaf_file **out) {
    leaf_header head;
    leaf_file *newer = NULL;
    *out = NULL;
    status st = leaf_file_changed(f);
    if (st != ST_OK || file_descriptor(f->source) < 0)
        return st;
    st = file_read_at(f->source, 0, &head, sizeof head);
    if (st != ST_OK || head.segments <= 1 || head.segments <= f->header.segments)
        return st;
    st = leaf_file_open(f->m, file_path(f->source), &newer);
    if (st == ST_OK && !is_continued(f, newer))
        st = status_describe(
            ST_CORRUPT, "%s changed while it was open: its first %u steps are not what they were",
            file_path(f->source), f->header.steps);
    if (st != ST_OK) {
        leaf_file_close(newer);
        return st;
    }
    *out = newer;
    return ST_OK;
}

/* Take from another header what sum_up() makes. */
static void take_sums(leaf_header *h, const leaf_header *of) {
    h->payload_bytes = of->payload_bytes;
    h->non_finite = of->non_finite;
    h->value_min = of->value_min;
    h->value_max = of->value_max;
    h->rounding_error = of->rounding_error;
    memcpy(h->id, of->id, sizeof h->id);
}

void leaf_file_exchange(leaf_file *f, leaf_file *newer) {
    leaf_header *h = &f->header, *other = &newer->header;
    exchange_arrays(f, newer);
    SWAP(leaf_links, f->links, newer->links);
    SWAP(leaf_segment *, f->segments, newer->segments);
    SWAP(file *, f->source, newer->source);
    SWAP(file_mark, f->mark, newer->mark);
    SWAP(uint64_t, f->directory_bytes, newer->directory_bytes);
    SWAP(uint32_t, f->layout.payloads, newer->layout.payloads);
    SWAP(uint32_t, f->layout.sets, newer->layout.sets);
    SWAP(uint32_t, f->layout.gradient_sets, newer->layout.gradient_sets);
    SWAP(uint32_t, f->layout.steps, newer->layout.steps);
    SWAP(uint64_t, h->last, other->last);
    SWAP(uint32_t, h->segments, other->segments);
    SWAP(uint64_t, h->checksum, other->checksum);
    SWAP(uint32_t, h->steps, other->steps);
    SWAP(uint64_t, h->file_bytes, other->file_bytes);
    const leaf_header own = *h;
    take_sums(h, other);
    take_sums(other, &own);
}

/* ---- numbers of sets ---- */

/* The segment that a step is in. whole: room for that of a file without segments. */
static const leaf_segment *segment_with(const leaf_file *f, uint32_t step, leaf_segment *whole) {
    *whole = (leaf_segment){.steps = f->layout.steps};
    return f->segments ? segment_of(f->segments, f->header.segments, step) : whole;
}

uint32_t leaf_file_number(const leaf_file *f, uint32_t set) {
    const uint32_t field = set / f->layout.steps, step = set % f->layout.steps;
    leaf_segment whole;
    const leaf_segment *s = segment_with(f, step, &whole);
    return s->first * f->header.fields + field * s->steps + step - s->first;
}

uint32_t leaf_file_numbered(const leaf_file *f, uint32_t number) {
    const uint32_t fields = f->header.fields;
    leaf_segment whole;
    const leaf_segment *s = segment_with(f, number / fields, &whole);
    return set_of(s, f->layout.steps, number - fields * s->first);
}

uint32_t leaf_file_segment_sets(const leaf_file *f, uint32_t set) {
    leaf_segment whole;
    return segment_with(f, set % f->layout.steps, &whole)->steps * f->header.fields;
}
