/* tool_mesh_build - how fast a mesh becomes a treelet file, and what its bytes are spent on.
 *
 *     build/release/tests/tool_mesh_build [CELLS [THREADS [TREELET_TETS [LEAF_TETS [MEMORY]]]]]
 *
 * CELLS^3 cells of 6 tets each, from arrays in memory. Time is wall time, without the reading.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "formats/base/clock.h"
#include "formats/base/num.h"
#include "formats/leaf/leaf_file.h"
#include "formats/mesh/mesh_leaf.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"

static uint32_t argument(int argc, char **argv, int i, uint32_t otherwise) {
    return argc > i ? (uint32_t)strtoul(argv[i], NULL, 10) : otherwise;
}

static void print_parts(leaf_file *f) {
    double sums[7] = {0};
    static const char *const names[] = {"nodes",       "leaf firsts", "tets",  "positions",
                                        "value codes", "values",      "counts"};
    uint64_t vertices = 0, nodes = 0, leaves = 0;
    const leaf_header *h = &f->header;
    for (uint32_t t = 0; t < h->treelets; t++) {
        const mesh_shape s = mesh_leaf_shape(f->layout.counts[t]);
        const uint32_t at[] = {0, s.leaf_first_at, s.tets_at, s.positions_at, s.topology_bytes};
        for (int i = 0; i < 4; i++)
            sums[i] += at[i + 1] - at[i];
        sums[4] += s.values_at;
        sums[5] += s.values_bytes - s.values_at;
        vertices += s.vertices;
        nodes += s.nodes;
        leaves += s.leaves;
    }
    const double tets = (double)h->tets;
    for (int i = 0; i < 6; i++)
        printf("%-12s %6.2f bytes a tet\n", names[i], sums[i] / tets);
    printf("%-12s %6.2f\n", "all of it", (double)h->file_bytes / tets);
    printf("treelets of %.0f tets; %.3f vertices a tet (%.3f in the mesh); leaves of %.1f tets, "
           "nodes of %.1f children\n",
           tets / (double)h->treelets, (double)vertices / tets, (double)h->vertices / tets,
           tets / (double)leaves, (double)(leaves + nodes - h->treelets) / (double)nodes);
}

int main(int argc, char **argv) {
    const uint32_t cells = argument(argc, argv, 1, 60);
    mesh_case c = mesh_cases_kuhn(cells, cells, cells);
    c.options.threads = (int)argument(argc, argv, 2, 2);
    c.options.treelet_tets = argument(argc, argv, 3, c.options.treelet_tets);
    c.options.leaf_tets = argument(argc, argv, 4, c.options.leaf_tets);
    c.options.memory = (uint64_t)4 << 30;
    if (argc > 5 && num_size(argv[5], "MEMORY", &c.options.memory) != ST_OK)
        return 2;
    mem m;
    mem_init(&m, 0);
    mesh_result r;
    leaf_file *f = NULL;
    const double cpu = clock_cpu_seconds();
    status st = mesh_cases_convert(&m, &c, "build.leaf", 0, &r);
    const double cpu_seconds = clock_cpu_seconds() - cpu;
    const double seconds = r.sort_s + r.build_s;
    if (st == ST_OK)
        st = leaf_file_open(&m, scratch_path("build.leaf"), &f);
    if (st != ST_OK) {
        fprintf(stderr, "tool_mesh_build: %s\n", status_text());
        return 1;
    }
    printf("%zu tets, %d threads, sort %.3f s, build %.3f s: %.2f million tets a second; %.0f MiB, "
           "%.0f MiB spilled; %.2f s of CPUs, reading included\n",
           c.tet_count, c.options.threads, r.sort_s, r.build_s, (double)c.tet_count / seconds / 1e6,
           (double)mem_peak(&m) / 0x1p20, (double)r.plan.spill_bytes / 0x1p20, cpu_seconds);
    print_parts(f);
    leaf_file_close(f);
    mesh_cases_free(&c);
    return 0;
}
