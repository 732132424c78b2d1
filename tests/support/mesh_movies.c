#include "tests/support/mesh_movies.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fields.h"
#include "tests/support/scratch.h"

static void require(bool good) {
    if (!good)
        abort();
}

mesh_movie mesh_movies_make(mesh_case c, uint32_t fields, uint32_t steps, uint32_t moves,
                            size_t same) {
    static const char *const names[] = {"one", "another", "third"};
    mesh_movie v = {.c = c, .fields = fields, .steps = steps};
    field_random r = {7};
    for (uint32_t s = 0; s < steps; s++) {
        v.times[s] = 0.5 * s * s - 1;
        v.points[s] = malloc(c.point_count * sizeof *c.points);
        require(v.points[s]);
        memcpy(v.points[s], c.points, c.point_count * sizeof *c.points);
        for (size_t i = s == moves ? same : 0; s >= moves && i < c.point_count; i++)
            for (int a = 0; a < 3; a++)
                v.points[s][i][a] = 2 * c.points[i][a] + (float)field_random_in(&r, -0.4, 0.4);
        for (uint32_t f = 0; f < fields; f++) {
            v.values[s][f] = malloc(c.point_count * sizeof *c.values);
            require(v.values[s][f]);
            for (size_t i = 0; i < c.point_count; i++)
                v.values[s][f][i] =
                    c.values[i] + (float)(10 * f + s) + (float)field_random_in(&r, -0.1, 0.1);
        }
    }
    memcpy(v.names, names, sizeof v.names);
    return v;
}

void mesh_movies_release(mesh_movie *v) {
    for (uint32_t s = 0; s < v->steps; s++) {
        free(v->points[s]);
        for (uint32_t f = 0; f < v->fields; f++)
            free(v->values[s][f]);
    }
    mesh_cases_free(&v->c);
}

/* One field: mesh streams. */
const char *mesh_movies_stream(const mesh_movie *v, uint32_t s, const char *name, size_t tets) {
    const mesh_case *c = &v->c;
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "wb");
    require(f);
    fprintf(f, "LEAFCAST MESH 1\nname: movie\nfield: one\npoints: %zu\ntets: %zu\n\n",
            c->point_count, tets);
    require(fwrite(v->points[s], 12, c->point_count, f) == c->point_count);
    require(fwrite(v->values[s][0], 4, c->point_count, f) == c->point_count);
    require(fwrite(c->tets, 16, tets, f) == tets);
    require(fclose(f) == 0);
    return path;
}

static void write_cells(FILE *f, const mesh_movie *v) {
    const mesh_case *c = &v->c;
    const size_t count = v->hexes ? v->hex_count : c->tet_count;
    const int corners = v->hexes ? 8 : 4;
    fprintf(f, "CELLS %zu %zu\n", count, (size_t)(1 + corners) * count);
    for (size_t i = 0; i < count; i++) {
        const uint32_t *corner = v->hexes ? v->hexes[i] : c->tets[i];
        fprintf(f, "%d", corners);
        for (int k = 0; k < corners; k++)
            fprintf(f, " %u", corner[k]);
        fputc('\n', f);
    }
    fprintf(f, "CELL_TYPES %zu\n", count);
    for (size_t i = 0; i < count; i++)
        fputs(v->hexes ? "12\n" : "10\n", f);
}

/* Several, or hexahedra: VTK text. */
static const char *write_vtk(const mesh_movie *v, uint32_t s, const char *name) {
    const mesh_case *c = &v->c;
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "w");
    require(f);
    fprintf(f,
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS %zu float\n",
            c->point_count);
    for (size_t i = 0; i < c->point_count; i++)
        fprintf(f, "%.9g %.9g %.9g\n", (double)v->points[s][i][0], (double)v->points[s][i][1],
                (double)v->points[s][i][2]);
    write_cells(f, v);
    fprintf(f, "POINT_DATA %zu\n", c->point_count);
    for (uint32_t k = 0; k < v->fields; k++) {
        fprintf(f, "SCALARS %s float 1\nLOOKUP_TABLE default\n", v->names[k]);
        for (size_t i = 0; i < c->point_count; i++)
            fprintf(f, "%.9g\n", (double)v->values[s][k][i]);
    }
    require(fclose(f) == 0);
    return path;
}

void mesh_movies_write(mesh_movie *v) {
    for (uint32_t s = 0; s < v->steps; s++) {
        char name[32];
        const bool vtk = v->fields > 1 || v->hexes;
        snprintf(name, sizeof name, "step%u.%s", s, vtk ? "vtk" : "mesh");
        v->paths[s] = vtk ? write_vtk(v, s, name) : mesh_movies_stream(v, s, name, v->c.tet_count);
    }
    v->series = (mesh_series){
        .of = {.paths = v->paths,
               .sets = {
                   .fields = v->fields, .steps = v->steps, .names = v->names, .times = v->times}}};
    v->c.options.series = &v->series;
}

status mesh_movies_convert(mem *m, const mesh_movie *v, const char *path, mesh_result *r,
                           bool dry) {
    mesh_input *x = NULL;
    const mesh_series *of = v->c.options.series;
    mesh_hints hints = of->hints;
    hints.field = of->of.sets.names ? of->of.sets.names[0] : NULL;
    m->limit = (size_t)v->c.options.memory;
    status st = step_series_check(&of->of);
    if (st == ST_OK)
        st = mesh_input_open(m, of->of.paths[0], &hints, &x);
    if (st == ST_OK)
        st = dry ? mesh_convert_dry(m, x, &v->c.options, NULL, r)
                 : mesh_convert_run(m, x, path, &v->c.options, NULL, r);
    mesh_input_close(x);
    m->limit = 0;
    return st;
}
