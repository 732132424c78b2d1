#include "render/app/scene_tiles.h"

#include <math.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "render/app/render_script.h"
#include "render/ray/placement.h"

enum {
    CELLS_MAX = 1 << 24,
    NAMES_MAX = 2 * SCENE_TILES_MAX, /* of edges, on an axis */
    RAYS_AT_ONCE = 1 << 16
};

static const char TILES_KEYS[] = "tiles counts size origin seed ground between",
                  TILE_KEYS[] = "scene edges";

enum { WEST, SOUTH, EAST, NORTH, EDGES };

typedef struct tile {
    char *scene;
    int edge[EDGES]; /* numbers of names: those of WEST and EAST, and of SOUTH and NORTH */
} tile;

struct scene_tiles {
    scene_tiles *next;
    char *what, *ground;
    int count;
    tile *tile;
    uint32_t counts[2];
    double size[2], origin[3], between[2];
    uint64_t seed;
};

/* ---- Reading ---- */

static status wrong(const char *what, const char *key, const char *wanted) {
    return status_describe(ST_USAGE, "%s: \"%s\" takes %s", what, key, wanted);
}

static bool numbers(const json_t *value, size_t least, size_t most, double out[]) {
    const size_t count = json_array_size(value);
    bool fine = json_is_array(value) && count >= least && count <= most;
    for (size_t i = 0; i < count && fine; i++) {
        fine = json_is_number(json_array_get(value, i));
        out[i] = json_number_value(json_array_get(value, i));
    }
    return fine;
}

/* Number the names of edges, of each direction on its own: the first tile with one counts. */
typedef struct names {
    const char *of[NAMES_MAX];
    int count;
} names;

static int number_of(names *n, const char *name) {
    int i = 0;
    while (i < n->count && strcmp(n->of[i], name) != 0)
        i++;
    if (i == n->count)
        n->of[n->count++] = name;
    return i;
}

static status read_tile(scene_reading *r, json_t *value, const char *what, names across[2],
                        tile *to) {
    const json_t *edges = json_object_get(value, "edges");
    const char *key, *scene = json_string_value(json_object_get(value, "scene"));
    json_t *item;
    if (!scene || !*scene)
        return status_describe(ST_USAGE, "%s: a tile has a \"scene\"", what);
    json_object_foreach(value, key, item) {
        if (!cli_options_listed(TILE_KEYS, key))
            return scene_unknown(what, key, TILE_KEYS, false);
    }
    bool fine = json_array_size(edges) == EDGES;
    for (size_t i = 0; i < EDGES && fine; i++)
        fine = json_is_string(json_array_get(edges, i));
    if (!fine)
        return wrong(what, "edges", "the names of four: west, south, east, north");
    for (size_t i = 0; i < EDGES; i++)
        to->edge[i] = number_of(&across[i % 2], json_string_value(json_array_get(edges, i)));
    to->scene = mem_copy_text(&r->m, scene);
    return to->scene ? ST_OK : ST_NOMEM;
}

static status read_numbers(json_t *value, const char *what, scene_tiles *t) {
    const json_t *between = json_object_get(value, "between"),
                 *origin = json_object_get(value, "origin"), *seed = json_object_get(value, "seed");
    double counts[2];
    if (!numbers(json_object_get(value, "counts"), 2, 2, counts) || !(counts[0] >= 1.0) ||
        !(counts[1] >= 1.0) || !(counts[0] * counts[1] <= CELLS_MAX) ||
        counts[0] != floor(counts[0]) || counts[1] != floor(counts[1]))
        return wrong(what, "counts", "how many there are along x and y: 16777216 in all at most");
    if (!numbers(json_object_get(value, "size"), 2, 2, t->size) || !(t->size[0] > 0.0) ||
        !(t->size[1] > 0.0))
        return wrong(what, "size", "how long a tile is along x and y: two numbers above 0");
    if (origin && !numbers(origin, 2, 3, t->origin))
        return wrong(what, "origin", "two or three numbers");
    if (between && (!numbers(between, 2, 2, t->between) || !(t->between[0] <= t->between[1])))
        return wrong(what, "between", "the least and the greatest elevation");
    if (seed && (!json_is_integer(seed) || json_integer_value(seed) < 0))
        return wrong(what, "seed", "a whole number");
    for (int a = 0; a < 2; a++)
        t->counts[a] = (uint32_t)counts[a];
    t->seed = (uint64_t)json_integer_value(seed);
    return ST_OK;
}

