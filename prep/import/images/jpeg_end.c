#include "prep/import/images/jpeg_end.h"

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/file.h"

enum { WINDOW = 4096 };

enum { TEMPORARY = 0x01, RESTART_0 = 0xd0, START = 0xd8, END = 0xd9, SCAN = 0xda, PREFIX = 0xff };

typedef struct reader {
    file *file;
    uint64_t at;    /* the next byte */
    uint64_t from;  /* offset of the window in the file */
    uint32_t bytes; /* in the window */
    uint8_t window[WINDOW];
    status st; /* the first failure; from then on next() gives 0 */
} reader;

static uint8_t next(reader *r) {
    if (r->st == ST_OK && r->at - r->from >= r->bytes) {
        const uint64_t left = file_size(r->file) - r->at;
        r->from = r->at;
        r->bytes = left < WINDOW ? (uint32_t)left : WINDOW;
        r->st = r->bytes ? file_read_at(r->file, r->at, r->window, r->bytes)
                         : status_describe(ST_CORRUPT,
                                           "%s: cut off or malformed: it ends at byte %llu, before "
                                           "its picture does",
                                           file_path(r->file), (unsigned long long)r->at);
    }
    return r->st == ST_OK ? r->window[r->at++ - r->from] : 0;
}

/* Skip a segment by the length at its start. */
static void skip_segment(reader *r) {
    const uint32_t high = next(r), length = high << 8 | next(r);
    const uint64_t left = file_size(r->file) - r->at, skip = length > 2 ? length - 2 : 0;
    r->at += skip < left ? skip : left;
}

/* Skip coded samples up to the next marker. In samples a prefix byte is followed by 0 or a
 * restart. */
static uint8_t skip_samples(reader *r) {
    uint8_t marker = 0;
    while (r->st == ST_OK && (marker == 0 || (marker >= RESTART_0 && marker < START))) {
        while (r->st == ST_OK && next(r) != PREFIX) {}
        do
            marker = next(r);
        while (marker == PREFIX);
    }
    return marker;
}

static uint8_t next_marker(reader *r) {
    uint8_t marker = 0;
    while (r->st == ST_OK && next(r) != PREFIX) {}
    do
        marker = next(r);
    while (marker == PREFIX);
    return marker;
}

static void find_end(reader *r) {
    uint8_t marker = next_marker(r);
    while (r->st == ST_OK && marker != END) {
        const bool alone = marker == TEMPORARY || (marker >= RESTART_0 && marker <= START);
        if (!alone)
            skip_segment(r);
        marker = marker == SCAN ? skip_samples(r) : next_marker(r);
    }
}

status jpeg_end_check(mem *m, const char *path) {
    reader r = {.file = NULL};
    r.st = file_open(m, path, &r.file);
    if (r.st == ST_OK)
        find_end(&r);
    file_close(r.file);
    return r.st;
}
