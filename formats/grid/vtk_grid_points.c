#include "formats/grid/vtk_grid_points.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Allowed rounding errors of a node, and of the edges from which it is computed. In units of the
 * last place of the largest coordinate, with room for the writer's own errors. VTK writes text with
 * 11 digits, and legacy files with 6. */
static const double roundings_of_edge = 4, roundings_of_node = 8;
static const double text_rounding = 1e-10, legacy_rounding = 1e-5;

/* An axis: the nodes along the edge from the first node, and how they lie. */
typedef struct edge {
    double (*at)[3];
    uint32_t count;
    double step[3]; /* to the last node; regular: from node to node */
    bool regular;
    int aligned; /* not regular: the world's axis that it lies along; -1: none */
} edge;

typedef struct places {
    const vtk_grid *g;
    edge e[3];
    double *row;
    double far[3]; /* the largest absolute coordinates */
    double unit;   /* the largest rounding error of 1 */
    double least;  /* the smallest step */
} places;

/* ---- all nodes ---- */

typedef status visit(places *p, const vtk_grid_piece *piece, const int64_t node[3],
                     const double xyz[3]);

static status check_points(const vtk_grid_piece *piece) {
    const vtk_array *a = &piece->points;
    if (a->type == VTK_ABSENT)
        return status_describe(ST_CORRUPT, "%s: expected the points of a piece", piece->path);
    if (a->components != 3 || vtk_array_width(a->type) == 0)
        return vtk_array_fault(a, ST_CORRUPT, "%u components, expected 3 numbers", a->components);
    return ST_OK;
}

static status visit_rows(places *p, const vtk_grid_piece *piece, vtk_cursor *c, visit *each) {
    const vtk_extent *e = &piece->extent;
    const size_t width = (size_t)(e->hi[0] - e->lo[0] + 1);
    int64_t n[3];
    for (n[2] = e->lo[2]; n[2] <= e->hi[2]; n[2]++)
        for (n[1] = e->lo[1]; n[1] <= e->hi[1]; n[1]++) {
            status st = vtk_cursor_doubles(c, 3 * width, p->row);
            for (n[0] = e->lo[0]; st == ST_OK && n[0] <= e->hi[0]; n[0]++)
                st = each(p, piece, n, p->row + 3 * (n[0] - e->lo[0]));
            if (st != ST_OK)
                return st;
        }
    return vtk_cursor_finish(c);
}

static status visit_piece(places *p, const vtk_grid_piece *piece, visit *each) {
    uint64_t count = 3;
    bool much = false;
    for (int a = 0; a < 3; a++)
        much |= __builtin_mul_overflow(
            count, (uint64_t)(piece->extent.hi[a] - piece->extent.lo[a] + 1), &count);
    vtk_cursor *c = NULL;
    status st = check_points(piece);
    if (st == ST_OK)
        st = vtk_cursor_open(p->g->m, &piece->points, much ? UINT64_MAX - 1 : count, &c);
    if (st == ST_OK)
        st = visit_rows(p, piece, c, each);
    vtk_cursor_close(c);
    return st;
}

static status visit_all(places *p, visit *each) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < p->g->count; i++)
        st = visit_piece(p, &p->g->pieces[i], each);
    return st;
}

/* ---- edges ---- */

static status take_edges(places *p, const vtk_grid_piece *piece, const int64_t node[3],
                         const double xyz[3]) {
    const int64_t *lo = p->g->frame.whole.lo;
    for (int c = 0; c < 3; c++) {
        if (!isfinite(xyz[c]))
            return vtk_array_fault(&piece->points, ST_CORRUPT,
                                   "node %lld %lld %lld: expected finite coordinates",
                                   (long long)node[0], (long long)node[1], (long long)node[2]);
        p->far[c] = fmax(p->far[c], fabs(xyz[c]));
    }
    for (int a = 0; a < 3; a++)
        if (node[(a + 1) % 3] == lo[(a + 1) % 3] && node[(a + 2) % 3] == lo[(a + 2) % 3])
            memcpy(p->e[a].at[node[a] - lo[a]], xyz, sizeof p->e[a].at[0]);
    return ST_OK;
}

