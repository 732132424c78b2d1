/* naive_leaf.c - section numbers are those of formats/FORMAT.md. */
#include "tests/support/naive_leaf.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "tests/support/naive_box.h"
#include "tests/support/naive_bytes.h"
#include "tests/support/naive_codes.h"
#include "tests/support/naive_family.h"
#include "tests/support/naive_outside.h"
#include "tests/support/naive_places.h"

static bool wrong(naive_leaf *leaf, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(naive_leaf *leaf, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(leaf->why, sizeof leaf->why, format, args);
    va_end(args);
    return false;
}

/* ---- 2. the header ---- */

static bool read_text(naive_leaf *leaf, uint64_t offset, uint64_t size, char *out) {
    memcpy(out, leaf->bytes + offset, size);
    const void *end = memchr(out, 0, size);
    if (!end)
        return wrong(leaf, "text at %llu has no end", (unsigned long long)offset);
    uint64_t length = (uint64_t)((const char *)end - out);
    return naive_zeros(leaf->bytes, offset + length, offset + size) ||
           wrong(leaf, "bytes behind a text's end");
}

static void take_fields(naive_leaf *leaf) {
    const unsigned char *b = leaf->bytes;
    leaf->version = (int)naive_number(b + 8, 4);
    leaf->sample_type = (int)naive_number(b + 16, 4);
    leaf->source_type = (int)naive_number(b + 20, 4);
    for (int a = 0; a < 3; a++)
        leaf->dims[a] = (long)naive_number(b + 24 + 4 * a, 4);
    leaf->levels = (int)naive_number(b + 36, 4);
    leaf->cells_log2 = (int)naive_number(b + 40, 4);
    leaf->halo = (int)naive_number(b + 44, 4);
    leaf->run_align_log2 = (int)naive_number(b + 52, 4);
    leaf->codec = (int)naive_number(b + 56, 4);
    leaf->rectilinear = naive_number(b + 60, 4) == 1;
    leaf->outside = naive_number(b + 76, 4) > 0;
    leaf->in_slices = naive_number(b + 76, 4) == 2;
    leaf->bare = naive_number(b + 1496, 4) == 1;
    leaf->outside_chunks = (long)naive_number(b + 1500, 4);
    leaf->fields = (long)naive_number(b + 64, 4);
    leaf->steps = (long)naive_number(b + 68, 4);
    leaf->sets = leaf->fields * leaf->steps;
    leaf->non_finite = naive_number(b + 104, 8);
    leaf->value_min = naive_real64(b + 112);
    leaf->value_max = naive_real64(b + 120);
    leaf->rounding_error = naive_real64(b + 128);
    for (int i = 0; i < 12; i++)
        leaf->to_world[i / 4][i % 4] = naive_real64(b + 136 + 8 * i);
}

static bool read_header(naive_leaf *leaf) {
    static const unsigned char magic[8] = {0x89, 0x4c, 0x45, 0x41, 0x46, 0x0d, 0x0a, 0x1a};
    /* offset, lowest and highest value of what the file of a grid may say */
    static const uint64_t ranges[][3] = {
        {8, 4, 4},        {12, 1, 6},       {16, 1, 5},  {20, 1, 11},  {24, 2, 1 << 20},
        {28, 2, 1 << 20}, {32, 2, 1 << 20}, {36, 1, 24}, {40, 4, 6},   {44, 0, 1},
        {48, 2, 2},       {52, 6, 21},      {56, 0, 1},  {60, 0, 1},   {64, 1, 65536},
        {68, 1, 65536},   {72, 1, 64},      {76, 0, 2},  {1496, 0, 1},
    };
    const unsigned char *b = leaf->bytes;
    if (leaf->size < 4096 || memcmp(b, magic, 8) != 0)
        return wrong(leaf, "no magic");
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        uint64_t value = naive_number(b + ranges[i][0], 4);
        if (value < ranges[i][1] || value > ranges[i][2])
            return wrong(leaf, "header field at %d is %llu", (int)ranges[i][0],
                         (unsigned long long)value);
    }
    take_fields(leaf);
    leaf->heights = naive_number(b + 12, 4) == 6;
    if (naive_number(b + 12, 4) != 1 &&
        (!leaf->heights || leaf->dims[1] != 2 || leaf->rectilinear || leaf->outside))
        return wrong(leaf, "kind %d", (int)naive_number(b + 12, 4));
    if (leaf->sets > 65536)
        return wrong(leaf, "%ld fields at %ld steps", leaf->fields, leaf->steps);
    if (leaf->outside &&
        (leaf->codec != 1 || leaf->sets != 1 || !naive_zeros(leaf->bytes, 1512, 1536)))
        return wrong(leaf, "samples outside");
    int stored = leaf->source_type <= 5 ? leaf->source_type : 5;
    if (stored != leaf->sample_type && leaf->sample_type != 5)
        return wrong(leaf, "stored type %d of source type %d", leaf->sample_type,
                     leaf->source_type);
    if (!(leaf->rounding_error >= 0) ||
        (leaf->source_type == leaf->sample_type && leaf->rounding_error != 0))
        return wrong(leaf, "rounding error %g", leaf->rounding_error);
    if (naive_number(b + 96, 8) != leaf->size)
        return wrong(leaf, "file_bytes");
    uint64_t sections = naive_number(b + 72, 4), table = naive_number(b + 1504, 8);
    table = table ? table : 4096;
    if (table > leaf->size || leaf->size - table < 32 * sections ||
        !naive_zeros(leaf->bytes, 1344, 1424) || !naive_zeros(leaf->bytes, 1488, 1496) ||
        !naive_zeros(leaf->bytes, 1536, 4096) || (leaf->outside_chunks && !leaf->outside))
        return wrong(leaf, "section table cut off, or reserved bytes");
    if (leaf->segments_before ? !naive_zeros(b, 1512, 1524) || !naive_number(b + 1524, 4) ||
                                    !naive_number(b + 1504, 8)
                              : !naive_zeros(b, 1524, 1536))
        return wrong(leaf, "what the header says of segments");
    if (!naive_text(b + 1424, 64))
        return wrong(leaf, "the name of the first field");
    return read_text(leaf, 256, 64, leaf->name) && read_text(leaf, 320, 1024, leaf->provenance) &&
           (naive_hashes(leaf->bytes, sections) || wrong(leaf, "the header's checksum or id"));
}

