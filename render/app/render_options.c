#include "render/app/render_options.h"

#include <string.h>

#include "formats/base/cli_value.h"
#include "render/app/scene_tiles.h"
#include "render/app/world_options.h"

/* ---- flags ---- */

enum {
    FILES = 0x3000, /* plus a frame_file */
    STATS = FILES + FRAME_FILES,
    REPEAT,
    TURNTABLE,
    FAIL_EMPTY,
    CERTIFY,
    PROGRESSIVE,
    ALLOW_MISSING,
    FONT,
    ISO_LIST,
    CAMERA_PATH,
    FRAMES,
    SCRIPT,
    STATE,
    AND,
    STEPS,
    FORMAT,
    BACKEND,
    SCHEMA,
    TREELET_LIMIT,
    ISA,
    PACKETS,
    ISOPOLYGONS,
    TRAVERSAL,
    FOLLOW_LINKS
};

static const char BACKENDS[] = "auto|mapped|arena", SIDES[] = "tile|2|4|8|16",
                  POLYGONS[] = "onthefly|precompute|cache", TRAVERSALS[] = "tree|faces";

const struct argp_option render_options_table[] = {
    {NULL, 0, NULL, 0, "Outputs (-o takes .png, .ppm, .pfm, .exr; -: standard output):", 1},
    {"format", FORMAT, "NAME", 0,
     "png, ppm, pfm or exr, where the name does not say it (-o -: png)", 0},
    {"depth-f64", FILES + FRAME_RAW + IMAGE_DEPTH, "FILE", 0,
     "distances from the eye as raw doubles", 0},
    {"rgba-f64", FILES + FRAME_RAW + IMAGE_RGBA, "FILE", 0,
     "red, green, blue, alpha as raw doubles: linear, premultiplied, unrounded", 0},
    {"error-f64", FILES + FRAME_RAW + IMAGE_ERROR, "FILE", 0,
     "of media: how far a pixel is at most from the exact integral, as raw doubles", 0},
    {"value-f64", FILES + FRAME_RAW + IMAGE_VALUE, "FILE", 0,
     "of --project: the values as raw doubles; NaN where there is none", 0},
    {"write-tf", FILES + FRAME_TF, "FILE", 0,
     "the transfer function that is used, as text for --tf", 0},
    {"stats", STATS, "FILE", 0, "times, rays, treelets and bytes as JSON", 0},
    {"fail-empty", FAIL_EMPTY, NULL, 0, "exit 1 where a picture shows no surface", 0},
    {"certify", CERTIFY, NULL, 0,
     "of media: draw again with half of the bound, and see that no channel differs by more than "
     "both bounds; else exit 1, without a picture",
     0},
    {"allow-missing", ALLOW_MISSING, NULL, 0,
     "draw treelets that are damaged by coarser ones, or not at all, mark their pixels, and exit "
     "with 1",
     0},
    {"progressive", PROGRESSIVE, NULL, 0,
     "write a first picture of what is soon there, as --preview does; the exact one takes its "
     "place. If that fails, the first one stays",
     0},
    {"repeat", REPEAT, "N", CLI_EXPERIMENT, "draw N times; the statistics are the median picture's",
     0},
    {"state", STATE, "FILE", 0,
     "a view as leafcast view has saved it: a JSON object whose keys are these flags; flags behind "
     "it "
     "add to it",
     10},
    {"and", AND, "FILE", 0,
     "a volume more, in the same picture; --iso, --colour, --opacity, --tf, --colour-map, "
     "--window, --opacity-length, --field and --step behind it are about that one. Repeatable; "
     "each can have a medium",
     10},
    WORLD_OPTION(10),
    {"follow-links", FOLLOW_LINKS, NULL, 0,
     "a scene file may name files anywhere, not only in its own folder", 10},
    {NULL, 0, NULL, 0, "Many pictures (-o out.png becomes out_0000.png ...):", 50},
    {"iso-list", ISO_LIST, "V1,V2,...", 0, "a picture for each isovalue; V:V is a picture with two",
     0},
    {"steps", STEPS, STEP_LIST_FORM, 0, "a picture for each of these time steps", 0},
    {"camera-path", CAMERA_PATH, "FILE", 0,
     "a picture for each entry of a JSON array: [{\"eye\": [1,2,3]}, ...]", 0},
    {"frames", FRAMES, "N", 0,
     "a movie: N pictures from the first entry of --camera-path to the last, with what is between "
     "them",
     0},
    {"turntable", TURNTABLE, "N", 0,
     "N pictures around what the camera looks at, about what is up, at equal angles", 0},
    {"script", SCRIPT, "FILE", 0,
     "a picture for each line, as it comes (-: standard input): a JSON object whose keys are these "
     "flags, with \"output\"; each is answered by a line of JSON",
     0},
    {"font", FONT, "FILE", 0, "letters of --annotate and --title (DejaVu Sans, or another)", 35},
    {NULL, 0, NULL, 0, "Machine:", 60},
    {"backend", BACKEND, BACKENDS, CLI_EXPERIMENT, "how treelets come in: auto, mapped or arena",
     0},
    {"schema", SCHEMA, "N", CLI_EXPERIMENT,
     "how another time step of a mesh comes in, 1: each step's trees are read, and stay beside "
     "those "
     "of other steps; 2: one tree, refit to vertices that are read (1 where all steps fit)",
     0},
    {"treelet-limit", TREELET_LIMIT, "N", CLI_EXPERIMENT,
     "never hold more than N treelets (0: what memory allows); for experiments", 0},
    {"isa", ISA, "auto|scalar|sse42|avx2|avx512", CLI_EXPERIMENT,
     "instructions to use: auto, scalar, sse42, avx2, avx512", 0},
    {"packets", PACKETS, SIDES, CLI_EXPERIMENT,
     "of a mesh: how rays walk together: by tile, or in packets of 2, 4, 8 or 16 on a side as "
     "those of Wald and others, 2007",
     0},
    {"isopolygons", ISOPOLYGONS, POLYGONS, CLI_EXPERIMENT,
     "of a mesh: onthefly, or kept: precompute, or cache (when rays first meet them) (onthefly)",
     0},
    {"traversal", TRAVERSAL, TRAVERSALS, CLI_EXPERIMENT,
     "of a mesh: how media and projections find tets: tree, or faces, from neighbour to neighbour",
     0},
    {NULL, 0, NULL, 0, NULL, 0}};

