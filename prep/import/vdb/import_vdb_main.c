/* leafcast import-vdb - writes a grid of an OpenVDB file as NRRD. */
#include <string.h>

#include "formats/base/cli_value.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "prep/import/import_hint.h"
#include "prep/import/importer.h"
#include "prep/import/importer_options.h"
#include "prep/import/vdb/vdb_memory.h"
#include "prep/import/vdb/vdb_tree.h"

enum { KEY_BOX = IMPORT_KEY_OWN, KEY_PAD, PAD_MAX = 1 << 20 };

static const struct argp_option options[] = {
    IMPORT_FIELD("grid"),
    IMPORT_COMPONENT,
    IMPORT_LIST("grids"),
    {"box", KEY_BOX, "X0,Y0,Z0,X1,Y1,Z1", CLI_BASIC,
     "the voxels to take, by their index coordinates (default: the box of those that are active)",
     0},
    {"pad", KEY_PAD, "N", CLI_BASIC, "N voxels more on each side of the box (0)", 0},
    IMPORT_END};

static vdb_request asked; /* from --box and --pad; the rest comes from the request */

static status set_box(const char *text) {
    double corner[6];
    status st = num_doubles(text, "--box", ", ", 6, corner);
    for (int i = 0; i < 6 && st == ST_OK; i++) {
        asked.box[i / 3][i % 3] = sample_holds(SAMPLE_I32, corner[i]) ? (int32_t)corner[i] : 0;
        if (asked.box[i / 3][i % 3] != corner[i] || (i >= 3 && corner[i] < corner[i - 3]))
            st = status_describe(ST_USAGE,
                                 "--box: \"%s\": expected six whole numbers, the lower corner, "
                                 "then the upper one",
                                 text);
    }
    asked.boxed = true;
    return st;
}

static status set_option(int key, const char *text) {
    switch (key) {
    case KEY_BOX: return set_box(text);
    case KEY_PAD: return cli_uint(text, "--pad", 0, PAD_MAX, &asked.pad);
    default: return ST_AGAIN;
    }
}

/* ---- slices ---- */

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    return vdb_tree_read(ctx, first, count, slices, NULL);
}

static status read_tiles(void *ctx, uint32_t first, uint32_t count, void *slices, uint8_t *busy) {
    return vdb_tree_read(ctx, first, count, slices, busy);
}

static void close_tree(void *ctx) {
    vdb_tree_close(ctx);
    vdb_memory_join(NULL);
}

static void take_facts(const vdb_facts *facts, grid *g) {
    uint32_t dims[3];
    for (int a = 0; a < 3; a++)
        dims[a] = facts->dims[a] < UINT32_MAX ? (uint32_t)facts->dims[a] : UINT32_MAX;
    grid_init(g, dims, facts->type);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            g->to_world[row][column] = facts->to_world[row][column];
    text_name(g->name, sizeof g->name, facts->name);
}

static status open_vdb(mem *m, const import_request *q, slice_source *out) {
    vdb_facts facts;
    vdb_tree *tree = NULL;
    static char hint[IMPORT_HINT_MAX]; /* asked outlives this call */
    asked.list = import_hint_list(q, hint);
    asked.path = q->paths[0];
    asked.field = q->field;
    asked.component = q->component;
    vdb_memory_join(m);
    const status st = vdb_tree_open(&asked, &facts, &tree);
    if (st != ST_OK) {
        vdb_memory_join(NULL);
        return st;
    }
    *out = (slice_source){.format = "OpenVDB",
                          .name = asked.path,
                          .m = m,
                          .read = read_slices,
                          .read_tiles = read_tiles,
                          .close = close_tree,
                          .ctx = tree};
    vdb_tree_background(tree, out->quiet);
    take_facts(&facts, &out->g);
    return ST_OK;
}

/* ---- the list ---- */

typedef struct listing {
    const import_list *to;
    const char *field; /* --field; NULL: the first that can be read */
    uint32_t component;
    bool found;
} listing;

static status pass_entry(void *ctx, const vdb_entry *e) {
    listing *l = ctx;
    const bool wanted = l->field ? strcmp(l->field, e->name) == 0 : !e->refuse;
    const import_item item = {.name = e->name,
                              .type = e->type,
                              .shape = {e->dims[0], e->dims[1], e->dims[2]},
                              .refuse = e->refuse,
                              .taken = wanted && !l->found,
                              .components = e->components,
                              .component = l->component};
    l->found = l->found || wanted;
    return l->to->take(l->to->ctx, &item);
}

static status list_vdb(mem *m, const import_request *q, const import_list *to) {
    listing l = {.to = to, .field = q->field, .component = q->component};
    vdb_memory_join(m);
    const status st = vdb_tree_list(q->paths[0], pass_entry, &l);
    vdb_memory_join(NULL);
    return st;
}

int main(int argc, char **argv) {
    static const importer row = {
        .verb = "import-vdb",
        .format = "OpenVDB",
        .inputs = "F.vdb",
        .doc = "Write a grid of an OpenVDB file as NRRD, to standard output or -o: level sets, fog "
               "volumes and other grids of numbers, active or not, in the box of what is active.\v"
               "Example:\n  leafcast import-vdb fire.vdb --field temperature --pad 1 -o fire.nrrd",
        .options = options,
        .set_option = set_option,
        .open = open_vdb,
        .list = list_vdb};
    return importer_main(&row, argc, argv);
}
