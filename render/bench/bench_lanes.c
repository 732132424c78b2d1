#include "render/bench/bench_lanes.h"

#include "render/app/view_camera.h"
#include "render/ray/lane_counts.h"
#include "render/ray/open_volume.h"

lane_counts lane_counts_now; /* what the kernels below count */

/* ---- kernels that count ---- */

CPU_KERNELS(tile_fn, grid_lanes_kernels, NULL, grid_lanes);
CPU_KERNELS(tile_fn, mesh_lanes_kernels, NULL, mesh_lanes);

/* False: none of this ISA. */
static bool let_count(leafcast *v) {
    const bool mesh = leafcast_describe(v).dims[0] == 0;
    v->kernels.tile = (mesh ? mesh_lanes_kernels : grid_lanes_kernels)[v->kernels.isa];
    return v->kernels.tile;
}

/* Lanes of a vector of floats, of doubles. */
static int floats_of(cpu_isa isa) {
    return isa == CPU_AVX512 ? 16 : isa == CPU_AVX2 ? 8 : 4;
}

static int doubles_of(cpu_isa isa) {
    return floats_of(isa) / 2;
}

/* ---- a picture ---- */

static status draw(bench_job *job, const bench_subject *s, leafcast *volume, uint64_t *pixels) {
    const leafcast_camera view = view_camera_of(&s->view, volume);
    float *colours = NULL;
    status st = (status)leafcast_select(volume, s->view.surfaces, s->view.isos);
    *pixels = (uint64_t)view.width * view.height;
    if (st == ST_OK && !let_count(volume))
        st = status_describe(ST_UNSUPPORTED, "this CPU has no vectors");
    if (st == ST_OK && !(colours = mem_array(&job->m, 3 * *pixels, sizeof *colours)))
        st = ST_NOMEM;
    const leafcast_image image = {
        .size = sizeof image, .r = colours, .g = colours + *pixels, .b = colours + 2 * *pixels};
    /* The first brings in what it needs, and waits for it. */
    for (int i = 0; i < 2 && st == ST_OK; i++) {
        lane_counts_now = (lane_counts){0};
        st = (status)leafcast_trace(volume, &s->view.scene, &view, &image, NULL, NULL, NULL);
    }
    mem_free(&job->m, colours);
    return st;
}

/* ---- the table ---- */

static void add_row(bench_table *t, const bench_subject *s, cpu_isa isa, const char *stage,
                    int width, const lane_stage *n, uint64_t pixels) {
    const double vectors = n->vectors ? (double)n->vectors : 1.0, lanes = (double)n->lanes;
    bench_table_add(t, "%s", s->label);
    bench_table_add(t, "%s", cpu_isa_name(isa));
    bench_table_add(t, "%s", stage);
    bench_table_add(t, "%d", width);
    bench_table_add(t, "%llu", (unsigned long long)n->vectors);
    bench_table_add(t, "%llu", (unsigned long long)n->lanes);
    bench_table_add(t, "%.3f", lanes / vectors);
    bench_table_add(t, "%.1f", 100.0 * lanes / (vectors * width));
    bench_table_add(t, "%.3f", lanes / (double)pixels);
}

static void add_rows(bench_table *t, const bench_subject *s, cpu_isa isa, bool mesh,
                     uint64_t pixels) {
    const lane_counts *n = &lane_counts_now;
    const int VF = floats_of(isa), VD = doubles_of(isa);
#define ROW(name, width) add_row(t, s, isa, #name, width, &n->name, pixels);
    if (mesh) {
        MESH_LANES(ROW)
    } else {
        GRID_LANES(ROW)
    }
#undef ROW
}

static status count(bench_job *job, const bench_subject *s, cpu_isa isa) {
    const leafcast_options options = {
        .size = sizeof options, .threads = 1, .isa = cpu_isa_name(isa)};
    leafcast *volume = NULL;
    uint64_t pixels = 0;
    status st = (status)leafcast_open(s->path, &options, &volume);
    if (st == ST_OK)
        st = draw(job, s, volume, &pixels);
    if (st == ST_OK)
        add_rows(&job->table, s, isa, leafcast_describe(volume).dims[0] == 0, pixels);
    leafcast_close(volume);
    return st;
}

status bench_lanes(bench_job *job) {
    static const char *const names[] = {"bonsai",   "ml-32",      "ml-256",
                                        "bucky-32", "bucky-2x32", NULL};
    static const char *const brief[] = {"ml-32", "bucky-12", NULL};
    bench_table_init(&job->table,
                     "Lanes: vectors of tiles' kernels that are not empty, and how full they are, "
                     "stage by stage",
                     "volume|isa|stage|width|vectors|lanes|lanes/vector|filled %|lanes/px");
    status st = ST_OK;
    for (int i = 0; st == ST_OK; i++) {
        bench_subject s;
        st = bench_suite_subject(job, names, brief, i, &s);
        for (int isa = (int)CPU_SCALAR + 1; isa <= (int)cpu_best() && st == ST_OK; isa++)
            st = count(job, &s, (cpu_isa)isa);
    }
    return st == ST_AGAIN ? ST_OK : st;
}