/* Returns the largest rounding error of 1 over the types and codings of all pieces. */
static double rounding_unit(const vtk_grid *g) {
    double unit = DBL_EPSILON;
    for (size_t i = 0; i < g->count; i++) {
        const vtk_array *a = &g->pieces[i].points;
        if (a->type == VTK_F32)
            unit = fmax(unit, (double)FLT_EPSILON);
        if (a->coding == VTK_TEXT)
            unit = fmax(unit, a->line ? text_rounding : legacy_rounding);
    }
    return unit;
}

static double allowed(const places *p, int c, double roundings) {
    return fmin(roundings * p->unit * p->far[c], p->least / 8);
}

static double distance(const double a[3], const double b[3]) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Returns whether node i of an edge lies at the first node plus t times the step. */
static bool lies_at(const places *p, const edge *e, uint32_t i, double t) {
    for (int c = 0; c < 3; c++)
        if (!(fabs(e->at[i][c] - (e->at[0][c] + t * e->step[c])) <=
              allowed(p, c, roundings_of_edge)))
            return false;
    return true;
}

/* Returns the world's axis along which an edge lies, to the bit; -1: none. */
static int find_aligned(const edge *e) {
    int found = -1, moving = 0;
    for (int c = 0; c < 3; c++) {
        bool moves = false;
        for (uint32_t i = 1; i < e->count; i++)
            moves = moves || e->at[i][c] != e->at[0][c];
        found = moves ? c : found;
        moving += moves;
    }
    return moving == 1 ? found : -1;
}

/* Returns how far along its edge's step node i lies: 0 at the first node, 1 at the last. */
static double share_of(const edge *e, uint32_t i) {
    double along = 0, square = 0;
    for (int c = 0; c < 3; c++) {
        along += (e->at[i][c] - e->at[0][c]) * e->step[c];
        square += e->step[c] * e->step[c];
    }
    return along / square;
}

static status refuse_node(const places *p, const int64_t node[3], const double xyz[3],
                          const double expected[3]) {
    return status_describe(
        ST_UNSUPPORTED,
        "%s: a curvilinear grid, which is not read here: node %lld %lld %lld is at %g %g %g, "
        "expected %g %g %g; ParaView's filter Resample To Image makes a grid of it (save it as "
        ".vti), Tetrahedralize a mesh (.vtu)",
        p->g->paths[0], (long long)node[0], (long long)node[1], (long long)node[2], xyz[0], xyz[1],
        xyz[2], expected[0], expected[1], expected[2]);
}

/* Judge an edge. It is regular if its nodes are evenly spaced; else they must lie on a line. */
static status judge_edge(places *p, int a) {
    edge *e = &p->e[a];
    const uint32_t last = e->count - 1;
    for (int c = 0; c < 3; c++)
        e->step[c] = e->at[last][c] - e->at[0][c];
    e->regular = true;
    for (uint32_t i = 0; i < e->count && e->regular; i++)
        e->regular = lies_at(p, e, i, (double)i / last);
    e->aligned = e->regular ? -1 : find_aligned(e);
    for (uint32_t i = 0; i < e->count && !e->regular; i++) {
        const double t = share_of(e, i);
        if (lies_at(p, e, i, t))
            continue;
        int64_t node[3];
        double expected[3];
        memcpy(node, p->g->frame.whole.lo, sizeof node);
        node[a] += i;
        for (int c = 0; c < 3; c++)
            expected[c] = e->at[0][c] + t * e->step[c];
        return refuse_node(p, node, e->at[i], expected);
    }
    for (int c = 0; c < 3 && e->regular; c++)
        e->step[c] /= last;
    return ST_OK;
}