static bool check_to_world(naive_leaf *leaf) {
    double(*m)[4] = leaf->to_world;
    double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    for (int i = 0; i < 12; i++)
        if (!isfinite(m[i / 4][i % 4]))
            return wrong(leaf, "to_world is not finite");
    return determinant != 0 || wrong(leaf, "to_world is not invertible");
}

/* ---- 1. levels and treelets ---- */

/* The levels that the dims imply, and their treelets in treelet order; memory for all samples. */
static bool lay_out(naive_leaf *leaf) {
    long side = 1L << leaf->cells_log2, total = 0;
    int levels = 0;
    for (bool fits = false; !fits; levels++) {
        if (levels == NAIVE_LEVELS_MAX)
            return wrong(leaf, "too many levels");
        naive_level *l = &leaf->level[levels];
        fits = true;
        for (int a = 0; a < 3; a++) {
            l->cells[a] =
                levels == 0 ? leaf->dims[a] - 1 : (leaf->level[levels - 1].cells[a] + 1) / 2;
            l->nodes[a] = l->cells[a] + 1;
            l->treelets[a] = (l->cells[a] + side - 1) / side;
            fits = fits && l->cells[a] <= side;
        }
        total += l->treelets[0] * l->treelets[1] * l->treelets[2];
    }
    if (leaf->bare && levels == 1)
        return wrong(leaf, "bare, of one level");
    if (levels != leaf->levels || (uint64_t)total != naive_number(leaf->bytes + 80, 8))
        return wrong(leaf, "%d levels, %ld treelets are implied", levels, total);
    if ((uint64_t)total > leaf->size / (uint64_t)leaf->sets)
        return wrong(leaf, "more treelets than bytes");
    leaf->treelet_count = total;
    leaf->treelets = calloc((size_t)(total * leaf->sets), sizeof leaf->treelets[0]);
    for (int i = 0; i < levels; i++) {
        naive_level *l = &leaf->level[i];
        size_t count = (size_t)l->nodes[0] * (size_t)l->nodes[1] * (size_t)l->nodes[2];
        l->samples = malloc(count * sizeof l->samples[0]);
        l->known = calloc(count, 1);
        if (!l->samples || !l->known)
            return wrong(leaf, "no memory");
    }
    return leaf->treelets != NULL || wrong(leaf, "no memory");
}

