#include "formats/leaf/leaf_layout.h"

#include <assert.h>
#include <string.h>

#include "formats/grid/grid.h"
#include "formats/leaf/grid_geometry.h"

static uint32_t halved_up(uint32_t n) {
    return n / 2 + (n & 1);
}

static leaf_payload payload_of(const leaf_layout *l, const uint32_t cells[3]) {
    leaf_payload p = {.node_levels = leaf_node_levels(l)};
    uint32_t count = 1;
    for (int a = 0; a < 3; a++) {
        p.cells[a] = cells[a];
        p.samples[a] = cells[a] + 1 + 2 * l->halo;
        count *= p.samples[a];
    }
    p.samples_at = leaf_aligned(leaf_codes_at(p.node_levels + 1));
    p.bytes = leaf_aligned(p.samples_at + count * (uint32_t)sample_size(l->type));
    if (l->beside) {
        p.beside = leaf_layout_beside(p.bytes, LEAF_BESIDE_SCRATCH(p.node_levels),
                                      leaf_aligned(p.samples_at + count * l->beside));
        p.bytes = leaf_layout_beside_end(&p.beside);
    }
    return p;
}

static uint32_t most_bytes(const leaf_layout *l) {
    const uint32_t b = 1U << l->cells_log2;
    return payload_of(l, (uint32_t[3]){b, b, b}).bytes;
}

/* Compute the dims of every level, up to the one whose cells fit a single treelet. A coarse level
 * has ceil(cells / 2) cells: each covers two fine ones, or the last fine one alone. */
static status level_dims(leaf_layout *l, const uint32_t dims[3]) {
    uint32_t b = 1u << l->cells_log2;
    uint32_t cells[3] = {dims[0] - 1, dims[1] - 1, dims[2] - 1};
    for (l->levels = 0;;) {
        if (l->levels == LEAF_LEVELS_MAX)
            return status_describe(ST_UNSUPPORTED, "more than %d levels of detail",
                                   LEAF_LEVELS_MAX);
        leaf_level *v = &l->level[l->levels++];
        for (int a = 0; a < 3; a++) {
            v->cells[a] = cells[a];
            v->dims[a] = cells[a] + 1;
            v->treelets[a] = (cells[a] + b - 1) / b;
        }
        l->sampled = l->levels;
        if (cells[0] <= b && cells[1] <= b && cells[2] <= b)
            return ST_OK;
        for (int a = 0; a < 3; a++)
            cells[a] = halved_up(cells[a]);
    }
}

status leaf_layout_levels(leaf_layout *l, const uint32_t dims[3], uint32_t cells_log2,
                          uint32_t halo, sample_type type) {
    memset(l, 0, sizeof *l);
    l->geometry = &grid_geometry;
    l->cells_log2 = cells_log2;
    l->halo = halo;
    l->type = type;
    assert(cells_log2 >= LEAF_CELLS_LOG2_MIN && cells_log2 <= LEAF_CELLS_LOG2_MAX && halo <= 1);
    for (int a = 0; a < 3; a++)
        if (dims[a] < 2 || dims[a] > GRID_DIM_MAX)
            return status_describe(ST_UNSUPPORTED,
                                   "%u samples along %c, where 2 to %d are possible", dims[a],
                                   "xyz"[a], GRID_DIM_MAX);
    status st = level_dims(l, dims);
    if (st != ST_OK)
        return st;
    uint64_t total = 0;
    for (uint32_t level = l->levels; level-- > 0;) {
        leaf_level *v = &l->level[level];
        uint64_t count = (uint64_t)v->treelets[0] * v->treelets[1] * v->treelets[2];
        if (total + count > LEAF_NO_TREELET - 1)
            return status_describe(ST_UNSUPPORTED, "more than 2^32 - 2 treelets; use larger ones");
        v->first = (uint32_t)total;
        v->count = (uint32_t)count;
        total += count;
    }
    l->treelets = l->payloads = (uint32_t)total;
    l->sets = l->steps = l->places = 1;
    l->payload_max = most_bytes(l);
    return ST_OK;
}

void leaf_layout_keep_beside(leaf_layout *l, uint32_t bytes) {
    l->beside = bytes;
    l->payload_max = most_bytes(l);
}

