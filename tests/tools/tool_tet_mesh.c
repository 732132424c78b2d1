/* tool_tet_mesh.c - the meshes of tests/support/tet_meshes.c as mesh streams, for scripts.
 *
 *   tet_mesh                      their names
 *   tet_mesh NAME N SEED OUT      one of n^3 cubes; prints the isovalue worth looking at
 */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/tet_meshes.h"

/* All arrays as they lie in memory: little endian. */
static bool write_stream(const lab_mesh *m, FILE *out) {
    fprintf(out, "LEAFCAST MESH 1\nname: %s\nfield: f\npoints: %zu\ntets: %zu\n\n", m->name,
            m->point_count, m->tet_count);
    fwrite(m->points, sizeof m->points[0], m->point_count, out);
    fwrite(m->values, sizeof m->values[0], m->point_count, out);
    fwrite(m->tets, sizeof m->tets[0], m->tet_count, out);
    return !ferror(out);
}

int main(int argc, char **argv) {
    lab_mesh m;
    if (argc == 1) {
        for (int i = 0; i < lab_mesh_count(); i++)
            puts(lab_mesh_name(i));
        return 0;
    }
    if (argc != 5 || !lab_mesh_make(&m, argv[1], atoi(argv[2]), strtoull(argv[3], NULL, 10))) {
        fprintf(stderr, "tet_mesh [NAME N SEED OUT]\n");
        return 2;
    }
    FILE *out = fopen(argv[4], "wb");
    bool written = out && write_stream(&m, out);
    if (!out || fclose(out) != 0 || !written) {
        fprintf(stderr, "tet_mesh: %s cannot be written\n", argv[4]);
        return 1;
    }
    printf("%.17g\n", m.iso);
    lab_mesh_release(&m);
    return 0;
}
