#include "prep/mesh/mesh_runs.h"

#include <assert.h>
#include <string.h>

#include "formats/base/file.h"

enum {
    BLOCK_MIN = 1 << 11,
    BLOCK_MAX = 1 << 16,
    WINDOW_MAX = 1 << 20,
    RUN_MIN = 1 << 12,
    PIECE = 1 << 16 /* records read or written between two questions whether to go on */
};

/* A run while it is merged. */
typedef struct stream {
    mesh_record *block;
    size_t at, count; /* in the block */
    uint64_t next;    /* record of the file where the next block begins */
    uint64_t end;
} stream;

struct mesh_runs {
    mem *m;
    const char *beside;
    mesh_runs_plan plan;
    const progress *p;
    work_folder *work;            /* where the file is kept; NULL: nowhere */
    mesh_sort *sort;              /* NULL: all has been put */
    mesh_record *records, *spare; /* of the current run */
    size_t filled;
    /* With several runs: */
    out_file *file;
    uint64_t written;
    uint64_t runs; /* in the file; 0: there is one, in memory */
    stream *streams;
    mesh_record *blocks;
    uint32_t *losers; /* tournament tree over all streams; [0]: the winner */
    mesh_record *window;
    /* The visible records: */
    size_t first, held;
};

/* ---- the plan ---- */

static uint64_t runs_of(const mesh_runs_plan *plan, uint64_t records) {
    return plan->run ? (records + plan->run - 1) / plan->run : 0;
}

uint64_t mesh_runs_filling(const mesh_runs_plan *plan) {
    return (plan->block ? 2 : 1) * plan->run * sizeof(mesh_record) + sizeof(mesh_runs) + 1024;
}

uint64_t mesh_runs_sorting(const mesh_runs_plan *plan) {
    return 2 * plan->run * sizeof(mesh_record) + sizeof(mesh_runs) + 1024;
}

uint64_t mesh_runs_merging(const mesh_runs_plan *plan, uint64_t records) {
    uint64_t each = plan->block * sizeof(mesh_record) + sizeof(stream) + sizeof(uint32_t);
    /* One run of all records stays where it was made. */
    uint64_t held = plan->block && plan->run < records
                        ? runs_of(plan, records) * each + plan->window * sizeof(mesh_record)
                        : plan->run * sizeof(mesh_record);
    return held + sizeof(mesh_runs) + 1024;
}

uint64_t mesh_runs_spill(const mesh_runs_plan *plan, uint64_t records) {
    return plan->block ? records * sizeof(mesh_record) : 0;
}

/* The shortest run for which making runs takes as much memory as the smallest merge. */
static uint64_t shortest_run(uint64_t records) {
    uint64_t run = RUN_MIN;
    while (run < records && (records + run - 1) / run * BLOCK_MIN > 2 * run)
        run += run / 8;
    return run < records ? run : records;
}

/* Double *what, up to `most`, as long as the merge fits into room. */
static void widen(mesh_runs_plan *plan, uint64_t *what, uint64_t most, uint64_t records,
                  uint64_t room) {
    while (*what < most) {
        *what *= 2;
        if (mesh_runs_merging(plan, records) <= room)
            continue;
        *what /= 2;
        return;
    }
}

mesh_runs_plan mesh_runs_plan_make(uint64_t records, uint64_t in_sight, uint64_t making,
                                   uint64_t merging) {
    const mesh_runs_plan one = {.run = records ? records : 1};
    if (mesh_runs_sorting(&one) <= making && mesh_runs_merging(&one, records) <= merging)
        return one;
    mesh_runs_plan plan = {
        .run = shortest_run(records), .block = BLOCK_MIN, .window = in_sight + RUN_MIN};
    /* Do not merge if that takes as much memory as one run. */
    if (mesh_runs_merging(&plan, records) >= mesh_runs_sorting(&one))
        return one;
    while (plan.run < records) {
        mesh_runs_plan longer = plan;
        longer.run += longer.run / 8;
        if (mesh_runs_sorting(&longer) > making || longer.run >= records)
            break;
        plan = longer;
    }
    widen(&plan, &plan.block, BLOCK_MAX, records, merging);
    widen(&plan, &plan.window, WINDOW_MAX, records, merging);
    return plan;
}

