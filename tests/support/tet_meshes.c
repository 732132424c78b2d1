#include "tests/support/tet_meshes.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TETS_A_CUBE = 6, SIDE_MAX = 64 };

/* What is done to a mesh, behind its field and its place. */
enum {
    MIXED = 1,    /* half of the tetrahedra inverted */
    APART = 2,    /* each has vertices of its own */
    HOLES = 4,    /* every fifth is missing */
    REPEATED = 8, /* some are there twice, some name a vertex twice or no point at all */
    NO_DATA = 16, /* some values are NaN or inf */
    OPEN = 32,    /* the boundary keeps its values */
    UNSOUND = 64  /* what its place does: tetrahedra that are flat or overlap */
};

/* ---- fields: of node i of n cubes an axis, u = -1..1 ---- */

typedef double formula(const int i[3], const double u[3], field_random *r);

static double sphere(const int i[3], const double u[3], field_random *r) {
    (void)i, (void)r;
    return 1 - sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
}

static double plane(const int i[3], const double u[3], field_random *r) {
    (void)u, (void)r;
    return 2 * i[0] + 3 * i[1] - i[2];
}

static double waves(const int i[3], const double u[3], field_random *r) {
    (void)i, (void)r;
    return sin(4 * u[0]) * cos(4 * u[1]) + sin(4 * u[1]) * cos(4 * u[2]) +
           sin(4 * u[2]) * cos(4 * u[0]);
}

static double noise(const int i[3], const double u[3], field_random *r) {
    (void)i, (void)u;
    return field_random_unit(r);
}

static double steps(const int i[3], const double u[3], field_random *r) {
    (void)i, (void)u;
    return (double)field_random_below(r, 4);
}

static double checker(const int i[3], const double u[3], field_random *r) {
    (void)u, (void)r;
    return (i[0] + i[1] + i[2]) % 2;
}

static double plateau(const int i[3], const double u[3], field_random *r) {
    return fmax(-0.5, fmin(0, floor(4 * sphere(i, u, r)) / 4));
}

static double wild(const int i[3], const double u[3], field_random *r) {
    (void)i, (void)u;
    double size = field_random_below(r, 2) ? 1e30 : 1e-30;
    return size * field_random_in(r, -1, 1);
}

static double raised(const int i[3], const double u[3], field_random *r) {
    return 1000 + 0.01 * noise(i, u, r);
}

static double denormal(const int i[3], const double u[3], field_random *r) {
    return 1e-40 * (noise(i, u, r) - 0.5);
}

/* ---- places: of the same node ---- */

typedef void placement(const int i[3], const double u[3], field_random *r, float p[3]);

static void put(const int i[3], double x, double y, double z, double origin, float p[3]) {
    p[0] = (float)(origin + x * i[0]);
    p[1] = (float)(origin + y * i[1]);
    p[2] = (float)(origin + z * i[2]);
}

static void unit(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1, 1, 1, 0, p);
}

static void tiny(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1e-6, 1e-6, 1e-6, 0, p);
}

static void minute(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1e-30, 1e-30, 1e-30, 0, p);
}

static void huge(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1e30, 1e30, 1e30, 0, p);
}

static void needle(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1000, 1, 1, 0, p);
}

static void slab(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1, 0.001, 1, 0, p);
}

static void narrow(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)r;
    for (int a = 0; a < 3; a++)
        p[a] = (float)(100 + 0.5e-3 * u[a]);
    (void)i;
}

static void far(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 0.25, 0.25, 0.25, 1e6, p);
}

/* Every node on the next float: as far as floats allow. */
static void farthest(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1, 1, 1, 1 << 23, p);
}

static void jittered(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u;
    for (int a = 0; a < 3; a++)
        p[a] = (float)(i[a] + field_random_in(r, -0.2, 0.2));
}

/* So far that tetrahedra turn inside out and overlap. */
static void tangled(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u;
    for (int a = 0; a < 3; a++)
        p[a] = (float)(i[a] + field_random_in(r, -0.8, 0.8));
}

/* No edge and no face along an axis. */
static void turned(const int i[3], const double u[3], field_random *r, float p[3]) {
    static const double m[3][3] = {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0.1}, {0.48, 0.64, 0.6}};
    (void)u, (void)r;
    for (int a = 0; a < 3; a++)
        p[a] = (float)(m[a][0] * i[0] + m[a][1] * i[1] + m[a][2] * i[2]);
}

