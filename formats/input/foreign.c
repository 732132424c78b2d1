#include "formats/input/foreign.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/leaf/leaf.h"

#define BYTES(text) text, sizeof(text) - 1

#define TO_NRRD \
    "save it as NRRD, for example with 3D Slicer or ITK-SNAP, or with Python (SimpleITK)"
#define PARAVIEW "save it as .nrrd or .vtu, for example with ParaView"
#define SLICES   "join the slices to one NRRD, for example with Fiji (File > Save As > NRRD)"
#define ARRAY    "write the array as raw samples and give --dims X,Y,Z and --type"
#define CONVERT  "`leafcast convert' takes it"
#define MESH     "`leafcast convert' takes it, and `resample' makes a grid of it"
#define UNPACK   "it is unpacked on the way where its name ends in .gz, .bz2, .xz or .zst"
#define HEIGHTS                                                                                   \
    "heights are no volume, but z - height(x, y) on a grid is one (as .npy, with Python), whose " \
    "surface at 0 is the ground"
#define SURFACE "`leafcast tetrahedralize' fills a surface with tets"

typedef struct row {
    foreign_format format;
    size_t at; /* of the bytes in the file; ANYWHERE: in what is looked at */
    const char *bytes;
    size_t size;
    const char *suffixes; /* each with a blank behind; hints where the bytes say nothing */
    bool both;            /* the bytes are others', too: a suffix must say so besides */
} row;

enum { ANYWHERE = FOREIGN_PEEK };

#define NO_BYTES NULL, 0
#define KNOWN(name, advice, at, bytes, suffixes) \
    { {name, advice, NULL}, at, bytes, suffixes, false }
#define IMPORTED(name, importer, at, bytes, suffixes) \
    { {name, CONVERT, importer}, at, bytes, suffixes, false }
#define IMPORTED_IF_NAMED(name, importer, at, bytes, suffixes) \
    { {name, CONVERT, importer}, at, bytes, suffixes, true }

/* What the formats are told by; the first that fits. Formats that another verb reads, first, go by
 * their bytes alone: a broken one is not to be sent to and fro. */
