/* fuzz_curvilinear.c - hostile curvilinear grids: the first byte chooses what is said of the file,
 * and whether it is its own solution and functions, too; the others are the file.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "formats/curvilinear/curvilinear_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Read all planes that fit into a small buffer, as a caller would. */
static void read_all(const curvilinear_source *s) {
    enum { ROOM = 1 << 16 };
    static float places[ROOM][3], values[ROOM];
    static uint8_t is_node[ROOM];
    status st = ST_OK;
    /* Text may repeat numbers, so it may have more planes than bytes. */
    int left = 1 << 10;
    for (uint32_t z = 0; z < s->zones; z++)
        for (uint32_t k = 0; k < s->nodes[z][2] && left-- > 0 && st == ST_OK; k++) {
            st = (uint64_t)s->nodes[z][0] * s->nodes[z][1] <= ROOM ? ST_OK : ST_NOMEM;
            if (st == ST_OK)
                st = s->places(s->own, z, k, 1, places);
            if (st == ST_OK)
                st = s->values(s->own, z, 0, k, 1, values);
            if (st == ST_OK && s->blanked)
                st = s->blanks(s->own, z, k, 1, is_node);
        }
}

static void read_file(const char *path, const curvilinear_hints *hints) {
    mem m;
    mem_init(&m, (size_t)64 << 20);
    curvilinear_input *x = NULL;
    if (curvilinear_input_open(&m, path, hints, &x) == ST_OK)
        read_all(curvilinear_input_source(x));
    curvilinear_input_close(x);
    if (mem_used(&m) != 0)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const layouts[] = {NULL, "records", "binary,planes", "f64", "text"};
    char path[64], grid[64];
    if (size == 0)
        return 0;
    snprintf(path, sizeof path, "/dev/shm/leafcast-fuzz-%d.xyz", (int)getpid());
    snprintf(grid, sizeof grid, "/dev/shm/leafcast-fuzz-%d.grid", (int)getpid());
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data + 1, 1, size - 1, f) != size - 1)
        abort();
    fclose(f);
    const char *layout = layouts[data[0] / 8 % 5];
    read_file(path, &(curvilinear_hints){.layout = layout});
    /* The same as what goes with a good grid of 2 x 2 x 2 nodes. */
    static const uint8_t good[12 + 12 * 8] = {2, 0, 0, 0, 2, 0, 0, 0, 2};
    f = fopen(grid, "wb");
    if (!f || fwrite(good, 1, sizeof good, f) != sizeof good)
        abort();
    fclose(f);
    const path_list files = {(char *[]){path}, 1};
    read_file(grid, data[0] & 4 ? &(curvilinear_hints){.solutions = files, .field = "entropy"}
                                : &(curvilinear_hints){.functions = files});
    remove(grid);
    remove(path);
    return 0;
}