static void add_treelet(naive_leaf *leaf, long *count, int level, const long at[3], long parent) {
    naive_treelet *t = &leaf->treelets[(*count)++];
    long side = 1L << leaf->cells_log2;
    t->level = level;
    t->parent = parent;
    for (int a = 0; a < 3; a++) {
        long left = leaf->level[level].cells[a] - side * at[a];
        t->at[a] = at[a];
        t->cells[a] = left < side ? left : side;
    }
}

static bool order_treelets(naive_leaf *leaf) {
    const long origin[3] = {0, 0, 0};
    long count = 0, first = 0;
    add_treelet(leaf, &count, leaf->levels - 1, origin, -1);
    for (int level = leaf->levels - 2; level >= 0; level--) {
        long end = count;
        for (long p = first; p < end; p++)
            for (int octant = 0; octant < 8; octant++) {
                const long *at = leaf->treelets[p].at, *exist = leaf->level[level].treelets;
                long child[3];
                for (int a = 0; a < 3; a++)
                    child[a] = 2 * at[a] + (octant >> a & 1);
                if (child[0] < exist[0] && child[1] < exist[1] && child[2] < exist[2])
                    add_treelet(leaf, &count, level, child, p);
            }
        first = end;
    }
    leaf->shell_count = leaf->codec == 1 ? first : 0;
    return count == leaf->treelet_count || wrong(leaf, "the treelets do not add up");
}

/* Those of each further set are as those of the first. */
static bool repeat_treelets(naive_leaf *leaf) {
    const long n = leaf->treelet_count;
    for (long i = n; i < n * leaf->sets; i++) {
        naive_treelet *t = &leaf->treelets[i];
        *t = leaf->treelets[i % n];
        t->parent += t->parent < 0 ? 0 : i / n * n;
    }
    return true;
}

/* ---- 3. sections ---- */

static bool read_axes(naive_leaf *leaf, const unsigned char *at) {
    for (int a = 0; a < 3; a++) {
        leaf->axis[a] = malloc((size_t)leaf->dims[a] * sizeof leaf->axis[a][0]);
        if (!leaf->axis[a])
            return wrong(leaf, "no memory");
        for (long i = 0; i < leaf->dims[a]; i++, at += 8) {
            leaf->axis[a][i] = naive_real64(at);
            if (!isfinite(leaf->axis[a][i]) ||
                (i > 0 && !(leaf->axis[a][i] > leaf->axis[a][i - 1])))
                return wrong(leaf, "axis %d at %ld", a, i);
        }
    }
    return true;
}

static bool read_labels(naive_leaf *leaf, const unsigned char *names, const unsigned char *times) {
    const char *why = naive_labels(leaf->bytes, names, leaf->fields, times, leaf->steps,
                                   &leaf->field_names, &leaf->times);
    return !why || wrong(leaf, "%s", why);
}