static status set_machine(render_options *o, int key, const char *text) {
    static const int sides[] = {0, 2, 4, 8, 16};
    int which = 0;
    status st = ST_OK;
    switch (key) {
    case BACKEND:
        st = cli_word(text, "--backend", BACKENDS, &which);
        o->open.backend = (leafcast_backend)which;
        return st;
    case SCHEMA:
        st = cli_int(text, "--schema", 1, 2, &which);
        o->experiments.schema = (leafcast_schema)which;
        return st;
    case ISOPOLYGONS:
        st = cli_word(text, "--isopolygons", POLYGONS, &which);
        o->experiments.isopolygons = (leafcast_isopolygons)which;
        return st;
    case TRAVERSAL:
        st = cli_word(text, "--traversal", TRAVERSALS, &which);
        o->traversal = st == ST_OK ? which + 1 : 0;
        return st;
    case PACKETS:
        st = cli_word(text, "--packets", SIDES, &which);
        o->experiments.packets = sides[which];
        return st;
    case ISA: o->open.isa = text; return ST_OK;
    case WORLD_OPTION_KEY: return world_option_set(text, &o->open.axes);
    case TREELET_LIMIT:
        return cli_uint(text, "--treelet-limit", 0, UINT32_MAX, &o->experiments.treelet_limit);
    default: return ST_AGAIN;
    }
}

static mem outside(void) {
    mem m;
    mem_init(&m, 0);
    return m;
}