/* The octants of those children of the treelet at this place that exist on the level below. */
static uint8_t octants(const leaf_level *below, const uint32_t place[3]) {
    unsigned mask = 0;
    for (unsigned o = 0; o < 8; o++)
        if (2 * place[0] + (o & 1) < below->treelets[0] &&
            2 * place[1] + (o >> 1 & 1) < below->treelets[1] &&
            2 * place[2] + (o >> 2) < below->treelets[2])
            mask |= 1u << o;
    return (uint8_t)mask;
}

static status allocate(leaf_layout *l, mem *m) {
    l->m = m;
    l->first_child = mem_array(m, l->treelets, sizeof *l->first_child);
    l->place = mem_array(m, l->treelets, sizeof *l->place);
    l->level_of = mem_array(m, l->treelets, sizeof *l->level_of);
    if (l->first_child && l->place && l->level_of)
        return ST_OK;
    leaf_layout_release(l);
    return ST_NOMEM;
}

status leaf_layout_init(leaf_layout *l, mem *m, const uint32_t dims[3], uint32_t cells_log2,
                        uint32_t halo, sample_type type) {
    status st = leaf_layout_levels(l, dims, cells_log2, halo, type);
    if (st == ST_OK)
        st = allocate(l, m);
    if (st != ST_OK)
        return st;
    /* Go breadth first from the root: each treelet's children take the next free indices. */
    l->level_of[0] = (uint8_t)(l->levels - 1);
    uint32_t next = 1;
    for (uint32_t t = 0; t < l->treelets; t++) {
        uint32_t level = l->level_of[t];
        l->first_child[t] = level ? next : LEAF_NO_TREELET;
        if (!level)
            continue;
        unsigned mask = octants(&l->level[level - 1], l->place[t]);
        for (unsigned o = 0; o < 8; o++) {
            if (!(mask >> o & 1))
                continue;
            l->level_of[next] = (uint8_t)(level - 1);
            for (unsigned a = 0; a < 3; a++)
                l->place[next][a] = 2 * l->place[t][a] + (o >> a & 1);
            next++;
        }
    }
    assert(next == l->treelets);
    return ST_OK;
}

bool leaf_layout_repeat(leaf_layout *l, uint32_t fields, uint32_t steps, bool compressed) {
    l->coded = compressed;
    l->shells = compressed && l->levels > 1 ? l->level[0].first : 0;
    const uint64_t payloads = ((uint64_t)l->treelets + l->shells) * fields * steps;
    l->sets = fields * steps;
    l->steps = steps;
    l->payloads = (uint32_t)payloads;
    return payloads < LEAF_NO_TREELET;
}

void leaf_layout_flat(leaf_layout *l, const leaf_geometry *geometry, uint32_t treelets,
                      uint32_t payloads) {
    memset(l, 0, sizeof *l);
    l->geometry = geometry;
    l->levels = l->sampled = 1;
    l->type = SAMPLE_F32;
    l->treelets = l->level[0].count = treelets;
    l->payloads = payloads;
    l->sets = l->steps = l->places = 1;
}

status leaf_layout_init_flat(leaf_layout *l, mem *m) {
    status st = allocate(l, m);
    for (uint32_t t = 0; st == ST_OK && t < l->treelets; t++)
        l->first_child[t] = LEAF_NO_TREELET;
    return st;
}

uint64_t leaf_layout_block_count(uint64_t treelets, uint32_t fields, uint32_t steps, bool moving) {
    return treelets < LEAF_NO_TREELET
               ? treelets * (1 + (uint64_t)fields * steps + (moving ? steps - 1 : 0))
               : LEAF_NO_TREELET;
}

bool leaf_layout_blocks(leaf_layout *l, const leaf_geometry *geometry, uint64_t treelets,
                        uint32_t fields, uint32_t steps, bool moving) {
    const uint64_t count = leaf_layout_block_count(treelets, fields, steps, moving);
    if (count >= LEAF_NO_TREELET)
        return false;
    leaf_layout_flat(l, geometry, (uint32_t)treelets, (uint32_t)count);
    l->sets = fields * steps;
    l->steps = steps;
    l->places = moving ? steps : 1;
    return true;
}

bool leaf_layout_block_repeat(leaf_layout *l, uint32_t steps) {
    const uint32_t fields = l->sets / l->steps;
    const uint64_t count = leaf_layout_block_count(l->treelets, fields, steps, false);
    l->sets = fields * steps;
    l->steps = steps;
    l->payloads = (uint32_t)count;
    return count < LEAF_NO_TREELET;
}

