#include "formats/base/id_map.h"

#include <string.h>

#include "formats/base/heap.h"

status id_map_add(id_map *map, uint64_t id) {
    id_run *last = map->count ? &map->runs[map->count - 1] : NULL;
    if (last && id >= last->id && id - last->id == last->count) {
        last->count++;
        map->ids++;
        return ST_OK;
    }
    status st = mem_grow(map->m, &map->runs, sizeof *map->runs, map->count, 64, &map->room);
    if (st == ST_OK)
        map->runs[map->count++] = (id_run){id, map->ids++, 1};
    return st;
}

static bool is_larger(const id_run *a, const id_run *b) {
    return a->id > b->id;
}

HEAP_SINK(run, id_run, is_larger)

/* Heapsort: needs no memory beyond the budget, and has no bad cases. */
static void sort(id_run *runs, size_t count) {
    for (size_t i = count / 2; i-- > 0;)
        run_sink(runs, i, count, runs[i]);
    for (size_t left = count; left > 1;) {
        const id_run largest = runs[0], last = runs[--left];
        run_sink(runs, 0, left, last);
        runs[left] = largest;
    }
}

bool id_map_seal(id_map *map, uint64_t *twice) {
    bool sorted = true;
    for (size_t i = 1; i < map->count; i++)
        sorted = sorted && map->runs[i - 1].id < map->runs[i].id;
    if (!sorted)
        sort(map->runs, map->count);
    for (size_t i = 1; i < map->count; i++) {
        const id_run *before = &map->runs[i - 1];
        *twice = map->runs[i].id;
        if (map->runs[i].id - before->id < before->count)
            return false;
    }
    return true;
}

uint64_t id_map_find(id_map *map, uint64_t id) {
    size_t lo = 0, hi = map->count;
    if (hi == 0)
        return UINT64_MAX;
    if (id - map->runs[map->last].id >= map->runs[map->last].count) {
        while (hi - lo > 1) {
            size_t middle = lo + (hi - lo) / 2;
            if (map->runs[middle].id <= id)
                lo = middle;
            else
                hi = middle;
        }
        map->last = lo;
    }
    const id_run *run = &map->runs[map->last];
    return id - run->id < run->count ? run->index + (id - run->id) : UINT64_MAX;
}

void id_map_release(id_map *map) {
    mem_free(map->m, map->runs);
    *map = (id_map){.m = map->m};
}
