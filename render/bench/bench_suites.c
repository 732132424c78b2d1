#include "render/bench/bench_suites.h"

#include <string.h>

#include "render/app/view_camera.h"
#include "render/bench/bench_behind.h"
#include "render/bench/bench_compression.h"
#include "render/bench/bench_dynamic.h"
#include "render/bench/bench_figure.h"
#include "render/bench/bench_frames.h"
#include "render/bench/bench_hexes.h"
#include "render/bench/bench_intersect.h"
#include "render/bench/bench_isovalue.h"
#include "render/bench/bench_lanes.h"
#include "render/bench/bench_media.h"
#include "render/bench/bench_nodes.h"
#include "render/bench/bench_packets.h"
#include "render/bench/bench_pareto.h"
#include "render/bench/bench_plucker.h"
#include "render/bench/bench_projections.h"
#include "render/bench/bench_streaming.h"
#include "render/bench/bench_terrain.h"
#include "render/bench/bench_threads.h"
#include "render/bench/bench_time.h"
#include "render/bench/bench_time4d.h"
#include "render/bench/bench_update.h"
#include "render/bench/bench_walk.h"

/* ---- intersectors ---- */

static status record(bench_job *job, const bench_subject *s, bench_ray_cells *cells) {
    const leafcast_options open = {.size = sizeof(leafcast_options), .threads = 1};
    leafcast *volume = NULL;
    status st = (status)leafcast_open(s->path, &open, &volume);
    if (st == ST_OK)
        st = (status)leafcast_select(volume, s->view.surfaces, s->view.isos);
    if (st == ST_OK) {
        const leafcast_camera camera = view_camera_of(&s->view, volume);
        st = bench_ray_cells_record(&job->m, volume, &s->view.scene, &camera, (uint32_t)job->count,
                                    cells);
    }
    leafcast_close(volume);
    return st;
}

/* On a built-in field, or where there is a subject, on its ray-cells. */
static status judge(bench_job *job, const char *name, const bench_subject *s) {
    bench_ray_cells cells = {0};
    status st = s ? record(job, s, &cells)
                  : bench_ray_cells_make(&job->m, name, (uint32_t)job->count, &cells);
    if (st == ST_OK)
        st = bench_intersect(&job->m, name, &cells, job->runs, &job->table);
    mem_free(&job->m, cells.cells);
    return st;
}

static status intersectors(bench_job *job) {
    static const char *const names[] = {"bonsai", "angiogram", "engine", NULL};
    static const char *const brief[] = {NULL};
    bench_table_init(&job->table,
                     "Cell intersectors (M08 tables 4.5, 4.6): against a long-double solution of "
                     "every ray-cell; distances in cells, medians of CPU time, runs interleaved",
                     bench_intersect_headings);
    if (job->target && !strchr(job->target, '.'))
        return judge(job, job->target, NULL);
    status st = ST_OK;
    if (!job->target) {
        st = judge(job, "marschner-lobb", NULL);
        if (st == ST_OK)
            st = judge(job, "noise", NULL);
    }
    for (int i = 0; st == ST_OK; i++) {
        bench_subject s;
        st = bench_suite_subject(job, names, brief, i, &s);
        if (st == ST_OK)
            st = judge(job, s.label, &s);
    }
    return st == ST_AGAIN ? ST_OK : st;
}

/* ---- experiments E1, E2 ---- */

static const char *const E_NAMES[] = {"bonsai", "engine", "ch2better", "ml-256", NULL};
static const char *const E_BRIEF[] = {"ml-32", NULL};

static status walk(bench_job *job) {
    bench_table_init(&job->table,
                     "E1, below 4^3 cells: one thread, all resident, the same depth bits; medians "
                     "of CPU time, runs interleaved",
                     bench_walk_headings);
    status st = ST_OK;
    for (int i = 0; st == ST_OK; i++) {
        bench_subject s;
        st = bench_suite_subject(job, E_NAMES, E_BRIEF, i, &s);
        if (st == ST_OK)
            st = bench_walk(&job->m, s.path, &s.view, job->runs, &job->table);
    }
    return st == ST_AGAIN ? ST_OK : st;
}

