#include "formats/leaf/leaf_unpacker.h"

#include <assert.h>
#include <string.h>

#include <zstd.h>

#include "formats/leaf/grid_codes.h"
#include "formats/leaf/grid_coding.h"
#include "formats/leaf/leaf_between.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/live_samples.h"
#include "formats/leaf/outside_samples.h"
#include "formats/leaf/stream_coding.h"

enum { SHELLS = 4 }; /* that one keeps for itself */

struct leaf_unpacker {
    mem *m;
    leaf_file *f;
    const leaf_fetcher *by; /* during a load; NULL: leaf_file_fetch() */
    void *stored;
    ZSTD_DCtx *zstd;  /* of kinds whose payloads are frames */
    uint8_t *streams; /* of a kind that has a coder */
    size_t streams_room;
    /* Of grids: */
    box_coder *boxes;
    grid_codes_scratch *codes;
    leaf_shells *shells, *own; /* own: freed with it; NULL: shared, or none */
    void *shell_stored;
    void *outside;        /* room for samples that lie in another file */
    leaf_unpacker *below; /* of a file between the steps of another: that one's; NULL: it is raw */
    uint64_t beside_bytes;
};

/* The most bytes of streams of any payload of a kind that has a coder. */
static size_t streams_max(const leaf_file *f) {
    size_t most = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const size_t room = stream_coding_room(f->layout.geometry->coder, f->layout.counts[t]);
        most = room > most ? room : most;
    }
    return most;
}

static status begin_streams(leaf_unpacker *u) {
    u->streams_room = streams_max(u->f);
    u->streams = mem_alloc(u->m, u->streams_room);
    return u->streams ? ST_OK : ST_NOMEM;
}

static size_t shells_room(const leaf_layout *l) {
    return SHELLS * leaf_layout_shell_max(l) * sample_size(l->type);
}

static size_t room_outside(const leaf_file *f) {
    const uint32_t side = (1U << f->layout.cells_log2) + 1 + 2 * f->layout.halo;
    return outside_samples_room(f->samples, side);
}

/* shells: those of several unpackers; NULL: make its own. */
static status begin_grid(leaf_unpacker *u, leaf_shells *shells) {
    const leaf_layout *l = &u->f->layout;
    u->codes = mem_alloc(u->m, grid_codes_scratch_bytes(leaf_node_levels(l)));
    status st = u->codes ? box_coder_create(u->m, l->type, leaf_layout_code_max(l), 0, &u->boxes)
                         : ST_NOMEM;
    if (st == ST_OK && !shells)
        st = leaf_shells_create(u->m, l, 1, shells_room(l), &u->own);
    u->shells = shells ? shells : u->own;
    if (st == ST_OK && u->f->samples) {
        u->outside = mem_alloc(u->m, room_outside(u->f));
        st = u->outside ? ST_OK : ST_NOMEM;
    }
    if (st != ST_OK || !l->shells)
        return st;
    u->shell_stored = mem_alloc(u->m, leaf_layout_stored_max(l));
    return u->shell_stored ? ST_OK : ST_NOMEM;
}

status leaf_unpacker_create(mem *m, leaf_file *f, leaf_unpacker **out) {
    return leaf_unpacker_share(m, f, NULL, out);
}

status leaf_unpacker_share(mem *m, leaf_file *f, leaf_shells *shells, leaf_unpacker **out) {
    *out = NULL;
    if (f->header.codec == LEAF_CODEC_RAW)
        return ST_OK;
    leaf_unpacker *u = mem_zalloc(m, sizeof *u);
    if (!u)
        return ST_NOMEM;
    u->m = m;
    u->f = f;
    if (f->below) {
        const status made = leaf_unpacker_share(m, f->below, shells, &u->below);
        *out = made == ST_OK ? u : NULL;
        if (made != ST_OK)
            leaf_unpacker_destroy(u);
        return made;
    }
    u->stored = mem_alloc(m, leaf_layout_stored_max(&f->layout));
    u->zstd = ZSTD_createDCtx();
    status st = u->stored && u->zstd ? ST_OK : ST_NOMEM;
    if (st == ST_OK && f->layout.coded)
        st = begin_grid(u, shells);
    if (st == ST_OK && f->layout.geometry->coder)
        st = begin_streams(u);
    if (st != ST_OK) {
        leaf_unpacker_destroy(u);
        return st;
    }
    *out = u;
    return ST_OK;
}

