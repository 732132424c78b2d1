/* tool_stress.c - the stress lab at length: `make stress`.
 *
 *   tool_stress [SECTION...] [options]
 *
 * Sections: cells blocks leaks shadows (all where none is named). Options:
 *
 *   --count N      ray-cells of each case (5000000); the other sections scale with it
 *   --case NAME    only this case of cells, several times for several
 *   --seed S       (20)
 *   --threads N    (the CPUs there are)
 *   --csv FILE     the table of cells as CSV, too
 *   --exact BY     hold this intersector to what marmitt is held to
 *   --list         the names of the cases
 *
 * Prints tables; a line that reruns it for each of the first faults of a case:
 *
 *   tool_stress cell CASE SEED INDEX [BY...]
 *   tool_stress block NAME SEED INDEX
 *   tool_stress leak FORM PLACING SEED RAY|picture SIDE
 *   tool_stress shadow FORM PLACING SEED VIEWS SIDE ISA
 *
 * Exit status 1 when there is a fault, 2 when the arguments make no sense.
 */
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "formats/base/cpu.h"
#include "tests/support/block_lab.h"
#include "tests/support/cell_lab.h"
#include "tests/support/leak_lab.h"
#include "tests/support/ray_cells.h"
#include "tests/support/shadow_lab.h"
#include "tests/support/solids.h"

enum { CELLS = 1, BLOCKS = 2, LEAKS = 4, SHADOWS = 8, CASES_MAX = 64, SIDE = 96 };

typedef struct stress {
    const char *program;
    unsigned sections, exact;
    uint64_t count, seed;
    int threads;
    const char *csv_path;
    FILE *csv;
    bool only[CASES_MAX];
    bool some; /* cases named */
    pool *pool;
} stress;

static _Noreturn void usage(const char *what) {
    fprintf(stderr, "tool_stress: %s (see the head of tests/tools/tool_stress.c)\n", what);
    exit(2);
}

static _Noreturn void give_up(status st) {
    fprintf(stderr, "tool_stress: %s\n", status_text());
    exit(st == ST_OK ? 2 : (int)st);
}

static uint64_t number(const char *text) {
    char *end;
    const unsigned long long n = strtoull(text, &end, 10);
    if (end == text || *end)
        usage(text);
    return n;
}

static unsigned intersector_bit(const char *name) {
    for (int x = 0; x < INTERSECTOR_COUNT; x++)
        if (strcmp(intersector_at(x)->name, name) == 0)
            return 1u << x;
    usage(name);
}

static void option(stress *s, int key) {
    switch (key) {
    case 'n': s->count = number(optarg); return;
    case 's': s->seed = number(optarg); return;
    case 't': s->threads = (int)number(optarg); return;
    case 'v': s->csv_path = optarg; return;
    case 'x': s->exact |= intersector_bit(optarg); return;
    case 'c':
        if (ray_cell_case(optarg) < 0)
            usage(optarg);
        s->only[ray_cell_case(optarg)] = s->some = true;
        return;
    case 'l':
        for (int i = 0; i < ray_cell_case_count(); i++)
            puts(ray_cell_case_name(i));
        exit(0);
    default: usage("what is this?");
    }
}

static void parse(stress *s, int argc, char **argv) {
    static const struct option table[] = {
        {"count", 1, NULL, 'n'},   {"seed", 1, NULL, 's'}, {"case", 1, NULL, 'c'},
        {"threads", 1, NULL, 't'}, {"csv", 1, NULL, 'v'},  {"exact", 1, NULL, 'x'},
        {"list", 0, NULL, 'l'},    {NULL, 0, NULL, 0},
    };
    static const char *const sections[] = {"cells", "blocks", "leaks", "shadows"};
    for (int key; (key = getopt_long(argc, argv, "", table, NULL)) != -1;)
        option(s, key);
    for (; optind < argc; optind++) {
        unsigned bit = 0;
        for (size_t i = 0; i < sizeof sections / sizeof *sections; i++)
            bit |= (unsigned)(strcmp(argv[optind], sections[i]) == 0) << i;
        if (!bit)
            usage(argv[optind]);
        s->sections |= bit;
    }
    if (s->sections == 0)
        s->sections = s->some ? CELLS : ~0u;
    if (s->threads < 1)
        usage("--threads");
}

