#include "prep/grid/convert_plan.h"

#include <math.h>

#include "formats/leaf/histogram_draw.h"
#include "formats/leaf/leaf_check.h"
#include "prep/grid/deviation_build.h"
#include "prep/grid/pyramid.h"
#include "prep/grid/read_ahead.h"
#include "prep/grid/treelet_build.h"

/* Memory not counted elsewhere: the thread pool, touched parts of stacks, rounding of blocks. */
enum { FIXED_BYTES = 256 << 10, THREAD_BYTES = 64 << 10, SPILLED_AHEAD_MAX = 32, AHEAD_MIN = 2 };

/* So many bytes of slices go through the levels at once: they are still in a cache. */
enum { BATCH_BYTES = 4 << 20 };

slab_plan convert_plan_slab(const convert_plan *plan, uint32_t level, int threads) {
    return (slab_plan){.spilled = level < plan->spilled_levels,
                       .column_families = plan->column_families,
                       .threads = threads,
                       .ahead = level == 0 ? plan->ahead : 0};
}

uint32_t convert_plan_slices(const convert_plan *plan, uint32_t level) {
    uint32_t slices = plan->batch;
    for (uint32_t l = 0; l < level; l++)
        slices = slices / 2 + 2;
    uint32_t all = plan->layout.level[level].dims[2];
    return slices < all ? slices : all;
}

/* Returns the bytes needed in any case, whether slabs are in memory or in scratch files. */
static uint64_t fixed_memory(const grid *g, const convert_options *o, const leaf_layout *l,
                             uint64_t packer) {
    uint64_t thread = (l->coded ? leaf_layout_payload_max(l) : 0) +
                      (l->shells ? leaf_layout_shell_max(l) * sample_size(l->type) : 0) +
                      grid_codes_scratch_bytes(leaf_node_levels(l)) + packer + THREAD_BYTES;
    uint64_t bytes = leaf_writer_memory(l, o->threads, o->grow != NULL) +
                     (uint64_t)o->threads * thread + FIXED_BYTES;
    if (o->work)
        bytes += state_io_memory();
    if (o->file.histograms)
        bytes += histogram_draw_grid(g->dims).count * sizeof(histogram_cell);
    for (uint32_t level = 0; level + 1 < l->sampled; level++)
        bytes += pyramid_memory(sample_stored(g->type), l->level[level].dims, o->threads);
    if (o->file.deviations)
        bytes += deviation_count(l) * sizeof(uint16_t) + 64;
    for (uint32_t level = 0; level + 1 < l->sampled && o->file.deviations; level++)
        bytes += deviation_build_memory(l, level, grid_is_rectilinear(g), o->threads);
    return bytes;
}

static uint64_t slab_side_memory(const grid *g, const convert_options *o,
                                 const convert_plan *plan) {
    const leaf_layout *l = &plan->layout;
    const slab_plan read = convert_plan_slab(plan, 0, o->threads);
    uint64_t bytes = read_ahead_memory(g, slab_slots(l, 0, &read));
    if (o->work && plan->spilled_levels > 0) /* a slice at a time, when unfinished work is loaded */
        bytes += (uint64_t)g->dims[0] * g->dims[1] * sample_size(l->type) + 128;
    for (uint32_t level = 0; level < l->sampled; level++) {
        slab_plan held = convert_plan_slab(plan, level, o->threads);
        bytes += slab_memory(l, level, &held);
        if (level > 0) {
            const uint32_t *dims = l->level[level].dims;
            bytes +=
                ((uint64_t)dims[0] * dims[1] * sample_size(l->type) + slice_tiles_count(dims)) *
                    convert_plan_slices(plan, level) +
                4096;
        }
    }
    return bytes;
}

/* ---- sizes of the file ---- */

/* Families along one axis, grouped by the cells of their one or two treelets. There are up to three
 * such groups. */
typedef struct sort {
    uint64_t count;
    uint32_t cells[2]; /* 0: there is no second treelet */
} sort;

static int family_sorts(uint32_t cells, uint32_t b, sort sorts[3]) {
    int n = 0;
    uint32_t whole = cells / (2 * b), rest = cells % (2 * b);
    if (whole)
        sorts[n++] = (sort){whole, {b, b}};
    if (rest > b)
        sorts[n++] = (sort){1, {b, rest - b}};
    else if (rest)
        sorts[n++] = (sort){1, {rest, 0}};
    return n;
}