void leaf_unpacker_destroy(leaf_unpacker *u) {
    if (!u)
        return;
    mem_free(u->m, u->stored);
    ZSTD_freeDCtx(u->zstd);
    mem_free(u->m, u->streams);
    box_coder_destroy(u->boxes);
    mem_free(u->m, u->codes);
    mem_free(u->m, u->shell_stored);
    mem_free(u->m, u->outside);
    leaf_shells_destroy(u->own);
    leaf_unpacker_destroy(u->below);
    mem_free(u->m, u);
}

size_t leaf_unpacker_memory(const leaf_file *f) {
    const leaf_layout *l = &f->layout;
    if (f->header.codec == LEAF_CODEC_RAW)
        return 0;
    if (f->below)
        return sizeof(leaf_unpacker) + leaf_unpacker_memory(f->below);
    size_t bytes = sizeof(leaf_unpacker) + leaf_layout_stored_max(l) + 1024;
    if (l->geometry->coder)
        bytes += streams_max(f);
    if (l->coded)
        bytes += grid_codes_scratch_bytes(leaf_node_levels(l)) +
                 box_coder_memory(l->type, leaf_layout_code_max(l));
    if (f->samples)
        bytes += room_outside(f);
    if (l->shells)
        bytes += leaf_shells_memory(l, 1, shells_room(l)) + leaf_layout_stored_max(l);
    return bytes;
}

status leaf_unpackers_create(mem *m, leaf_file *f, int count, leaf_unpacker ***out) {
    leaf_unpacker **list = mem_array(m, (size_t)count, sizeof(leaf_unpacker *));
    status st = list ? ST_OK : ST_NOMEM;
    for (int i = 0; i < count && st == ST_OK; i++)
        st = leaf_unpacker_create(m, f, &list[i]);
    if (st != ST_OK) {
        leaf_unpackers_destroy(m, list, count);
        return st;
    }
    *out = list;
    return ST_OK;
}

void leaf_unpackers_destroy(mem *m, leaf_unpacker **list, int count) {
    for (int i = 0; list && i < count; i++)
        leaf_unpacker_destroy(list[i]);
    mem_free(m, list);
}

uint64_t leaf_unpacker_take(leaf_unpacker *u) {
    const uint64_t bytes = u ? u->beside_bytes : 0;
    if (u)
        u->beside_bytes = 0;
    return bytes;
}

static status malformed(const leaf_unpacker *u, uint32_t p, const char *why) {
    char name[LEAF_NAME_MAX];
    return status_describe(ST_CORRUPT, "%s: byte %llu: %s does not decompress to %u bytes: %s",
                           file_path(u->f->source), (unsigned long long)u->f->offsets[p],
                           leaf_layout_payload_name(&u->f->layout, p, name),
                           leaf_layout_payload_bytes(&u->f->layout, p), why);
}

static status unframe(leaf_unpacker *u, uint32_t p, const void *stored, void *payload) {
    const size_t bytes = leaf_layout_payload_bytes(&u->f->layout, p);
    const size_t got = ZSTD_decompressDCtx(u->zstd, payload, bytes, stored, (size_t)u->f->sizes[p]);
    if (got == bytes)
        return ST_OK;
    return malformed(u, p,
                     ZSTD_isError(got) ? ZSTD_getErrorName(got) : "it decompresses to fewer bytes");
}

static status decode_streams(leaf_unpacker *u, uint32_t p, const void *stored, void *payload) {
    const leaf_layout *l = &u->f->layout;
    const uint32_t t = p % l->treelets;
    uint32_t index;
    const leaf_block block = leaf_layout_block_of(l, p, &index);
    const float(*bounds)[6] = l->geometry->section(u->f, LEAF_SECTION_BOUNDS);
    const size_t got =
        ZSTD_decompressDCtx(u->zstd, u->streams, u->streams_room, stored, (size_t)u->f->sizes[p]);
    if (ZSTD_isError(got))
        return malformed(u, p, ZSTD_getErrorName(got));
    if (!l->geometry->coder->decode(block, l->counts[t], bounds[t], u->streams, got, payload))
        return malformed(u, p, "its streams are malformed");
    return ST_OK;
}

static status fetch(leaf_file *f, uint32_t p, const leaf_fetcher *by, void *stored) {
    return by ? by->fetch(by->ctx, p, stored) : leaf_file_fetch(f, p, stored);
}

/* The codes that a payload's samples rest on, and how many of them are to be read, from the last of
 * these to the first. */
typedef struct codes {
    uint32_t chain[LEAF_CHAIN_MAX];
    int count, wanted;
} codes;

