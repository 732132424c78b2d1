#include "formats/input/foreign.h"

#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "formats/base/text.h"
#include "formats/input/dicom_mark.h"
#include "formats/input/foreign_start.h"
#include "formats/leaf/leaf.h"

#define BYTES(text) text, sizeof(text) - 1

#define TO_NRRD \
    "save it as NRRD, for example with 3D Slicer or ITK-SNAP, or with Python (SimpleITK)"
#define PARAVIEW "save it as .nrrd or .vtu, for example with ParaView"
#define SLICES   "join the slices to one NRRD, for example with Fiji (File > Save As > NRRD)"
#define ARRAY    "write the array as raw samples and give --dims X,Y,Z and --type"
#define CONVERT  "`leafcast convert' takes it"
#define PIECES   "each of the .vtp files that it names is taken; ParaView saves them as one"
#define MESH                                                                                     \
    "`leafcast convert' takes its tets; its surface as .ply, as `meshio convert' writes it, is " \
    "filled by `leafcast tetrahedralize'"
#define BLOCKS     CONVERT "; or give one of the files that it names"
#define UNPACK     "it is unpacked on the way where its name ends in .gz, .bz2, .xz or .zst"
#define MESHIO(in) "`meshio convert " in " out.vtu' (python3-meshio) writes what is read"
#define UCD \
    "`meshio convert --input-format avsucd in.inp out.vtu' (python3-meshio) writes what is read"
#define AVS_FIELD                                                                               \
    "its samples begin behind two form feeds, or in the file that it names: give that as raw, " \
    "with --dims X,Y,Z --type TYPE --skip BYTES"
#define PARTICLES                                                                  \
    "particles are no volume, but yt (Python) makes a grid of them: load(), then " \
    "arbitrary_grid() of the dataset, transposed and saved by numpy.save() as .npy"
#define AMREX                                                                       \
    "yt (Python) makes a grid of it: load(), then covering_grid() of the dataset, " \
    "transposed and saved by numpy.save() as .npy"
#define FOAM "OpenFOAM's own `foamToVTK' writes it as .vtu or .vtk, into the folder VTK"
#define NEK  "open its .nek5000 in ParaView and save it as .vtu"
#define CUBE                                                                                  \
    "write its array as .npy with Python: numpy.save() of what ase.io.cube.read_cube_data() " \
    "gives, transposed"
#define LAS                                                                                    \
    "points are no volume, but `pdal translate in.las out.csv' and `leafcast tetrahedralize' " \
    "of that make tets"
#define PLOT3D                                                                                 \
    "a binary grid of three dimensions is, if its size fits to the byte, and a solution goes " \
    "with its grid; " PARAVIEW
#define SURFACE CONVERT "; `leafcast tetrahedralize' fills a .ply, .stl or .off with tets"

typedef struct row {
    foreign_format format;
    size_t at; /* where the bytes stand in the file; ANYWHERE: in any place that is looked at */
    const char *bytes;
    size_t size;
    const char *word;                              /* must stand anywhere, too; NULL: none */
    bool (*is)(const uint8_t *start, size_t size); /* must agree, too; NULL: nobody is asked */
    const char *suffixes; /* each with a blank behind; a hint where the bytes say nothing */
    bool both;            /* other formats have the bytes, too: a suffix must fit besides */
    const char *inside;   /* files in a folder, each with a blank behind; one of them must fit */
} row;

enum { ANYWHERE = FOREIGN_PEEK };

#define NO_BYTES NULL, 0
#define HDF5     "\x89HDF\r\n\x1a\n"

/* Formats of this program, read by another verb or by an importer. */
#define KNOWN(name, advice, at, bytes, suffixes) \
    { {name, advice, NULL, false}, at, bytes, NULL, NULL, suffixes, false, "" }
#define IMPORTED(name, importer, at, bytes, suffixes) \
    { {name, CONVERT, importer, false}, at, bytes, NULL, NULL, suffixes, false, "" }
#define IMPORTED_IF_NAMED(name, importer, at, bytes, suffixes) \
    { {name, CONVERT, importer, false}, at, bytes, NULL, NULL, suffixes, true, "" }
#define IMPORTED_MESH(name, importer, bytes) \
    { {name, CONVERT, importer, true}, 0, bytes, NULL, NULL, "", false, "" }
