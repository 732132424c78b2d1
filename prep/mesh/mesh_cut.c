#include "prep/mesh/mesh_cut.h"

#include "formats/mesh/mesh_morton.h"

/* Index of the first of records[low .. count) that does not share `bits` bits with records[0]. */
static size_t end_of_node(const mesh_record *records, size_t count, int bits) {
    size_t low = 1, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (mesh_morton_common(records[0].key, records[middle].key) >= bits)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

size_t mesh_cut_next(const mesh_record *records, size_t count, const uint64_t *before,
                     size_t most) {
    int bits = 0;
    if (before)
        bits = mesh_morton_common(*before, records[0].key) + 1;
    if (count > most) {
        int more = mesh_morton_common(records[0].key, records[most].key) + 1;
        bits = more > bits ? more : bits;
        count = most;
    }
    /* All tets have one key, or they are the rest of such tets: no node but this key fits. */
    return end_of_node(records, count, bits > MESH_MORTON_BITS ? MESH_MORTON_BITS : bits);
}
