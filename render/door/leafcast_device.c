#include "render/door/leafcast_device.h"

#include "formats/public_status.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_volume.h"
#include "render/frame/laboratory.h"
#include "render/grid/walk_choice.h"

void device_lock(leafcast_device *d) {
    pthread_mutex_lock(&d->lock);
}

void device_unlock(leafcast_device *d) {
    pthread_mutex_unlock(&d->lock);
}

static status make_threads(leafcast_device *d) {
    const leafcast_options *o = &d->options;
    const int threads = o->threads > 0 ? o->threads : pool_default_threads();
    return o->run ? pool_create_host(&d->budget, threads, o->run, o->host, &d->threads)
                  : pool_create(&d->budget, threads, &d->threads);
}

/* Find the kernels that options.isa names: an ISA, or an experiment's choice. */
static bool choose_kernels(leafcast_device *d) {
    const laboratory *l = laboratory_find();
    d->choice = l ? l->walk_named(d->options.isa) : NULL;
    if (d->choice)
        d->isa = d->choice->walk ? CPU_SCALAR : cpu_best();
    else if (!cpu_isa_find(d->options.isa, &d->isa))
        return false;
    d->isa_name = d->choice ? d->choice->name : cpu_isa_name(d->isa);
    return true;
}

static status device_init(leafcast_device *d) {
    mem_init(&d->budget, (size_t)d->options.memory);
    pthread_mutex_init(&d->lock, NULL);
    d->users = 1;
    d->process = getpid();
    if (!choose_kernels(d))
        return status_describe(ST_USAGE, "this CPU or this build has no kernels called %s",
                               d->options.isa);
    status st = make_threads(d);
    if (st == ST_OK)
        st = readers_create(&d->budget, &d->readers);
    d->base_bytes = mem_used(&d->budget);
    return st;
}

leafcast_status leafcast_device_create(const leafcast_options *options, leafcast_device **device) {
    mem outside;
    status st = public_needs(__func__, "device", (const void *[]){device});
    if (st == ST_OK && options)
        st = arguments_check_options(options);
    if (st == ST_OK && options && options->device)
        st = status_describe(ST_USAGE, "leafcast_options.device: a device is not on another one");
    if (st != ST_OK)
        return public_status(st);
    mem_init(&outside, 0);
    leafcast_device *d = mem_zalloc(&outside, sizeof *d);
    if (!d)
        return LEAFCAST_NOMEM;
    if (options)
        d->options = *options;
    d->options.experiments = NULL; /* volumes have their own */
    st = device_init(d);
    if (st == ST_OK)
        *device = d;
    else
        device_release(d);
    return public_status(st);
}

void device_release(leafcast_device *d) {
    mem outside;
    device_lock(d);
    const int users = --d->users;
    device_unlock(d);
    if (users > 0)
        return;
    mem_init(&outside, 0);
    readers_destroy(d->readers);
    pool_destroy(d->threads);
    mem_free(&d->budget, d->scratch);
    pthread_mutex_destroy(&d->lock);
    mem_free(&outside, d);
}

void leafcast_device_destroy(leafcast_device *d) {
    if (d && device_is_here(d))
        device_release(d);
}

void device_clear(leafcast_device *d) {
    for (leafcast *v = d->volumes; v && d->budget.limit; v = v->next)
        loader_clear(v->treelets);
}

void device_make_room(leafcast *v) {
    const mem *m = v->m;
    const size_t used = mem_used(m), room = m->limit > used ? m->limit - used : 0;
    if (m->limit && room < loader_slot_bytes(v->treelets))
        device_clear(v->device);
}

bool device_drop_scratch(leafcast_device *d) {
    const bool any = d->scratch_bytes > 0;
    mem_free(&d->budget, d->scratch);
    d->scratch = NULL;
    d->scratch_bytes = 0;
    return any;
}

status device_scratch(leafcast_device *d, size_t bytes) {
    if (d->scratch && bytes <= d->scratch_bytes)
        return ST_OK;
    (void)device_drop_scratch(d);
    d->scratch = mem_alloc(&d->budget, bytes);
    d->scratch_bytes = d->scratch ? bytes : 0;
    return d->scratch ? ST_OK : ST_NOMEM;
}
