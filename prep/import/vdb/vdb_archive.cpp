#include "prep/import/vdb/vdb_archive.hpp"

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

using openvdb::GridBase;
using openvdb::io::GridDescriptor;

/* ---- errors ---- */

void vdb_fail(status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    throw vdb_failure{status_describe(st, "%s", text)};
}

status vdb_told(const std::string &path) {
    const char *name = path.c_str();
    try {
        /* cppcheck-suppress rethrowNoCurrentException */
        throw; /* within a handler: see vdb_archive.hpp */
    } catch (const vdb_failure &f) {
        return f.st;
    } catch (const std::bad_alloc &) {
        return status_describe(
            ST_NOMEM, "%s: OpenVDB's tree does not fit in what --memory leaves for it", name);
    } catch (const std::ios_base::failure &) {
        return status_describe(ST_CORRUPT,
                               "%s: malformed OpenVDB: it ends early, or points behind "
                               "its end",
                               name);
    } catch (const openvdb::LookupError &e) {
        return status_describe(ST_UNSUPPORTED, "%s: OpenVDB does not know what is in it: %s", name,
                               e.what());
    } catch (const std::exception &e) {
        return status_describe(ST_CORRUPT, "%s: malformed OpenVDB: %s", name, e.what());
    } catch (...) {
        return status_describe(ST_CORRUPT, "%s: malformed OpenVDB", name);
    }
}

void vdb_begin() {
    openvdb::initialize();
}

/* ---- the list ---- */

vdb_archive::vdb_archive(const std::string &file) : path(file), size(0) {
    in.open(path, std::ios::binary);
    if (!in)
        vdb_fail(ST_IO, "%s: cannot open: %s", path.c_str(), strerror(errno));
    in.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    in.seekg(0, std::ios::end);
    size = in.tellg();
    in.seekg(0);
    state.reset(new openvdb::io::StreamMetadata);
    openvdb::io::setStreamMetadataPtr(in, state, false);
    readHeader(in);
    state->setSeekable(inputHasGridOffsets());
    setFormatVersion(in);
    setLibraryVersion(in);
    setDataCompression(in);
    openvdb::MetaMap().readMeta(in);
    if (inputHasGridOffsets())
        read_list();
    else
        read_all();
}

/* Check that a grid's parts are in order, inside the file and behind its entry. An instance has no
 * blocks: it shares another grid's tree. */
static void check_extent(const GridDescriptor &d, std::streamoff from, std::streamoff size,
                         const std::string &path, const std::string &name) {
    const int64_t grid = d.getGridPos(), block = d.getBlockPos(), end = d.getEndPos();
    if (end > size)
        vdb_fail(ST_CORRUPT, "%s: cut off: grid \"%s\" ends at byte %lld, the file at byte %lld",
                 path.c_str(), name.c_str(), (long long)end, (long long)size);
    const bool ordered = d.isInstance() || (grid <= block && block <= end);
    if (!(ordered && from <= grid && grid <= end))
        vdb_fail(ST_CORRUPT, "%s: malformed OpenVDB: grid \"%s\" lies at bytes %lld, %lld to %lld",
                 path.c_str(), name.c_str(), (long long)grid, (long long)block, (long long)end);
}

void vdb_archive::read_list() {
    for (int32_t i = 0, count = readGridCount(in); i < count; i++) {
        vdb_grid g;
        g.empty = g.entry.read(in);
        g.name = GridDescriptor::nameAsString(g.entry.uniqueName());
        check_extent(g.entry, in.tellg(), size, path, g.name);
        list.push_back(g);
        g.entry.seekToEnd(in);
    }
}

void vdb_archive::read_all() {
    NamedGridMap known;
    for (int32_t i = 0, count = readGridCount(in); i < count; i++) {
        vdb_grid g;
        g.empty = g.entry.read(in);
        readGrid(g.empty, g.entry, in);
        g.name = GridDescriptor::nameAsString(g.entry.uniqueName());
        known[g.entry.uniqueName()] = g.empty;
        list.push_back(g);
    }
    for (const vdb_grid &g : list)
        connectInstance(g.entry, known);
}

/* ---- loading ---- */

/* Read everything but the values: with a box that contains nothing, they are not read. */
void vdb_archive::walk(const GridDescriptor &d) {
    const openvdb::CoordBBox nothing(openvdb::Coord::max(), openvdb::Coord::max());
    in.clear();
    d.seekToGrid(in);
    readGrid(GridBase::createGrid(d.gridType()), d, in, nothing);
    const std::streamoff at = in.tellg();
    if (at != d.getEndPos())
        vdb_fail(ST_CORRUPT,
                 "%s: malformed OpenVDB: grid \"%s\" ends at byte %lld, where %lld was expected",
                 path.c_str(), GridDescriptor::nameAsString(d.uniqueName()).c_str(), (long long)at,
                 (long long)d.getEndPos());
}

GridBase::Ptr vdb_archive::load(const vdb_grid &g) {
    if (!inputHasGridOffsets())
        return g.empty;
    walk(g.entry);
    for (const vdb_grid &parent : list)
        if (g.entry.isInstance() && parent.entry.uniqueName() == g.entry.instanceParentName())
            walk(parent.entry);
    openvdb::io::File file(path);
#ifdef OPENVDB_USE_DELAYED_LOADING
    file.setCopyMaxBytes(0);
#endif
    file.open();
    return file.readGrid(g.name);
}
