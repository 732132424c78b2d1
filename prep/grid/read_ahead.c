#include "prep/grid/read_ahead.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/base/sample.h"
#include "formats/base/thread.h"

struct read_ahead {
    mem *m;
    volume *v;
    size_t slice_samples, slice_bytes; /* of the stored type */
    void *raw;                         /* one slice of the input's type, if that is larger */
    slice_ring ring;
    size_t tiles; /* bytes of a map */
    bool told;    /* maps come from the input; otherwise from a look at the samples */
    _Alignas(double) uint8_t quiet[SLICE_SAMPLE_MAX];
    pthread_t thread;
    bool started;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    /* Guarded by lock: slices [taken, filled) are there, of which the caller waits for `wanted`. */
    uint32_t filled, taken, needed, wanted;
    bool ended, quit;
    status_note note;
    read_ahead_facts facts;  /* the reader's own */
    read_ahead_facts *seen;  /* up to the end of the slice in each slot */
    read_ahead_facts handed; /* the caller's: up to the end of what it has */
    uint32_t done;           /* slices of an earlier run */
};

static uint64_t count_non_finite(const float *samples, size_t count) {
    uint64_t found = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &samples[i], sizeof bits);
        found += (bits & 0x7F800000u) == 0x7F800000u;
    }
    return found;
}

/* Count in busy tiles only: quiet samples are finite. */
static uint64_t count_in_tiles(const read_ahead *r, const float *slice, const uint8_t *busy) {
    const uint32_t *dims = volume_grid(r->v)->dims;
    uint64_t found = 0;
    for (size_t i = 0; i < r->tiles; i++) {
        const slice_tile t = slice_tiles_at(dims, i);
        for (uint32_t y = t.y; busy[i] && y < t.end_y; y++)
            found += count_non_finite(slice + (size_t)y * dims[0] + t.x, t.end_x - t.x);
    }
    return found;
}

static void add_sum(read_ahead_facts *f, const void *bytes, size_t size) {
    const uint64_t both[2] = {f->checksum, hash_bytes(bytes, size)};
    f->checksum = hash_bytes(both, sizeof both);
}

/* Checksums of slices follow from one another. Of rows of tiles that are all quiet the map tells.
 */
static void sum_slice(read_ahead *r, const char *slice, const uint8_t *busy) {
    const uint32_t *dims = volume_grid(r->v)->dims;
    const size_t row = SLICE_TILE * (r->slice_bytes / dims[1]);
    add_sum(&r->facts, busy, r->tiles);
    for (uint32_t i = 0; i < slice_tiles_along(dims[1]); i++) {
        const size_t left = r->slice_bytes - i * row;
        if (slice_tiles_row_busy(dims, busy, i))
            add_sum(&r->facts, slice + i * row, left < row ? left : row);
    }
}

static status read_samples(read_ahead *r, char *into) {
    sample_type type = volume_grid(r->v)->type;
    void *raw = r->raw ? r->raw : into;
    status st = volume_read(r->v, 1, raw);
    if (st != ST_OK)
        return st;
    r->facts.rounding_error = fmax(r->facts.rounding_error, volume_rounding(r->v));
    if (sample_stored(type) != type) {
        double error = sample_to_stored(type, raw, into, r->slice_samples);
        r->facts.rounding_error = fmax(r->facts.rounding_error, error);
    }
    return ST_OK;
}

static status read_slice(read_ahead *r, char *into, uint8_t *busy) {
    const grid *g = volume_grid(r->v);
    const sample_type type = sample_stored(g->type);
    const status st = r->told ? volume_read_tiles(r->v, 1, into, busy) : read_samples(r, into);
    if (st != ST_OK)
        return st;
    if (!r->told)
        slice_tiles_find(g->dims, sample_size(type), into, r->quiet, busy);
    if (type == SAMPLE_F32)
        r->facts.non_finite += count_in_tiles(r, (const float *)(const void *)into, busy);
    sum_slice(r, into, busy);
    return ST_OK;
}

/* Wait for a slot that may be filled. Returns false if the reader is to end. */
static bool wait_for_room(read_ahead *r) {
    pthread_mutex_lock(&r->lock);
    while (!r->quit && r->filled - r->needed == r->ring.slots)
        pthread_cond_wait(&r->changed, &r->lock);
    bool go = !r->quit;
    pthread_mutex_unlock(&r->lock);
    return go;
}

static bool must_quit(read_ahead *r) {
    pthread_mutex_lock(&r->lock);
    bool quit = r->quit;
    pthread_mutex_unlock(&r->lock);
    return quit;
}

/* Read slice z to its slot. */
static status fill_slot(read_ahead *r, uint32_t z) {
    const uint32_t slot = z % r->ring.slots;
    return read_slice(r, r->ring.samples + slot * r->slice_bytes, r->ring.busy + slot * r->tiles);
}

/* Move on behind the slices of an earlier run. Those that are needed are in their slots, which the
 * next one is not. */
static status pass_done(read_ahead *r) {
    const read_ahead_facts past = r->facts;
    status st = r->done && volume_skips(r->v) ? volume_skip(r->v, r->done) : ST_OK;
    if (!r->done || volume_skips(r->v))
        return st;
    r->facts.checksum = 0;
    for (uint32_t z = 0; z < r->done && st == ST_OK && !must_quit(r); z++)
        st = fill_slot(r, r->done);
    if (st == ST_OK && !must_quit(r) && r->facts.checksum != past.checksum)
        st = status_describe(ST_CORRUPT,
                             "the input has changed: its first %u slices are not those that the "
                             "work so far was made from; --force begins again",
                             r->done);
    r->facts = past;
    return st;
}