static const row rows[] = {
    KNOWN("a treelet file", "render or info take it as it is", 0, BYTES(LEAF_MAGIC), ""),
    KNOWN("NRRD, a grid", CONVERT, 0, BYTES("NRRD000"), ""),
    KNOWN("MetaImage, a grid", CONVERT, 0, BYTES("ObjectType"), ""),
    KNOWN("NIfTI-1, a grid", CONVERT, 344, BYTES("n+1\0"), ""),
    KNOWN("NIfTI-1, a grid", CONVERT, 344, BYTES("ni1\0"), ""),
    KNOWN("NIfTI-2, a grid", CONVERT, 4, BYTES("n+2\0\r\n\x1a\n"), ""),
    KNOWN("NIfTI-2, a grid", CONVERT, 4, BYTES("ni2\0\r\n\x1a\n"), ""),
    KNOWN("a NumPy array", CONVERT, 0, BYTES("\x93NUMPY"), ""),
    KNOWN("MRC, a grid", CONVERT, 208, BYTES("MAP"), ""),
    KNOWN("PVM, a grid", CONVERT, 0, BYTES("PVM\n"), ""),
    KNOWN("PVM, a grid", CONVERT, 0, BYTES("PVM2\n"), ""),
    KNOWN("PVM, a grid", CONVERT, 0, BYTES("PVM3\n"), ""),
    KNOWN("PVM, a grid", CONVERT, 0, BYTES("DDS v3"), ""),
    KNOWN("a mesh stream", MESH, 0, BYTES("LEAFCAST MESH "), ""),
    KNOWN("Gmsh", MESH, 0, BYTES("$MeshFormat"), ""),
    KNOWN("a VTK mesh", MESH, ANYWHERE, BYTES("type=\"UnstructuredGrid\""), ""),
    KNOWN("a legacy VTK mesh", MESH, ANYWHERE, BYTES("DATASET UNSTRUCTURED_GRID"), ""),
    KNOWN("Analyze 7.5", TO_NRRD, 0, BYTES("\x5c\x01\0\0"), ""),
    KNOWN("Analyze 7.5", TO_NRRD, 0, BYTES("\0\0\x01\x5c"), ""),
    IMPORTED("DICOM", "dicom", 128, BYTES("DICM"), ".dcm .ima "),
    IMPORTED("TIFF", "images", 0, BYTES("II*\0"), ".tif .tiff "),
    IMPORTED("TIFF", "images", 0, BYTES("MM\0*"), ""),
    IMPORTED("BigTIFF", "images", 0, BYTES("II+\0"), ""),
    IMPORTED("BigTIFF", "images", 0, BYTES("MM\0+"), ""),
    IMPORTED("PNG", "images", 0, BYTES("\x89PNG\r\n"), ".png "),
    IMPORTED("JPEG", "images", 0, BYTES("\xff\xd8\xff"), ".jpg .jpeg "),
    IMPORTED("OpenEXR", "images", 0, BYTES("\x76\x2f\x31\x01"), ".exr "),
    IMPORTED_IF_NAMED("PNM", "images", 0, BYTES("P"), ".pgm .ppm .pnm .pbm "),
    KNOWN("JPEG 2000", SLICES, 0, BYTES("\0\0\0\x0cjP  \r\n"), ".jp2 "),
    IMPORTED("OpenVDB", "vdb", 0, BYTES(" BDV\0\0\0\0"), ".vdb "),
    IMPORTED_IF_NAMED("NetCDF-4", "netcdf", 0, BYTES("\x89HDF\r\n\x1a\n"), ".nc .nc4 .cdf "),
    IMPORTED("HDF5", "hdf5", 0, BYTES("\x89HDF\r\n\x1a\n"), ".h5 .hdf5 .he5 "),
    KNOWN("HDF4", ARRAY, 0, BYTES("\x0e\x03\x13\x01"), ".hdf "),
    IMPORTED("NetCDF", "netcdf", 0, BYTES("CDF\x01"), ".nc .cdf "),
    IMPORTED("NetCDF", "netcdf", 0, BYTES("CDF\x02"), ""),
    IMPORTED("NetCDF", "netcdf", 0, BYTES("CDF\x05"), ""),
    KNOWN("a MATLAB file", ARRAY, 0, BYTES("MATLAB 5.0 MAT"), ".mat "),
    KNOWN("FITS", ARRAY " and --big-endian", 0, BYTES("SIMPLE  ="), ".fits .fit "),
    KNOWN("GRIB", ARRAY, 0, BYTES("GRIB"), ".grib .grb .grib2 "),
    KNOWN("VTK image data (.vti)", CONVERT, ANYWHERE, BYTES("type=\"ImageData\""), ""),
    KNOWN("VTK image data in pieces (.pvti)", CONVERT, ANYWHERE, BYTES("type=\"PImageData\""), ""),
    KNOWN("a VTK rectilinear grid", CONVERT, ANYWHERE, BYTES("type=\"RectilinearGrid\""), ""),
    KNOWN("a VTK rectilinear grid in pieces (.pvtr)", CONVERT, ANYWHERE,
          BYTES("type=\"PRectilinearGrid\""), ""),
    KNOWN("a VTK structured grid", PARAVIEW, ANYWHERE, BYTES("type=\"StructuredGrid\""), ".vts "),
    KNOWN("VTK surface data", SURFACE " of .ply or .stl, which ParaView writes", ANYWHERE,
          BYTES("type=\"PolyData\""), ".vtp "),
    KNOWN("a parallel VTK mesh", "ParaView joins its pieces (File > Save Data)", ANYWHERE,
          BYTES("type=\"PUnstructuredGrid\""), ".pvtu "),
    KNOWN("a parallel VTK structured grid", PARAVIEW, ANYWHERE, BYTES("type=\"PStructuredGrid\""),
          ".pvts "),
    KNOWN("VTK data of several blocks", "give one of the files that it names", ANYWHERE,
          BYTES("type=\"vtkMultiBlockDataSet\""), ".vtm .vtmb "),
    KNOWN("a collection of VTK files", "give one of the files that it names", ANYWHERE,
          BYTES("type=\"Collection\""), ".pvd "),
    KNOWN("legacy VTK of structured points", CONVERT, ANYWHERE, BYTES("DATASET STRUCTURED_POINTS"),
          ""),
    KNOWN("a legacy VTK rectilinear grid", CONVERT, ANYWHERE, BYTES("DATASET RECTILINEAR_GRID"),
          ""),
    KNOWN("a legacy VTK structured grid", PARAVIEW, ANYWHERE, BYTES("DATASET STRUCTURED_GRID"), ""),
    KNOWN("legacy VTK surface data", SURFACE " of .ply or .stl, which ParaView writes", ANYWHERE,
          BYTES("DATASET POLYDATA"), ""),
    KNOWN("a USGS DEM, heights over a map", HEIGHTS, 0, NO_BYTES, ".dem "),
    KNOWN("EnSight", PARAVIEW, 0, BYTES("EnSight"), ".case "),
    KNOWN("CGNS", PARAVIEW, 0, NO_BYTES, ".cgns "),
    KNOWN("Exodus", PARAVIEW, 0, NO_BYTES, ".exo .ex2 "),
    KNOWN("PLOT3D", PARAVIEW, 0, NO_BYTES, ".p3d .q "),
    KNOWN("a mesh of DOLFIN", "save it as .vtu, for example with Python (meshio)", ANYWHERE,
          BYTES("<dolfin"), ""),
    KNOWN("XDMF", PARAVIEW, 0, NO_BYTES, ".xdmf .xmf "),
    KNOWN("PLY", SURFACE, 0, BYTES("ply\n"), ".ply "),
    KNOWN("PLY", SURFACE, 0, BYTES("ply\r"), ""),
    KNOWN("OFF", SURFACE, 0, BYTES("OFF\n"), ".off "),
    KNOWN("STL", SURFACE, 0, BYTES("solid "), ".stl "),
    KNOWN("a surface for TetGen", "`leafcast tetrahedralize' takes it", 0, NO_BYTES,
          ".poly .smesh "),
    KNOWN("a table", "`leafcast tetrahedralize' makes tets of points", 0, NO_BYTES, ".csv .xyz "),
    KNOWN("Wavefront OBJ", "save it as .ply; " SURFACE, 0, NO_BYTES, ".obj "),
    KNOWN("gzip", UNPACK, 0, BYTES("\x1f\x8b\x08"), ""),
    KNOWN("zstd", UNPACK, 0, BYTES("\x28\xb5\x2f\xfd"), ""),
    KNOWN("xz", UNPACK, 0, BYTES("\xfd\x37zXZ\0"), ""),
    KNOWN("bzip2", UNPACK, 0, BYTES("BZh"), ""),
    KNOWN("a zip archive", "unpack it first", 0, BYTES("PK\x03\x04"), ".zip .npz "),
    KNOWN("a tar archive", "unpack it first", 257, BYTES("ustar"), ".tar "),
    KNOWN("PDF", "it holds no volume", 0, BYTES("%PDF"), ".pdf "),
};