/* Every second layer without thickness. */
static void flat(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u, (void)r;
    put(i, 1, 1, 1, 0, p);
    p[2] = (float)((i[2] + 1) / 2);
}

/* Every second layer a hair thick, and bent. */
static void slivers(const int i[3], const double u[3], field_random *r, float p[3]) {
    flat(i, u, r, p);
    p[2] += (float)(1e-6 * field_random_in(r, -1, 1));
}

/* Pairs of layers whose nodes coincide here and there. */
static void collapsed(const int i[3], const double u[3], field_random *r, float p[3]) {
    (void)u;
    put(i, 1, 1, 1, 0, p);
    if (i[2] % 2 == 1 && field_random_below(r, 2))
        p[2] -= 1;
}

/* ---- the table ---- */

typedef struct recipe {
    const char *name;
    placement *place;
    formula *field;
    double iso, outside; /* the boundary's value */
    unsigned damage;
} recipe;

static const recipe recipes[] = {
    {"sphere", unit, sphere, 0.3, -1, 0},
    {"plane", unit, plane, 3.5, 0, OPEN},
    {"waves", jittered, waves, 0.1, -1, 0},
    {"noise", unit, noise, 0.6, -1, 0},
    {"noise-turned", turned, noise, 0.6, -1, 0},
    {"noise-jittered", jittered, noise, 0.6, -1, MIXED},
    {"noise-open", jittered, noise, 0.5, 0, OPEN},
    {"vertex-values", unit, steps, 2, 0, 0},
    {"vertex-values-turned", turned, steps, 2, 0, 0},
    {"vertex-values-open", jittered, steps, 1, 0, OPEN},
    {"checker", unit, checker, 0.5, 0, 0},
    {"checker-at-one", unit, checker, 1, 0, 0},
    {"plateau", unit, plateau, 0, -1, 0},
    {"plateau-turned", turned, plateau, 0, -1, MIXED},
    {"tiny", tiny, noise, 0.6, -1, 0},
    {"minute", minute, noise, 0.6, -1, 0},
    {"huge", huge, noise, 0.6, -1, 0},
    {"needle", needle, noise, 0.6, -1, 0},
    {"needle-sphere", needle, sphere, 0.3, -1, 0},
    {"slab", slab, noise, 0.6, -1, 0},
    {"narrow", narrow, noise, 0.6, -1, 0},
    {"far", far, noise, 0.6, -1, 0},
    {"farthest", farthest, noise, 0.6, -1, 0},
    {"flat", flat, noise, 0.6, -1, UNSOUND},
    {"flat-steps", flat, steps, 2, 0, UNSOUND | MIXED},
    {"slivers", slivers, noise, 0.6, -1, UNSOUND},
    {"collapsed", collapsed, noise, 0.6, -1, UNSOUND},
    {"tangled", tangled, noise, 0.6, -1, UNSOUND | OPEN},
    {"wild", jittered, wild, 1e-31, -1, 0},
    {"raised", jittered, raised, 1000.005, 999, 0},
    {"denormal", unit, denormal, 1e-42, -1e-40, 0},
    {"no-data", unit, noise, 0.6, -1, NO_DATA | OPEN},
    {"mixed", unit, noise, 0.6, -1, MIXED},
    {"apart", unit, noise, 0.6, -1, APART},
    {"apart-flat", flat, steps, 2, 0, APART | UNSOUND},
    {"holes", jittered, noise, 0.6, -1, HOLES | OPEN},
    {"repeated", jittered, noise, 0.6, -1, REPEATED},
};
enum { RECIPES = sizeof recipes / sizeof recipes[0] };

int lab_mesh_count(void) {
    return RECIPES;
}

const char *lab_mesh_name(int index) {
    return recipes[index].name;
}

/* ---- making ---- */

static void measure(lab_mesh *m) {
    for (int a = 0; a < 3; a++) {
        m->lo[a] = INFINITY;
        m->hi[a] = -INFINITY;
        for (size_t i = 0; i < m->point_count; i++) {
            m->lo[a] = fmin(m->lo[a], (double)m->points[i][a]);
            m->hi[a] = fmax(m->hi[a], (double)m->points[i][a]);
        }
    }
}