static bool find_sections(naive_leaf *leaf) {
    enum { OPTIONAL = 1 << NAIVE_FIELDS | 1 << NAIVE_TIMES | 1 << NAIVE_SAME | 1 << NAIVE_BASES };
    const uint64_t treelets = (uint64_t)(leaf->treelet_count * leaf->sets);
    const uint64_t payloads = (uint64_t)((leaf->treelet_count + leaf->shell_count) * leaf->sets);
    const bool grows = leaf->segments_before || naive_number(leaf->bytes + 1520, 4);
    const bool series = leaf->sets > 1 || leaf->segments_before;
    const uint64_t want[NAIVE_KINDS] = {
        [NAIVE_RANGES] = 8 * treelets,
        [NAIVE_OWN] = 8 * treelets,
        [NAIVE_FLAGS] = treelets,
        [NAIVE_OFFSETS] = 8 * payloads,
        [NAIVE_SIZES] = 8 * payloads,
        [NAIVE_CHECKSUMS] = 8 * payloads,
        [NAIVE_AXES] =
            leaf->rectilinear ? 8 * (uint64_t)(leaf->dims[0] + leaf->dims[1] + leaf->dims[2]) : 0,
        [NAIVE_FIELDS] = 64 * (uint64_t)leaf->fields,
        [NAIVE_TIMES] = leaf->steps > 1 || grows ? 8 * (uint64_t)leaf->steps : 0,
        [NAIVE_OUTSIDE] = leaf->outside ? 4608 : 0,
        [NAIVE_CHUNKS] = 16 * (uint64_t)leaf->outside_chunks,
        [NAIVE_SLICES] = leaf->in_slices ? 280 * (uint64_t)leaf->dims[2] : 0,
        [NAIVE_SAME] = series ? 4 * payloads : 0,
        [NAIVE_BASES] = series && leaf->codec == 1 ? 4 * payloads : 0};
    if (!naive_sections_find(&leaf->sections, leaf->bytes, leaf->size, want, OPTIONAL))
        return wrong(leaf, "%s", leaf->sections.why);
    return !leaf->sections.deviations || !leaf->bare ||
           wrong(leaf, "deviations of levels without samples");
}

/* ---- 4. payloads ---- */

/* The node of the level at (i, j, k) of the treelet's samples; whether it is one without clamping.
 */
static bool node_of(const naive_leaf *leaf, const naive_treelet *t, const long i[3], long node[3]) {
    bool own = true;
    for (int a = 0; a < 3; a++) {
        long n = (t->at[a] << leaf->cells_log2) - leaf->halo + i[a],
             end = leaf->level[t->level].nodes[a] - 1;
        node[a] = n < 0 ? 0 : n > end ? end : n;
        own = own && i[a] >= leaf->halo && i[a] <= leaf->halo + t->cells[a];
    }
    return own;
}

static size_t node_index(const naive_level *l, const long n[3]) {
    return (size_t)n[0] + (size_t)l->nodes[0] * ((size_t)n[1] + (size_t)l->nodes[1] * (size_t)n[2]);
}

static bool same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Put the treelet's samples where they belong. own: those of its cells, which may be there already
 * and then agree; not own: the halo, which must agree with what the others have put there. */
static bool place_samples(naive_leaf *leaf, const naive_treelet *t, const naive_window *w,
                          bool own) {
    naive_level *l = &leaf->level[t->level];
    long i[3], node[3];
    size_t n = 0;
    for (i[2] = 0; i[2] < w->size[2]; i[2]++)
        for (i[1] = 0; i[1] < w->size[1]; i[1]++)
            for (i[0] = 0; i[0] < w->size[0]; i[0]++, n++) {
                if (node_of(leaf, t, i, node) != own)
                    continue;
                size_t at = node_index(l, node);
                if (own && !l->known[at]) {
                    l->samples[at] = w->samples[n];
                    l->known[at] = true;
                } else if (!l->known[at] || !same_bits(l->samples[at], w->samples[n])) {
                    return wrong(leaf, "level %d node %ld %ld %ld is %g here, %g there", t->level,
                                 node[0], node[1], node[2], (double)w->samples[n],
                                 (double)l->samples[at]);
                }
            }
    return true;
}

static bool check_own_range(naive_leaf *leaf, const naive_treelet *t, const naive_window *w) {
    const long from[3] = {leaf->halo, leaf->halo, leaf->halo};
    const long to[3] = {leaf->halo + t->cells[0], leaf->halo + t->cells[1],
                        leaf->halo + t->cells[2]};
    float lo, hi;
    bool all_finite = naive_finite_range(w, from, to, &lo, &hi);
    if (lo != t->own[0] || hi != t->own[1])
        return wrong(leaf, "own range %g %g, not %g %g", (double)t->own[0], (double)t->own[1],
                     (double)lo, (double)hi);
    return all_finite == !t->has_non_finite || wrong(leaf, "the flag of non-finite samples");
}