/* ---- making runs ---- */

status mesh_runs_create(mem *m, pool *p, const char *beside, const mesh_runs_plan *plan,
                        mesh_runs **out) {
    mesh_runs *r = mem_zalloc(m, sizeof *r);
    if (!r)
        return ST_NOMEM;
    r->m = m;
    r->beside = beside;
    r->plan = *plan;
    status st = mesh_sort_create(m, p, &r->sort);
    if (st == ST_OK && !(r->records = mem_alloc(m, (size_t)plan->run * sizeof *r->records)))
        st = ST_NOMEM;
    if (st != ST_OK) {
        mesh_runs_destroy(r);
        return st;
    }
    *out = r;
    return ST_OK;
}

void mesh_runs_destroy(mesh_runs *r) {
    if (!r)
        return;
    mesh_sort_destroy(r->sort);
    mem_free(r->m, r->records);
    mem_free(r->m, r->spare);
    mem_free(r->m, r->streams);
    mem_free(r->m, r->blocks);
    mem_free(r->m, r->losers);
    mem_free(r->m, r->window);
    out_file_discard(r->file);
    mem_free(r->m, r);
}

void mesh_runs_stop_by(mesh_runs *r, const progress *p) {
    r->p = p;
    mesh_sort_stop_by(r->sort, p);
}

static status open_file(mesh_runs *r) {
    return r->file   ? ST_OK
           : r->work ? work_folder_file(r->work, WORK_RUNS, true, &r->file)
                     : out_file_scratch(r->m, r->beside, &r->file);
}

/* Write the current run to the file, at record `to`. */
static status write_records(mesh_runs *r, uint64_t to) {
    status st = open_file(r);
    for (size_t at = 0; at < r->filled && st == ST_OK; at += PIECE) {
        const size_t some = r->filled - at < PIECE ? r->filled - at : PIECE;
        st = progress_ask(r->p, "sorting");
        if (st == ST_OK)
            st = out_file_write_at(r->file, (to + at) * sizeof *r->records, r->records + at,
                                   some * sizeof *r->records);
    }
    return st;
}

static status sort_run(mesh_runs *r) {
    if (!r->spare && !(r->spare = mem_alloc(r->m, (size_t)r->plan.run * sizeof *r->spare)))
        return ST_NOMEM;
    return mesh_sort_records(r->sort, r->records, r->spare, r->filled);
}

static status write_run(mesh_runs *r) {
    status st = sort_run(r);
    if (st == ST_OK)
        st = write_records(r, r->written);
    r->written += r->filled;
    r->runs++;
    r->filled = 0;
    return st;
}

mesh_record *mesh_runs_room(mesh_runs *r, size_t *count) {
    *count = (size_t)r->plan.run - r->filled;
    return r->records + r->filled;
}

status mesh_runs_put(mesh_runs *r, size_t count) {
    r->filled += count;
    assert(r->filled <= r->plan.run);
    /* A full run may be the only one: then it stays in memory. */
    return r->filled == r->plan.run && r->plan.block ? write_run(r) : ST_OK;
}

/* ---- merging them ---- */

static status fill_block(mesh_runs *r, stream *s) {
    uint64_t left = s->end - s->next;
    s->at = 0;
    s->count = left < r->plan.block ? (size_t)left : (size_t)r->plan.block;
    uint64_t at = s->next * sizeof *s->block;
    s->next += s->count;
    return s->count ? out_file_read_at(r->file, at, s->block, s->count * sizeof *s->block) : ST_OK;
}

/* The next key of a stream; at its end UINT64_MAX, which no key reaches. */
static uint64_t head(const mesh_runs *r, uint32_t i) {
    const stream *s = &r->streams[i];
    return s->at < s->count ? s->block[s->at].key : UINT64_MAX;
}

/* Returns whether stream a comes before b. For equal keys the earlier run does. */
static bool precedes(const mesh_runs *r, uint32_t a, uint32_t b) {
    uint64_t x = head(r, a), y = head(r, b);
    return x < y || (x == y && a < b);
}