static void allocate(lab_mesh *m, size_t points, size_t tets) {
    m->point_count = points;
    m->tet_count = tets;
    m->points = malloc(points * sizeof *m->points);
    m->values = malloc(points * sizeof *m->values);
    m->tets = malloc(tets * sizeof *m->tets);
    if (!m->points || !m->values || !m->tets)
        abort(); /* a test's own memory */
}

void lab_mesh_release(lab_mesh *m) {
    free(m->points);
    free(m->values);
    free(m->tets);
    *m = (lab_mesh){0};
}

/* The six ways from a cube's first corner to its last, one axis after the other; ids through `id`,
 * NULL: as they are. */
static size_t add_cube(lab_mesh *m, size_t at, size_t corner, const size_t step[3],
                       const uint32_t *id) {
    static const int orders[TETS_A_CUBE][3] = {{0, 1, 2}, {1, 0, 2}, {1, 2, 0},
                                               {2, 1, 0}, {2, 0, 1}, {0, 2, 1}};
    for (int n = 0; n < TETS_A_CUBE; n++, at++) {
        size_t node = corner;
        m->tets[at][0] = id ? id[node] : (uint32_t)node;
        for (int k = 0; k < 3; k++) {
            node += step[orders[n][k]];
            m->tets[at][k + 1] = id ? id[node] : (uint32_t)node;
        }
    }
    return at;
}

static void add_cubes(lab_mesh *m, const int n[3], const uint32_t *id) {
    const size_t step[3] = {1, (size_t)n[0] + 1, ((size_t)n[0] + 1) * ((size_t)n[1] + 1)};
    size_t at = 0;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++)
                at = add_cube(m, at, (size_t)x + step[1] * (size_t)y + step[2] * (size_t)z, step,
                              id);
}

void lab_mesh_kuhn(lab_mesh *m, const int n[3], const double origin[3], double step,
                   double (*f)(const double p[3])) {
    *m = (lab_mesh){.name = "kuhn", .sound = true};
    size_t nodes[3] = {(size_t)n[0] + 1, (size_t)n[1] + 1, (size_t)n[2] + 1};
    allocate(m, nodes[0] * nodes[1] * nodes[2],
             TETS_A_CUBE * (size_t)n[0] * (size_t)n[1] * (size_t)n[2]);
    for (size_t i = 0; i < m->point_count; i++) {
        size_t at[3] = {i % nodes[0], i / nodes[0] % nodes[1], i / nodes[0] / nodes[1]};
        double p[3];
        for (int a = 0; a < 3; a++) {
            m->points[i][a] = (float)(origin[a] + step * (double)at[a]);
            p[a] = m->points[i][a];
        }
        m->values[i] = (float)f(p);
    }
    add_cubes(m, n, NULL);
    measure(m);
}

static void shuffle(uint32_t *id, size_t count, field_random *r) {
    for (size_t i = 0; i < count; i++)
        id[i] = (uint32_t)i;
    for (size_t i = count - 1; i > 0; i--) {
        size_t k = (size_t)field_random_below(r, (long)i + 1);
        uint32_t swap = id[i];
        id[i] = id[k];
        id[k] = swap;
    }
}

static void fill(lab_mesh *m, const recipe *c, int n, field_random *r) {
    const int cubes[3] = {n, n, n};
    const size_t nodes = (size_t)n + 1;
    allocate(m, nodes * nodes * nodes, TETS_A_CUBE * (size_t)n * (size_t)n * (size_t)n);
    uint32_t *id = malloc(m->point_count * sizeof *id);
    if (!id)
        abort();
    shuffle(id, m->point_count, r);
    for (size_t at = 0; at < m->point_count; at++) {
        int i[3] = {(int)(at % nodes), (int)(at / nodes % nodes), (int)(at / nodes / nodes)};
        double u[3];
        bool boundary = false;
        for (int a = 0; a < 3; a++) {
            u[a] = 2.0 * i[a] / n - 1;
            boundary |= i[a] == 0 || i[a] == n;
        }
        c->place(i, u, r, m->points[id[at]]);
        double value = c->field(i, u, r);
        m->values[id[at]] = (float)(boundary && !(c->damage & OPEN) ? c->outside : value);
    }
    add_cubes(m, cubes, id);
    free(id);
}