#define IMPORTED_MESH_WITH(name, importer, bytes, word) \
    { {name, CONVERT, importer, true}, 0, bytes, word, NULL, "", false, "" }
#define IMPORTED_MESH_IF_NAMED(name, importer, bytes, suffixes) \
    { {name, CONVERT, importer, true}, 0, bytes, NULL, NULL, suffixes, true, "" }

/* Formats that nothing here reads. tests/support/foreign_samples.py has a file for each of them. */
#define REFUSED(name, advice, at, bytes, suffixes) \
    { {name, advice, NULL, false}, at, bytes, NULL, NULL, suffixes, false, "" }
#define REFUSED_IF_NAMED(name, advice, bytes, suffixes) \
    { {name, advice, NULL, false}, 0, bytes, NULL, NULL, suffixes, true, "" }
#define REFUSED_WITH(name, advice, bytes, word) \
    { {name, advice, NULL, false}, 0, bytes, word, NULL, "", false, "" }
#define REFUSED_IF(name, advice, is, suffixes) \
    { {name, advice, NULL, false}, 0, NO_BYTES, NULL, is, suffixes, false, "" }
#define REFUSED_IF_BOTH(name, advice, is, suffixes) \
    { {name, advice, NULL, false}, 0, NO_BYTES, NULL, is, suffixes, true, "" }
#define REFUSED_FOLDER(name, advice, is, suffixes, inside) \
    { {name, advice, NULL, false}, 0, NO_BYTES, NULL, is, suffixes, false, inside }

/* How formats are recognised; the first row that fits wins. Formats that another verb reads come
 * first, and go by their bytes alone: a broken file must not be sent to and fro. */
