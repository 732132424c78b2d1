/* plot3d_layout.h - how a file of PLOT3D may be written, and which ways fit its first bytes and its
 * size.
 *
 * A file says its numbers of nodes and nothing else: not the byte order, the precision, or whether
 * it has records. So every layout is tried, and a layout fits if the file then has exactly as many
 * bytes as it should have. Source: Walatka, Buning, Pierce, Elson, "PLOT3D User's Manual", NASA
 * TM-101067, 1990, chapter 8. All functions are pure.
 *
 *   grid       [zones], nodes of each zone; then per zone x, y, z, [IBLANK: an int a node]
 *   solution   the same head; then per zone Mach, alpha, Re, time; density, momentum, energy
 *   functions  [zones], nodes and number of functions of each zone; then per zone the functions
 *
 * Each number of nodes is an int of 4 bytes. In a layout of planes each plane along k has all its
 * x, then all its y, and so on; else the whole zone. Fortran's unformatted records have their
 * length in 4 bytes before and behind: the number of zones, the numbers of nodes, the four numbers
 * of a solution's zone, and each zone (of planes: each plane) are a record each.
 *
 * In text the same numbers come in the same order. Where this header says bytes, it is numbers
 * then.
 */
#ifndef FORMATS_CURVILINEAR_PLOT3D_LAYOUT_H
#define FORMATS_CURVILINEAR_PLOT3D_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

enum {
    PLOT3D_ZONES_MAX = 4000,
    PLOT3D_HEAD_MAX = 1 << 16, /* the head of any layout with so many zones is shorter */
    PLOT3D_CONDITIONS = 4      /* numbers before a solution's zone: Mach, alpha, Re, time */
};

typedef enum plot3d_content { PLOT3D_GRID, PLOT3D_SOLUTION, PLOT3D_FUNCTIONS } plot3d_content;

/* A layout is a set of these; each has a word, and so has its absence. */
enum {
    PLOT3D_RECORDS = 1, /* Fortran's records; else C binary */
    PLOT3D_LITTLE = 2,  /* little endian; else big */
    PLOT3D_F64 = 4,     /* else f32 */
    PLOT3D_BLANKS = 8,  /* a grid with IBLANK */
    PLOT3D_MULTI = 16,  /* begins with a number of zones; else there is one */
    PLOT3D_PLANES = 32, /* plane by plane; else the zone as a whole */
    PLOT3D_FLAT = 64,   /* of two dimensions: known only to be refused */
    PLOT3D_LAYOUTS = 128,
    PLOT3D_TEXT = 128 /* text (plot3d_text.h), without the first three */
};

/* Words that the user said: bits of `said` are as in `layout`. */
typedef struct plot3d_words {
    unsigned said, layout;
} plot3d_words;

/* plot3d_words_parse() - read words split by commas: binary or records; big or little; f32 or f64;
 * no-blanks or blanks; single or multi; whole or planes; 3d or 2d; text, in place of the first
 * three. NULL: none. ST_USAGE for any other word, and for one that contradicts another. */
CHECKED status plot3d_words_parse(const char *text, plot3d_words *out);

/* plot3d_layout_print() - the words of a layout, as plot3d_words_parse() takes them. */
enum { PLOT3D_LAYOUT_TEXT = 64 };
const char *plot3d_layout_print(plot3d_content content, unsigned layout,
                                char text[PLOT3D_LAYOUT_TEXT]);

/* What a file says first, by some layout. */
typedef struct plot3d_head {
    const uint8_t *nodes; /* in the file's first bytes */
    unsigned layout;
    plot3d_content content;
    uint32_t zones;
    uint32_t bytes;  /* of the head: there the first zone begins */
    uint64_t length; /* of the whole file; UINT64_MAX: more than any file has */
} plot3d_head;

/* plot3d_head_read() - read a file's head by a layout. start: its first PLOT3D_HEAD_MAX bytes, or
 * all there are; of text: its whole numbers as C binary, big endian. False: it is none of that
 * layout. */
bool plot3d_head_read(plot3d_content content, unsigned layout, const uint8_t *start, size_t size,
                      plot3d_head *out);

/* plot3d_head_nodes() - the nodes of a zone along i, j, k, 1 or more each.
 * plot3d_head_numbers() - the numbers that each of its nodes has: 3, 5, or that of the functions.
 */
void plot3d_head_nodes(const plot3d_head *h, uint32_t zone, uint32_t nodes[3]);
uint32_t plot3d_head_numbers(const plot3d_head *h, uint32_t zone);

/* Where the numbers of a zone are. A piece is the zone, or each plane of it. */
typedef struct plot3d_block {
    uint64_t at;    /* byte of the file where the first piece begins, its record's length included;
                       the conditions of a solution come before */
    uint64_t nodes; /* of a piece */
    uint64_t bytes; /* of a piece, without the lengths of its record */
    uint32_t pieces;
} plot3d_block;

/* plot3d_head_block() - the block of a zone that begins at byte `at`; returns where the zone ends.
 * UINT64_MAX: beyond any file. */
uint64_t plot3d_head_block(const plot3d_head *h, uint32_t zone, uint64_t at, plot3d_block *out);

/* plot3d_layout_mark() - the bytes of a record's length at one side of it: 4 or 0.
 * plot3d_layout_width() - the bytes of a number: 4 or 8; of text 1.
 * plot3d_layout_blank() - those of IBLANK. */
static inline uint32_t plot3d_layout_mark(unsigned layout) {
    return layout & PLOT3D_RECORDS ? 4 : 0;
}
static inline uint32_t plot3d_layout_width(unsigned layout) {
    return layout & PLOT3D_TEXT ? 1 : layout & PLOT3D_F64 ? 8 : 4;
}
static inline uint32_t plot3d_layout_blank(unsigned layout) {
    return layout & PLOT3D_TEXT ? 1 : 4;
}

/* plot3d_head_find() - find the layouts of a content that fit a file of so many bytes, and agree
 * with the words. C binary counts only if no layout of records fits. C binary of planes is only
 * looked for if the words say so: it has the same bytes as the whole. heads: room for
 * PLOT3D_LAYOUTS. text: PLOT3D_TEXT, or 0. behind: take files that have up to so many bytes more.
 * Returns how many fit. */
uint32_t plot3d_head_find(plot3d_content content, const plot3d_words *words, unsigned text,
                          const uint8_t *start, size_t size, uint64_t bytes, uint64_t behind,
                          plot3d_head *heads);

#endif