static status read_slices_on(read_ahead *r) {
    const uint32_t slices = volume_grid(r->v)->dims[2];
    const status passed = pass_done(r);
    if (passed != ST_OK)
        return passed;
    for (uint32_t z = r->done; z < slices && wait_for_room(r); z++) {
        const status st = fill_slot(r, z);
        if (st != ST_OK)
            return st;
        pthread_mutex_lock(&r->lock);
        r->seen[z % r->ring.slots] = r->facts;
        r->filled++;
        if (r->filled - r->taken >= r->wanted)
            pthread_cond_broadcast(&r->changed);
        pthread_mutex_unlock(&r->lock);
    }
    return must_quit(r) ? ST_OK : volume_finish(r->v, &r->facts.trailing_bytes);
}

static void *work(void *arg) {
    read_ahead *r = arg;
    status st = read_slices_on(r);
    pthread_mutex_lock(&r->lock);
    status_note_take(&r->note, st);
    r->ended = true;
    pthread_cond_broadcast(&r->changed);
    pthread_mutex_unlock(&r->lock);
    return NULL;
}

static size_t stored_slice_bytes(const grid *g) {
    return (size_t)g->dims[0] * g->dims[1] * sample_size(sample_stored(g->type));
}

static bool needs_raw(const grid *g) {
    return sample_size(g->type) > sample_size(sample_stored(g->type));
}

uint64_t read_ahead_memory(const grid *g, uint32_t slots) {
    return (needs_raw(g) ? grid_slice_bytes(g) : 0) + slots * sizeof(read_ahead_facts) +
           sizeof(read_ahead) + 4096;
}

/* Returns whether the input tells a quiet value that is unchanged when stored: finite, and not -0.
 */
static bool ask_quiet(read_ahead *r) {
    const grid *g = volume_grid(r->v);
    float value = 0;
    if (!volume_quiet(r->v, r->quiet) || sample_stored(g->type) != g->type)
        return false;
    if (g->type == SAMPLE_F32)
        memcpy(&value, r->quiet, sizeof value);
    return isfinite(value) && !(value == 0 && signbit(value));
}

status read_ahead_create(mem *m, volume *v, const slice_ring *ring, const read_ahead_facts *past,
                         uint32_t done, read_ahead **out) {
    const grid *g = volume_grid(v);
    read_ahead *r = mem_zalloc(m, sizeof *r);
    if (!r)
        return ST_NOMEM;
    r->m = m;
    r->v = v;
    r->ring = *ring;
    r->done = r->filled = r->taken = done;
    r->facts = r->handed = past ? *past : (read_ahead_facts){0};
    r->slice_samples = (size_t)g->dims[0] * g->dims[1];
    r->slice_bytes = stored_slice_bytes(g);
    r->tiles = slice_tiles_count(g->dims);
    r->told = ask_quiet(r);
    if (!r->told)
        memset(r->quiet, 0, sizeof r->quiet);
    pthread_mutex_init(&r->lock, NULL);
    pthread_cond_init(&r->changed, NULL);
    r->seen = mem_array(m, ring->slots, sizeof *r->seen);
    if (needs_raw(g))
        r->raw = mem_alloc(m, (size_t)grid_slice_bytes(g));
    if (!r->seen || (needs_raw(g) && !r->raw)) {
        read_ahead_destroy(r);
        return ST_NOMEM;
    }
    *out = r;
    return ST_OK;
}

void read_ahead_destroy(read_ahead *r) {
    if (!r)
        return;
    if (r->started) {
        pthread_mutex_lock(&r->lock);
        r->quit = true;
        pthread_cond_broadcast(&r->changed);
        pthread_mutex_unlock(&r->lock);
        pthread_join(r->thread, NULL);
    }
    pthread_cond_destroy(&r->changed);
    pthread_mutex_destroy(&r->lock);
    mem_free(r->m, r->seen);
    mem_free(r->m, r->raw);
    mem_free(r->m, r);
}

const void *read_ahead_quiet(const read_ahead *r) {
    return r->quiet;
}

/* How many slices are next that the ring has, or will have, in one piece. */
static uint32_t next_piece(const read_ahead *r, uint32_t most) {
    const uint32_t left = volume_grid(r->v)->dims[2] - r->taken, slots = r->ring.slots;
    const uint32_t room = r->needed + slots - r->taken, piece = slots - r->taken % slots;
    uint32_t count = most < left ? most : left;
    count = count < room ? count : room;
    return count < piece ? count : piece;
}

status read_ahead_next(read_ahead *r, uint32_t needed, uint32_t most, read_slices *out) {
    assert(needed <= r->taken && r->taken - needed < r->ring.slots && most > 0);
    pthread_mutex_lock(&r->lock);
    r->needed = needed;
    r->wanted = next_piece(r, most);
    pthread_cond_broadcast(&r->changed);
    status st = ST_OK;
    if (!r->started)
        st = thread_start(&r->thread, work, r, "the thread that reads the input");
    r->started |= st == ST_OK;
    while (st == ST_OK && !r->ended && (r->filled - r->taken < r->wanted || !r->wanted))
        pthread_cond_wait(&r->changed, &r->lock);
    const uint32_t there = r->filled - r->taken, slot = r->taken % r->ring.slots;
    const uint32_t count = there < r->wanted ? there : r->wanted;
    *out = (read_slices){r->ring.samples + slot * r->slice_bytes, r->ring.busy + slot * r->tiles,
                         count};
    if (count > 0)
        r->handed = r->seen[slot + count - 1];
    r->taken += count;
    pthread_mutex_unlock(&r->lock);
    if (st != ST_OK || count > 0)
        return st;
    r->handed.trailing_bytes = r->facts.trailing_bytes;
    return r->note.st == ST_OK ? ST_OK : status_note_raise(&r->note);
}

read_ahead_facts read_ahead_seen(const read_ahead *r) {
    return r->handed;
}