/* Play the tournament below a node. Node i has children 2i and 2i + 1; node runs + k is stream
 * k. */
static uint32_t play(mesh_runs *r, uint32_t node) {
    if (node >= r->runs)
        return node - (uint32_t)r->runs;
    uint32_t a = play(r, 2 * node), b = play(r, 2 * node + 1);
    bool first = precedes(r, a, b);
    r->losers[node] = first ? b : a;
    return first ? a : b;
}

/* Stream i has a new head: replay the matches on its path to the root. */
static void replay(mesh_runs *r, uint32_t i) {
    uint32_t winner = i;
    for (uint32_t node = ((uint32_t)r->runs + i) / 2; node > 0; node /= 2)
        if (precedes(r, r->losers[node], winner)) {
            uint32_t other = r->losers[node];
            r->losers[node] = winner;
            winner = other;
        }
    r->losers[0] = winner;
}

static status begin_merge(mesh_runs *r) {
    size_t n = (size_t)r->runs, block = (size_t)r->plan.block;
    mem_free(r->m, r->records);
    r->records = NULL;
    r->streams = mem_array(r->m, n, sizeof *r->streams);
    r->losers = mem_array(r->m, n, sizeof *r->losers);
    r->blocks = mem_alloc(r->m, n * block * sizeof *r->blocks);
    r->window = mem_alloc(r->m, (size_t)r->plan.window * sizeof *r->window);
    if (!r->streams || !r->losers || !r->blocks || !r->window)
        return ST_NOMEM;
    return mesh_runs_rewind(r);
}

status mesh_runs_rewind(mesh_runs *r) {
    size_t n = (size_t)r->runs;
    r->first = r->held = 0;
    for (size_t i = 0; i < n; i++) {
        stream *s = &r->streams[i];
        s->block = r->blocks + i * (size_t)r->plan.block;
        s->next = i * r->plan.run;
        s->end = i + 1 < n ? s->next + r->plan.run : r->written;
        status st = fill_block(r, s);
        if (st != ST_OK)
            return st;
    }
    if (n > 0)
        r->losers[0] = n > 1 ? play(r, 1) : 0;
    return ST_OK;
}

/* Free what sorting needs, then make what merging needs. */
static status end_sorting(mesh_runs *r) {
    mesh_sort_destroy(r->sort);
    mem_free(r->m, r->spare);
    r->sort = NULL;
    r->spare = NULL;
    return r->runs ? begin_merge(r) : ST_OK;
}

status mesh_runs_end(mesh_runs *r) {
    status st = ST_OK;
    if (!r->runs)
        st = sort_run(r);
    else if (r->filled)
        st = write_run(r);
    return st == ST_OK ? end_sorting(r) : st;
}

static status merge_some(mesh_runs *r) {
    while (r->held < r->plan.window) {
        stream *s = &r->streams[r->losers[0]];
        if (s->at == s->count)
            return ST_OK;
        r->window[r->held++] = s->block[s->at++];
        if (s->at == s->count) {
            status st = fill_block(r, s);
            if (st != ST_OK)
                return st;
        }
        replay(r, r->losers[0]);
    }
    return ST_OK;
}

status mesh_runs_window(mesh_runs *r, size_t used, const mesh_record **records, size_t *count,
                        bool *last) {
    if (!r->runs) {
        r->first += used;
        *records = r->records + r->first;
        *count = r->filled - r->first;
        *last = true;
        return ST_OK;
    }
    r->held -= used;
    memmove(r->window, r->window + used, r->held * sizeof *r->window);
    status st = merge_some(r);
    *records = r->window;
    *count = r->held;
    *last = r->held < r->plan.window;
    return st;
}

/* ---- for another run ---- */

void mesh_runs_keep_in(mesh_runs *r, work_folder *work) {
    assert(r->filled == 0 && !r->file);
    r->work = work;
}

bool mesh_runs_written(const mesh_runs *r) {
    return !r->sort || (r->runs > 0 && r->filled == 0);
}

status mesh_runs_store(mesh_runs *r) {
    return r->runs || r->file ? ST_OK : write_records(r, 0);
}