/* ---- damage ---- */

static void invert_some(lab_mesh *m, field_random *r) {
    for (size_t i = 0; i < m->tet_count; i++) {
        if (field_random_below(r, 2))
            continue;
        uint32_t swap = m->tets[i][1];
        m->tets[i][1] = m->tets[i][3];
        m->tets[i][3] = swap;
    }
}

static void take_apart(lab_mesh *m) {
    lab_mesh whole = *m;
    allocate(m, 4 * whole.tet_count, whole.tet_count);
    for (size_t i = 0; i < m->point_count; i++) {
        uint32_t from = whole.tets[i / 4][i % 4];
        memcpy(m->points[i], whole.points[from], sizeof m->points[i]);
        m->values[i] = whole.values[from];
        m->tets[i / 4][i % 4] = (uint32_t)i;
    }
    lab_mesh_release(&whole);
}

static void make_holes(lab_mesh *m, field_random *r) {
    size_t kept = 0;
    for (size_t i = 0; i < m->tet_count; i++)
        if (field_random_below(r, 5))
            memmove(m->tets[kept++], m->tets[i], sizeof m->tets[i]);
    m->tet_count = kept;
}

/* The list half as long again: what is there already, in another order; and nonsense. */
static void repeat_some(lab_mesh *m, field_random *r) {
    size_t more = m->tet_count / 2;
    m->tets = realloc(m->tets, (m->tet_count + more) * sizeof *m->tets);
    if (!m->tets)
        abort();
    for (size_t i = 0; i < more; i++) {
        const uint32_t *from = m->tets[field_random_below(r, (long)m->tet_count)];
        uint32_t *to = m->tets[m->tet_count + i];
        for (int k = 0; k < 4; k++)
            to[k] = from[(k + i) % 4];
        if (i % 4 == 1)
            to[2] = to[0];
        else if (i % 4 == 2)
            to[3] = (uint32_t)m->point_count + (uint32_t)field_random_below(r, 1000);
    }
    m->tet_count += more;
}

static void lose_data(lab_mesh *m, field_random *r) {
    const float lost[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < m->point_count; i++)
        if (field_random_below(r, 20) == 0)
            m->values[i] = lost[field_random_below(r, 3)];
}

bool lab_mesh_make(lab_mesh *m, const char *name, int n, uint64_t seed) {
    int which = 0;
    assert(n >= 2 && n <= SIDE_MAX);
    while (which < RECIPES && strcmp(recipes[which].name, name) != 0)
        which++;
    if (which == RECIPES)
        return false;
    const recipe *c = &recipes[which];
    field_random r = {seed};
    *m = (lab_mesh){.name = c->name, .iso = c->iso};
    m->closed = !(c->damage & OPEN);
    m->sound = !(c->damage & UNSOUND);
    fill(m, c, n, &r);
    measure(m);
    if (c->damage & MIXED)
        invert_some(m, &r);
    if (c->damage & APART)
        take_apart(m);
    if (c->damage & HOLES)
        make_holes(m, &r);
    if (c->damage & REPEATED)
        repeat_some(m, &r);
    if (c->damage & NO_DATA)
        lose_data(m, &r);
    return true;
}

tet_ref_mesh lab_mesh_reference(const lab_mesh *m) {
    return (tet_ref_mesh){m->point_count, m->tet_count, (const float(*)[3])m->points, m->values,
                          (const uint32_t(*)[4])m->tets};
}

/* ---- rays ---- */

const char *lab_ray_name(lab_ray kind) {
    static const char *const names[LAB_RAY_KINDS] = {"random",  "axis",    "at-vertex",
                                                     "at-edge", "at-face", "in-edge",
                                                     "in-face", "inside",  "on-vertex"};
    return names[kind];
}

/* A tetrahedron whose corners are points, in a random order. */
static void pick_corners(const lab_mesh *m, field_random *r, const float *corner[4]) {
    const uint32_t *ids;
    bool sound;
    do {
        ids = m->tets[field_random_below(r, (long)m->tet_count)];
        sound = true;
        for (int k = 0; k < 4; k++)
            sound = sound && ids[k] < m->point_count;
    } while (!sound);
    long turn = field_random_below(r, 4), mirror = field_random_below(r, 2);
    for (int k = 0; k < 4; k++)
        corner[(turn + (mirror ? 3 - k : k)) % 4] = m->points[ids[k]];
}