static status read_all(scene_reading *r, json_t *value, const char *what, scene_tiles *t) {
    const json_t *tiles = json_object_get(value, "tiles"),
                 *ground = json_object_get(value, "ground");
    const size_t count = json_array_size(tiles);
    names across[2] = {{.count = 0}, {.count = 0}};
    const char *key;
    json_t *item;
    json_object_foreach(value, key, item) {
        if (!cli_options_listed(TILES_KEYS, key))
            return scene_unknown(what, key, TILES_KEYS, false);
    }
    if (count == 0 || count > SCENE_TILES_MAX)
        return wrong(what, "tiles", "an array of 1 to 256");
    t->what = mem_copy_text(&r->m, what);
    t->tile = mem_array(&r->m, count, sizeof *t->tile);
    if (!t->what || !t->tile)
        return ST_NOMEM;
    t->count = (int)count;
    status st = read_numbers(value, what, t);
    for (size_t i = 0; i < count && st == ST_OK; i++)
        st = read_tile(r, json_array_get(tiles, i), what, across, &t->tile[i]);
    if (st == ST_OK && ground && !json_is_string(ground))
        return wrong(what, "ground", "the \"file\" of another object of the scene");
    return st == ST_OK && ground ? scene_find_file(r, json_string_value(ground), what, &t->ground)
                                 : st;
}

status scene_tiles_read(scene_reading *r, json_t *value, const char *what, scene_tiles **out) {
    scene_tiles *t = mem_zalloc(&r->m, sizeof *t);
    if (!t)
        return ST_NOMEM;
    *t = (scene_tiles){.next = r->tiles, .between = {-INFINITY, INFINITY}};
    r->tiles = *out = t;
    return read_all(r, value, what, t);
}

void scene_tiles_free(mem *m, scene_tiles *list) {
    while (list) {
        scene_tiles *next = list->next;
        for (int k = 0; k < list->count; k++)
            mem_free(m, list->tile[k].scene);
        mem_free(m, list->tile);
        mem_free(m, list->what);
        mem_free(m, list->ground);
        mem_free(m, list);
        list = next;
    }
}

int scene_tiles_count(const scene_tiles *t) {
    return t->count;
}

const char *scene_tiles_scene(const scene_tiles *t, int k) {
    return t->tile[k].scene;
}

const char *scene_tiles_ground(const scene_tiles *t) {
    return t->ground;
}

/* ---- Which tile ---- */

