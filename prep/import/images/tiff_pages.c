#include "prep/import/images/tiff_pages.h"

#include <stdbool.h>
#include <string.h>

static status read_header(tiff *t, uint64_t *first) {
    unsigned char order[2];
    uint64_t version;
    status st = file_read_at(t->file, 0, order, sizeof order);
    if (st != ST_OK)
        return st;
    t->big_endian = order[0] == 'M';
    st = tiff_number(t, 2, 2, &version);
    t->big = version == 43;
    return st == ST_OK ? tiff_number(t, t->big ? 8 : 4, t->big ? 8 : 4, first) : st;
}

/* Follow a directory: the number of entries, the entries, the offset of the next directory. */
static status follow(const tiff *t, uint64_t at, uint64_t number, const tiff_visit *to,
                     uint64_t *next) {
    const uint64_t size = file_size(t->file), entry = t->big ? 20 : 12;
    const int head = t->big ? 8 : 2, link = t->big ? 8 : 4;
    uint64_t entries;
    tiff_page page;
    if (at > size)
        return status_describe(ST_CORRUPT,
                               "%s: cut off: a page's directory is at byte %llu, the file ends at "
                               "byte %llu",
                               t->path, (unsigned long long)at, (unsigned long long)size);
    status st = tiff_number(t, at, head, &entries);
    if (st != ST_OK)
        return st;
    if (entries > size / entry)
        return status_describe(ST_CORRUPT, "%s: the directory at byte %llu has %llu entries",
                               t->path, (unsigned long long)at, (unsigned long long)entries);
    st = tiff_number(t, at + (uint64_t)head + entries * entry, link, next);
    if (st == ST_OK)
        st = tiff_page_read(t, at + (uint64_t)head, entries, &page);
    return st == ST_OK ? to->take(to->ctx, t, &page, number) : st;
}

static status walk(tiff *t, const tiff_visit *to, uint64_t *pages) {
    const uint64_t most = file_size(t->file) / 6; /* 6 bytes: a directory without entries */
    uint64_t at;
    status st = read_header(t, &at);
    for (*pages = 0; at && st == ST_OK; ++*pages) {
        if (*pages > most)
            return status_describe(ST_CORRUPT, "%s: its pages' directories go round in a circle",
                                   t->path);
        st = follow(t, at, *pages, to, &at);
    }
    return st;
}

status tiff_pages_each(mem *m, const char *path, const tiff_visit *to, uint64_t *pages) {
    tiff t = {.path = path};
    status st = file_open(m, path, &t.file);
    if (st == ST_OK)
        st = walk(&t, to, pages);
    file_close(t.file);
    return st;
}

static status check_page(void *ctx, const tiff *t, const tiff_page *page, uint64_t number) {
    (void)ctx;
    return tiff_pieces_check(t, page, number);
}

status tiff_pages_count(mem *m, const char *path, uint64_t *pages) {
    return tiff_pages_each(m, path, &(tiff_visit){check_page, NULL}, pages);
}
