#include "prep/export/marching_cell.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

enum { BISECTIONS = 60 };

const marching_case *marching_cell_case(const marching_table *t, int mask,
                                        const double f[HEX_CORNERS]) {
    int joined = 0, asked = 0;
    for (int face = 0; face < 6; face++) {
        if (!(t->undecided[mask] >> face & 1))
            continue;
        const uint8_t *at = t->face[face];
        const double one = f[at[0]] * f[at[2]], other = f[at[1]] * f[at[3]];
        const bool first_inside = mask >> at[0] & 1;
        joined |= (first_inside ? one >= other : other >= one) << asked++;
    }
    return &t->cases[t->first[mask] + joined];
}

double marching_cell_value(const double f[HEX_CORNERS], const double u[3], double gradient[3]) {
    double sum = 0;
    memset(gradient, 0, 3 * sizeof *gradient);
    for (int corner = 0; corner < HEX_CORNERS; corner++) {
        double weight[3], sign[3];
        for (int a = 0; a < 3; a++) {
            weight[a] = corner >> a & 1 ? u[a] : 1 - u[a];
            sign[a] = corner >> a & 1 ? 1 : -1;
        }
        sum += weight[0] * weight[1] * weight[2] * f[corner];
        for (int a = 0; a < 3; a++)
            gradient[a] += sign[a] * weight[(a + 1) % 3] * weight[(a + 2) % 3] * f[corner];
    }
    return sum;
}

/* Find by bisection where the sign changes between `from` and a corner of the other sign. */
static void bisect(const double f[HEX_CORNERS], const double from[3], int corner, double root[3]) {
    double gradient[3], lo = 0, hi = 1;
    const bool side = marching_cell_value(f, from, gradient) >= 0;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = lo + (hi - lo) / 2;
        for (int a = 0; a < 3; a++)
            root[a] = from[a] + middle * ((corner >> a & 1) - from[a]);
        if ((marching_cell_value(f, root, gradient) >= 0) == side)
            lo = middle;
        else
            hi = middle;
    }
}

/* Find the nearest surface point on the lines from `from` to the corners of the other sign. */
static void find_centre(const double f[HEX_CORNERS], const double from[3], double centre[3]) {
    double gradient[3], least = INFINITY;
    const bool side = marching_cell_value(f, from, gradient) >= 0;
    for (int corner = 0; corner < HEX_CORNERS; corner++) {
        double root[3], away[3];
        if ((f[corner] >= 0) == side)
            continue;
        bisect(f, from, corner, root);
        vec3_sub(root, from, away);
        if (vec3_dot(away, away) >= least)
            continue;
        least = vec3_dot(away, away);
        memcpy(centre, root, sizeof root);
    }
}

/* Middle of the loop around centre n. */
static void middle_of_loop(const marching_table *t, const marching_case *m, int n,
                           const double f[HEX_CORNERS], double middle[3]) {
    int count = 0;
    memset(middle, 0, 3 * sizeof *middle);
    for (int i = 0; i < m->triangles; i++) {
        if (m->corner[i][2] != MARCHING_EDGES + n)
            continue;
        const int edge = m->corner[i][0];
        const uint8_t *ends = t->edge[edge];
        const double from = f[ends[0]], part = from / (from - f[ends[1]]);
        for (int a = 0; a < 3; a++)
            middle[a] += a == edge / 4 ? part : ends[0] >> a & 1;
        count++;
    }
    for (int a = 0; a < 3; a++)
        middle[a] /= count;
}

void marching_cell_centre(const marching_table *t, const marching_case *m, int n,
                          const double f[HEX_CORNERS], double u[3]) {
    double middle[3];
    middle_of_loop(t, m, n, f, middle);
    find_centre(f, middle, u);
}