static uint64_t payload_size(const leaf_layout *l, const uint32_t cells[3]) {
    uint64_t samples = sample_size(l->type);
    for (int a = 0; a < 3; a++)
        samples *= cells[a] + 1 + 2 * l->halo;
    uint32_t codes = leaf_codes_at(l->cells_log2 - LEAF_BLOCK_LOG2 + 1);
    return leaf_layout_aligned(leaf_layout_aligned(codes, LEAF_ALIGN_LOG2) + samples,
                               LEAF_ALIGN_LOG2);
}

static uint64_t family_size(const leaf_layout *l, const sort *x, const sort *y, const sort *z) {
    uint64_t bytes = 0;
    for (int o = 0; o < 8; o++) {
        uint32_t cells[3] = {x->cells[o & 1], y->cells[o >> 1 & 1], z->cells[o >> 2]};
        if (cells[0] && cells[1] && cells[2])
            bytes += payload_size(l, cells);
    }
    return bytes;
}

/* Bytes in front of the payloads. */
static uint64_t directory_size(const leaf_layout *l, const grid *g, const convert_options *o) {
    const leaf_sets *sets = o->series ? &o->series->of.sets : NULL;
    const leaf_header h = {.kind = g->heights ? LEAF_KIND_HEIGHTS : LEAF_KIND_GRID,
                           .version = LEAF_VERSION,
                           .codec = o->file.codec,
                           .halo = l->halo,
                           .sample_type = l->type,
                           .treelets = l->treelets,
                           .cells_log2 = l->cells_log2,
                           .dims = {g->dims[0], g->dims[1], g->dims[2]},
                           .rectilinear = grid_is_rectilinear(g),
                           .outside = o->file.slices ? LEAF_IN_SLICES : o->file.outside != NULL,
                           .bare = l->sampled < l->levels,
                           .outside_chunks = o->file.chunk_count,
                           .fields = l->sets / l->steps,
                           .steps = l->steps};
    const bool there[LEAF_SECTION_LAST + 1] = {
        [LEAF_SECTION_FIELDS] = sets && sets->names, [LEAF_SECTION_TIMES] = sets && sets->times};
    uint64_t bytes = 0, sections = 0;
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++)
        if (leaf_section_bytes(&h, kind) && (!leaf_section_optional(kind) || there[kind])) {
            bytes += leaf_layout_aligned(leaf_section_bytes(&h, kind), LEAF_ALIGN_LOG2);
            sections++;
        }
    const bool ancillary[LEAF_ANCILLARY_LAST] = {o->file.histograms, o->file.deviations,
                                                 world_frame_is_told(&g->frame) ||
                                                     (sets && sets->time_unit)};
    for (uint32_t i = 0; i < LEAF_ANCILLARY_LAST; i++) {
        const uint64_t size = leaf_section_bytes(&h, LEAF_SECTION_HISTOGRAMS + i);
        if (ancillary[i] && size) {
            bytes += leaf_layout_aligned(size, LEAF_ALIGN_LOG2);
            sections++;
        }
    }
    bytes +=
        leaf_layout_aligned(LEAF_HEADER_BYTES + sections * sizeof(leaf_section), LEAF_ALIGN_LOG2);
    return leaf_layout_aligned(bytes, o->file.run_align_log2);
}

static void plan_sizes(convert_plan *plan, const grid *g, const convert_options *o) {
    const leaf_layout *l = &plan->layout;
    uint64_t bytes = 0;
    for (uint32_t level = o->file.outside ? 1 : 0; level < l->sampled; level++) {
        sort sorts[3][3];
        int n[3];
        for (int a = 0; a < 3; a++)
            n[a] = family_sorts(l->level[level].cells[a], 1u << l->cells_log2, sorts[a]);
        for (int i = 0; i < n[0] * n[1] * n[2]; i++) {
            const sort *x = &sorts[0][i % n[0]], *y = &sorts[1][i / n[0] % n[1]],
                       *z = &sorts[2][i / n[0] / n[1]];
            uint64_t count = x->count * y->count * z->count, family = family_size(l, x, y, z);
            plan->payload_bytes += count * family;
            bytes += count * leaf_layout_aligned(family, o->file.run_align_log2);
        }
    }
    plan->payload_bytes *= l->sets;
    plan->file_bytes = directory_size(l, g, o) + bytes * l->sets;
}

/* ---- choosing ---- */

/* Level-0 slabs stay in memory only if two of them take at most half the budget. */
static bool may_hold(const convert_plan *plan, const convert_options *o) {
    if (plan->spilled_levels > 0)
        return true;
    slab_plan held = {.spilled = false};
    return slab_memory(&plan->layout, 0, &held) <= o->memory / 4;
}

