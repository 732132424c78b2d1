/* vdb_archive.hpp - the grids of an OpenVDB file, each checked before it is loaded. It throws. */
#ifndef PREP_IMPORT_VDB_VDB_ARCHIVE_HPP
#define PREP_IMPORT_VDB_VDB_ARCHIVE_HPP

#include <fstream>
#include <string>
#include <vector>

/* Templates that the library instantiates, too, must be visible: they hold state to be shared. */
#pragma GCC visibility push(default)
#include <openvdb/io/Archive.h>
#include <openvdb/io/File.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#pragma GCC visibility pop

extern "C" {
#include "formats/base/status.h"
}

/* A failure with its description already set. */
struct vdb_failure {
    status st;
};

/* Describe and throw. */
[[noreturn]] void vdb_fail(status st, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* Call this before anything is read. OpenVDB allocates in places that may not throw. If the budget
 * ends there, the program ends with the exit status for that. */
void vdb_begin();

/* The status of the exception being handled, described with the file's path. */
status vdb_told(const std::string &path);

struct vdb_grid {
    openvdb::io::GridDescriptor entry;
    openvdb::GridBase::Ptr empty; /* of its type, without values */
    std::string name;             /* unique in the file: "density", "density[1]" */
};

class vdb_archive : private openvdb::io::Archive {
  public:
    /* Reads the header and, where the file has offsets, the list of its grids. */
    explicit vdb_archive(const std::string &path);

    /* For a file without offsets (written to a pipe) this loads all grids. */
    const std::vector<vdb_grid> &grids() const { return list; }

    /* Checks the grid's extent in the file and loads it. Values are read on first use if the file
     * allows that. */
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
