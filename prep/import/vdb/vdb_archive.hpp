/* vdb_archive.hpp - the grids of an OpenVDB file, each checked before it is loaded; throws. */
#ifndef PREP_IMPORT_VDB_VDB_ARCHIVE_HPP
#define PREP_IMPORT_VDB_VDB_ARCHIVE_HPP

#include <fstream>
#include <string>
#include <vector>

/* What the library instantiates, too, must be one with the library's: it keeps state in there. */
#pragma GCC visibility push(default)
#include <openvdb/io/Archive.h>
#include <openvdb/io/File.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#pragma GCC visibility pop

extern "C" {
#include "formats/base/status.h"
}

/* What is described already. */
struct vdb_failure {
    status st;
};

/* Describe and throw. */
[[noreturn]] void vdb_fail(status st, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* To be called before anything is read. OpenVDB allocates where it may not throw: a budget that
 * ends there ends the program, with the exit status of that. */
void vdb_begin();

/* The status of the exception that is being handled, described with the file's path. */
status vdb_told(const std::string &path);

struct vdb_grid {
    openvdb::io::GridDescriptor entry;
    openvdb::GridBase::Ptr empty; /* its type alone */
    std::string name;             /* unique in the file: "density", "density[1]" */
};

class vdb_archive : private openvdb::io::Archive {
  public:
    /* Reads the header and, where the file has offsets, the list of its grids. */
    explicit vdb_archive(const std::string &path);

    /* Of a file without offsets (one that was written to a pipe) this loads all grids. */
    const std::vector<vdb_grid> &grids() const { return list; }

    /* Checks the grid's extent in the file and loads it; values come when they are first used where
     * the file allows that. */
    openvdb::GridBase::Ptr load(const vdb_grid &g);

  private:
    void read_list();
    void read_all();
    void walk(const openvdb::io::GridDescriptor &d);

    std::string path;
    std::ifstream in;
    openvdb::io::StreamMetadata::Ptr state;
    std::streamoff size;
    std::vector<vdb_grid> list;
};

#endif