static uint64_t sample_count(const naive_leaf *leaf, const naive_treelet *t) {
    uint64_t count = 1;
    for (int a = 0; a < 3; a++)
        count *= (uint64_t)(t->cells[a] + 1 + 2 * leaf->halo);
    return count;
}

static uint64_t samples_at(const naive_leaf *leaf) {
    return naive_up_to(naive_codes_size(leaf), 64);
}

/* Of a raw payload, but for its samples: codes and zeros. */
static bool check_around(naive_leaf *leaf, const naive_treelet *t, const naive_window *w) {
    const unsigned char *payload = t->stored.at;
    const uint64_t codes = naive_codes_size(leaf), start = samples_at(leaf),
                   width = (uint64_t)naive_sample_bytes(leaf->sample_type);
    unsigned char *want = malloc(codes);
    if (!want)
        return wrong(leaf, "no memory");
    naive_codes_make(leaf, t, w, want);
    uint64_t same = 0;
    while (same < codes && payload[same] == want[same])
        same++;
    free(want);
    if (same < codes)
        return wrong(leaf, "code %llu of a treelet", (unsigned long long)same);
    return (naive_zeros(payload, codes, start) || wrong(leaf, "bytes behind the codes")) &&
           (naive_zeros(payload, start + sample_count(leaf, t) * width, t->payload_size) ||
            wrong(leaf, "bytes behind the samples"));
}

/* One treelet, whose samples are `held`: in the first pass (own) all that it says of itself, in the
 * second its halo. */
static bool read_treelet(naive_leaf *leaf, const naive_treelet *t, const unsigned char *held,
                         bool own) {
    naive_window w;
    const uint64_t count = sample_count(leaf, t);
    float *samples = malloc(count * sizeof samples[0]);
    if (!samples)
        return wrong(leaf, "no memory");
    for (uint64_t i = 0; i < count; i++)
        samples[i] = naive_sample(held, leaf->sample_type, i);
    for (int a = 0; a < 3; a++)
        w.size[a] = t->cells[a] + 1 + 2 * leaf->halo;
    w.samples = samples;
    bool good = !own || check_own_range(leaf, t, &w);
    if (good && own && (t->stored.size || t->outside))
        good = !naive_family_is_value(leaf, t, held, count) ||
               wrong(leaf, "a payload that the directory tells");
    if (good && own && t->stored.size && leaf->codec == 0)
        good = check_around(leaf, t, &w);
    good = good && place_samples(leaf, t, &w, own);
    free(samples);
    return good;
}

static unsigned char *hold_raw(const naive_leaf *leaf, const naive_treelet *t) {
    const size_t count = sample_count(leaf, t),
                 width = (size_t)naive_sample_bytes(leaf->sample_type);
    unsigned char value[4], *held = malloc(count * width);
    naive_family_value(leaf, t, value);
    if (held && t->stored.size)
        memcpy(held, t->stored.at + samples_at(leaf), count * width);
    else
        for (uint64_t i = 0; held && i < count; i++)
            memcpy(held + i * width, value, width);
    return held;
}

/* The samples of all treelets of a set, from `first` on, as they are in raw payloads. */
static bool hold_samples(naive_leaf *leaf, long first, unsigned char **held) {
    const naive_treelet *t = leaf->treelets + first;
    const char *why = NULL;
    for (long i = 0, count; !why && i < leaf->treelet_count; i += count) {
        for (count = 1; i + count < leaf->treelet_count && t[i + count].parent == t[i].parent;)
            count++;
        const bool bare = naive_leaf_is_bare(leaf, &t[i]);
        const bool coded = !bare && leaf->codec == 1 && !(leaf->outside && t[i].level == 0);
        if (coded)
            why = naive_family_read(leaf, t[i].parent, first + i, count, held + i);
        for (long n = i; n < i + count && !coded && !bare; n++)
            why = (held[n] = hold_raw(leaf, t + n)) ? why : "no memory";
    }
    for (long i = 0; !why && leaf->other && i < leaf->treelet_count; i++)
        why = naive_outside_hold(leaf, t + i, held[i]);
    return !why || wrong(leaf, "%s", why);
}

