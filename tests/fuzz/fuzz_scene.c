/* fuzz_scene.c - hostile files of a picture: the first byte chooses a transfer function or a colour
 * map, or the keys of a camera path; the others are the file.
 */
#include <jansson.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "render/app/keyframes.h"
#include "render/app/transfer_file.h"

enum { FRAMES = 7 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void write_file(const char *path, const uint8_t *data, size_t size) {
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size)
        abort();
    fclose(f);
}

static void read_transfer(const uint8_t *data, size_t size) {
    char path[64];
    transfer_file t = {0};
    mem m;
    mem_init(&m, (size_t)64 << 20);
    snprintf(path, sizeof path, "/dev/shm/leafcast-fuzz-%d.tf", (int)getpid());
    write_file(path, data, size);
    (void)!transfer_file_read(&m, path, &t);
    transfer_file_release(&t);
    if (mem_used(&m) != 0)
        abort();
    remove(path);
}

static void read_path(const uint8_t *data, size_t size) {
    json_t *keys = json_loadb((const char *)data, size, 0, NULL), *path = NULL;
    if (json_is_array(keys) && json_array_size(keys) > 0 &&
        keyframes_spread(keys, "path", FRAMES, &path) == ST_OK && json_array_size(path) != FRAMES)
        abort();
    json_decref(path);
    json_decref(keys);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size > 0 && data[0] % 2)
        read_path(data + 1, size - 1);
    else if (size > 0)
        read_transfer(data + 1, size - 1);
    return 0;
}
