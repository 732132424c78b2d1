/* leaf_check.h - whether the header and the directory of a treelet file make sense.
 *
 * A reader uses nothing of a file before these functions have accepted it. They work on memory,
 * allocate nothing, and describe a fault as "FILE: byte N: expected ..., found ...". Checksums
 * detect accidents. These checks hold against any bytes, so also against malicious files.
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

struct chunk_entry;
struct slice_file;

/* leaf_check_header() - check magic, version, checksum, and every field's range, for a file of
 * file_bytes. ST_UNSUPPORTED for a later version, kind or feature, else ST_CORRUPT. */
CHECKED status leaf_check_header(const char *path, const leaf_header *h, uint64_t file_bytes);

/* leaf_check_layout() - check that dims and B imply this number of levels and treelets, and that a
 * file of this size can hold their directory (meshes: the directory of payloads). Fills *l like
 * leaf_layout_levels() and mesh_layout_of(). */
CHECKED status leaf_check_layout(const char *path, const leaf_header *h, leaf_layout *l);

/* leaf_check_sections() - check the id; that kinds are known and occur once, that sizes are as the
 * header implies, or possible where compressed, and that each section lies at the first multiple of
 * LEAF_ALIGN behind the one before. *end: out, where the last one ends. */
CHECKED status leaf_check_sections(const char *path, const leaf_header *h,
                                   const leaf_section *table, uint64_t *end);

/* Input of leaf_check_directory(); the arrays as in leaf_file. */
typedef struct leaf_directory {
    const float (*ranges)[2];
    const float (*own)[2];
    const uint8_t *flags;
    const uint64_t *offsets;
    const uint64_t *sizes;
    const uint64_t *checksums;
    leaf_links links;               /* sections SAME and BASES */
    const float (*bounds)[6];       /* mesh */
    const uint32_t (*counts)[4];    /* mesh */
    const leaf_part *parts;         /* mesh: section COARSE; NULL without */
    uint64_t at[LEAF_SECTION_LAST]; /* file offset of section kind k: at[k - 1]; for messages */
    uint64_t end;                   /* of the sections */
} leaf_directory;

/* leaf_check_directory() - check that payloads follow one another in treelet order by
 * leaf_placing_next(), up to the parts and the end of the file. Check that ranges are well formed,
 * and that each merged one is exactly the union of its own and its children's merged ones. Meshes:
 * also bounds and their union. leaf_geometry.h has the part of each kind. */
CHECKED status leaf_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                                    const leaf_directory *d);

/* leaf_check_axis() - check that coordinates are finite and strictly increasing. at: the first
 * one's offset in the file. */
CHECKED status leaf_check_axis(const char *path, const double *axis, uint32_t count, uint64_t at);

/* leaf_check_world() - check section WORLD, which begins at byte `at`. */
CHECKED status leaf_check_world(const char *path, const leaf_header *h, const world_frame *f,
                                uint64_t at);

/* leaf_check_outside() - check section OUTSIDE, which begins at byte `at`. */
CHECKED status leaf_check_outside(const char *path, const leaf_header *h, const leaf_outside *o,
                                  uint64_t at);

/* leaf_check_slices() - check section SLICES, which begins at byte `at`.
 * leaf_check_chunks() - the same of section CHUNKS, beside sections OUTSIDE and SLICES (NULL: there
 * is none) that were found sound. */
CHECKED status leaf_check_slices(const char *path, const leaf_header *h,
                                 const struct slice_file *slices, uint64_t at);
CHECKED status leaf_check_chunks(const char *path, const leaf_header *h, const leaf_outside *o,
                                 const struct chunk_entry *chunks, const struct slice_file *slices,
                                 uint64_t at);

/* leaf_section_bytes() - the size that a section of this kind must have. 0 for an unknown kind, a
 * kind that this file lacks, and an unknown geometry.
 * leaf_section_optional() - whether it may be missing all the same.
 * leaf_section_ancillary() - whether it is a known kind that a reader may skip. */
uint64_t leaf_section_bytes(const leaf_header *h, uint32_t kind);
bool leaf_section_optional(uint32_t kind);
bool leaf_section_ancillary(uint32_t kind);

/* leaf_header_checksum(), leaf_header_id() - compute the checksum and the id that a sound header
 * has. */
uint64_t leaf_header_checksum(const leaf_header *h);
hash_id leaf_header_id(const leaf_header *h, const leaf_section *table);

/* ---- For the tables of leaf_geometry.h ---- */

/* leaf_check_corrupt() - describe a fault: "FILE: byte N: " and the text. Returns ST_CORRUPT. */
__attribute__((format(printf, 3, 4))) status leaf_check_corrupt(const char *path, uint64_t at,
                                                                const char *fmt, ...);

/* A field that must lie in [lo, hi]. A value outside may be a later version's, hence
 * ST_UNSUPPORTED. */
typedef struct leaf_field {
    size_t at;
    const char *name;
    uint32_t value, lo, hi;
} leaf_field;
#define LEAF_FIELD(h, name, lo, hi) \
    { offsetof(leaf_header, name), #name, (h)->name, lo, hi }
CHECKED status leaf_check_fields(const char *path, const leaf_field *fields, size_t count);

/* leaf_check_source() - check that the input's type is stored as the samples' type. */
CHECKED status leaf_check_source(const char *path, const leaf_header *h);

/* leaf_check_zero() - check that reserved bytes are 0; they begin at byte `at` of the file.
 * leaf_check_text() - check that a text ends with a NUL, and that only zeros follow. */
CHECKED status leaf_check_zero(const char *path, const void *bytes, size_t size, uint64_t at);
CHECKED status leaf_check_text(const char *path, const char *text, size_t size, uint64_t at);

/* leaf_check_directory_bytes() - bytes of all sections that a file with this header must have. */
uint64_t leaf_check_directory_bytes(const leaf_header *h);

/* leaf_check_may_hold() - whether a file of the header's length may hold those. One whose sections
 * are compressed has to have at least a 1024th of their bytes. */
bool leaf_check_may_hold(const leaf_header *h);

/* leaf_check_well_formed() - whether a range is ordered and finite, or the empty range.
 * leaf_check_widen() - extend a range by another one. */
bool leaf_check_well_formed(double lo, double hi);
void leaf_check_widen(double range[2], const float own[2]);

/* leaf_check_flags() - check that an element of FLAGS has only possible flags.
 * leaf_check_union() - check the header's statements on all values against the treelets' union:
 * their range, and that there are non-finite ones. */
CHECKED status leaf_check_flags(const char *path, const leaf_header *h, const leaf_directory *d,
                                size_t element);
CHECKED status leaf_check_union(const char *path, const leaf_header *h, const double range[2],
                                unsigned flags);

/* leaf_check_bounds() - check that the treelets' boxes at all places (leaf_layout.places) are
 * boxes, and that the header's bounds are their union. */
CHECKED status leaf_check_bounds(const char *path, const leaf_header *h, const leaf_layout *l,
                                 const leaf_directory *d);

#endif
