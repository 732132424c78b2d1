#include "render/bench/bench_lanes.h"

#include "render/app/view_camera.h"
#include "render/kernels.h"
#include "render/ray/lane_counts.h"

lane_counts lane_counts_now; /* what the kernels below count */

/* ---- kernels that count ---- */

#if defined __x86_64__ || defined __i386__
#define DECLARE(name)                                                            \
    void name(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[], \
              tile_outcome *out, ray_counters *counters)
DECLARE(grid_lanes_sse42);
DECLARE(grid_lanes_avx2);
DECLARE(grid_lanes_avx512);
DECLARE(mesh_lanes_sse42);
DECLARE(mesh_lanes_avx2);
DECLARE(mesh_lanes_avx512);
#endif

/* False: none of this ISA. */
static bool let_count(cpu_isa isa, kernels *k) {
    (void)k; /* another CPU has no such ISA */
    switch (isa) {
#if defined __x86_64__ || defined __i386__
    case CPU_SSE42:
        k->grid_tile = grid_lanes_sse42;
        k->mesh_tile = mesh_lanes_sse42;
        return true;
    case CPU_AVX2:
        k->grid_tile = grid_lanes_avx2;
        k->mesh_tile = mesh_lanes_avx2;
        return true;
    case CPU_AVX512:
        k->grid_tile = grid_lanes_avx512;
        k->mesh_tile = mesh_lanes_avx512;
        return true;
#endif
    default: return false;
    }
}

/* Lanes of a vector of floats, of doubles. */
static int floats_of(cpu_isa isa) {
    return isa == CPU_AVX512 ? 16 : isa == CPU_AVX2 ? 8 : 4;
}

static int doubles_of(cpu_isa isa) {
    return floats_of(isa) / 2;
}

/* ---- a picture ---- */

static status draw(bench_job *job, const bench_subject *s, cpu_isa isa, leafcast *volume,
                   uint64_t *pixels) {
    const leafcast_camera view = view_camera_of(&s->view, volume);
    float *colours = NULL;
    status st = (status)leafcast_select(volume, s->view.surfaces, s->view.isos);
    *pixels = (uint64_t)view.width * view.height;
    if (st == ST_OK && !let_count(isa, kernels_in_use(volume)))
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
        st = draw(job, s, isa, volume, &pixels);
    if (st == ST_OK)
        add_rows(&job->table, s, isa, leafcast_describe(volume).tets > 0, pixels);
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