int leaf_layout_block_rows(const leaf_layout *l, leaf_row *rows) {
    rows[0] = (leaf_row){leaf_layout_values(l, 0, 0), l->treelets};
    return 1;
}

leaf_series leaf_layout_block_series(const leaf_layout *l, uint32_t p) {
    uint32_t index;
    switch (leaf_layout_block_of(l, p, &index)) {
    case LEAF_BLOCK_TOPOLOGY: return (leaf_series){p, l->treelets, 0};
    case LEAF_BLOCK_VALUES: return leaf_series_of(p, leaf_layout_values(l, 0, 0), l->treelets);
    case LEAF_BLOCK_GRADIENTS:
        return leaf_series_of(p, leaf_layout_gradients(l, 0, 0), l->treelets);
    default: return leaf_series_of(p, leaf_layout_positions(l, 1, 0), l->treelets);
    }
}

void leaf_layout_release(leaf_layout *l) {
    if (!l->m)
        return;
    mem_free(l->m, l->first_child);
    mem_free(l->m, l->place);
    mem_free(l->m, l->level_of);
    l->first_child = NULL;
    l->place = NULL;
    l->level_of = NULL;
    l->m = NULL;
}

uint32_t leaf_layout_find(const leaf_layout *l, uint32_t level, const uint32_t place[3]) {
    assert(level < l->levels && place[0] < l->level[level].treelets[0] &&
           place[1] < l->level[level].treelets[1] && place[2] < l->level[level].treelets[2]);
    uint32_t t = 0;
    for (uint32_t v = l->levels - 1; v-- > level;) {
        unsigned shift = v - level;
        unsigned o =
            (place[0] >> shift & 1) | (place[1] >> shift & 1) << 1 | (place[2] >> shift & 1) << 2;
        unsigned below = leaf_layout_children(l, t) & ((1u << o) - 1);
        t = l->first_child[t] + (uint32_t)__builtin_popcount(below);
    }
    return t;
}

uint32_t leaf_layout_parent(const leaf_layout *l, uint32_t treelet) {
    const uint32_t *at = l->place[treelet];
    const uint32_t place[3] = {at[0] / 2, at[1] / 2, at[2] / 2};
    return leaf_layout_find(l, l->level_of[treelet] + 1U, place);
}

uint8_t leaf_layout_children(const leaf_layout *l, uint32_t treelet) {
    uint32_t level = l->level_of[treelet];
    return level ? octants(&l->level[level - 1], l->place[treelet]) : 0;
}

leaf_payload leaf_layout_payload(const leaf_layout *l, uint32_t treelet) {
    const leaf_level *v = &l->level[l->level_of[treelet]];
    uint32_t b = 1u << l->cells_log2, cells[3];
    for (int a = 0; a < 3; a++) {
        uint32_t left = v->cells[a] - l->place[treelet][a] * b;
        cells[a] = left < b ? left : b;
    }
    return payload_of(l, cells);
}

uint32_t leaf_layout_payload_bytes(const leaf_layout *l, uint32_t p) {
    return l->geometry->payload_bytes(l, p);
}

uint32_t leaf_layout_payload_max(const leaf_layout *l) {
    return l->payload_max;
}

size_t leaf_layout_own_samples(const leaf_layout *l, uint32_t treelet) {
    const leaf_payload p = leaf_layout_payload(l, treelet);
    const leaf_level *v = &l->level[l->level_of[treelet]];
    size_t samples = 1;
    for (int a = 0; a < 3; a++) {
        const uint32_t place = l->place[treelet][a];
        const bool shares = place % 2 || place + 1 < v->treelets[a];
        samples *= p.samples[a] - (shares ? 1 + 2 * l->halo : 0);
    }
    return samples;
}

size_t leaf_layout_shell_samples(const leaf_layout *l, uint32_t parent) {
    const leaf_level *v = &l->level[l->level_of[parent] - 1];
    const uint32_t b = 1U << l->cells_log2, shared = 1 + 2 * l->halo;
    size_t all = 1, own = 1;
    for (int a = 0; a < 3; a++) {
        const uint32_t left = v->cells[a] - l->place[parent][a] * 2 * b;
        const uint32_t cells = left < 2 * b ? left : 2 * b;
        all *= cells + shared;
        own *= cells + (cells > b ? 0 : shared);
    }
    return all - own;
}