static codes codes_of(const leaf_file *f, uint32_t p) {
    codes c;
    c.count = c.wanted = leaf_file_chain(f, p, c.chain);
    return c;
}

/* Of payload p, if the samples of q are there. */
static codes codes_after(const leaf_file *f, uint32_t p, uint32_t q) {
    const uint32_t home = leaf_file_home(f, q);
    codes c = codes_of(f, p);
    for (int i = 0; i < c.count; i++)
        if (c.chain[i] == home)
            c.wanted = i;
    return c;
}

/* Read codes. stored: room for one. */
static status read_codes(leaf_unpacker *u, const codes *c, void *stored, void *to) {
    for (int i = c->wanted; i-- > 0;) {
        const uint32_t q = c->chain[i];
        const status st = fetch(u->f, q, u->by, stored);
        if (st != ST_OK)
            return st;
        u->beside_bytes += u->f->sizes[q];
        if (!grid_coding_unpack(&u->f->layout, q, u->boxes, stored, (size_t)u->f->sizes[q],
                                i + 1 < c->count, to))
            return malformed(u, q, "its code of samples is malformed");
    }
    return ST_OK;
}

/* Shells that it rests on may be decoded already. */
static status read_shell(leaf_unpacker *u, uint32_t p, void *samples) {
    codes c = codes_of(u->f, p);
    for (int i = 1; i < c.count && c.wanted == c.count; i++)
        if (leaf_shells_copy(u->shells, c.chain[i], samples))
            c.wanted = i;
    return read_codes(u, &c, u->shell_stored, samples);
}

/* Copy what treelet t has of its family's shell, which is payload p, a home. */
static status take_shell(leaf_unpacker *u, uint32_t p, uint32_t parent, uint32_t t, void *payload) {
    void *samples;
    const bool made = leaf_shells_hold(u->shells, p, &samples);
    const status st = made ? ST_OK : read_shell(u, p, samples);
    if (st == ST_OK)
        grid_family_take(&u->f->layout, parent, t, samples, payload);
    leaf_shells_release(u->shells, p, st == ST_OK);
    return st;
}

/* The shell that treelet payload p needs; LEAF_NO_TREELET: none. */
static uint32_t shell_of(const leaf_file *f, uint32_t p, uint32_t *parent) {
    const leaf_layout *l = &f->layout;
    const uint32_t t = p % l->treelets;
    if (t == 0)
        return LEAF_NO_TREELET;
    *parent = leaf_layout_parent(l, t);
    const uint32_t shell = leaf_layout_shell(l, p / l->treelets, *parent);
    return f->sizes[shell] > 0 ? leaf_file_home(f, shell) : LEAF_NO_TREELET;
}

/* q: what payload has already; p itself: nothing. */
static status load_treelet(leaf_unpacker *u, uint32_t p, uint32_t q, void *payload) {
    const leaf_layout *l = &u->f->layout;
    const uint32_t t = p % l->treelets;
    uint32_t parent = 0;
    const uint32_t shell = shell_of(u->f, p, &parent);
    const codes c = q == p ? codes_of(u->f, p) : codes_after(u->f, p, q);
    const bool there = q != p && shell == shell_of(u->f, q, &parent);
    status st = read_codes(u, &c, u->stored, payload);
    if (st == ST_OK && shell != LEAF_NO_TREELET && !there)
        st = take_shell(u, shell, parent, t, payload);
    if (st != ST_OK)
        return st;
    (void)grid_codes_make(l, t, u->codes, payload);
    u->beside_bytes -= u->f->sizes[p]; /* which callers count */
    return ST_OK;
}

static status load_coded(leaf_unpacker *u, uint32_t p, void *payload) {
    const leaf_layout *l = &u->f->layout;
    const codes c = codes_of(u->f, p);
    if (p < l->sets * l->treelets)
        return load_treelet(u, p, p, payload);
    const status st = read_codes(u, &c, u->stored, payload);
    u->beside_bytes -= st == ST_OK ? u->f->sizes[p] : 0;
    return st;
}

static status load_frame(leaf_unpacker *u, uint32_t p, void *payload) {
    const status st = fetch(u->f, p, u->by, u->stored);
    if (st != ST_OK)
        return st;
    return u->f->layout.geometry->coder ? decode_streams(u, p, u->stored, payload)
                                        : unframe(u, p, u->stored, payload);
}

