/* naive_sections.h - the sections of a treelet file, wherever they lie and however they are stored,
 * from sections 3 and 14 of formats/FORMAT.md alone; for the second readers. */
#ifndef TESTS_SUPPORT_NAIVE_SECTIONS_H
#define TESTS_SUPPORT_NAIVE_SECTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    NAIVE_RANGES = 1,
    NAIVE_OWN,
    NAIVE_FLAGS,
    NAIVE_OFFSETS,
    NAIVE_SIZES,
    NAIVE_CHECKSUMS,
    NAIVE_AXES,
    NAIVE_BOUNDS,
    NAIVE_COUNTS,
    NAIVE_FIELDS,
    NAIVE_TIMES,
    NAIVE_COARSE,
    NAIVE_OUTSIDE,
    NAIVE_CHUNKS,
    NAIVE_SAME,
    NAIVE_BASES,
    NAIVE_SLICES,
    NAIVE_KINDS,
    NAIVE_SECTIONS_MAX = 64
};

typedef struct naive_sections {
    const unsigned char *where[NAIVE_KINDS]; /* what is in a section, as it is; NULL: not there */
    const unsigned char *histograms, *deviations; /* likewise, of any size */
    uint64_t histogram_bytes;
    uint64_t directory;              /* 0: before the payloads */
    uint64_t payloads;               /* where these begin */
    uint64_t table, end;             /* where the directory begins and ends */
    void *frame[NAIVE_SECTIONS_MAX]; /* decompressed; freed by naive_sections_release() */
    int frames;
    char why[128];
} naive_sections;

/* naive_sections_find() - find all sections, and check their places and checksums. want: the bytes
 * that each kind must have; 0: there must be none. optional: bit k of kind k: it may be missing.
 * False: s->why. Release it either way. */
bool naive_sections_find(naive_sections *s, const unsigned char *file, size_t size,
                         const uint64_t want[NAIVE_KINDS], uint32_t optional);
void naive_sections_release(naive_sections *s);

/* naive_sections_hold() - the end of the file, or of its part before coarse grids, for payloads
 * that end at `end`; 0: something else lies there. */
uint64_t naive_sections_hold(const naive_sections *s, const unsigned char *file, size_t size,
                             uint64_t end);

/* naive_sections_link() - the set that an entry of SAME or BASES leads payload p to; -1: to none.
 */
long naive_sections_link(const naive_sections *s, int kind, long p);

#endif