static status judge_edges(places *p) {
    p->unit = rounding_unit(p->g);
    p->least = INFINITY;
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < p->e[a].count; i++) {
            if (isnan(p->e[a].at[i][0]))
                return status_describe(ST_CORRUPT, "%s: no piece has the points along its %c axis",
                                       p->g->paths[0], "ijk"[a]);
            if (i > 0)
                p->least = fmin(p->least, distance(p->e[a].at[i], p->e[a].at[i - 1]));
        }
    status st = ST_OK;
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = judge_edge(p, a);
    return st;
}

/* Check that a node lies where the nodes of the three edges together lead. */
static status check_node(places *p, const vtk_grid_piece *piece, const int64_t node[3],
                         const double xyz[3]) {
    (void)piece;
    double expected[3];
    bool good = true;
    for (int c = 0; c < 3; c++) {
        const double first = p->e[0].at[0][c];
        expected[c] = first;
        for (int a = 0; a < 3; a++)
            expected[c] += p->e[a].at[node[a] - p->g->frame.whole.lo[a]][c] - first;
        good = good && fabs(xyz[c] - expected[c]) <= allowed(p, c, roundings_of_node);
    }
    return good ? ST_OK : refuse_node(p, node, xyz, expected);
}

/* ---- the grid ---- */

/* Set the coordinates along an axis: of the nodes, or of the cells' centres between them. */
static status set_axis(const places *p, int a, grid *to) {
    const edge *e = &p->e[a];
    double *x = p->row; /* it has room for any axis */
    for (uint32_t i = 0; i < e->count; i++)
        x[i] = e->aligned >= 0 ? e->at[i][e->aligned] : share_of(e, i);
    for (uint32_t i = 0; p->g->owner == VTK_OF_CELLS && i + 1 < e->count; i++)
        x[i] += (x[i + 1] - x[i]) / 2;
    return grid_set_axis(to, p->g->m, p->g->paths[0], a, x);
}

/* Set to_world. An axis along one of the world's axes keeps its coordinates. */
static status set_place(const places *p, grid *to) {
    status st = ST_OK;
    for (int c = 0; c < 3; c++) {
        to->to_world[c][3] = p->e[0].at[0][c];
        for (int a = 0; a < 3; a++) {
            const edge *e = &p->e[a];
            to->to_world[c][a] = e->aligned < 0 ? e->step[c] : e->aligned == c;
            if (e->aligned == c)
                to->to_world[c][3] -= e->at[0][c];
            else if (e->regular && p->g->owner == VTK_OF_CELLS)
                to->to_world[c][3] += e->step[c] / 2;
        }
    }
    for (int a = 0; st == ST_OK && a < 3; a++)
        if (!p->e[a].regular)
            st = set_axis(p, a, to);
    return st;
}

static status make_room(places *p) {
    const vtk_extent *whole = &p->g->frame.whole;
    size_t most = 0;
    for (int a = 0; a < 3; a++) {
        const size_t count = (size_t)(whole->hi[a] - whole->lo[a] + 1);
        p->e[a].count = (uint32_t)count;
        p->e[a].at = mem_array(p->g->m, count, sizeof *p->e[a].at);
        if (!p->e[a].at)
            return ST_NOMEM;
        for (size_t i = 0; i < count; i++)
            p->e[a].at[i][0] = NAN; /* to find nodes that no piece has */
        most = count > most ? count : most;
    }
    p->row = mem_array(p->g->m, most, 3 * sizeof *p->row);
    return p->row ? ST_OK : ST_NOMEM;
}

status vtk_grid_place_points(const vtk_grid *g, grid *to) {
    places p = {.g = g};
    status st = make_room(&p);
    if (st == ST_OK)
        st = visit_all(&p, take_edges);
    if (st == ST_OK)
        st = judge_edges(&p);
    if (st == ST_OK)
        st = visit_all(&p, check_node);
    if (st == ST_OK)
        st = set_place(&p, to);
    for (int a = 0; a < 3; a++)
        mem_free(g->m, p.e[a].at);
    mem_free(g->m, p.row);
    return st;
}