/* The samples of payload p, of a treelet of level 0, in the other file. */
static outside_box box_outside(const leaf_layout *l, uint32_t p) {
    const uint32_t t = p % l->treelets;
    const leaf_payload shape = leaf_layout_payload(l, t);
    outside_box b;
    for (int a = 0; a < 3; a++) {
        b.first[a] = ((int64_t)l->place[t][a] << l->cells_log2) - l->halo;
        b.size[a] = shape.samples[a];
    }
    return b;
}

uint32_t leaf_file_rows(const leaf_file *f) {
    const uint32_t *treelets = f->layout.level[0].treelets;
    const bool shared =
        f->samples && outside_samples_are_shared(f->samples, 1u << f->layout.cells_log2);
    return shared ? treelets[1] * treelets[2] : 0;
}

uint32_t leaf_file_row(const leaf_file *f, uint32_t p) {
    const uint32_t *place = f->layout.place[p];
    return place[2] * f->layout.level[0].treelets[1] + place[1];
}

uint64_t leaf_file_bytes_outside(const leaf_file *f, uint32_t p) {
    if (!leaf_file_is_outside(f, p))
        return 0;
    const outside_box b = box_outside(&f->layout, p);
    if (f->live)
        return (uint64_t)b.size[0] * b.size[1] * b.size[2] * sample_size(f->layout.type);
    return outside_samples_bytes(f->samples, &b);
}

/* Copy the samples of a treelet that lie in memory, and change from step to step. */
static status load_live(leaf_unpacker *u, uint32_t p, void *payload) {
    const leaf_file *f = u->f;
    const uint32_t t = p % f->layout.treelets;
    const outside_box b = box_outside(&f->layout, p);
    char *samples = (char *)payload + leaf_layout_payload(&f->layout, t).samples_at;
    live_samples_load(f->live, (int)(p / f->layout.treelets), b.first, b.size, samples);
    u->beside_bytes += leaf_file_bytes_outside(f, p);
    (void)grid_codes_make(&f->layout, t, u->codes, payload);
    return ST_OK;
}

/* Let one part have what the other one has, if that is `fit` to be there. */
static void move_part(leaf_unpacker *u, uint32_t p, int part, uint32_t needed, void *payload,
                      bool (*fit)(const leaf_file *f, uint32_t needed, uint32_t has)) {
    leaf_file *below = u->f->below;
    uint32_t *has, *other_has;
    void *to = leaf_between_part(u->f, p, payload, part, &has);
    const void *other = leaf_between_part(u->f, p, payload, !part, &other_has);
    if (*other_has == LEAF_NO_TREELET || !fit(below, needed, *other_has))
        return;
    memcpy(to, other, leaf_layout_payload_bytes(&below->layout, needed));
    *has = *other_has;
}

/* Read payload `needed` of the file below, or none, into a part that has another one, or nothing.
 */
static status load_part(leaf_unpacker *u, uint32_t p, int part, uint32_t needed, void *payload) {
    leaf_file *below = u->f->below;
    uint32_t *has;
    void *to = leaf_between_part(u->f, p, payload, part, &has);
    if (needed == LEAF_NO_TREELET) {
        *has = needed;
        return ST_OK;
    }
    if (*has == LEAF_NO_TREELET || !leaf_file_helps(below, needed, *has))
        move_part(u, p, part, needed, payload, leaf_file_helps);
    const status st = *has == LEAF_NO_TREELET
                          ? leaf_file_load(below, needed, u->below, to)
                          : leaf_file_load_after(below, needed, u->below, NULL, *has, to);
    *has = st == ST_OK ? needed : LEAF_NO_TREELET;
    u->beside_bytes += below->sizes[needed] + leaf_unpacker_take(u->below);
    return st;
}

/* Load a payload that is the one of the file below. */
static status load_below(leaf_unpacker *u, uint32_t p, void *payload) {
    leaf_file *below = u->f->below;
    const uint32_t q = leaf_between_needs(u->f, p).of[0];
    u->beside_bytes += below->sizes[q];
    return leaf_file_load(below, q, u->below, payload);
}

/* Load the payloads of both steps that a payload needs, as far as it does not have them. */
static status load_between(leaf_unpacker *u, uint32_t p, void *payload) {
    const leaf_blend needs = leaf_between_needs(u->f, p);
    status st = ST_OK;
    /* Playing on, the second step becomes the first, and backwards the other way round. */
    for (int i = 0; i < LEAF_BETWEEN_PARTS; i++)
        if (needs.of[i] != LEAF_NO_TREELET && leaf_between_lacks(u->f, p, payload, i))
            move_part(u, p, i, needs.of[i], payload, leaf_file_same);
    for (int i = 0; i < LEAF_BETWEEN_PARTS && st == ST_OK; i++)
        if (leaf_between_lacks(u->f, p, payload, i))
            st = load_part(u, p, i, needs.of[i], payload);
    return st;
}