/* ---- 3. ranges ---- */

static bool read_ranges(naive_leaf *leaf) {
    const unsigned char *const *where = leaf->sections.where;
    for (long i = 0; i < leaf->treelet_count * leaf->sets; i++) {
        naive_treelet *t = &leaf->treelets[i];
        for (int n = 0; n < 2; n++) {
            t->merged[n] = naive_real32(where[NAIVE_RANGES] + 8 * i + 4 * n);
            t->own[n] = naive_real32(where[NAIVE_OWN] + 8 * i + 4 * n);
            if (naive_minus_zero(t->merged[n]) || naive_minus_zero(t->own[n]))
                return wrong(leaf, "treelet %ld: -0 in a range", i);
        }
        if (where[NAIVE_FLAGS][i] > 1)
            return wrong(leaf, "treelet %ld: flags", i);
        t->has_non_finite = where[NAIVE_FLAGS][i] == 1;
        t->payload_size =
            naive_up_to(samples_at(leaf) +
                            sample_count(leaf, t) * (uint64_t)naive_sample_bytes(leaf->sample_type),
                        64);
    }
    return true;
}

/* Merged ranges from below: children come after their parent. */
static bool check_merged(naive_leaf *leaf) {
    const long count = leaf->treelet_count * leaf->sets;
    float(*merged)[2] = malloc((size_t)count * sizeof merged[0]);
    if (!merged)
        return wrong(leaf, "no memory");
    bool good = true;
    for (long i = 0; i < count; i++)
        memcpy(merged[i], leaf->treelets[i].own, sizeof merged[i]);
    for (long i = count - 1; good && i >= 0; i--) {
        const naive_treelet *t = &leaf->treelets[i];
        good = (merged[i][0] == t->merged[0] && merged[i][1] == t->merged[1]) ||
               wrong(leaf, "treelet %ld: merged range", i);
        if (t->parent >= 0) {
            float *p = merged[t->parent];
            p[0] = merged[i][0] < p[0] ? merged[i][0] : p[0];
            p[1] = merged[i][1] > p[1] ? merged[i][1] : p[1];
        }
    }
    free(merged);
    return good;
}

/* What the header says of level 0, from all samples of all sets. */
typedef struct tally {
    double lo, hi;
    uint64_t non_finite;
} tally;

static void count_values(const naive_leaf *leaf, tally *t) {
    const naive_level *l = &leaf->level[0];
    size_t count = (size_t)l->nodes[0] * (size_t)l->nodes[1] * (size_t)l->nodes[2];
    for (size_t i = 0; i < count; i++) {
        double value = (double)l->samples[i];
        if (!isfinite(value)) {
            t->non_finite++;
            continue;
        }
        t->lo = value < t->lo ? value : t->lo;
        t->hi = value > t->hi ? value : t->hi;
    }
}

static bool check_values(naive_leaf *leaf, const tally *t) {
    if (t->lo != leaf->value_min || t->hi != leaf->value_max)
        return wrong(leaf, "value_min, value_max");
    return t->non_finite == leaf->non_finite || wrong(leaf, "non_finite");
}

/* Samples of another set take the place of those that are there. */
static bool read_set(naive_leaf *leaf, long set, tally *t) {
    const long n = leaf->treelet_count;
    unsigned char **held = calloc((size_t)n, sizeof held[0]);
    bool good = held ? hold_samples(leaf, set * n, held) : wrong(leaf, "no memory");
    for (int i = 0; i < leaf->levels; i++) {
        naive_level *l = &leaf->level[i];
        memset(l->known, 0, (size_t)(l->nodes[0] * l->nodes[1] * l->nodes[2]));
    }
    for (int own = 1; own >= 0; own--)
        for (long i = 0; good && i < n; i++)
            good = naive_leaf_is_bare(leaf, &leaf->treelets[i]) ||
                   read_treelet(leaf, &leaf->treelets[set * n + i], held[i], own);
    if (good)
        count_values(leaf, t);
    for (long i = 0; held && i < n; i++)
        free(held[i]);
    free(held);
    return good;
}