enum { ROWS = sizeof rows / sizeof *rows };

static bool has_bytes(const row *r, const uint8_t *start, size_t size) {
    if (!r->bytes)
        return false;
    if (r->at >= ANYWHERE)
        return memmem(start, size, r->bytes, r->size) != NULL;
    return size >= r->at + r->size && memcmp(start + r->at, r->bytes, r->size) == 0;
}

/* Whether the path ends as one of the row's suffixes. */
static bool has_suffix(const row *r, const char *path) {
    const size_t length = strlen(path);
    for (const char *at = r->suffixes; *at; at += strcspn(at, " ") + 1) {
        const size_t size = strcspn(at, " ");
        if (length > size && strncasecmp(path + length - size, at, size) == 0)
            return true;
    }
    return false;
}

enum { PLOT3D_PADDING = 512 };

static uint64_t word(const uint8_t *at, bool big) {
    uint64_t value = 0;
    for (int i = 0; i < 4; i++)
        value = value << 8 | at[big ? i : 3 - i];
    return value;
}

/* PLOT3D has no magic: three sizes, then as many floats as they say (positions, or four numbers and
 * a solution of five), and at most some padding. */
static bool is_plot3d(const uint8_t *start, size_t size, uint64_t bytes) {
    for (int big = 0; big < 2 && size >= 12; big++) {
        uint64_t nodes = 1;
        for (int a = 0; a < 3; a++) {
            const uint64_t n = word(start + 4 * (ptrdiff_t)a, big);
            nodes = n >= 2 && n < 1 << 16 ? nodes * n : 0;
        }
        const uint64_t points = 12 + 12 * nodes, solution = 28 + 20 * nodes;
        if (nodes && ((bytes >= points && bytes < points + PLOT3D_PADDING) ||
                      (bytes >= solution && bytes < solution + PLOT3D_PADDING)))
            return true;
    }
    return false;
}

const foreign_format *foreign_find(const char *path, const uint8_t *start, size_t size,
                                   uint64_t bytes) {
    static const foreign_format plot3d = {"PLOT3D", PARAVIEW, NULL};
    for (int i = 0; i < ROWS; i++)
        if (has_bytes(&rows[i], start, size) && (!rows[i].both || has_suffix(&rows[i], path)))
            return &rows[i].format;
    if (is_plot3d(start, size, bytes))
        return &plot3d;
    for (int i = 0; i < ROWS; i++)
        if (has_suffix(&rows[i], path))
            return &rows[i].format;
    return NULL;
}

/* Up to sixteen bytes for people who know their formats. */
static void show_start(const uint8_t *start, size_t size, char text[64]) {
    *text = 0;
    for (size_t i = 0, at = 0; i < size && i < 16; i++)
        at += (size_t)snprintf(text + at, 64 - at, "%s%02x", i ? " " : "", start[i]);
}

status foreign_refuse(byte_stream *s, const char *expected) {
    const uint8_t *start;
    size_t size;
    char bytes[64];
    status st = byte_stream_peek(s, FOREIGN_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    if (size == 0)
        return status_describe(ST_CORRUPT, "%s: is empty", byte_stream_name(s));
    const foreign_format *f = foreign_find(byte_stream_kind(s), start, size, byte_stream_left(s));
    if (f)
        return status_describe(ST_UNSUPPORTED, "%s: this is %s, which is not read here: %s",
                               byte_stream_name(s), f->name, f->advice);
    show_start(start, size, bytes);
    return status_describe(ST_UNSUPPORTED, "%s: no known format (it begins with %s): %s",
                           byte_stream_name(s), bytes, expected);
}
