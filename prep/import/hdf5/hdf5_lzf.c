#include "prep/import/hdf5/hdf5_lzf.h"

#include "formats/input/lzf.h"

/* Parameters of the filter: its version, liblzf's version, bytes of a chunk. */
enum { VALUES = 3, CHUNK_BYTES = 2 };

static size_t refuse(const char *why) {
    H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_PLINE, H5E_CANTFILTER,
             "%s", why);
    return 0;
}

/* An H5Z_func_t. Returns the bytes now in *buffer; 0: it failed and changed nothing. */
static size_t unpack(unsigned flags, size_t value_count, const unsigned values[], size_t size,
                     size_t *room, void **buffer) {
    size_t unpacked;
    if (!(flags & H5Z_FLAG_REVERSE))
        return refuse("LZF: nothing is packed here");
    const char *why = lzf_size(*buffer, size, &unpacked);
    if (why)
        return refuse(why);
    if (value_count < VALUES || unpacked != values[CHUNK_BYTES] || unpacked == 0)
        return refuse("LZF: a chunk of another size than its filter tells");
    void *out = H5allocate_memory(unpacked, false);
    if (!out) {
        H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_RESOURCE, H5E_NOSPACE,
                 "no memory for a chunk");
        return 0;
    }
    lzf_unpack(*buffer, size, out);
    H5free_memory(*buffer);
    *buffer = out;
    *room = unpacked;
    return unpacked;
}

bool hdf5_lzf_register(void) {
    const H5Z_class2_t lzf = {.version = H5Z_CLASS_T_VERS,
                              .id = HDF5_LZF,
                              .decoder_present = 1,
                              .name = "lzf",
                              .filter = unpack};
    return H5Zregister(&lzf) >= 0;
}

const char *hdf5_lzf_check(hid_t plist, unsigned at, uint64_t chunk_bytes) {
    unsigned flags, setup, values[VALUES] = {0};
    size_t count = VALUES;
    for (unsigned i = 0; i < at; i++) {
        count = 0;
        if (H5Pget_filter2(plist, i, &flags, &count, NULL, 0, NULL, &setup) != H5Z_FILTER_SHUFFLE)
            return "compressed by lzf behind a filter that changes sizes: expected shuffle, or "
                   "none";
    }
    count = VALUES;
    H5Pget_filter2(plist, at, &flags, &count, values, 0, NULL, &setup);
    if (count < VALUES || values[CHUNK_BYTES] != chunk_bytes)
        return "compressed by lzf, whose filter tells another size of chunks than the data set";
    return NULL;
}
