#include "prep/import/hdf5/hdf5_chunks.h"

#include <string.h>

#include "prep/import/hdf5/hdf5_lzf.h"
#include "prep/import/hdf5/hdf5_text.h"

/* Filters of others, by the numbers that The HDF Group has given them. */
enum { FILTER_BLOSC = 32001, FILTER_ZSTD = 32015 };

/* ---- filters ---- */

/* The codec that a filter is; 0: none. */
static zarr_codec codec_of(H5Z_filter_t filter) {
    switch (filter) {
    case H5Z_FILTER_DEFLATE:
    case FILTER_ZSTD: return ZARR_STREAM;
    case FILTER_BLOSC: return ZARR_BLOSC;
    case HDF5_LZF: return ZARR_LZF;
    default: return (zarr_codec)0;
    }
}

/* Take the next filter of a pipeline: shuffles, then a codec, then a checksum. */
static const char *take_filter(H5Z_filter_t filter, uint32_t element, chunk_array *a) {
    const zarr_number n = {a->type, a->big_endian};
    const zarr_codec codec = codec_of(filter);
    zarr_filters *f = &a->filters;
    if (a->summed)
        return "a filter behind a checksum";
    if (filter == H5Z_FILTER_FLETCHER32) {
        a->summed = true;
        return NULL;
    }
    if (filter == H5Z_FILTER_SZIP)
        return "szip";
    if (filter == H5Z_FILTER_NBIT)
        return "nbit";
    if (filter == H5Z_FILTER_SCALEOFFSET)
        return "scaleoffset";
    if (filter != H5Z_FILTER_SHUFFLE && !codec)
        return "a filter of another library";
    if (a->codec != ZARR_RAW || (!codec && f->count == ZARR_FILTERS))
        return "several filters";
    if (codec)
        a->codec = codec;
    else
        f->of[f->count++] = (zarr_filter){.kind = 0, .plain = n, .coded = n, .element = element};
    return NULL;
}

/* Whether chunks that reach over the edge are stored without filters, which no chunk says of
 * itself.
 */
static bool spares_edges(hid_t plist) {
    unsigned options = 0;
    return H5Pget_chunk_opts(plist, &options) < 0 || options & H5D_CHUNK_DONT_FILTER_PARTIAL_CHUNKS;
}

static const char *take_filters(hid_t plist, uint64_t chunk_bytes, chunk_array *a) {
    const int count = H5Pget_nfilters(plist);
    const char *why = count < 0                          ? "filters that are not told"
                      : count > 0 && spares_edges(plist) ? "chunks at the edge without filters"
                                                         : NULL;
    for (int i = 0; i < count && !why; i++) {
        unsigned flags, setup, values[8] = {0};
        size_t given = sizeof values / sizeof *values;
        const H5Z_filter_t filter =
            H5Pget_filter2(plist, (unsigned)i, &flags, &given, values, 0, NULL, &setup);
        why = take_filter(filter, (uint32_t)sample_size(a->type), a);
        /* Where the element of a shuffle is not one number, bytes lie otherwise. */
        if (!why && filter == H5Z_FILTER_SHUFFLE && values[0] != sample_size(a->type))
            why = "shuffle of other elements";
        if (!why && filter == HDF5_LZF)
            why = hdf5_lzf_check(plist, (unsigned)i, chunk_bytes);
    }
    return why;
}

/* ---- the array ---- */

/* Read the fill value, in native byte order. */
static bool read_fill(hid_t plist, hid_t memory, chunk_array *a) {
    H5D_fill_value_t defined;
    uint8_t value[16] = {0};
    if (H5Pfill_value_defined(plist, &defined) < 0 || defined == H5D_FILL_VALUE_UNDEFINED ||
        H5Tget_size(memory) > sizeof value || H5Pget_fill_value(plist, memory, value) < 0)
        return false;
    memcpy(a->fill, value, sizeof a->fill);
    return true;
}

