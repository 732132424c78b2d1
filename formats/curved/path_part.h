/* path_part.h - the parts of a ray in a curved cell: from where it crosses in to where it crosses
 * out.
 */
#ifndef FORMATS_CURVED_PATH_PART_H
#define FORMATS_CURVED_PATH_PART_H

#include <stdbool.h>

enum { PATH_PARTS = 8, PATH_CROSSINGS = 16 };

/* An end of a part: on a face. */
typedef struct path_end {
    double t, at[3], value;
} path_end;

typedef struct path_part {
    path_end end[2];
} path_part;

/* Crossings of a cell's faces in one sense, in order of t. */
typedef struct path_crossings {
    int count;
    path_end end[PATH_CROSSINGS];
} path_crossings;

void path_crossings_add(path_crossings *s, const path_end *e);

/* path_parts() - a part for each crossing out, [0], and in, [1]: the first with the first, and so
 * on. The senses of all faces add up to 0: as many go in as come out. folded: which is which means
 * nothing; the ends of a part are put in order of t. Returns the number of parts. */
int path_parts(const path_crossings in_out[2], bool folded, path_part out[PATH_PARTS]);

/* path_parts_at() - the point at t on the straight line between the ends of the part that has t:
 * each t belongs to one part at most. False: none has it. */
bool path_parts_at(const path_part part[], int count, double t, path_end *out);

/* Looks at one stretch of a part, cut from it `depth` times. Returns true, and a point in its
 * middle, if it is to be cut there. */
typedef bool path_look(void *ctx, const path_end *from, const path_end *to, int depth,
                       path_end *middle);
enum { PATH_DEPTH = 52 }; /* a stretch of this depth is not cut, whatever is returned */

/* path_part_walk() - look at the whole of a part, then at what it is cut into, in order of t. */
void path_part_walk(const path_part *part, path_look *look, void *ctx);

#endif
