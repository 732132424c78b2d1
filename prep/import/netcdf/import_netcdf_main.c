/* leafcast import-netcdf - a variable of a netCDF file as NRRD. */
#include "prep/import/importer_options.h"
#include "prep/import/netcdf/netcdf_slices.h"

enum { KEY_INDICES = IMPORT_KEY_OWN };

static const struct argp_option options[] = {
    IMPORT_FIELD("variable"),
    IMPORT_STEP,
    {"indices", KEY_INDICES, NULL, 0, "leave coordinates aside: nodes lie at 0, 1, 2, ..", 0},
    IMPORT_LIST("variables"),
    IMPORT_END};

static const char doc[] =
    "Import a variable of a netCDF file as NRRD: for convert, or for others.\v"
    "Example:\n"
    "  leafcast import-netcdf F.nc --field TEMP | leafcast convert - -o F.leaf\n\v"
    "After the CF conventions: packed values are unpacked, missing ones become NaN, coordinates "
    "are "
    "spacing and origin, or axes where distances differ.";

static bool indices;

static status set(int key, const char *text) {
    (void)text;
    if (key != KEY_INDICES)
        return ST_AGAIN;
    indices = true;
    return ST_OK;
}

static status open(mem *m, const import_request *q, slice_source *out) {
    return netcdf_slices_open(m, q, indices, out);
}

int main(int argc, char **argv) {
    const importer netcdf = {.verb = "import-netcdf",
                             .format = "netCDF",
                             .inputs = "F.nc",
                             .doc = doc,
                             .options = options,
                             .set_option = set,
                             .open = open,
                             .list = netcdf_slices_list};
    return importer_main(&netcdf, argc, argv);
}