static const char *describe(const hdf5_field *f, hid_t plist, chunk_array *a) {
    static const int roles[HDF5_AXES] = {[HDF5_X] = ORDER_X,
                                         [HDF5_Y] = ORDER_Y,
                                         [HDF5_Z] = ORDER_Z,
                                         [HDF5_T] = ORDER_STEP,
                                         [HDF5_C] = ORDER_COMPONENT};
    if (H5Pget_layout(plist) != H5D_CHUNKED || f->rank > CHUNK_AXES)
        return "no chunks";
    a->axes = f->rank;
    for (int i = 0; i < f->rank; i++) {
        if (f->chunk[i] < 1 || f->chunk[i] > INT32_MAX)
            return "chunks of such a size";
        a->chunk[i] = (uint32_t)f->chunk[i];
        a->role[i] = -1;
    }
    for (int r = 0; r < HDF5_AXES; r++)
        if (f->at[r] >= 0)
            a->role[f->at[r]] = roles[r];
    if (!read_fill(plist, f->memory, a))
        return "a fill value that is not told";
    return take_filters(plist, f->chunk_bytes, a);
}

/* Whether offsets that the library tells count from the file's first byte. */
static bool has_user_block(hid_t set) {
    hsize_t bytes = 0;
    hid_t of = H5Iget_file_id(set), plist = of < 0 ? of : H5Fget_create_plist(of);
    const bool known = plist >= 0 && H5Pget_userblock(plist, &bytes) >= 0;
    if (plist >= 0)
        H5Pclose(plist);
    if (of >= 0)
        H5Fclose(of);
    return !known || bytes > 0;
}

const char *hdf5_chunks_describe(const hdf5_field *f, sample_type type, bool big_endian,
                                 chunk_array *out) {
    hid_t plist = H5Dget_create_plist(f->set);
    *out =
        (chunk_array){.type = type, .big_endian = big_endian, .codec = ZARR_RAW, .separator = '.'};
    const char *why = plist < 0 ? "no list of properties" : describe(f, plist, out);
    if (plist >= 0)
        H5Pclose(plist);
    if (!why && has_user_block(f->set))
        why = "a user block in front";
    return why;
}

/* ---- the table ---- */

static status find_chunk(const hdf5_field *f, const char *path, const chunk_array *a,
                         const uint32_t index[ORDER_AXES], chunk_entry *out) {
    hsize_t at[CHUNK_AXES] = {0}, bytes = 0;
    haddr_t offset = HADDR_UNDEF;
    unsigned skipped = 0;
    for (int i = 0; i < a->axes; i++)
        at[i] = a->role[i] < 0 ? 0 : (hsize_t)index[a->role[i]] * a->chunk[i];
    *out = (chunk_entry){0};
    if (H5Dget_chunk_info_by_coord(f->set, at, &skipped, &offset, &bytes) < 0)
        return hdf5_failed(path, "where its chunks are");
    if (offset != HADDR_UNDEF && bytes > 0 && bytes <= UINT32_MAX)
        *out = (chunk_entry){offset, (uint32_t)bytes, skipped};
    return ST_OK;
}

status hdf5_chunks_find(mem *m, const hdf5_field *f, const char *path, const chunk_array *a,
                        const chunk_range *range, chunk_entry **table) {
    uint64_t count = 1;
    for (int r = 0; r < ORDER_AXES; r++)
        count *= range->count[r];
    *table = mem_array(m, count, sizeof **table);
    status st = *table ? ST_OK : ST_NOMEM;
    for (uint64_t n = 0; n < count && st == ST_OK; n++) {
        uint32_t index[ORDER_AXES];
        uint64_t left = n;
        for (int r = 0; r < ORDER_AXES; r++) {
            index[r] = range->first[r] + (uint32_t)(left % range->count[r]);
            left /= range->count[r];
        }
        st = find_chunk(f, path, a, index, &(*table)[n]);
    }
    return st;
}