/* Outside the box, 24 bits a coordinate: what is subtracted from it stays exact. */
static void start_outside(const lab_mesh *m, field_random *r, double o[3]) {
    int side = (int)field_random_below(r, 3);
    for (int a = 0; a < 3; a++) {
        double width = m->hi[a] - m->lo[a], from = m->lo[a] - width, to = m->hi[a] + width;
        if (a == side && field_random_below(r, 2))
            from = m->hi[a] + width / 8;
        else if (a == side)
            to = m->lo[a] - width / 8;
        o[a] = (float)field_random_in(r, from, to);
    }
}

/* A point between the corners: weights in sixteenths, exact where the corners have few bits. */
static void point_within(const float *const corner[4], field_random *r, double p[3]) {
    long w[4] = {1, 1, 1, 1};
    for (int k = 0; k < 12; k++)
        w[field_random_below(r, 4)]++;
    for (int a = 0; a < 3; a++)
        p[a] = ((double)w[0] * corner[0][a] + (double)w[1] * corner[1][a] +
                (double)w[2] * corner[2][a] + (double)w[3] * corner[3][a]) /
               16;
}

/* What a kind of ray is aimed at. */
static void aim(lab_ray kind, const float *const c[4], field_random *r, double p[3]) {
    double part = field_random_below(r, 2) ? 0.5 : 0.25;
    for (int a = 0; a < 3; a++) {
        double middle = c[0][a] + part * ((double)c[1][a] - c[0][a]);
        if (kind == LAB_RAY_AT_VERTEX || kind == LAB_RAY_ON_VERTEX)
            p[a] = c[0][a];
        else if (kind == LAB_RAY_AT_EDGE || kind == LAB_RAY_IN_EDGE)
            p[a] = middle;
        else
            p[a] = (middle + c[2][a]) / 2;
    }
}

static bool is_outside(const lab_mesh *m, const double p[3]) {
    bool outside = false;
    for (int a = 0; a < 3; a++)
        outside |= p[a] < m->lo[a] || p[a] > m->hi[a];
    return outside;
}

/* Along the edge, or in the face, or the axis: from p back out of the mesh. */
static void turn_into(const lab_mesh *m, lab_ray kind, const float *const c[4], field_random *r,
                      const double p[3], ref_ray *ray) {
    double along[3], length = 0, across = kind == LAB_RAY_IN_FACE ? 1 : 0;
    double far = field_random_below(r, 2) ? 2 : -2;
    int axis = (int)field_random_below(r, 3);
    for (int a = 0; a < 3; a++) {
        along[a] = (double)c[1][a] - c[0][a] + across * ((double)c[2][a] - c[1][a]) / 4;
        if (kind == LAB_RAY_AXIS)
            along[a] = a == axis ? (float)(m->hi[a] - m->lo[a]) : 0;
        length = fmax(length, fabs(along[a]));
    }
    if (length == 0)
        return; /* an edge that has collapsed */
    do {
        for (int a = 0; a < 3; a++) {
            ray->d[a] = far * along[a];
            ray->o[a] = p[a] - ray->d[a];
        }
        far *= 2;
    } while (!is_outside(m, ray->o));
}

ref_ray lab_mesh_ray(const lab_mesh *m, lab_ray kind, field_random *r) {
    const float *corner[4];
    double p[3];
    ref_ray ray;
    pick_corners(m, r, corner);
    if (kind == LAB_RAY_RANDOM || kind == LAB_RAY_AXIS || kind == LAB_RAY_INSIDE)
        point_within(corner, r, p);
    else
        aim(kind, corner, r, p);
    start_outside(m, r, ray.o);
    for (int a = 0; a < 3; a++)
        ray.d[a] = p[a] - ray.o[a];
    if (kind == LAB_RAY_IN_EDGE || kind == LAB_RAY_IN_FACE || kind == LAB_RAY_AXIS)
        turn_into(m, kind, corner, r, p, &ray);
    if (kind == LAB_RAY_INSIDE || kind == LAB_RAY_ON_VERTEX)
        memcpy(ray.o, p, sizeof p);
    return ray;
}
