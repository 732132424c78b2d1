/* leafcast import-hdf5 - writes a data set of an HDF5 file as NRRD. */
#include "prep/import/hdf5/hdf5_slices.h"
#include "prep/import/importer_options.h"

enum { KEY_AXES = IMPORT_KEY_OWN };

static const struct argp_option options[] = {
    IMPORT_FIELD_BY("data set", "largest"),
    IMPORT_COMPONENT,
    IMPORT_STEP,
    {"axes", KEY_AXES, "ORDER", CLI_BASIC,
     "the order of its axes, the fastest last, such as zyx, tzyx, zyxc: t time steps, c components",
     0},
    IMPORT_LIST("data sets"),
    IMPORT_TRUST_END};

static const char doc[] =
    "Import a data set of an HDF5 file as NRRD: for convert, or for others.\v"
    "Example:\n"
    "  leafcast import-hdf5 F.h5 --field /raw | leafcast convert - -o F.leaf\n\v"
    "Spacing comes from attributes (element_size_um, spacing, resolution, ..), or from VTKHDF. "
    "Samples are kept as they are; integers of 64 bits become f64.";

static const char *axes;

static status set(int key, const char *text) {
    if (key != KEY_AXES)
        return ST_AGAIN;
    axes = text;
    return ST_OK;
}

static status open(mem *m, const import_request *q, slice_source *out) {
    return hdf5_slices_open(m, q, axes, out);
}

static status list(mem *m, const import_request *q, const import_list *to) {
    return hdf5_slices_list(m, q, axes, to);
}

int main(int argc, char **argv) {
    const importer hdf5 = {.verb = "import-hdf5",
                           .format = "HDF5",
                           .inputs = "F.h5",
                           .doc = doc,
                           .beside = true,
                           .options = options,
                           .set_option = set,
                           .open = open,
                           .list = list};
    return importer_main(&hdf5, argc, argv);
}