render_also *render_options_also(render_options *o) {
    mem m = outside();
    if (mem_grow(&m, &o->also, sizeof *o->also, (size_t)o->also_count, 4, &o->also_room) != ST_OK)
        return NULL;
    render_also *also = &o->also[o->also_count++];
    *also = (render_also){.same = -1};
    view_options_init(&also->view);
    also->view.takes_media = true;
    return also;
}

void render_options_release(render_options *o) {
    mem m = outside();
    for (int i = 0; i < o->also_count; i++) {
        mem_free(&m, o->also[i].places.at);
        mem_free(&m, o->also[i].allocated);
    }
    for (int i = 0; i < o->group_count; i++) {
        mem_free(&m, o->groups[i].places.at);
        mem_free(&m, o->groups[i].which);
    }
    for (size_t i = 0; i < o->scene_path_count; i++)
        mem_free(&m, o->scene_paths[i]);
    scene_tiles_free(&m, o->scene_tiles);
    mem_free(&m, o->groups);
    mem_free(&m, o->scene_paths);
    mem_free(&m, o->places.at);
    mem_free(&m, o->first_path);
    mem_free(&m, o->flags);
    mem_free(&m, o->also);
    o->also = NULL;
    o->also_count = 0;
}

static status add_volume(render_options *o, const char *path) {
    if (o->also_count == LEAFCAST_VOLUMES_MAX - 1)
        return status_describe(ST_USAGE, "--and: at most %d volumes in one picture",
                               LEAFCAST_VOLUMES_MAX);
    render_also *also = render_options_also(o);
    if (!also)
        return ST_NOMEM;
    also->path = path;
    return ST_OK;
}

/* Returns the options that a flag belongs to: of the last volume of --and, or of the picture. */
static view_options *view_of(render_options *o, int key) {
    return o->also_count > 0 && view_options_of_one(key) ? &o->also[o->also_count - 1].view
                                                         : &o->view;
}

/* Keep a flag of the picture, or of its first volume, in case that the input is a scene file. */
static status note_flag(render_options *o, int key, const char *text) {
    mem m = outside();
    const status st = mem_grow(&m, &o->flags, sizeof *o->flags, o->flag_count, 16, &o->flag_room);
    if (st == ST_OK)
        o->flags[o->flag_count++] = (struct render_flag){key, text, view_options_of_one(key)};
    return st;
}

/* Read --state at its place among the flags: later flags add to it. Errors are kept for later. */
static status read_state(render_options *o, const char *path) {
    if (o->state)
        return status_describe(ST_USAGE, "--state: one is enough");
    o->state = path;
    status_note_take(&o->state_read, script_load_state(path, &o->view));
    return ST_OK;
}

status render_options_set(void *own, int key, const char *text) {
    render_options *o = own;
    status st = ST_OK;
    switch (key) {
    case STATE: return read_state(o, text);
    case AND: return add_volume(o, text);
    case FORMAT: o->format = text; return ST_OK;
    case STATS: o->stats = text; return ST_OK;
    case SCRIPT: o->script = text; return ST_OK;
    case ISO_LIST: o->iso_list = text; return ST_OK;
    case CAMERA_PATH: o->camera_path = text; return ST_OK;
    case FRAMES: return cli_int(text, "--frames", 1, PICTURES_MAX, &o->frames);
    case STEPS: return step_list_parse(text, "--steps", &o->steps);
    case TURNTABLE: return cli_int(text, "--turntable", 1, PICTURES_MAX, &o->turns);
    case FOLLOW_LINKS: o->follow_links = true; return ST_OK;
    case FAIL_EMPTY: o->fail_empty = true; return ST_OK;
    case CERTIFY: o->certify = true; return ST_OK;
    case PROGRESSIVE: o->progressive = true; return ST_OK;
    case ALLOW_MISSING: o->view.scene.allow_missing = true; return ST_OK;
    case FONT: o->font = text; return ST_OK;
    case REPEAT: return cli_int(text, "--repeat", 1, 10000, &o->repeat);
    default:
        if (key >= FILES && key < STATS) {
            o->files[key - FILES] = text;
            return ST_OK;
        }
        st = set_machine(o, key, text);
        if (st != ST_AGAIN)
            return st;
        st = view_options_set(view_of(o, key), key, text);
        return st == ST_OK && view_of(o, key) == &o->view ? note_flag(o, key, text) : st;
    }
}

