/* fuzz_image.c - hostile images, as far as the importer reads them itself: the pages and strips of
 * a TIFF, the end of a JPEG. The first byte chooses.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "prep/import/images/jpeg_end.h"
#include "prep/import/images/tiff_pages.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    uint64_t pages;
    mem m;
    if (size == 0)
        return 0;
    mem_init(&m, (size_t)16 << 20);
    snprintf(path, sizeof path, "/dev/shm/leafcast-fuzz-%d.image", (int)getpid());
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data + 1, 1, size - 1, f) != size - 1)
        abort();
    fclose(f);
    (void)!(data[0] % 2 ? jpeg_end_check(&m, path) : tiff_pages_count(&m, path, &pages));
    if (mem_used(&m) != 0)
        abort();
    remove(path);
    return 0;
}