/* ---- loading ---- */

static bool read_file(naive_leaf *leaf, const char *path) {
    FILE *in = fopen(path, "rb");
    if (!in)
        return wrong(leaf, "cannot be opened");
    fseek(in, 0, SEEK_END);
    long size = ftell(in);
    rewind(in);
    leaf->size = size > 0 ? (size_t)size : 0;
    leaf->bytes = malloc(leaf->size + 1);
    bool good = leaf->bytes && fread(leaf->bytes, 1, leaf->size, in) == leaf->size;
    fclose(in);
    return good || wrong(leaf, "cannot be read");
}

bool naive_leaf_read(naive_leaf *leaf, const char *path, long set) {
    const unsigned char *const *where = leaf->sections.where;
    const char *why;
    tally t = {.lo = INFINITY, .hi = -INFINITY};
    bool good = read_header(leaf) && check_to_world(leaf) && lay_out(leaf) &&
                order_treelets(leaf) && repeat_treelets(leaf) && find_sections(leaf) &&
                read_ranges(leaf) && (!leaf->rectilinear || read_axes(leaf, where[NAIVE_AXES])) &&
                read_labels(leaf, where[NAIVE_FIELDS], where[NAIVE_TIMES]) &&
                (!leaf->outside ||
                 !(why = naive_outside_read(leaf, path, where[NAIVE_OUTSIDE], where[NAIVE_CHUNKS],
                                            where[NAIVE_SLICES], &leaf->other)) ||
                 wrong(leaf, "%s", why)) &&
                naive_places_read(leaf);
    /* The one that is asked for comes last, and stays. */
    for (long i = 1; good && i <= leaf->sets; i++)
        good = read_set(leaf, (set + i) % leaf->sets, &t);
    return good && check_merged(leaf) && check_values(leaf, &t);
}

/* Both sides of the layer of cells of a height field have the same samples. */
static bool check_heights(naive_leaf *leaf) {
    for (int v = 0; leaf->heights && v < (leaf->bare ? 1 : leaf->levels); v++) {
        const naive_level *l = &leaf->level[v];
        const size_t row = (size_t)l->nodes[0] * sizeof *l->samples;
        for (long k = 0; k < l->nodes[2]; k++)
            if (memcmp(l->samples + 2 * k * l->nodes[0], l->samples + (2 * k + 1) * l->nodes[0],
                       row) != 0)
                return wrong(leaf, "level %d: two heights at row %ld", v, k);
    }
    return true;
}

bool naive_leaf_load_set(naive_leaf *leaf, const char *path, long set) {
    memset(leaf, 0, sizeof *leaf);
    return read_file(leaf, path) && naive_leaf_read(leaf, path, set) && check_heights(leaf);
}

bool naive_leaf_load(naive_leaf *leaf, const char *path) {
    return naive_leaf_load_set(leaf, path, 0);
}

void naive_leaf_release(naive_leaf *leaf) {
    for (int i = 0; i < NAIVE_LEVELS_MAX; i++) {
        free(leaf->level[i].samples);
        free(leaf->level[i].known);
    }
    for (int a = 0; a < 3; a++)
        free(leaf->axis[a]);
    free(leaf->treelets);
    free(leaf->field_names);
    free(leaf->times);
    free(leaf->bytes);
    free(leaf->other);
    naive_sections_release(&leaf->sections);
    memset(leaf, 0, sizeof *leaf);
}

float naive_leaf_sample(const naive_leaf *leaf, int level, long i, long j, long k) {
    const long node[3] = {i, j, k};
    return leaf->level[level].samples[node_index(&leaf->level[level], node)];
}