static status load_outside(leaf_unpacker *u, uint32_t p, void *payload) {
    const leaf_file *f = u->f;
    const leaf_payload shape = leaf_layout_payload(&f->layout, p);
    const outside_box b = box_outside(&f->layout, p);
    char *samples = (char *)payload + shape.samples_at;
    const status st = outside_samples_load(f->samples, &b, u->outside, samples, &u->beside_bytes);
    if (st != ST_OK)
        return st;
    const uint64_t sum =
        outside_samples_sum(samples, leaf_payload_sample_bytes(&shape, f->layout.type));
    char where[OUTSIDE_SAMPLES_TEXT];
    if (sum != f->checksums[p])
        return status_describe(ST_CORRUPT,
                               "%s: the samples of treelet %u have the checksum %016llx, expected "
                               "%016llx",
                               outside_samples_print(f->samples, &b, where), p,
                               (unsigned long long)sum, (unsigned long long)f->checksums[p]);
    (void)grid_codes_make(&f->layout, p, u->codes, payload);
    return ST_OK;
}

status leaf_file_check_implied(leaf_file *f, uint32_t p, leaf_unpacker *u, void *payload) {
    const leaf_layout *l = &f->layout;
    if (!leaf_layout_is_outside(l, p) || !leaf_file_is_implied(f, p))
        return ST_OK;
    const outside_box b = box_outside(l, p);
    char *samples = (char *)payload + leaf_layout_payload(l, p).samples_at;
    char where[OUTSIDE_SAMPLES_TEXT];
    const status st = outside_samples_load(f->samples, &b, u->outside, samples, &u->beside_bytes);
    if (st != ST_OK || l->geometry->implies(l, p, f->own[p], f->flags[p], payload))
        return st;
    return status_describe(ST_CORRUPT,
                           "%s: the samples of treelet %u are not all the same, as they were",
                           outside_samples_print(f->samples, &b, where), p);
}

static status refuse_bare(const leaf_file *f, uint32_t p) {
    const leaf_layout *l = &f->layout;
    const uint32_t t = p % l->treelets;
    return status_describe(ST_UNSUPPORTED, "%s: treelet %u is of level %u, which has no samples",
                           file_path(f->source), t, l->level_of[t]);
}

status leaf_file_load_by(leaf_file *f, uint32_t p, leaf_unpacker *u, const leaf_fetcher *by,
                         void *payload) {
    const leaf_layout *l = &f->layout;
    if (f->below && !leaf_between_is_made_of(f, p))
        return load_below(u, p, payload);
    if (f->below) {
        leaf_between_begin(f, p, payload);
        return load_between(u, p, payload);
    }
    if (leaf_file_is_implied(f, p)) {
        l->geometry->imply(l, p % l->treelets, f->own[p], payload);
        return ST_OK;
    }
    if (leaf_file_is_bare(f, p))
        return refuse_bare(f, p);
    if (leaf_file_is_raw(f, p))
        return fetch(f, p, by, payload);
    assert(u && u->f == f);
    if (f->live)
        return load_live(u, p, payload);
    if (leaf_file_is_outside(f, p))
        return load_outside(u, p, payload);
    u->by = by;
    return l->coded ? load_coded(u, p, payload) : load_frame(u, p, payload);
}

bool leaf_file_helps(const leaf_file *f, uint32_t p, uint32_t q) {
    if (!f->layout.coded || !leaf_file_has_bytes(f, p) || !leaf_file_has_bytes(f, q))
        return false;
    const codes c = codes_after(f, p, q);
    return c.wanted < c.count;
}

status leaf_file_load_after(leaf_file *f, uint32_t p, leaf_unpacker *u, const leaf_fetcher *by,
                            uint32_t q, void *payload) {
    if (f->below)
        return load_between(u, p, payload);
    if (!leaf_file_helps(f, p, q))
        return leaf_file_load_by(f, p, u, by, payload);
    u->by = by;
    return load_treelet(u, p, q, payload);
}

status leaf_file_load(leaf_file *f, uint32_t p, leaf_unpacker *u, void *payload) {
    return leaf_file_load_by(f, p, u, NULL, payload);
}