static status kernel(bench_job *job) {
    bench_table_init(&job->table,
                     "E2, the cell kernel: double throughout, and behind a float filter with a "
                     "proven bound",
                     bench_filter_headings);
    status st = ST_OK;
    for (int i = 0; st == ST_OK; i++) {
        bench_subject s;
        st = bench_suite_subject(job, E_NAMES, E_BRIEF, i, &s);
        if (st == ST_OK)
            st = bench_filter(s.path, &s.view, &job->table);
    }
    return st == ST_AGAIN ? ST_OK : st;
}

/* ---- figure 4.9 ---- */

static status figure49(bench_job *job) {
    const char *path = job->output ? job->output : "figure49.png";
    bench_figure r;
    bench_table_init(&job->table,
                     "M08 figure 4.9: two surfaces in one cell; neubauer on the left, marmitt on "
                     "the right",
                     "intersector|rays|surfaces|missed");
    status st = bench_figure_draw(&job->m, path, job->force, job->view.camera.height / 2, &r);
    if (st)
        return st;
    for (int i = 0; i < 2; i++) {
        const uint64_t seen = i ? r.right : r.left;
        bench_table_add(&job->table, "%s", i ? "marmitt" : "neubauer");
        bench_table_add(&job->table, "%llu", (unsigned long long)r.rays);
        bench_table_add(&job->table, "%llu", (unsigned long long)seen);
        bench_table_add(&job->table, "%llu", (unsigned long long)(r.right - seen));
    }
    return ST_OK;
}

/* ---- the table ---- */

/* What every suite of whole frames counts. */
static const bench_count FRAME_COUNTS[] = {
    {"nodes/ray", 0.03}, {"cells/ray", 0.03}, {"roots/ray", 0.01}, {"active MB", 0.0},
    {"read MB", 0.05},   {"differ", 0.0},     {NULL, 0.0}};
static const bench_count PARETO_COUNTS[] = {
    {"rms cells", 0.05}, {"wrong px", 0.05}, {"active MB", 0.0}, {NULL, 0.0}};
static const bench_count NODE_COUNTS[] = {
    {"tree MB", 0.0},    {"tree/raw", 0.0}, {"nodes/ray", 0.01}, {"corners/ray", 0.01},
    {"cells/ray", 0.01}, {"hits", 0.0},     {NULL, 0.0}};
static const bench_count PACKET_COUNTS[] = {{"box tests", 0.03},
                                            {"polygon tests", 0.03},
                                            {"isorange tests", 0.03},
                                            {"isopolygons", 0.03},
                                            {"interval tests", 0.03},
                                            {"differ", 0.0},
                                            {NULL, 0.0}};
static const bench_count PLUCKER_COUNTS[] = {
    {"tets/ray", 0.01}, {"tests/tet", 0.01}, {"nodes/ray", 0.03}, {"differ", 0.0}, {NULL, 0.0}};
static const bench_count HEX_COUNTS[] = {{"hexes/ray", 0.01}, {"tests/hex", 0.01}, {"hits", 0.01},
                                         {"lost", 0.05},      {"missed", 0.05},    {"false", 0.05},
                                         {NULL, 0.0}};
static const bench_count INTERSECTOR_COUNTS[] = {
    {"ray-cells", 0.0}, {"surfaces", 0.0}, {"missed", 0.05}, {"false", 0.05}, {NULL, 0.0}};

static const bench_count BEHIND_COUNTS[] = {{"rays/px", 0.0},        {"hit px", 0.0},
                                            {"surfaces/hit", 0.0},   {"differ", 0.0},
                                            {"colours differ", 0.0}, {NULL, 0.0}};

static const bench_count STREAMING_COUNTS[] = {{"active MB", 0.0}, {"visible MB", 0.0},
                                               {"read MB", 0.05},  {"loads", 0.05},
                                               {"differ", 0.0},    {NULL, 0.0}};

static const bench_count TIME_COUNTS[] = {{"steps", 0.0},  {"hits", 0.0},   {"first MB", 0.05},
                                          {"loads", 0.05}, {"differ", 0.0}, {NULL, 0.0}};

static const bench_count UPDATE_COUNTS[] = {{"steps", 0.0}, {"treelets", 0.0}, {"new", 0.0},
                                            {"MB", 0.0},    {"cells", 0.0},    {"differ", 0.0},
                                            {NULL, 0.0}};

static const bench_count TIME4D_COUNTS[] = {
    {"leaves", 0.0},      {"step nodes", 0.0}, {"series nodes", 0.0}, {"sweep nodes", 0.0},
    {"first nodes", 0.0}, {"met", 0.0},        {"differ", 0.0},       {NULL, 0.0}};

