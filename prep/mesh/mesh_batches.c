#include "prep/mesh/mesh_batches.h"

#include "prep/mesh/mesh_cut.h"

status mesh_batches_init(mesh_batches *b, mem *m, mesh_runs *runs, uint64_t tets,
                         uint32_t treelet_tets, size_t most) {
    *b = (mesh_batches){
        .m = m, .runs = runs, .tets = tets, .treelet_tets = treelet_tets, .most = most};
    b->first = mem_array(m, most + 1, sizeof *b->first);
    return b->first ? ST_OK : ST_NOMEM;
}

void mesh_batches_release(mesh_batches *b) {
    if (b->first)
        mem_free(b->m, b->first);
    b->first = NULL;
}

void mesh_batches_doubt(mesh_batches *b, uint64_t vertices, uint32_t corners) {
    b->vertices = vertices;
    b->corners = corners;
}

void mesh_batches_doubt_cells(mesh_batches *b, uint64_t cells) {
    b->cells = cells;
}

status mesh_batches_fault(void) {
    return status_describe(ST_CORRUPT, "the sorted tets of unfinished work have changed meanwhile; "
                                       "--force begins again");
}

/* Whether a record can come behind one with the key `before`. */
static bool is_sound(const mesh_batches *b, const mesh_record *r, uint64_t before) {
    const uint32_t *id = r->id;
    const uint64_t vertices = b->vertices;
    if (b->cells)
        return r->key >= before && mesh_record_cell(r) < b->cells;
    for (uint32_t i = 0; i < b->corners; i++)
        for (uint32_t k = 0; k < i; k++)
            if (id[i] == id[k])
                return false;
    return r->key >= before && id[0] < vertices && id[1] < vertices && id[2] < vertices &&
           id[3] < vertices;
}

/* Check the batch's records. before: the key in front of them. */
static status check_records(const mesh_batches *b, uint64_t before) {
    if (!b->vertices && !b->cells)
        return ST_OK;
    for (size_t i = 0; i < b->used; i++)
        if (!is_sound(b, &b->records[i], i > 0 ? b->records[i - 1].key : before))
            return mesh_batches_fault();
    return ST_OK;
}

status mesh_batches_rewind(mesh_batches *b) {
    b->tet = b->before = b->treelet = 0;
    b->count = b->used = b->first[0] = 0;
    return mesh_runs_rewind(b->runs);
}

uint64_t mesh_batches_end(const mesh_batches *b) {
    return (uint64_t)b->treelet + b->count;
}

/* The number of the first tet behind the batch. */
static uint64_t end_tet(const mesh_batches *b) {
    return b->tet + b->first[b->count];
}

bool mesh_batches_more(const mesh_batches *b) {
    return end_tet(b) < b->tets;
}

status mesh_batches_next(mesh_batches *b) {
    const uint64_t before = b->before;
    size_t count, used = 0;
    bool last = false;
    b->tet = end_tet(b);
    b->treelet += (uint32_t)b->count;
    b->count = b->first[0] = 0;
    status st = mesh_runs_window(b->runs, b->used, &b->records, &count, &last);
    while (st == ST_OK && b->count < b->most && used < count) {
        /* Do not cut where tets that are not in sight could belong to the treelet. */
        if (!last && count - used <= b->treelet_tets)
            break;
        const uint64_t *key = b->tet + used > 0 ? &b->before : NULL;
        used += mesh_cut_next(b->records + used, count - used, key, b->treelet_tets);
        b->before = b->records[used - 1].key;
        b->first[++b->count] = used;
    }
    b->used = used;
    if (st == ST_OK && b->count == 0)
        st = mesh_batches_fault();
    return st == ST_OK ? check_records(b, before) : st;
}

status mesh_batches_keep(mesh_batches *b, state_io *io) {
    uint64_t tet = end_tet(b);
    uint32_t treelet = b->treelet + (uint32_t)b->count;
    status st = STATE_IO(io, tet);
    if (st == ST_OK)
        st = STATE_IO(io, treelet);
    if (st == ST_OK)
        st = STATE_IO(io, b->before);
    if (st == ST_OK)
        st = mesh_runs_keep_place(b->runs, b->used, io);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    b->tet = tet;
    b->treelet = treelet;
    b->count = b->used = b->first[0] = 0;
    return tet > b->tets || mesh_runs_left(b->runs) != b->tets - tet ? state_io_fault(io) : ST_OK;
}