static const row rows[] = {
    /* DICOM is first: its preamble may be the head of any other format. */
    IMPORTED("DICOM", "dicom", DICOM_PREAMBLE, BYTES("DICM"), ".dcm .ima "),
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
    KNOWN("a curvilinear stream", CONVERT, 0, BYTES("LEAFCAST CURVILINEAR "), ""),
    KNOWN("Gmsh", MESH, 0, BYTES("$MeshFormat"), ""),
    KNOWN("a VTK mesh", MESH, ANYWHERE, BYTES("type=\"UnstructuredGrid\""), ""),
    KNOWN("a VTK mesh in pieces (.pvtu)", MESH, ANYWHERE, BYTES("type=\"PUnstructuredGrid\""), ""),
    KNOWN("VTK data of several blocks (.vtm)", BLOCKS, ANYWHERE,
          BYTES("type=\"vtkMultiBlockDataSet\""), ""),
    KNOWN("a collection of VTK files (.pvd)", BLOCKS, ANYWHERE, BYTES("type=\"Collection\""), ""),
    KNOWN("a legacy VTK mesh", MESH, ANYWHERE, BYTES("DATASET UNSTRUCTURED_GRID"), ""),
    REFUSED("Analyze 7.5", TO_NRRD, 0, BYTES("\x5c\x01\0\0"), ""),
    REFUSED("Analyze 7.5", TO_NRRD, 0, BYTES("\0\0\x01\x5c"), ""),
    IMPORTED("TIFF", "images", 0, BYTES("II*\0"), ".tif .tiff "),
    IMPORTED("TIFF", "images", 0, BYTES("MM\0*"), ""),
    IMPORTED("BigTIFF", "images", 0, BYTES("II+\0"), ""),
    IMPORTED("BigTIFF", "images", 0, BYTES("MM\0+"), ""),
    IMPORTED("PNG", "images", 0, BYTES("\x89PNG\r\n"), ".png "),
    IMPORTED("JPEG", "images", 0, BYTES("\xff\xd8\xff"), ".jpg .jpeg "),
    IMPORTED("OpenEXR", "images", 0, BYTES("\x76\x2f\x31\x01"), ".exr "),
    IMPORTED_IF_NAMED("PNM", "images", 0, BYTES("P"), ".pgm .ppm .pnm .pbm "),
    REFUSED("JPEG 2000", SLICES, 0, BYTES("\0\0\0\x0cjP  \r\n"), ".jp2 "),
    IMPORTED("OpenVDB", "vdb", 0, BYTES(" BDV\0\0\0\0"), ".vdb "),
    /* Formats inside HDF5 and NetCDF come before these two, and go by their content. */
    IMPORTED_MESH_WITH("Exodus", "exodus", BYTES(HDF5), "num_el_blk"),
    IMPORTED_MESH_WITH("Exodus", "exodus", BYTES("CDF"), "num_el_blk"),
    IMPORTED_MESH_IF_NAMED("Exodus", "exodus", BYTES(HDF5), ".exo .ex2 .e .g .exii "),
    IMPORTED_MESH_IF_NAMED("Exodus", "exodus", BYTES("CDF"), ".exo .ex2 .e .g .exii "),
    REFUSED_WITH("MED", MESHIO("in.med"), BYTES(HDF5), "INFOS_GENERALES"),
    REFUSED_IF_NAMED("MED", MESHIO("in.med"), BYTES(HDF5), ".med .rmed "),
    IMPORTED_MESH_WITH("CGNS", "cgns", BYTES(HDF5), "CGNSLibraryVersion"),
    IMPORTED_MESH_IF_NAMED("CGNS", "cgns", BYTES(HDF5), ".cgns "),
    IMPORTED_MESH("CGNS", "cgns",
                  BYTES("\xc0\xa8\xa3\xa9"
                        "ADF Database Version")),
    REFUSED_WITH("GADGET, particles", PARTICLES, BYTES(HDF5), "PartType"),
    REFUSED_IF("GADGET, particles", PARTICLES, foreign_is_gadget, ""),
    REFUSED("GADGET, particles", PARTICLES, 0, BYTES("\x08\0\0\0HEAD"), ""),
    REFUSED("GADGET, particles", PARTICLES, 0, BYTES("\0\0\0\x08HEAD"), ""),
    IMPORTED_IF_NAMED("NetCDF-4", "netcdf", 0, BYTES("\x89HDF\r\n\x1a\n"), ".nc .nc4 .cdf "),
    IMPORTED("HDF5", "hdf5", 0, BYTES("\x89HDF\r\n\x1a\n"), ".h5 .hdf5 .he5 "),
    REFUSED("HDF4", ARRAY, 0, BYTES("\x0e\x03\x13\x01"), ".hdf "),
    IMPORTED("NetCDF", "netcdf", 0, BYTES("CDF\x01"), ".nc .cdf "),
    IMPORTED("NetCDF", "netcdf", 0, BYTES("CDF\x02"), ""),
    IMPORTED("NetCDF", "netcdf", 0, BYTES("CDF\x05"), ""),
    REFUSED("a MATLAB file", ARRAY, 0, BYTES("MATLAB 5.0 MAT"), ".mat "),
    REFUSED("FITS", ARRAY " and --big-endian", 0, BYTES("SIMPLE  ="), ".fits .fit "),
    REFUSED("GRIB", ARRAY, 0, BYTES("GRIB"), ".grib .grb .grib2 "),
    KNOWN("VTK image data (.vti)", CONVERT, ANYWHERE, BYTES("type=\"ImageData\""), ""),
    KNOWN("VTK image data in pieces (.pvti)", CONVERT, ANYWHERE, BYTES("type=\"PImageData\""), ""),
    KNOWN("a VTK rectilinear grid", CONVERT, ANYWHERE, BYTES("type=\"RectilinearGrid\""), ""),
    KNOWN("a VTK rectilinear grid in pieces (.pvtr)", CONVERT, ANYWHERE,
          BYTES("type=\"PRectilinearGrid\""), ""),
    KNOWN("a VTK structured grid", CONVERT, ANYWHERE, BYTES("type=\"StructuredGrid\""), ""),
    KNOWN("a VTK structured grid in pieces (.pvts)", CONVERT, ANYWHERE,
          BYTES("type=\"PStructuredGrid\""), ""),
    KNOWN("VTK surface data", CONVERT, ANYWHERE, BYTES("type=\"PolyData\""), ".vtp "),
    REFUSED("VTK surface data in pieces (.pvtp)", PIECES, ANYWHERE, BYTES("type=\"PPolyData\""),
            ".pvtp "),
    KNOWN("legacy VTK of structured points", CONVERT, ANYWHERE, BYTES("DATASET STRUCTURED_POINTS"),
          ""),
    KNOWN("a legacy VTK rectilinear grid", CONVERT, ANYWHERE, BYTES("DATASET RECTILINEAR_GRID"),
          ""),
    KNOWN("a legacy VTK structured grid", CONVERT, ANYWHERE, BYTES("DATASET STRUCTURED_GRID"), ""),
    KNOWN("legacy VTK surface data", CONVERT, ANYWHERE, BYTES("DATASET POLYDATA"), ""),
    REFUSED("EnSight", PARAVIEW, 0, BYTES("EnSight"), ".case "),
    REFUSED_IF("Abaqus", MESHIO("in.inp"), foreign_is_abaqus, ".inp "),
    REFUSED_IF_BOTH("AVS UCD", UCD, foreign_is_ucd, ".inp .avs .ucd "),
    REFUSED("AVS field", AVS_FIELD, 0, BYTES("# AVS"), ".fld "),
    REFUSED_IF("Nastran", MESHIO("in.bdf"), foreign_is_nastran, ".bdf .nas "),
    REFUSED_IF("Medit", MESHIO("in.mesh"), foreign_is_medit, ".meshb "),
    REFUSED_IF("SU2", MESHIO("in.su2"), foreign_is_su2, ".su2 "),
    REFUSED("UGRID", MESHIO("in.ugrid"), 0, NO_BYTES, ".ugrid "),
    REFUSED("Tecplot, binary", PARAVIEW, 0, BYTES("#!TDV"), ".plt "),
    REFUSED("Tecplot, binary", PARAVIEW, 0, BYTES("#!SZPLT"), ".szplt "),
    REFUSED_IF("Tecplot", MESHIO("in.dat"), foreign_is_tecplot, ".tec "),
    REFUSED("MFEM", "MFEM's own ParaViewDataCollection writes it as .vtu", 0, BYTES("MFEM "), ""),
    REFUSED("Nek5000", NEK, 0, BYTES("#std"), ".nek5000 "),
    REFUSED("Nek5000", NEK, 0, BYTES("#v00"), ".re2 "),
    REFUSED_FOLDER("an AMReX plotfile", AMREX, foreign_is_amrex, "", "Header "),
    REFUSED_FOLDER("OpenFOAM", FOAM, foreign_is_foam, ".foam ",
                   "system/controlDict constant/polyMesh/owner owner "),
    KNOWN("SLC, a grid", CONVERT, 0, BYTES("11111\n"), ".slc "),
    KNOWN("SLC, a grid", CONVERT, 0, BYTES("11111 "), ""),
    REFUSED_IF("a Gaussian cube file", CUBE, foreign_is_cube, ".cube .cub "),
    REFUSED("LAS, points", LAS, 0, BYTES("LASF"), ".las .laz "),
    REFUSED("AFNI", "`3dAFNItoNIFTI -prefix out.nii in+orig' writes it as NIfTI", ANYWHERE,
            BYTES("string-attribute"), ".head .brik "),
    REFUSED("Philips PAR/REC", "`parrec2nii in.PAR' (nibabel) writes it as NIfTI", 0,
            BYTES("# === DATA DESCRIPTION FILE"), ".par .rec "),
    REFUSED("PLOT3D", PLOT3D, 0, NO_BYTES, ".p3d .q "),
    REFUSED("a mesh of DOLFIN", "save it as .vtu, for example with Python (meshio)", ANYWHERE,
            BYTES("<dolfin"), ""),
    KNOWN("XDMF", CONVERT " where it is of grids", ANYWHERE, BYTES("<Xdmf"), ".xdmf .xmf "),
    KNOWN("PLY", SURFACE, 0, BYTES("ply\n"), ".ply "),
    KNOWN("PLY", SURFACE, 0, BYTES("ply\r"), ""),
    KNOWN("OFF", SURFACE, 0, BYTES("OFF\n"), ".off "),
    KNOWN("STL", SURFACE, 0, BYTES("solid "), ".stl "),
    KNOWN("a surface for TetGen", "`leafcast tetrahedralize' takes it", 0, NO_BYTES,
          ".poly .smesh "),
    KNOWN("a table", "`leafcast tetrahedralize' makes tets of points", 0, NO_BYTES, ".csv .xyz "),
    KNOWN("Wavefront OBJ", CONVERT, 0, NO_BYTES, ".obj "),
    KNOWN("glTF, binary", CONVERT, 0, BYTES("glTF"), ".glb "),
    KNOWN("glTF", CONVERT, 0, NO_BYTES, ".gltf "),
    KNOWN("gzip", UNPACK, 0, BYTES("\x1f\x8b\x08"), ""),
    KNOWN("zstd", UNPACK, 0, BYTES("\x28\xb5\x2f\xfd"), ""),
    KNOWN("xz", UNPACK, 0, BYTES("\xfd\x37zXZ\0"), ""),
    KNOWN("bzip2", UNPACK, 0, BYTES("BZh"), ""),
    REFUSED("a zip archive", "unpack it first", 0, BYTES("PK\x03\x04"), ".zip .npz "),
    REFUSED("a tar archive", "unpack it first", 257, BYTES("ustar"), ".tar "),
    REFUSED("PDF", "it holds no volume", 0, BYTES("%PDF"), ".pdf "),
};

