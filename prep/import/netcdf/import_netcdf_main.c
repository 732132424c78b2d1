/* leafcast import-netcdf - writes a variable of a netCDF file as NRRD, or as a curvilinear grid. */
#include "prep/import/importer_options.h"
#include "prep/import/netcdf/netcdf_slices.h"
#include "prep/import/netcdf/netcdf_zone.h"

enum { KEY_INDICES = IMPORT_KEY_OWN, KEY_STACK_TIME };

static const struct argp_option options[] = {
    IMPORT_FIELD_BY("variable", "largest field"),
    IMPORT_STEP,
    IMPORT_TO,
    {"indices", KEY_INDICES, NULL, 0, "leave coordinates aside: nodes lie at 0, 1, 2, ..", 0},
    {"stack-time", KEY_STACK_TIME, NULL, 0, "take a map that changes: its times are slices along z",
     0},
    IMPORT_LIST("variables"),
    IMPORT_TRUST_END};

static const char doc[] =
    "Import a variable of a netCDF file as NRRD: for convert, or for others.\v"
    "Example:\n"
    "  leafcast import-netcdf F.nc --field TEMP | leafcast convert - -o F.leaf\n\v"
    "After the CF conventions: packed values are unpacked, missing ones become NaN, coordinates "
    "are "
    "spacing and origin, or axes where distances differ.";

static netcdf_wish wish;

static status set(int key, const char *text) {
    (void)text;
    switch (key) {
    case KEY_INDICES: wish.indices = true; return ST_OK;
    case KEY_STACK_TIME: wish.stack_time = true; return ST_OK;
    default: return ST_AGAIN;
    }
}

static status open(mem *m, const import_request *q, slice_source *out) {
    return netcdf_slices_open(m, q, &wish, out);
}

static status open_zone(mem *m, const import_request *q, import_mesh *out) {
    return netcdf_zone_open(m, q, &wish, out);
}

static status list(mem *m, const import_request *q, const import_list *to) {
    return q->to ? netcdf_zone_list(m, q, &wish, to) : netcdf_slices_list(m, q, &wish, to);
}

int main(int argc, char **argv) {
    const importer netcdf = {.verb = "import-netcdf",
                             .format = "netCDF",
                             .inputs = "F.nc",
                             .doc = doc,
                             .beside = true,
                             .options = options,
                             .set_option = set,
                             .open = open,
                             .open_mesh = open_zone,
                             .list = list};
    return importer_main(&netcdf, argc, argv);
}
