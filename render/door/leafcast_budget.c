/* leafcast_budget.c - divides a device's memory budget before each turn of a frame. Its parts:
 * volumes without their treelets, the most that begun frames may need, treelets of each volume.
 */
#include "render/door/coarse_preview.h"
#include "render/door/leafcast_turn.h"
#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"

size_t budget_image(const leafcast_image *image, size_t pixels) {
    const float *const floats[] = {image->r,         image->g,         image->b,        image->a,
                                   image->normal[0], image->normal[1], image->normal[2]};
    size_t bytes = 0;
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++)
        bytes += floats[i] ? pixels * sizeof(float) : 0;
    bytes += image->z ? pixels * sizeof(double) : 0;
    bytes += image->id ? pixels * sizeof(int32_t) : 0;
    bytes += image->rgba ? 4 * pixels * sizeof(double) : 0;
    bytes += image->error ? pixels * sizeof(double) : 0;
    bytes += image->value ? pixels * sizeof(double) : 0;
    bytes += image->rgba8 ? 4 * pixels : 0;
    return bytes + (image->provisional ? pixels : 0);
}

/* The most records of suspended rays that a frame can use. */
static uint32_t records_wanted(const frame *f) {
    const uint32_t least = frame_records_min(f);
    const size_t records = (frame_pixels(f) + 255) / 256 * 256 * 2;
    return records < least ? least : records < UINT32_MAX / 2 ? (uint32_t)records : UINT32_MAX / 2;
}

/* Bytes of scratch of all threads. */
size_t budget_scratch(const frame *f) {
    return (size_t)pool_threads(f->threads) * frame_scratch_bytes(f);
}

/* The frame's bytes without records and treelets. least: without what turn_prepare() can give back:
 * scratch that another frame has left, and coarse grids that nobody draws. */
static size_t frame_fixed_bytes(const turn *t, bool least) {
    const frame *f = &t->f;
    const leafcast_image *planes = &f->image;
    const leafcast_image colours = {.r = planes->r,
                                    .g = planes->g,
                                    .b = planes->b,
                                    .a = planes->a,
                                    .provisional =
                                        t->scene.allow_missing ? planes->provisional : NULL};
    const size_t kept = least ? 0 : t->device->scratch_bytes, scratch = budget_scratch(f);
    size_t bytes = (kept > scratch ? kept : scratch) + budget_image(&f->image, frame_pixels(f)) +
                   frame_bytes(f, records_wanted(f));
    if (t->scene.samples > 1)
        bytes += budget_image(&colours, frame_pixels(f));
    for (int i = 0; i < turn_all(t); i++) {
        const leafcast *v = t->drawn[i], *of = t->shown[i].volume;
        if (!turn_is_first(t, i))
            continue;
        bytes += (least ? coarse_preview_held(of) : coarse_preview_bytes(of)) +
                 (v->kind->tiles ? v->kind->tiles->projection_bytes(&v->file->layout) : 0);
    }
    return bytes;
}

/* Returns the bytes in use or promised, without this frame's records and without treelets. */
static size_t fixed_bytes(const turn *t, bool least) {
    const leafcast_device *d = t->device;
    return d->base_bytes + d->beside + d->frames_bytes - t->reserved + frame_fixed_bytes(t, least);
}

/* Bytes of one treelet of each volume. */
static size_t least_slots(const turn *t) {
    size_t bytes = 0;
    for (int i = 0; i < turn_all(t); i++)
        bytes += turn_is_first(t, i) ? loader_slot_bytes(t->shown[i].volume->treelets) : 0;
    return bytes;
}

size_t budget_enough(const leafcast_device *d, size_t needed) {
    size_t enough = needed, before;
    do {
        before = enough;
        enough = needed;
        for (const leafcast *v = d->volumes; v; v = v->next)
            enough += loader_more_bytes(v->treelets, before);
    } while (enough > before);
    return enough;
}

/* Check that the fewest records and one treelet of each volume fit. After the first turn, records
 * have a fixed number. */