enum { ROWS = sizeof rows / sizeof *rows };

static bool has_bytes(const row *r, const uint8_t *start, size_t size) {
    if (!r->bytes)
        return r->is != NULL;
    if (r->at >= ANYWHERE)
        return memmem(start, size, r->bytes, r->size) != NULL;
    return size >= r->at + r->size && memcmp(start + r->at, r->bytes, r->size) == 0;
}

/* Returns whether a file begins as the row says. */
static bool begins(const row *r, const uint8_t *start, size_t size) {
    return has_bytes(r, start, size) && (!r->is || r->is(start, size)) &&
           (!r->word || memmem(start, size, r->word, strlen(r->word)));
}

/* Returns whether the path ends in one of the row's suffixes. */
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

/* Returns whether a file is PLOT3D, which has no magic: three sizes, then as many floats as they
 * say (positions, or four numbers and a solution of five), and at most some padding. */
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
    static const foreign_format plot3d = {"PLOT3D", PLOT3D, NULL, false};
    for (int i = 0; i < ROWS; i++)
        if (begins(&rows[i], start, size) && (!rows[i].both || has_suffix(&rows[i], path)))
            return &rows[i].format;
    if (is_plot3d(start, size, bytes))
        return &plot3d;
    for (int i = 0; i < ROWS; i++)
        if ((!rows[i].both || rows[i].format.importer) && has_suffix(&rows[i], path))
            return &rows[i].format;
    return NULL;
}