static const bench_count DYNAMIC_COUNTS[] = {
    {"triangles", 0.0}, {"nodes/ray", 0.01}, {"triangles/ray", 0.01}, {"cost", 0.01},
    {"MB", 0.0},        {"hits", 0.01},      {"differ", 0.0},         {NULL, 0.0}};

/* Of suites that draw depths by the flags of the command line. */
#define LOOK_FLAGS "size view eye look-at up fov clip-box clip-plane lod light point-light shadows"

static const bench_suite SUITES[] = {
    {.name = "intersectors",
     .takes = "[marschner-lobb | noise | F.leaf --iso V]",
     .about = "the cell intersectors: what they miss, how far off they are,\n"
              "how long they take (M08 tables 4.5, 4.6)",
     .counts = INTERSECTOR_COUNTS,
     .run = intersectors,
     .view = LOOK_FLAGS,
     .surfaces = "iso opacity layers",
     .several = true,
     .labels = 2,
     .charts = {{"ns/ray-cell", "+-", false}, {"rms cells", NULL, true}}},
    {.name = "steps",
     .takes = "[F.leaf --iso V]",
     .about = "traversal steps of single rays and of tiles (M08 table 4.1)",
     .counts = FRAME_COUNTS,
     .run = bench_steps,
     .view = "size",
     .surfaces = "iso",
     .labels = 5,
     .charts = {{"nodes/ray", NULL, false}, {"cells/ray", NULL, false}, {"Mray/s", NULL, false}}},
    {.name = "nodes",
     .takes = "[F.leaf --iso V]",
     .about = "what nodes and looser ranges cost (M08 tables 4.2 to 4.4)",
     .counts = NODE_COUNTS,
     .run = bench_nodes,
     .view = "size",
     .surfaces = "iso",
     .labels = 4,
     .charts = {{"tree/raw", NULL, false}, {"ns/ray", "+-", false}, {"nodes/ray", NULL, false}}},
    {.name = "frames",
     .takes = "[F.leaf --iso V]",
     .about = "frames of many volumes, standard and close (M08 table 4.7)",
     .counts = FRAME_COUNTS,
     .run = bench_frames,
     .view = "size",
     .surfaces = "iso",
     .labels = 5,
     .charts = {{"Mray/s", NULL, false}, {"cells/ray", NULL, false}, {"read MB", NULL, false}}},
    {.name = "behind",
     .takes = "[F.leaf --iso V]",
     .about = "shadows and transparency beside the opaque frame, and beside\n"
              "rays that go one by one",
     .counts = BEHIND_COUNTS,
     .run = bench_behind,
     .view = "size view eye look-at up fov clip-box clip-plane light point-light",
     .surfaces = "iso",
     .several = true,
     .labels = 2,
     .charts = {{"x opaque", NULL, false}, {"ms", "+-", false}, {"one by one CPU ms", NULL, true}}},
    {.name = "figure414",
     .takes = "",
     .about = "one field on 32^3 to 1024^3 samples (M08 figure 4.14)",
     .counts = FRAME_COUNTS,
     .run = bench_figure414,
     .view = "size",
     .labels = 5,
     .curve = {.x = "samples",
               .y = "x smallest",
               .labels = 5,
               .series = {"isa", NULL},
               .log_x = true,
               .joined = true}},
    {.name = "zoom",
     .takes = "[F.leaf --iso V]",
     .about = "experiment E4: far, near and inside, zoom 0.5 to 50",
     .counts = FRAME_COUNTS,
     .run = bench_zoom,
     .view = "size",
     .surfaces = "iso",
     .labels = 5,
     .curve = {.x = "zoom",
               .y = "Mray/s",
               .labels = 5,
               .series = {"view", "isa"},
               .log_x = true,
               .log_y = true,
               .joined = true}},
    {.name = "pareto",
     .takes = "[F.leaf --iso V]",
     .about = "time against error: intersector x level of detail x pixels",
     .counts = PARETO_COUNTS,
     .run = bench_pareto,
     .view = "size",
     .surfaces = "iso",
     .labels = 4,
     .curve = {.x = "ms",
               .y = "rms cells",
               .labels = 4,
               .series = {"intersector", NULL},
               .log_x = true,
               .log_y = true,
               .mark = "front",
               .marked = "front"}},
    {.name = "media",
     .takes = "[F.leaf] [--tf T]...",
     .about = "time against error of media, certified and in steps (M08 table\n4.9); T: opaque, "
              "thin, positive, or as render --tf has it",
     .run = bench_media,
     .view = "size view eye look-at up fov clip-box clip-plane",
     .surfaces = "",
     .media = true,
     .labels = 4,
     .curve = {.x = "ms",
               .y = "worst",
               .labels = 4,
               .series = {"transfer", "way"},
               .log_x = true,
               .log_y = true,
               .mark = "front",
               .marked = "front"}},
    {.name = "projections",
     .takes = "[F.leaf --iso V]",
     .about = "greatest, least, mean and first value on rays, beside the\nisosurface",
     .run = bench_projections,
     .view = "size view eye look-at up fov clip-box clip-plane",
     .surfaces = "iso",
     .labels = 2,
     .charts = {{"ms", "+-", false}, {"x surface", NULL, false}, {"read %", NULL, false}}},
    {.name = "packets",
     .takes = "[F.leaf --iso V]",
     .about = "packets of 2x2 to 16x16 rays in a mesh (W07 table 4)",
     .counts = PACKET_COUNTS,
     .run = bench_packets,
     .view = "size view",
     .surfaces = "iso opacity layers",
     .several = true,
     .labels = 3,
     .charts = {{"box tests", NULL, true}, {"isorange tests", NULL, true}, {"ms", "+-", false}}},
    {.name = "plucker",
     .takes = "[F.leaf]",
     .about = "tets of a mesh from neighbour to neighbour by Pluecker tests,\n"
              "beside the tree (M08 6.3)",
     .counts = PLUCKER_COUNTS,
     .run = bench_plucker,
     .view = "size view eye look-at up fov",
     .surfaces = "",
     .labels = 3,
     .charts = {{"ms", "+-", false}, {"x tree", NULL, false}, {"tests/tet", NULL, false}}},
    {.name = "hexes",
     .takes = "[F.leaf --iso V]",
     .about = "hexahedra of a curvilinear grid from neighbour to neighbour, by\n"
              "Pluecker tests and by bilinear patches, beside exact cells (M08\n6.4)",
     .counts = HEX_COUNTS,
     .run = bench_hexes,
     .view = "size view",
     .surfaces = "iso",
     .labels = 3,
     .charts = {{"ms", "+-", false}, {"Mhexes/s", NULL, false}, {"t mean", NULL, true}}},
    {.name = "isopolygons",
     .takes = "[F.leaf --iso V]",
     .about = "isopolygons made on the fly, precomputed, cached (W07 4.4)",
     .run = bench_isopolygons,
     .view = "size view",
     .surfaces = "iso",
     .labels = 4,
     .charts = {{"ms", "+-", false}, {"new ms", NULL, false}, {"peak MB", NULL, false}}},
    {.name = "threads",
     .takes = "[F.leaf --iso V]",
     .about = "1 to --threads threads, beside a loop that only computes",
     .run = bench_threads,
     .view = "size",
     .surfaces = "iso",
     .labels = 2,
     .curve = {.x = "threads",
               .y = "frame/loop",
               .labels = 2,
               .series = {"volume", NULL},
               .joined = true}},
    {.name = "compression",
     .takes = "",
     .about = "small files: bytes, entropy, loading, first pictures warm and cold",
     .run = bench_compression,
     .view = "size",
     .labels = 1,
     .charts = {{"of zstd", NULL, false}, {"load MB/s", NULL, false}, {"x raw", NULL, false}}},
    {.name = "streaming",
     .takes = "[F.leaf --iso V]",
     .about = "what pictures read, raw and compressed, mapped and not; first\n"
              "and exact ones, cold and warm; how long threads stand still",
     .counts = STREAMING_COUNTS,
     .run = bench_streaming,
     .view = "size",
     .surfaces = "iso",
     .budget = true,
     .labels = 4,
     .charts = {{"cold exact", "+-", false},
                {"warm exact", NULL, false},
                {"read MB", NULL, false}}},
    {.name = "isovalues",
     .takes = "[F.leaf --iso V]",
     .about = "what a new isovalue costs: masks of active cells, frames",
     .run = bench_isovalue,
     .view = "size",
     .surfaces = "iso",
     .labels = 2,
     .charts = {{"us/treelet", "+-", false}, {"new/same", NULL, false}}},
    {.name = "time",
     .takes = "[F.leaf --iso V]",
     .about = "a new time step in every frame: of grids by single rays and\n"
              "tiles (M08 tables 5.3 to 5.6), of meshes by both schemas (W07\n8.5)",
     .counts = TIME_COUNTS,
     .run = bench_time,
     .view = "size field shading normals light point-light shadows ambient specular shininess "
             "clip-box clip-plane",
     .surfaces = "iso opacity layers",
     .several = true,
     .series = true,
     .labels = 3,
     .charts = {{"fps", "+-", false}, {"new/same", NULL, false}, {"resident MB", NULL, false}}},
    {.name = "update",
     .takes = "[F.leaf --iso V]",
     .about = "what a new time step of a grid costs beside rays (M08 tables\n5.1, 5.2)",
     .counts = UPDATE_COUNTS,
     .run = bench_update,
     .view = "",
     .surfaces = "iso",
     .labels = 3,
     .charts = {{"ms", "+-", false}, {"us/treelet", NULL, false}, {"new", NULL, false}}},
    {.name = "time4d",
     .takes = "[F.leaf --iso V]",
     .about = "one tree over treelets and time steps (M08 5.1.3), beside a\ntree a step",
     .counts = TIME4D_COUNTS,
     .run = bench_time4d,
     .view = "size",
     .surfaces = "iso",
     .labels = 2,
     .charts = {{"series nodes", NULL, true},
                {"sweep nodes", NULL, true},
                {"sweep us", NULL, true}}},
    {.name = "dynamic",
     .takes = "",
     .about = "triangles that move: refit and drawn, by boxes and by a bounded\n"
              "kd-tree (M08 5.3, tables 5.8, 5.9)",
     .counts = DYNAMIC_COUNTS,
     .run = bench_dynamic,
     .view = "size",
     .labels = 4,
     .charts = {{"ms", "+-", false}, {"refit ms", NULL, true}, {"nodes/ray", NULL, true}}},
    {.name = "terrain",
     .takes = "",
     .about = "a wood of tiles on hills, up to 10^12 triangles (M08 5.2.3,\ntable 5.7)",
     .run = bench_terrain,
     .view = "size",
     .budget = true,
     .labels = 1,
     .charts = {{"ms", "+-", false}, {"asked/ray", NULL, true}}},
    {.name = "lanes",
     .takes = "[F.leaf --iso V]",
     .about = "how full the vectors of tiles are, stage by stage",
     .run = bench_lanes,
     .view = "size view eye look-at up fov clip-box clip-plane",
     .surfaces = "iso opacity layers",
     .several = true,
     .once = true,
     .labels = 3,
     .charts = {{"filled %", NULL, false}, {"lanes/px", NULL, false}}},
    {.name = "walk",
     .takes = "[F.leaf --iso V]",
     .about = "experiment E1: below 4^3 cells",
     .run = walk,
     .view = LOOK_FLAGS,
     .surfaces = "iso opacity layers",
     .several = true,
     .labels = 2,
     .charts = {{"ns/ray", "+-", false}}},
    {.name = "kernel",
     .takes = "[F.leaf --iso V]",
     .about = "experiment E2: a float filter",
     .run = kernel,
     .view = LOOK_FLAGS,
     .surfaces = "iso opacity layers",
     .several = true,
     .once = true,
     .labels = 1,
     .charts = {{"double ns/16", NULL, false}, {"filtered ns/16", NULL, false}}},
    {.name = "figure49",
     .takes = "[-o FILE.png]",
     .about = "two surfaces in a cell (M08 figure 4.9)",
     .run = figure49,
     .view = "size",
     .once = true,
     .picture = true,
     .labels = 1,
     .charts = {{"surfaces", NULL, false}, {"missed", NULL, false}}}};
enum { SUITE_COUNT = sizeof SUITES / sizeof *SUITES };

const bench_suite *bench_suite_at(int index) {
    return index < SUITE_COUNT ? &SUITES[index] : NULL;
}

const bench_suite *bench_suite_find(const char *name) {
    for (int i = 0; i < SUITE_COUNT; i++)
        if (strcmp(SUITES[i].name, name) == 0)
            return &SUITES[i];
    return NULL;
}
