/* tool_grid.c - what a reader of grids gives, for script tests.
 *
 *   tool_grid INPUT [--component N] [--step N] [--memory BYTES] [--slices N]
 *
 * Prints a line, "FORMAT; NX NY NZ TYPE SOURCE SPACING.. " with to_world's twelve numbers at its
 * end, then all samples as they are handed out, N slices at a time (default 1).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/grid/volume.h"

static status print_all(mem *m, volume *v, uint32_t at_once) {
    const grid *g = volume_grid(v);
    printf("%s; %u %u %u %s %s", volume_format(v), g->dims[0], g->dims[1], g->dims[2],
           sample_name(g->type), sample_name(grid_source(g)));
    for (int i = 0; i < 12; i++)
        printf(" %.17g", g->to_world[i / 4][i % 4]);
    putchar('\n');
    const uint64_t bytes = grid_slice_bytes(g);
    char *slices = mem_alloc(m, at_once * bytes);
    status st = slices ? ST_OK : ST_NOMEM;
    for (uint32_t z = 0, n; st == ST_OK && z < g->dims[2]; z += n) {
        n = g->dims[2] - z < at_once ? g->dims[2] - z : at_once;
        st = volume_read(v, n, slices);
        if (st == ST_OK && fwrite(slices, bytes, n, stdout) != n)
            st = ST_IO;
    }
    mem_free(m, slices);
    return st == ST_OK ? volume_finish(v, NULL) : st;
}

int main(int argc, char **argv) {
    volume_hints hints = {0};
    size_t memory = 0;
    uint32_t at_once = 1;
    for (int i = 2; i + 1 < argc; i += 2) {
        const unsigned long value = strtoul(argv[i + 1], NULL, 10);
        if (strcmp(argv[i], "--component") == 0)
            hints.component = (uint32_t)value;
        else if (strcmp(argv[i], "--step") == 0)
            hints.step = (uint32_t)value;
        else if (strcmp(argv[i], "--slices") == 0)
            at_once = (uint32_t)value;
        else
            memory = value;
    }
    mem m;
    mem_init(&m, memory);
    volume *v = NULL;
    status st = argc < 2 ? ST_USAGE : volume_open(&m, argv[1], &hints, &v);
    if (st == ST_OK)
        st = print_all(&m, v, at_once);
    volume_close(v);
    if (st != ST_OK)
        fprintf(stderr, "tool_grid: %s\n", status_text());
    if (mem_used(&m) != 0)
        fprintf(stderr, "tool_grid: %zu bytes leaked\n", mem_used(&m));
    return st != ST_OK ? status_exit_code(st) : mem_used(&m) != 0;
}