void mesh_runs_unstore(mesh_runs *r) {
    if (r->runs || !r->file)
        return;
    (void)!out_file_cut(r->file, 0);
    out_file_discard(r->file);
    r->file = NULL;
}

out_file *mesh_runs_file(const mesh_runs *r) {
    return r->file;
}

/* The first record of a stream that is not in the window. */
static uint64_t place_of(const stream *s) {
    return s->next - (s->count - s->at);
}

uint64_t mesh_runs_left(const mesh_runs *r) {
    if (r->sort)
        return r->written + r->filled;
    uint64_t left = r->runs ? r->held : r->filled - r->first;
    for (uint64_t i = 0; i < r->runs; i++)
        left += r->streams[i].end - place_of(&r->streams[i]);
    return left;
}

/* Whether the counts that were loaded are those of the plan. ended: all had been put. */
static bool fits(const mesh_runs *r, bool ended) {
    const mesh_runs_plan *plan = &r->plan;
    if (r->runs == 0)
        return ended && r->written == 0 && r->filled <= plan->run;
    const uint64_t whole = r->written / plan->run, rest = r->written % plan->run;
    return plan->block > 0 && r->filled == 0 && r->runs <= UINT32_MAX / 2 &&
           r->runs == whole + (ended && rest > 0) && (ended || rest == 0);
}

/* Read the only run. */
static status read_records(mesh_runs *r) {
    status st = ST_OK;
    for (size_t at = 0; at < r->filled && st == ST_OK; at += PIECE) {
        const size_t some = r->filled - at < PIECE ? r->filled - at : PIECE;
        st = progress_ask(r->p, "reading");
        if (st == ST_OK)
            st = out_file_read_at(r->file, at * sizeof *r->records, r->records + at,
                                  some * sizeof *r->records);
    }
    return st;
}

static status load(mesh_runs *r, bool ended, state_io *io) {
    const uint64_t all = r->written + r->filled;
    if (!fits(r, ended))
        return state_io_fault(io);
    status st = open_file(r);
    if (st == ST_OK && out_file_size(r->file) / sizeof *r->records < all)
        st = state_io_fault(io);
    if (st == ST_OK)
        st = out_file_cut(r->file, all * sizeof *r->records);
    if (st == ST_OK && !r->runs)
        st = read_records(r);
    return st == ST_OK && ended ? end_sorting(r) : st;
}

status mesh_runs_keep(mesh_runs *r, state_io *io) {
    uint32_t ended = !r->sort;
    assert(state_io_loads(io) || mesh_runs_written(r));
    status st = STATE_IO(io, ended);
    if (st == ST_OK)
        st = STATE_IO(io, r->runs);
    if (st == ST_OK)
        st = STATE_IO(io, r->written);
    if (st == ST_OK)
        st = STATE_IO(io, r->filled);
    return st == ST_OK && state_io_loads(io) ? load(r, ended, io) : st;
}

static status keep_only_place(mesh_runs *r, size_t used, state_io *io) {
    size_t first = r->first + used;
    status st = STATE_IO(io, first);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    r->first = first;
    return first > r->filled ? state_io_fault(io) : ST_OK;
}

static status keep_stream(mesh_runs *r, uint64_t i, state_io *io) {
    stream *s = &r->streams[i];
    uint64_t place = place_of(s);
    status st = STATE_IO(io, place);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    if (place < i * r->plan.run || place > s->end)
        return state_io_fault(io);
    s->next = place;
    return fill_block(r, s);
}

status mesh_runs_keep_place(mesh_runs *r, size_t used, state_io *io) {
    if (!r->runs)
        return keep_only_place(r, used, io);
    size_t left = r->held - used;
    status st = STATE_IO(io, left);
    if (st == ST_OK && left > r->plan.window)
        st = state_io_fault(io);
    if (st == ST_OK)
        st = state_io_bytes(io, r->window + used, left * sizeof *r->window);
    for (uint64_t i = 0; i < r->runs && st == ST_OK; i++)
        st = keep_stream(r, i, io);
    if (st == ST_OK && state_io_loads(io)) {
        r->held = left;
        r->losers[0] = r->runs > 1 ? play(r, 1) : 0;
    }
    return st;
}