static uint64_t run_cells(stress *s) {
    uint64_t faults = 0;
    printf("single cells: seed %llu, %llu ray-cells of each case, errors in cells\n",
           (unsigned long long)s->seed, (unsigned long long)s->count);
    cell_lab_heading(stdout);
    if (s->csv)
        cell_lab_csv_heading(s->csv);
    holes *h = s->some ? NULL : holes_make(s->seed);
    for (int which = h ? CELL_LAB_HOLES : 0; which < ray_cell_case_count(); which++) {
        if (s->some && !s->only[which])
            continue;
        const cell_lab_job job = {.which = which,
                                  .h = h,
                                  .seed = s->seed,
                                  .count = s->count,
                                  .exact = s->exact,
                                  .rerun = s->program,
                                  .log = stdout};
        cell_lab_row row;
        status st = cell_lab_run(s->pool, &job, &row);
        if (st != ST_OK)
            give_up(st);
        cell_lab_print(stdout, cell_lab_name(which), &row);
        if (s->csv)
            cell_lab_csv(s->csv, cell_lab_name(which), &row);
        for (int x = 0; x < INTERSECTOR_COUNT; x++)
            if (s->exact >> x & 1u)
                faults += cell_lab_faults(&row.of[x]);
    }
    holes_free(h);
    return faults;
}

static uint64_t run_blocks(stress *s) {
    uint64_t faults = 0;
    printf("\n");
    ref_tally_heading(stdout, "blocks of cells: rays");
    for (int which = 0; which < block_lab_count(); which++) {
        const block_lab_job job = {which, s->seed, s->count / 10, s->program, stdout};
        ref_tally tally;
        uint64_t broken;
        status st = block_lab_run(s->pool, &job, &tally, &broken);
        if (st != ST_OK)
            give_up(st);
        ref_tally_row(stdout, block_lab_name(which), &tally);
        fflush(stdout);
        faults += ref_tally_faults(&tally) + broken;
    }
    return faults;
}

/* Every form in every placing: a thousandth of the count in rays from outside and from inside. */
static uint64_t run_leaks(stress *s) {
    leak_tally all = {0};
    printf("\n");
    leak_tally_heading(stdout);
    for (int which = 0; which < solid_count(); which++) {
        leak_tally sum = {0};
        for (int placing = 0; placing < placing_count(); placing++) {
            const leak_lab_job job = {
                which,      placing, s->seed + (uint64_t)placing, s->count / 500 + 1, SIDE,
                s->program, stdout};
            leak_tally one;
            status st = leak_lab_run(s->pool, &job, &one);
            if (st != ST_OK)
                give_up(st);
            leak_tally_add(&sum, &one);
        }
        leak_tally_row(stdout, solid_name(which), &sum);
        leak_tally_add(&all, &sum);
    }
    leak_tally_row(stdout, "all", &all);
    return leak_tally_faults(&all);
}

/* The same, with shadows, by the newest kernels. */
static uint64_t run_shadows(stress *s) {
    shadow_tally all = {0};
    const int views = s->count < 10000 ? 2 : s->count < 1000000 ? 4 : 16;
    printf("\n");
    shadow_tally_heading(stdout);
    for (int which = 0; which < solid_count(); which++) {
        shadow_tally sum = {0};
        for (int placing = 0; placing < placing_count(); placing++) {
            const shadow_lab_job job = {which,      placing, s->seed + (uint64_t)placing,
                                        views,      SIDE,    cpu_isa_name(cpu_best()),
                                        s->program, stdout};
            shadow_tally one;
            status st = shadow_lab_run(&job, &one);
            if (st != ST_OK)
                give_up(st);
            shadow_tally_add(&sum, &one);
        }
        shadow_tally_row(stdout, solid_name(which), &sum);
        shadow_tally_add(&all, &sum);
    }
    shadow_tally_row(stdout, "all", &all);
    return shadow_tally_faults(&all);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "cell") == 0)
        return cell_lab_rerun(argc - 2, argv + 2);
    if (argc > 1 && strcmp(argv[1], "block") == 0)
        return block_lab_rerun(argc - 2, argv + 2);
    if (argc > 1 && strcmp(argv[1], "leak") == 0)
        return leak_lab_rerun(argc - 2, argv + 2);
    if (argc > 1 && strcmp(argv[1], "shadow") == 0)
        return shadow_lab_rerun(argc - 2, argv + 2);
    stress s = {.program = argv[0],
                .exact = cell_lab_exact(),
                .count = 5000000,
                .seed = 20,
                .threads = pool_default_threads()};
    mem m;
    mem_init(&m, 0);
    parse(&s, argc, argv);
    if (s.csv_path && !(s.csv = fopen(s.csv_path, "w")))
        usage(s.csv_path);
    status st = pool_create(&m, s.threads, &s.pool);
    if (st != ST_OK)
        give_up(st);
    const double start = seconds();
    uint64_t faults = 0;
    faults += s.sections & CELLS ? run_cells(&s) : 0;
    faults += s.sections & BLOCKS ? run_blocks(&s) : 0;
    faults += s.sections & LEAKS ? run_leaks(&s) : 0;
    faults += s.sections & SHADOWS ? run_shadows(&s) : 0;
    printf("\n%llu faults, %.0f s with %d threads\n", (unsigned long long)faults, seconds() - start,
           s.threads);
    pool_destroy(s.pool);
    if (s.csv)
        fclose(s.csv);
    return faults > 0;
}