/* Print up to sixteen bytes, for people who know their formats. */
static void show_start(const uint8_t *start, size_t size, char text[64]) {
    *text = 0;
    for (size_t i = 0, at = 0; i < size && i < 16; i++)
        at += (size_t)snprintf(text + at, 64 - at, "%s%02x", i ? " " : "", start[i]);
}

static status refuse(const char *name, const foreign_format *f) {
    return status_describe(ST_UNSUPPORTED, "%s: this is %s, which is not read here: %s", name,
                           f->name, f->advice);
}

status foreign_refuse(byte_stream *s, const char *expected) {
    const uint8_t *start;
    size_t size;
    char bytes[64];
    status st = byte_stream_peek(s, FOREIGN_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    const foreign_format *f = foreign_find(byte_stream_kind(s), start, size, byte_stream_left(s));
    /* An empty file may stand for its folder, as case.foam does. */
    if (size == 0 && !(f && text_ends_in(byte_stream_kind(s), ".foam")))
        return status_describe(ST_CORRUPT, "%s: is empty", byte_stream_name(s));
    if (f)
        return refuse(byte_stream_name(s), f);
    show_start(start, size, bytes);
    return status_describe(ST_UNSUPPORTED, "%s: no known format (it begins with %s): %s",
                           byte_stream_name(s), bytes, expected);
}

/* ---- folders ---- */

/* Returns whether a file of a folder is there, and begins as the row says. */
static bool fits_inside(mem *m, const row *r, const char *folder, const char *name, int length) {
    char path[PATH_MAX];
    byte_stream *s = NULL;
    const uint8_t *start;
    size_t size;
    if (snprintf(path, sizeof path, "%s/%.*s", folder, length, name) >= (int)sizeof path ||
        access(path, R_OK) != 0 || byte_stream_open(m, path, &s) != ST_OK)
        return false;
    const bool fits =
        byte_stream_peek(s, FOREIGN_PEEK, &start, &size) == ST_OK && begins(r, start, size);
    byte_stream_close(s);
    return fits;
}

status foreign_check_folder(mem *m, const char *folder) {
    for (int i = 0; i < ROWS; i++)
        for (const char *at = rows[i].inside; *at; at += strcspn(at, " ") + 1)
            if (fits_inside(m, &rows[i], folder, at, (int)strcspn(at, " ")))
                return refuse(folder, &rows[i].format);
    return ST_OK;
}
