#include "render/view/view_map.h"

#include <math.h>

/* Choose the number of blocks along each axis, so that blocks are about cubes. */
static void choose_blocks(const leafcast_info *info, uint32_t blocks[3]) {
    double edges[3], longest = 0.0;
    for (int a = 0; a < 3; a++) {
        edges[a] =
            info->dims[a] > 0 ? info->dims[a] - 1.0 : info->bounds[1][a] - info->bounds[0][a];
        longest = fmax(longest, edges[a]);
    }
    for (int a = 0; a < 3; a++)
        blocks[a] = (uint32_t)fmax(1.0, rint(VIEW_MAP_SIDE * (edges[a] / longest)));
}

/* List one of the counts that `count` structs of `size` bytes have, at this offset. */
static json_t *list(const void *map, size_t count, size_t size, size_t at) {
    json_t *out = json_array();
    for (size_t i = 0; i < count && out; i++) {
        const uint32_t *n = (const uint32_t *)(const void *)((const char *)map + i * size + at);
        json_array_append_new(out, json_integer(*n));
    }
    return out;
}

static json_t *describe_blocks(const leafcast_block *map, const uint32_t blocks[3],
                               uint32_t level) {
    const size_t count = (size_t)blocks[0] * blocks[1] * blocks[2];
    return json_pack("{s:I,s:[I,I,I],s:o,s:o,s:o}", "level", (json_int_t)level, "blocks",
                     (json_int_t)blocks[0], (json_int_t)blocks[1], (json_int_t)blocks[2], "wanted",
                     list(map, count, sizeof *map, offsetof(leafcast_block, wanted)), "resident",
                     list(map, count, sizeof *map, offsetof(leafcast_block, resident)), "seen",
                     list(map, count, sizeof *map, offsetof(leafcast_block, seen)));
}

json_t *view_map_describe(mem *m, leafcast *volume, uint32_t level, const leafcast_stats *stats) {
    const leafcast_info info = leafcast_describe(volume);
    /* A mesh's coarse levels have no treelets of their own. */
    const uint32_t of = level < info.levels ? level : info.levels - 1;
    uint32_t blocks[3];
    json_t *out = NULL;
    choose_blocks(&info, blocks);
    leafcast_block *map = mem_array(m, (size_t)blocks[0] * blocks[1] * blocks[2], sizeof *map);
    if (map && leafcast_map_treelets(volume, of, blocks, map) == LEAFCAST_OK)
        out = json_pack(
            "{s:s,s:I,s:I,s:I,s:I,s:o}", "type", "treelets", "total",
            (json_int_t)stats->treelets_total, "active", (json_int_t)stats->treelets_active,
            "loaded", (json_int_t)stats->treelets_loaded, "bytes_resident",
            (json_int_t)stats->bytes_resident, "map", describe_blocks(map, blocks, level));
    mem_free(m, map);
    return out;
}

json_t *view_map_steps(mem *m, leafcast *volume, uint32_t field) {
    const uint32_t steps = leafcast_describe(volume).steps;
    json_t *out = NULL;
    leafcast_holding *map = mem_array(m, steps, sizeof *map);
    if (map && leafcast_map_steps(volume, field, steps, map) == LEAFCAST_OK)
        out =
            json_pack("{s:s,s:o,s:o}", "type", "steps", "wanted",
                      list(map, steps, sizeof *map, offsetof(leafcast_holding, wanted)), "resident",
                      list(map, steps, sizeof *map, offsetof(leafcast_holding, resident)));
    mem_free(m, map);
    return out;
}

/* Set has[] where any of the isovalues is. some: room for as many. */
static bool find_marks(const view_marks *marks, uint8_t *has, uint8_t *some) {
    uint32_t first;
    bool found = has && some;
    for (int i = 0; i < marks->count && found; i++) {
        const double v = marks->isovalues[i];
        found = leafcast_find_steps(marks->volume, marks->field, v, v, marks->steps, some,
                                    &first) == LEAFCAST_OK;
        for (uint32_t step = first; step < marks->steps && found; step++)
            has[step] |= some[step];
    }
    return found;
}

/* List the runs of steps that have it, first and last one. */
static json_t *runs(const uint8_t *has, uint32_t steps) {
    json_t *out = json_array();
    for (uint32_t step = 0, end; step < steps; step = end) {
        end = step + 1;
        while (end < steps && has[end] == has[step])
            end++;
        if (has[step])
            json_array_append_new(out, json_pack("[I,I]", (json_int_t)step, (json_int_t)end - 1));
    }
    return out;
}

json_t *view_map_marks(mem *m, const view_marks *marks) {
    uint8_t *has = mem_zalloc(m, marks->steps), *some = mem_alloc(m, marks->steps);
    json_t *out = NULL;
    if (find_marks(marks, has, some))
        out = json_pack("{s:s,s:I,s:o}", "type", "present", "steps", (json_int_t)marks->steps, "at",
                        marks->count > 0 ? runs(has, marks->steps) : json_null());
    mem_free(m, some);
    mem_free(m, has);
    return out;
}
