/* leafcast_refresh.c - the steps that have come since a volume was opened. */
#include "formats/base/file_mark.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"

/* Whether the file was written to since its steps were taken in. Costs two calls of the system. */
static bool is_touched(const leafcast *v) {
    live_hold h;
    (void)volume_hold(v, 0, &h);
    const status st = file_mark_check(v->file->source, &v->file->mark);
    volume_let_go(v, &h);
    return st != ST_OK; /* leaf_file_newer() says whether it has grown */
}

/* End what all volumes of the device read, so that memory can be measured. */
static void rest_all(const leafcast_device *d) {
    for (leafcast *v = d->volumes; v; v = v->next) {
        loader_rest(v->treelets);
        if (v->coarse)
            loader_rest(v->coarse->treelets);
    }
}

/* Exchange the volume's file for a newer one, which gets what was there. */
static status take_in(leafcast *v, leaf_file *newer) {
    const uint32_t steps = v->file->layout.steps;
    pthread_rwlock_wrlock(&v->steps);
    leaf_file_exchange(v->file, newer);
    /* What lies between its steps is made of payloads that have other numbers now. */
    status st = v->between ? loader_restart(v->between->treelets) : ST_OK;
    if (st == ST_OK)
        st = loader_grow(v->treelets, steps);
    if (st == ST_OK)
        v->set = leaf_layout_set(&v->file->layout, v->set / steps, v->set % steps);
    else
        leaf_file_exchange(v->file, newer);
    pthread_rwlock_unlock(&v->steps);
    return st;
}

/* Take in what has come, and count the memory of it. Nothing may be read meanwhile. */
static status grow(leafcast *v) {
    leafcast_device *d = v->device;
    leaf_file *newer = NULL;
    size_t before = mem_used(v->m);
    status st = leaf_file_newer(v->file, &newer);
    if (!newer)
        return st;
    /* Treelets are not of what is counted: those that take_in() gives up go first. */
    if (v->between) {
        const size_t with = mem_used(v->m);
        loader_clear(v->between->treelets);
        before -= with - mem_used(v->m);
    }
    st = take_in(v, newer);
    leaf_file_close(newer);
    const size_t after = mem_used(v->m);
    v->base_bytes += after - before;
    d->base_bytes += after - before;
    return st;
}

/* Needs the device's lock. Treelets make room if they must. */
static status refresh(leafcast *v) {
    rest_all(v->device);
    const status st = grow(v);
    if (st != ST_NOMEM || !v->m->limit)
        return st;
    device_clear(v->device);
    return grow(v);
}

leafcast_status leafcast_refresh(leafcast *v, uint32_t *steps) {
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = public_needs(__func__, "steps", (const void *[]){steps});
    if (st == ST_OK && !v->live && is_touched(v)) {
        device_lock(v->device);
        st = refresh(v);
        device_unlock(v->device);
    }
    if (st == ST_OK)
        *steps = leafcast_describe(v).steps;
    return public_status(st);
}