/* The least memory with this many spilled levels: single slices, columns one family wide. */
static uint64_t least_memory(const grid *g, const convert_options *o, const convert_plan *plan,
                             uint32_t spilled) {
    convert_plan least = *plan;
    least.spilled_levels = spilled;
    least.ahead = AHEAD_MIN;
    least.batch = 1;
    least.column_families = 1;
    return slab_side_memory(g, o, &least);
}

/* Slices at once, of those that are read ahead: the others are read meanwhile. */
static uint32_t batch_of(const grid *g, const convert_plan *plan) {
    const uint64_t slice = (uint64_t)g->dims[0] * g->dims[1] * sample_size(plan->layout.type);
    const uint64_t some = BATCH_BYTES / slice + 1, half = plan->ahead / 2;
    return (uint32_t)(some < half ? some : half);
}

/* With plan->spilled_levels given: choose the widest columns that fit, then read as far ahead as
 * fits, at most a slab. */
static bool choose_sizes(const grid *g, const convert_options *o, convert_plan *plan,
                         uint64_t room) {
    const uint32_t most = plan->spilled_levels ? SPILLED_AHEAD_MAX : 2u << plan->layout.cells_log2;
    for (uint32_t across = slab_families(&plan->layout, 0, 0);; across = (across + 1) / 2) {
        for (plan->ahead = most; plan->ahead >= AHEAD_MIN; plan->ahead /= 2) {
            plan->column_families = across;
            plan->batch = batch_of(g, plan);
            if (slab_side_memory(g, o, plan) <= room)
                return true;
        }
        if (across == 1)
            return false;
    }
}

/* The user's budget includes what is lent to importers. So raise plan->memory_least and
 * memory_in_core to cover that, too. */
static void count_lent(const mem *m, const convert_options *o, convert_plan *plan) {
    const double share = o->memory ? (double)m->lent / (double)o->memory : 0;
    plan->memory_least += (uint64_t)ceil((double)plan->memory_least * share);
    plan->memory_in_core += (uint64_t)ceil((double)plan->memory_in_core * share);
}

static status refuse(const mem *m, const convert_options *o, const convert_plan *plan) {
    return status_describe(
        ST_NOMEM,
        "a memory budget of %llu MiB is too small: this input needs %llu MiB with %d threads%s",
        (unsigned long long)((o->memory + m->lent) >> 20),
        (unsigned long long)((plan->memory_least >> 20) + 1), o->threads,
        m->lent ? ", half of it for the importer" : "");
}

status convert_plan_make(mem *m, const grid *g, const convert_options *o, convert_plan *plan) {
    *plan = (convert_plan){0};
    status st = leaf_layout_levels(&plan->layout, g->dims, o->file.cells_log2, o->file.halo,
                                   sample_stored(g->type));
    if (st == ST_OK && o->file.bare)
        leaf_layout_bare(&plan->layout);
    uint64_t packer = 0;
    const leaf_sets *sets = o->series ? &o->series->of.sets : NULL;
    if (st == ST_OK && !leaf_layout_repeat(&plan->layout, sets ? sets->fields : 1,
                                           sets ? sets->steps : 1, o->file.codec != LEAF_CODEC_RAW))
        st = status_describe(ST_UNSUPPORTED, "more than 2^32 - 2 payloads; use larger treelets");
    if (st == ST_OK)
        st = leaf_packer_memory(m, &plan->layout, NULL, NULL, &o->file, &packer);
    if (st != ST_OK)
        return st;
    plan_sizes(plan, g, o);
    uint64_t fixed = mem_used(m) + fixed_memory(g, o, &plan->layout, packer);
    /* Without spilling, the rule of may_hold() may ask for more. */
    slab_plan held = {.spilled = false};
    uint64_t rule = 4 * slab_memory(&plan->layout, 0, &held);
    plan->memory_in_core = fixed + least_memory(g, o, plan, 0);
    if (plan->memory_in_core < rule)
        plan->memory_in_core = rule;
    plan->memory_least = plan->memory_in_core;
    for (uint32_t k = 1; k <= plan->layout.sampled; k++) {
        uint64_t least = fixed + least_memory(g, o, plan, k);
        if (least < plan->memory_least)
            plan->memory_least = least;
    }
    count_lent(m, o, plan);
    for (uint32_t k = 0; k <= plan->layout.sampled; k++) {
        plan->spilled_levels = k;
        if (fixed > o->memory || !may_hold(plan, o) || !choose_sizes(g, o, plan, o->memory - fixed))
            continue;
        plan->memory = fixed + slab_side_memory(g, o, plan);
        for (uint32_t level = 0; level < k; level++) {
            held = convert_plan_slab(plan, level, o->threads);
            plan->spill_bytes += slab_spill_bytes(&plan->layout, level, &held);
        }
        return ST_OK;
    }
    return refuse(m, o, plan);
}
