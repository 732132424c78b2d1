/* leafcast import-cgns - writes the mesh of a CGNS file as a mesh stream. */
#include "prep/import/cgns/cgns_mesh.h"
#include "prep/import/importer_options.h"

static const struct argp_option options[] = {IMPORT_FIELDS("solution's field"),
                                             IMPORT_CELLS_TO_POINTS,
                                             IMPORT_ZONES,
                                             IMPORT_STEP,
                                             IMPORT_BY_CORNERS,
                                             IMPORT_LIST("fields"),
                                             IMPORT_TRUST_END};

static const char doc[] =
    "Import the mesh of a CGNS file as a mesh stream, or its zones as a curvilinear stream: for "
    "convert, or for others.\v"
    "Example:\n"
    "  leafcast import-cgns F.cgns --step 3 | leafcast convert - --whole-cells -o F.leaf\n\v"
    "The zones of the first base of three dimensions come one behind the other, structured ones "
    "as hexahedra. Where all are structured, convert takes them as they are (--zones).";

int main(int argc, char **argv) {
    const importer cgns = {.verb = "import-cgns",
                           .format = "CGNS",
                           .inputs = "F.cgns",
                           .doc = doc,
                           .beside = true,
                           .options = options,
                           .open_mesh = cgns_mesh_open,
                           .list = cgns_mesh_list};
    return importer_main(&cgns, argc, argv);
}