static uint64_t hash_of(uint64_t seed, uint32_t x, uint32_t y) {
    uint64_t h = seed + UINT64_C(0x9e3779b97f4a7c15) * (((uint64_t)y << 32 | x) + 1);
    h = (h ^ h >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    h = (h ^ h >> 27) * UINT64_C(0x94d049bb133111eb);
    return h ^ h >> 31;
}

/* Returns the tile of a cell, between those before and below it; NULL: there is none. */
static const tile *choose(const scene_tiles *t, uint32_t x, uint32_t y, const tile *before,
                          const tile *below) {
    const tile *fit[SCENE_TILES_MAX];
    size_t count = 0;
    for (int k = 0; k < t->count; k++) {
        const tile *of = &t->tile[k];
        if ((!before || before->edge[EAST] == of->edge[WEST]) &&
            (!below || below->edge[NORTH] == of->edge[SOUTH]))
            fit[count++] = of;
    }
    return count > 0 ? fit[hash_of(t->seed, x, y) % count] : NULL;
}

static status lay(const scene_tiles *t, uint16_t tiles[]) {
    for (uint32_t y = 0; y < t->counts[1]; y++)
        for (uint32_t x = 0; x < t->counts[0]; x++) {
            uint16_t *at = tiles + (size_t)y * t->counts[0] + x;
            const tile *of = choose(t, x, y, x > 0 ? &t->tile[at[-1]] : NULL,
                                    y > 0 ? &t->tile[at[-(ptrdiff_t)t->counts[0]]] : NULL);
            if (!of)
                return status_describe(ST_USAGE,
                                       "%s: at cell %u, %u no tile fits, by its edges, beside tile "
                                       "%d%s",
                                       t->what, x, y, x > 0 ? at[-1] : at[-(ptrdiff_t)t->counts[0]],
                                       x > 0 && y > 0 ? ", and above the one below" : "");
            *at = (uint16_t)(of - t->tile);
        }
    return ST_OK;
}

/* ---- The ground ---- */

/* Find the elevation at the corners of all cells; NaN: there is no ground. */
static status find_ground(const scene_tiles *t, mem *m, const leafcast_shown *ground, double z[]) {
    const size_t row = t->counts[0] + 1, all = row * (t->counts[1] + 1);
    const leafcast_info info = leafcast_describe(ground->volume);
    const placement place = placement_of(ground->place);
    leafcast_scene scene = leafcast_scene_default();
    double box[2][3];
    scene.volumes = ground;
    scene.volume_count = 1;
    placement_box(&place, info.bounds, box);
    const double top = box[1][2] + 1e-3 * (box[1][2] - box[0][2]) + 1e-6 * fabs(box[1][2]);
    leafcast_ray *rays = mem_array(m, RAYS_AT_ONCE, sizeof *rays);
    leafcast_ray_hit *hits = mem_array(m, RAYS_AT_ONCE, sizeof *hits);
    status st = rays && hits ? ST_OK : ST_NOMEM;
    for (size_t from = 0; from < all && st == ST_OK; from += RAYS_AT_ONCE) {
        const size_t count = all - from < RAYS_AT_ONCE ? all - from : RAYS_AT_ONCE;
        for (size_t i = 0; i < count; i++) {
            const double at[2] = {(double)((from + i) % row), (double)((from + i) / row)};
            rays[i] = (leafcast_ray){.origin = {t->origin[0] + at[0] * t->size[0],
                                                t->origin[1] + at[1] * t->size[1], top},
                                     .direction = {0.0, 0.0, -1.0},
                                     .t1 = INFINITY};
        }
        st = render_status(leafcast_trace_rays(ground->volume, &scene, rays, count, hits));
        for (size_t i = 0; i < count && st == ST_OK; i++)
            z[from + i] = hits[i].volume < 0 ? (double)NAN : top - hits[i].t;
    }
    mem_free(m, hits);
    mem_free(m, rays);
    return st;
}

/* Set where the tile of a cell lies. Returns false if it lies nowhere. z: of all corners, or NULL.
 */
static bool place_cell(const scene_tiles *t, uint32_t x, uint32_t y, const double *z,
                       double place[12]) {
    double corner[4] = {t->origin[2], t->origin[2], t->origin[2], t->origin[2]};
    for (uint32_t i = 0; i < 4 && z; i++)
        corner[i] = z[(size_t)(y + i / 2) * (t->counts[0] + 1) + x + i % 2];
    const double mean = 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
    if (!(mean >= t->between[0] && mean <= t->between[1])) /* a NaN is not */
        return false;
    const double rise[2] = {0.5 * (corner[1] - corner[0] + corner[3] - corner[2]),
                            0.5 * (corner[2] - corner[0] + corner[3] - corner[1])};
    const double at[12] = {1.0,
                           0.0,
                           0.0,
                           t->origin[0] + x * t->size[0],
                           0.0,
                           1.0,
                           0.0,
                           t->origin[1] + y * t->size[1],
                           rise[0] / t->size[0],
                           rise[1] / t->size[1],
                           1.0,
                           mean - 0.5 * (rise[0] + rise[1])};
    memcpy(place, at, sizeof at);
    return true;
}

/* List the places of tiles, and in place of `tiles` which lie there. */
static void list_places(const scene_tiles *t, uint16_t tiles[], const double *z,
                        render_places *places) {
    for (uint32_t y = 0; y < t->counts[1]; y++)
        for (uint32_t x = 0; x < t->counts[0]; x++)
            if (place_cell(t, x, y, z, places->at + 12 * (size_t)places->count))
                tiles[places->count++] = tiles[(size_t)y * t->counts[0] + x];
}

status scene_tiles_place(const scene_tiles *t, mem *m, const leafcast_shown *ground,
                         render_places *places, uint16_t **which) {
    const size_t cells = (size_t)t->counts[0] * t->counts[1],
                 corners = ((size_t)t->counts[0] + 1) * ((size_t)t->counts[1] + 1);
    double *z = ground ? mem_array(m, corners, sizeof *z) : NULL;
    *which = mem_array(m, cells, sizeof **which);
    *places = (render_places){mem_array(m, cells, 12 * sizeof *places->at), 0};
    status st = *which && places->at && (z || !ground) ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = lay(t, *which);
    if (st == ST_OK && ground)
        st = find_ground(t, m, ground, z);
    if (st == ST_OK)
        list_places(t, *which, z, places);
    mem_free(m, z);
    return st;
}
