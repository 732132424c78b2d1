/* leafcast import-exodus - writes the mesh of an Exodus II file as a mesh stream. */
#include "prep/import/exodus/exodus_mesh.h"
#include "prep/import/importer_options.h"

static const struct argp_option options[] = {
    IMPORT_FIELDS("variable"), IMPORT_CELLS_TO_POINTS,   IMPORT_STEP,
    IMPORT_BY_CORNERS,         IMPORT_LIST("variables"), IMPORT_TRUST_END};

static const char doc[] =
    "Import the mesh of an Exodus II file as a mesh stream: for convert, or for others.\v"
    "Example:\n"
    "  leafcast import-exodus F.exo --step 3 | leafcast convert - --whole-cells -o F.leaf\n\v"
    "Blocks of hexahedra, wedges, pyramids and tets are joined; shells, bars and points are left "
    "out.";

int main(int argc, char **argv) {
    const importer exodus = {.verb = "import-exodus",
                             .format = "Exodus II",
                             .inputs = "F.exo",
                             .doc = doc,
                             .beside = true,
                             .options = options,
                             .open_mesh = exodus_mesh_open,
                             .list = exodus_mesh_list};
    return importer_main(&exodus, argc, argv);
}