size_t leaf_layout_shell_max(const leaf_layout *l) {
    const size_t b = (size_t)1 << l->cells_log2, all = 2 * b + 1 + 2 * l->halo;
    return all * all * all - 8 * b * b * b;
}

size_t leaf_layout_code_max(const leaf_layout *l) {
    const size_t side = ((size_t)1 << l->cells_log2) + 1 + 2 * l->halo;
    const size_t root = side * side * side, shell = leaf_layout_shell_max(l);
    return root > shell ? root : shell;
}

static uint32_t code_bytes(const leaf_layout *l, size_t samples) {
    return (uint32_t)(LEAF_CODE_BYTES + samples * sample_size(l->type));
}

uint32_t leaf_layout_stored(const leaf_layout *l, uint32_t p) {
    uint32_t set, parent;
    if (!l->coded)
        return leaf_layout_payload_bytes(l, p);
    return code_bytes(l, leaf_layout_is_shell(l, p, &set, &parent)
                             ? leaf_layout_shell_samples(l, parent)
                             : leaf_layout_own_samples(l, p % l->treelets));
}

uint32_t leaf_layout_stored_max(const leaf_layout *l) {
    return l->coded ? code_bytes(l, leaf_layout_code_max(l)) : l->payload_max;
}

bool leaf_layout_begins_run(const leaf_layout *l, uint32_t p) {
    return l->geometry->begins_run(l, p);
}

leaf_block leaf_layout_block_of(const leaf_layout *l, uint32_t p, uint32_t *index) {
    const uint32_t block = p / l->treelets;
    assert(p < l->payloads);
    *index = 0;
    if (block == 0)
        return LEAF_BLOCK_TOPOLOGY;
    *index = block - 1;
    if (*index < l->sets)
        return LEAF_BLOCK_VALUES;
    *index -= l->sets;
    if (*index < l->gradient_sets)
        return LEAF_BLOCK_GRADIENTS;
    *index -= l->gradient_sets;
    ++*index;
    return LEAF_BLOCK_POSITIONS;
}

void leaf_layout_set_counts(leaf_layout *l, const uint32_t (*counts)[4]) {
    uint32_t blocks[4] = {0, leaf_layout_values(l, 0, 0)};
    int n = 2;
    if (l->gradient_sets)
        blocks[n++] = leaf_layout_gradients(l, 0, 0);
    if (leaf_layout_moves(l))
        blocks[n++] = leaf_layout_positions(l, 1, 0);
    l->counts = counts;
    l->payload_max = 0;
    for (uint32_t t = 0; t < l->treelets; t++)
        for (int i = 0; i < n; i++) {
            const uint32_t bytes = leaf_layout_payload_bytes(l, blocks[i] + t);
            l->payload_max = bytes > l->payload_max ? bytes : l->payload_max;
        }
}

leaf_beside leaf_layout_block_beside(const leaf_layout *l, leaf_block block, uint32_t bytes,
                                     size_t scratch) {
    if (!l->beside || block == LEAF_BLOCK_TOPOLOGY)
        return (leaf_beside){0};
    return leaf_layout_beside(bytes, scratch, bytes);
}

leaf_series leaf_layout_series(const leaf_layout *l, uint32_t p) {
    return l->geometry->series(l, p);
}

static uint32_t led_to(const leaf_layout *l, uint32_t p, uint32_t entry) {
    const leaf_series s = leaf_layout_series(l, p);
    return leaf_series_payload(&s, entry - 1);
}

uint32_t leaf_layout_home(const leaf_layout *l, const leaf_links *links, uint32_t p) {
    return links->same && links->same[p] ? led_to(l, p, links->same[p]) : p;
}

int leaf_layout_chain(const leaf_layout *l, const leaf_links *links, uint32_t p,
                      uint32_t chain[LEAF_CHAIN_MAX]) {
    int count = 1;
    chain[0] = leaf_layout_home(l, links, p);
    for (; links->bases && links->bases[chain[count - 1]]; count++)
        chain[count] = led_to(l, chain[count - 1], links->bases[chain[count - 1]]);
    return count;
}

const char *leaf_layout_payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    return l->geometry->payload_name(l, p, text);
}