/* Returns the number of files to write besides the picture. streams: count only files that are
 * standard output. */
static int count_files(const render_options *o, bool streams) {
    int n = 0;
    for (int i = 0; i < FRAME_FILES; i++)
        n += streams ? output_name_is_stdout(o->files[i]) : o->files[i] != NULL;
    return n;
}

/* Check all flags together. */
status render_options_check(void *own) {
    const render_options *o = own;
    const bool sequence = render_options_many(o);
    const int files = count_files(o, false), streams = count_files(o, true);
    const bool output = o->common.output || files > 0 || o->stats || o->common.json;
    if (!o->common.input)
        return status_describe(ST_USAGE, "which treelet file?");
    if (o->script && (sequence || o->common.output || files > 0 || o->stats))
        return status_describe(ST_USAGE,
                               "--script takes its outputs from its lines and answers them on "
                               "standard output");
    if (output_name_is_stdout(o->common.output) + streams + o->common.json > 1)
        return status_describe(ST_USAGE, "standard output takes one of -o -, --depth-f64 - (or "
                                         "another plane) and --json");
    if (!o->script && !output)
        return status_describe(ST_USAGE, "nothing to write: -o FILE.png");
    if (o->progressive && o->view.scene.preview)
        return status_describe(ST_USAGE, "either --preview or --progressive");
    if (o->view.scene.allow_missing && (o->progressive || o->certify || o->view.scene.preview))
        return status_describe(ST_USAGE, "--allow-missing is for exact pictures: without "
                                         "--preview, --progressive and --certify");
    if (o->progressive && o->certify)
        return status_describe(ST_USAGE, "either --certify or --progressive");
    if (o->progressive && !o->script &&
        (!o->common.output || output_name_is_stdout(o->common.output)))
        return status_describe(ST_USAGE, "--progressive writes a file twice: -o FILE.png");
    if (o->frames && !o->camera_path)
        return status_describe(ST_USAGE, "--frames: of which --camera-path?");
    if (o->iso_list && o->view.isos > 0)
        return status_describe(ST_USAGE, "either --iso or --iso-list");
    if (step_list_given(&o->steps) && (o->view.step > 0 || o->view.time.given))
        return status_describe(ST_USAGE, "either --%s or --steps",
                               o->view.time.given ? "time" : "step");
    /* With a path or a script, too: their entries may give others. */
    return view_options_check_either(&o->view);
}

status render_options_check_file(const render_options *o, const leafcast_info *info) {
    const bool can = info->abilities & LEAFCAST_ABILITY_PACKETS;
    const struct {
        bool given;
        const char *name;
    } of_meshes[] = {{o->experiments.packets != 0, "--packets"},
                     {o->experiments.isopolygons != 0, "--isopolygons"},
                     {o->traversal != 0, "--traversal"},
                     {o->experiments.schema != 0, "--schema"}};
    for (size_t i = 0; i < sizeof of_meshes / sizeof *of_meshes; i++)
        if (of_meshes[i].given && !can)
            return status_describe(ST_USAGE, "%s is for meshes, and %s is a %s", of_meshes[i].name,
                                   o->common.input, info->kind);
    if (o->experiments.schema != 0 && info->steps == 1)
        return status_describe(ST_USAGE, "--schema: %s has one step", o->common.input);
    return ST_OK;
}

bool render_options_many(const render_options *o) {
    return o->iso_list || step_list_given(&o->steps) || o->camera_path || o->turns;
}

bool render_options_neighbours(const render_options *o) {
    bool filled = view_options_filled(&o->view);
    for (int i = 0; i < o->also_count; i++)
        filled |= view_options_filled(&o->also[i].view);
    return o->traversal ? o->traversal == 2 : filled && !o->experiments.isopolygons;
}
