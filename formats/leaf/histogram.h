/* histogram.h - how the values of a field are spread, and which isovalues are worth a look.
 *
 * Counting every cell of a volume would cost more than converting it. So cells are drawn
 * (histogram_draw.h): all of a small volume, at most HISTOGRAM_DRAWS of a large one, always the
 * same ones. A share p of the cells is then known to about sqrt(p / HISTOGRAM_DRAWS).
 *
 * The same cells give the same bits. No function here allocates or fails; all are thread-safe.
 */
#ifndef FORMATS_LEAF_HISTOGRAM_H
#define FORMATS_LEAF_HISTOGRAM_H

#include <float.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/sample.h"

enum { HISTOGRAM_BINS = 256, HISTOGRAM_DRAWS = 1 << 16, HISTOGRAM_ISOVALUES = 4 };

/* What was drawn: a node of a grid and the cell that begins there, or a tetrahedron. */
typedef struct histogram_cell {
    float value; /* the node's; of a tet the mean of its four; NaN: not finite */
    float lo,
        hi; /* of the cell's corners; lo > hi: no cell begins there, or a corner is NaN or inf */
    float slope; /* length of the gradient in the middle of the cell, per world unit */
    float area;  /* mean area of its surfaces over the isovalues in (lo, hi], world units: its
                    volume times slope / (hi - lo) */
    uint8_t position[4]; /* of a grid's cell: 255 * node / cells on x, y, z, rounded down; then 0 */
} histogram_cell;

/* Bin i holds the values with edges[i] <= value < edges[i + 1]. At the isovalue edges[i] a cell is
 * active iff lo < edges[i] && edges[i] <= hi.
 *
 * Integers: every edge lies half way between two integers, and where 256 bins are enough, each
 * integer has its own. Wide ranges: the first and last bin may be tails, which reach far beyond
 * the others. A marker (below) has a bin of its own at one end, and an empty one between it and the
 * others. This is also the layout in a treelet file (FORMAT.md). */
typedef struct histogram {            /* offset size */
    uint32_t bins;                    /*    0    4  0: not one finite value was drawn */
    uint32_t reserved0;               /*    4    4 */
    uint64_t drawn;                   /*    8    8  sum of samples[] */
    uint64_t cells;                   /*   16    8  cells that were drawn and have a range */
    uint64_t total;                   /*   24    8  nodes of the grid, tets of the mesh */
    uint64_t reserved[3];             /*   32   24 */
    double edges[HISTOGRAM_BINS + 1]; /*   56 2056  ascending; behind edges[bins]: 0, as below */
    uint32_t samples[HISTOGRAM_BINS]; /* 2112 1024  values drawn in bin i */
    uint32_t active[HISTOGRAM_BINS];  /* 3136 1024  cells drawn that are active at edges[i] */
    float gradient[HISTOGRAM_BINS];   /* 4160 1024  their mean slope; 0 where there are none */
    float area[HISTOGRAM_BINS];       /* 5184 1024  of the surface at edges[i], about: the sum of
                                                    their areas times total / number drawn */
    uint8_t box[HISTOGRAM_BINS][6];   /* 6208 1536  of the cells counted in active[i]: smallest
                                                    position on x, y, z, then largest; of a mesh, and
                                                    where there are none, 0 */
} histogram;
_Static_assert(sizeof(histogram) == 7744, "histogram is 7744 bytes");

/* histogram_limited() - a slope or an area, which is no NaN, as a float: at most FLT_MAX. */
static inline float histogram_limited(double v) {
    return v < (double)FLT_MAX ? (float)v : FLT_MAX;
}

/* histogram_build() - of count cells that were drawn from `total`. type: a stored one, that of the
 * samples. range: of all finite values, drawn or not; lo > hi: there are none. */
void histogram_build(histogram *h, const histogram_cell *cells, uint32_t count, sample_type type,
                     const double range[2], uint64_t total);

/* histogram_count() - the same with h->bins, h->edges as they are: the rest of *h is made anew. */
void histogram_count(histogram *h, const histogram_cell *cells, uint32_t count, uint64_t total);

/* histogram_fault() - what contradicts the layout above, in words; NULL: nothing. For bytes that
 * come from a file. */
const char *histogram_fault(const histogram *h);

/* histogram_suggest() - up to `most` isovalues that are worth a look, best first; returns how many.
 * None where all values are equal or not finite. The rule, "sharp and large": see histogram.c. A
 * marker is left aside. */
int histogram_suggest(const histogram *h, double *isovalues, int most);

/* histogram_parting() - Otsu: the bin of [from, to) at which the samples part into two whose means
 * are apart the most, by their weights; `from` where all share a bin. from < to. */
uint32_t histogram_parting(const double *edges, const uint32_t *samples, uint32_t from,
                           uint32_t to);

/* A value that may stand for missing data, as people have -9999 or 1e30 do. */
typedef struct histogram_marker {
    double value;
    double share;     /* of the samples drawn that are numbers */
    double others[2]; /* the least and the greatest of the other values that were drawn */
} histogram_marker;

/* histogram_find_marker() - whether there is one among the cells that were drawn: the least or the
 * greatest value of all (range) that at least one sample of a thousand has, more than ten times as
 * far from 0 as any other, where the others differ. False, and *out untouched: no. */
bool histogram_find_marker(const histogram_cell *cells, uint32_t count, const double range[2],
                           histogram_marker *out);

/* histogram_data() - the bins [bins[0], bins[1]) that hold data: all, or all but the marker's and
 * the empty one beside it. Returns whether there is a marker, with what is known of it in *out,
 * which is untouched otherwise; `others` are the ends of the other bins. */
bool histogram_data(const histogram *h, uint32_t bins[2], histogram_marker *out);

#endif
