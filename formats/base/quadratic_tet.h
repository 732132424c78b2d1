/* quadratic_tet.h - a tet of ten nodes, whose position and value are quadratic in it.
 *
 * Nodes 0 to 3 are the corners. The others lie on the edges, in the order of VTK, Exodus and CGNS:
 * 01, 12, 20, 03, 13, 23. The three parameters are the shares (barycentric coordinates) of corners
 * 1 to 3. Edges may be bent; then faces are, too.
 *
 * A quadratic form has ten Bernstein coefficients: its values at the corners, and one for each edge
 * (quadratic_control()). All that it is in the tet lies between the least and the greatest one.
 */
#ifndef FORMATS_BASE_QUADRATIC_TET_H
#define FORMATS_BASE_QUADRATIC_TET_H

#include <stdbool.h>

enum { QUADRATIC_NODES = 10, QUADRATIC_CORNERS = 4, QUADRATIC_EDGES = 6, QUADRATIC_FACES = 4 };

typedef struct quadratic_tet {
    double p[QUADRATIC_NODES][3]; /* floats, as doubles */
    double value[QUADRATIC_NODES];
} quadratic_tet;

/* quadratic_edge() - the corners of edge 0 to 5, whose node is 4 + edge; in ascending order. */
const int *quadratic_edge(int edge);

/* quadratic_coefficient() - which coefficient belongs to the product of the shares of two corners.
 */
static inline int quadratic_coefficient(int corner, int other) {
    static const int of[QUADRATIC_CORNERS][QUADRATIC_CORNERS] = {
        {0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}};
    return of[corner][other];
}

/* quadratic_is_straight() - whether an edge's node is its middle, to within 2^-21 of coordinates,
 * which is some roundings to floats: then the edge counts as straight. So a face with such edges is
 * the triangle that a linear tet beside it has. The same for both directions. */
bool quadratic_is_straight(const double end[3], const double other[3], const double middle[3]);

/* quadratic_control() - the Bernstein coefficient of an edge from the values at its ends and at its
 * node. */
static inline double quadratic_control(double end, double other, double middle) {
    return 2.0 * middle - 0.5 * (end + other);
}

/* quadratic_straight_edges() - bit by bit, which edges of a cell count as straight. */
unsigned quadratic_straight_edges(const quadratic_tet *c);

/* quadratic_form() - the coefficients of a form with these values at the nodes. straight: of these
 * edges, as bits, the node counts as the middle. */
void quadratic_form(const double v[QUADRATIC_NODES], unsigned straight,
                    double form[QUADRATIC_NODES]);

/* quadratic_at() - a form, by its coefficients, at parameters. quadratic_slope() - its derivatives
 * by them. quadratic_twist() - its second ones, which are the same everywhere: twist[a] by the two
 * parameters other than a, square[a] half the one by a twice. */
double quadratic_at(const double form[QUADRATIC_NODES], const double at[3]);
void quadratic_slope(const double form[QUADRATIC_NODES], const double at[3], double slope[3]);
void quadratic_twist(const double form[QUADRATIC_NODES], double twist[3], double square[3]);

/* quadratic_range() - the least and the greatest coefficient of the value. */
void quadratic_range(const double value[QUADRATIC_NODES], double range[2]);

/* quadratic_sense() - as hexahedron_sense(): 1 if the map is right-handed inside the tet, by the
 * Bernstein coefficients of its Jacobian's determinant in the tet or in parts of it; -1
 * left-handed; 0 folded or flat. Depends on positions alone. */
int quadratic_sense(const quadratic_tet *c);

/* quadratic_part() - the nodes at the corners of part 0 to 7, the linear tets between a quadratic
 * one's nodes: one at each corner, four about the line between edges 02 and 13; of its sense. */
enum { QUADRATIC_PARTS = 8 };
const int *quadratic_part(int part);

/* quadratic_face() - the nodes of face 0 to 3, opposite to that corner: three corners, then the
 * nodes of the edges from the first to the second, from there to the third, and back. Seen from
 * outside of a right-handed tet the corners go round to the left. */
const int *quadratic_face(int face);

#endif