static status check_budget(const turn *t, size_t fixed) {
    const size_t limit = t->device->budget.limit;
    const size_t records = t->begun ? t->f.records_max : frame_records_min(&t->f);
    const size_t needed = fixed + records * frame_record_bytes(&t->f) + least_slots(t);
    if (limit == 0 || needed <= limit)
        return ST_OK;
    return status_describe(
        ST_NOMEM,
        "the memory budget of %zu bytes is too small for this picture: %zu bytes would do", limit,
        budget_enough(t->device, needed));
}

/* Bytes of all active treelets of a volume. */
static size_t wanted_bytes(const leafcast *v) {
    return v->treelets->treelets_active * loader_slot_bytes(v->treelets);
}

/* Returns how many of `rest` bytes remain with treelets of volumes that are not shown. Evicts these
 * treelets if the frame could use the bytes. */
static size_t others_bytes(turn *t, size_t rest) {
    size_t held = 0, wanted = records_wanted(&t->f) * frame_record_bytes(&t->f);
    for (leafcast *v = t->device->volumes; v; v = v->next) {
        if (turn_shows(t, v))
            wanted += wanted_bytes(v);
        else
            held += loader_statistics(v->treelets).bytes_resident;
    }
    if (wanted + held <= rest)
        return held;
    for (leafcast *v = t->device->volumes; v; v = v->next)
        if (!turn_shows(t, v))
            loader_clear(v->treelets);
    return 0;
}

void budget_slots(leafcast *v, size_t bytes) {
    const uint32_t treelets = v->file->layout.treelets, limit = v->experiments.treelet_limit;
    const size_t slot = loader_slot_bytes(v->treelets);
    size_t slots = bytes / slot < treelets ? bytes / slot : treelets;
    size_t cached = bytes == SIZE_MAX ? SIZE_MAX : bytes - slots * slot;
    if (limit) {
        slots = slots < limit ? slots : limit;
        cached = 0;
    }
    loader_set_capacity(v->treelets, (uint32_t)slots, cached);
}

/* Give each volume one treelet, and a share of the rest in proportion to its active bytes. */
static void share_treelets(turn *t, size_t bytes) {
    size_t spare = bytes - least_slots(t);
    double wanted = 0.0;
    int left = 0;
    for (int i = 0; i < turn_all(t); i++) {
        left += turn_is_first(t, i);
        wanted += turn_is_first(t, i) ? (double)wanted_bytes(t->shown[i].volume) : 0.0;
    }
    for (int i = 0; i < turn_all(t); i++) {
        leafcast *v = t->shown[i].volume;
        if (!turn_is_first(t, i))
            continue;
        const double share = wanted > 0.0 ? (double)wanted_bytes(v) / wanted : 1.0;
        const bool last = --left == 0 || share >= 1.0;
        const size_t more = last ? spare : (size_t)(share * (double)spare);
        wanted -= (double)wanted_bytes(v);
        spare -= more;
        budget_slots(v, loader_slot_bytes(v->treelets) + more);
    }
}

/* Share the budget out: the fixed part and the picture first, then records of suspended rays (a
 * quarter of the rest, or what one treelet of each volume leaves), then treelets. */
status budget_share(turn *t) {
    leafcast_device *d = t->device;
    frame *f = &t->f;
    const uint32_t least = frame_records_min(f);
    size_t records = t->begun ? f->records_max : records_wanted(f);
    if (d->budget.limit == 0) {
        for (int i = 0; i < turn_all(t); i++)
            if (turn_is_first(t, i))
                budget_slots(t->shown[i].volume, SIZE_MAX);
    } else {
        const size_t fixed = fixed_bytes(t, false), slots = least_slots(t);
        status st = check_budget(t, fixed);
        if (st != ST_OK)
            return st;
        size_t rest = d->budget.limit - fixed;
        rest -= others_bytes(t, rest);
        const size_t beside = rest - slots;
        const size_t most = (rest / 4 < beside ? rest / 4 : beside) / frame_record_bytes(f);
        if (!t->begun)
            records = most < least ? least : most < records ? most : records;
        share_treelets(t, rest - records * frame_record_bytes(f));
    }
    f->records_max = (uint32_t)records;
    d->frames_bytes -= t->reserved;
    t->reserved = frame_fixed_bytes(t, false) + records * frame_record_bytes(f);
    d->frames_bytes += t->reserved;
    return ST_OK;
}

status budget_check(const turn *t) {
    return check_budget(t, fixed_bytes(t, true));
}
