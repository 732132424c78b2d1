/* leaf_between.h - a treelet file that never was one: another file's samples at times between its
 * steps, linear in time (blend_rows.h). Of a mesh that moves, its vertices, too. What a kind
 * decides about it is in leaf_blending.h.
 *
 * It looks like a file of f32 samples with a few sets. Each stands for a field at a moment, which
 * may change; leaf_file.versions says how often it has. Its directory follows from that of the file
 * below: as no blend turns the order of two samples round, ranges are the blends of ranges, and
 * boxes of moving treelets those of boxes. They hold all samples, and may be wider than need be:
 * codes are relative to them.
 *
 * In memory a payload has those of both steps behind its own codes and samples. So another moment
 * between the same steps reads nothing. Its codes and samples are made when its treelet's masks
 * are, by leaf_between_make(). What is the same at both steps is there once, and never blended.
 *
 * One writer at a time, of a set that nobody reads.
 */
#ifndef FORMATS_LEAF_LEAF_BETWEEN_H
#define FORMATS_LEAF_LEAF_BETWEEN_H

#include "formats/leaf/leaf_blending.h"

typedef struct leaf_between leaf_between;

/* Of the way from a step to the next one, a share above 0 and below 1. */
typedef struct leaf_moment {
    uint32_t field, step;
    double share;
} leaf_moment;

/* leaf_between_check() - ST_UNSUPPORTED where times between steps of f cannot be drawn: its
 * kind has none, or it has too many treelets.
 * leaf_between_open() - below: of two steps or more, checked; it outlives the file. */
CHECKED status leaf_between_check(const leaf_file *f);
CHECKED status leaf_between_open(mem *m, leaf_file *below, cpu_isa isa, leaf_file **out);

/* leaf_between_find() - whether a set stands for that moment: *set. leaf_between_select() - let one
 * stand for it, and return it: one that stands for those steps, or else the one that was asked for
 * longest ago. Takes a pass over the set's directory. */
bool leaf_between_find(const leaf_file *f, const leaf_moment *at, uint32_t *set);
uint32_t leaf_between_select(leaf_file *f, const leaf_moment *at);

/* When the file below has grown (leaf_file_exchange()), sets stand for what they did, but payloads
 * in memory must be given up: those of the file below have other numbers. */

/* ---- Payloads ---- */

/* What payload p is made of: payloads of the file below. share 0: of the first alone. */
typedef struct leaf_blend {
    uint32_t of[LEAF_BETWEEN_PARTS]; /* LEAF_NO_TREELET: none */
    double share;
} leaf_blend;
leaf_blend leaf_between_needs(const leaf_file *f, uint32_t p);

/* leaf_between_is_made_of() - whether payload p is made of such. Otherwise it is the one of the
 * file below, and the functions that follow are not for it. */
bool leaf_between_is_made_of(const leaf_file *f, uint32_t p);

/* leaf_between_begin() - of new memory for a payload: it has nothing yet.
 * leaf_between_part() - where the payload of a step lies in it, and *has, which of the file below
 * it is; LEAF_NO_TREELET: none. Both may be written then: codes and samples are no longer made.
 * leaf_between_part_of() - where it lies, to read it. */
void leaf_between_begin(const leaf_file *f, uint32_t p, void *payload);
void *leaf_between_part(const leaf_file *f, uint32_t p, void *payload, int part, uint32_t **has);
const void *leaf_between_part_of(const leaf_file *f, uint32_t p, const void *payload, int part);

/* leaf_between_helps() - whether a payload of the same treelet has one of the steps that p needs.
 * leaf_between_lacks() - whether p needs a part that it does not have. leaf_between_is_made() -
 * whether it lacks nothing, and has codes and samples of p.
 * leaf_between_make() - make these, unless it has them. It must lack nothing. shared: what treelets
 * of all sets share, a mesh's topology; or NULL. */
bool leaf_between_helps(const leaf_file *f, uint32_t p, const void *payload);
bool leaf_between_lacks(const leaf_file *f, uint32_t p, const void *payload, int part);
bool leaf_between_is_made(const leaf_file *f, uint32_t p, const void *payload);
void leaf_between_make(const leaf_file *f, uint32_t p, const void *shared, void *payload);

#endif
