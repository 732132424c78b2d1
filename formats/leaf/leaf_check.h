/* leaf_check.h - whether the header and the directory of a treelet file make sense.
 *
 * The reader's door: nothing of a file is used before these functions have passed it. They work on
 * memory, allocate nothing, and describe what they find as "FILE: byte N: expected ..., found ...".
 * Checksums detect accidents; these checks hold against any bytes, so also against files made to do
 * harm.
 */
#ifndef FORMATS_LEAF_LEAF_CHECK_H
#define FORMATS_LEAF_LEAF_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/hash.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf.h"
#include "formats/leaf/leaf_layout.h"

/* leaf_check_header() - magic, version, checksum, and every field's range, against a file of
 * file_bytes. ST_UNSUPPORTED for a later version, kind or feature, else ST_CORRUPT. */
CHECKED status leaf_check_header(const char *path, const leaf_header *h, uint64_t file_bytes);

/* leaf_check_layout() - levels and treelets are those that dims and B imply, and that many (of a
 * mesh: as many payloads) can be in a file of this size. Fills *l as leaf_layout_levels() and
 * leaf_layout_mesh() do. */
CHECKED status leaf_check_layout(const char *path, const leaf_header *h, leaf_layout *l);

/* leaf_check_sections() - the id; kinds known and present once, sizes as the header implies, each
 * at the first multiple of LEAF_ALIGN behind the one before. *end becomes where the last one ends.
 */
CHECKED status leaf_check_sections(const char *path, const leaf_header *h,
                                   const leaf_section *table, uint64_t *end);

/* What leaf_check_directory() looks at; the arrays as in leaf_file. */
typedef struct leaf_directory {
    const float (*ranges)[2];
    const float (*own)[2];
    const uint8_t *flags;
    const uint64_t *offsets;
    const uint64_t *sizes;
    const float (*bounds)[6];       /* mesh */
    const uint32_t (*counts)[4];    /* mesh */
    const leaf_part *parts;         /* mesh: section COARSE; NULL without */
    uint64_t at[LEAF_SECTION_LAST]; /* where section kind k lies in the file is at[k - 1]; for
                                       messages */
    uint64_t end;                   /* of the sections */
} leaf_directory;

/* leaf_check_directory() - payloads follow one another in treelet order as leaf_placing_next()
 * says, up to the parts and the end of the file; ranges are well formed, and each merged one is
 * exactly the union of its own and its children's merged ones. Of a mesh: bounds too, and their
 * union. Each kind's part: leaf_geometry.h. */
CHECKED status leaf_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                                    const leaf_directory *d);

/* leaf_check_axis() - finite and strictly increasing; at: the first coordinate's offset in the
 * file. */
CHECKED status leaf_check_axis(const char *path, const double *axis, uint32_t count, uint64_t at);

/* leaf_check_world() - section WORLD, at byte `at`. */
CHECKED status leaf_check_world(const char *path, const leaf_header *h, const world_frame *f,
                                uint64_t at);

/* leaf_section_bytes() - the size that a section of this kind must have; 0 for an unknown kind, one
 * that this file has not, and a geometry that nobody knows. leaf_section_optional() - whether it
 * may be missing all the same. leaf_section_ancillary() - whether it is one of the known ones that
 * a reader may pass over. */
uint64_t leaf_section_bytes(const leaf_header *h, uint32_t kind);
bool leaf_section_optional(uint32_t kind);
bool leaf_section_ancillary(uint32_t kind);

/* leaf_header_checksum(), leaf_header_id() - as a sound header has them. */
uint64_t leaf_header_checksum(const leaf_header *h);
hash_id leaf_header_id(const leaf_header *h, const leaf_section *table);

/* ---- For rows of leaf_geometry.h ---- */

/* leaf_check_corrupt() - ST_CORRUPT: "FILE: byte N: " and the text. */
__attribute__((format(printf, 3, 4))) status leaf_check_corrupt(const char *path, uint64_t at,
                                                                const char *fmt, ...);

/* A field that must lie in [lo, hi]; outside, it may be a later version's, hence ST_UNSUPPORTED. */
typedef struct leaf_field {
    size_t at;
    const char *name;
    uint32_t value, lo, hi;
} leaf_field;
#define LEAF_FIELD(h, name, lo, hi) \
    { offsetof(leaf_header, name), #name, (h)->name, lo, hi }
CHECKED status leaf_check_fields(const char *path, const leaf_field *fields, size_t count);

/* leaf_check_source() - the input's type is one that is stored as the samples'. */
CHECKED status leaf_check_source(const char *path, const leaf_header *h);

/* leaf_check_zero() - nothing in a reserved place, which is `at` in the file. leaf_check_text() -
 * it ends with a NUL, and nothing hides behind it. */
CHECKED status leaf_check_zero(const char *path, const void *bytes, size_t size, uint64_t at);
CHECKED status leaf_check_text(const char *path, const char *text, size_t size, uint64_t at);

/* leaf_check_directory_bytes() - of all sections that a file with this header must have. */
uint64_t leaf_check_directory_bytes(const leaf_header *h);

/* leaf_check_well_formed() - whether a range is ordered and finite, or the empty range.
 * leaf_check_widen() - by another one. */
bool leaf_check_well_formed(double lo, double hi);
void leaf_check_widen(double range[2], const float own[2]);

/* leaf_check_flags() - of an element of FLAGS: those that it can have. leaf_check_union() - what
 * the header says of all values against what treelets say: their range, and that there are
 * non-finite ones. */
CHECKED status leaf_check_flags(const char *path, const leaf_header *h, const leaf_directory *d,
                                size_t element);
CHECKED status leaf_check_union(const char *path, const leaf_header *h, const double range[2],
                                unsigned flags);

#endif
