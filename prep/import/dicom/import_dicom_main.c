/* leafcast import-dicom - writes a series of DICOM files as NRRD. */
#include <limits.h>

#include "prep/import/dicom/dicom_slices.h"
#include "prep/import/importer_options.h"

enum { KEY_GAPS = IMPORT_KEY_OWN };

static const struct argp_option options[] = {
    IMPORT_FIELD("series, by its UID or description,"),
    IMPORT_COMPONENT,
    IMPORT_STEP,
    {"allow-gaps", KEY_GAPS, NULL, CLI_BASIC,
     "go on where slices are missing: those beside them lie further apart", 0},
    IMPORT_LIST("series"),
    IMPORT_END};

static const char doc[] =
    "Import a series of DICOM files as NRRD: for convert, or for others.\v"
    "Example:\n"
    "  leafcast import-dicom FOLDER | leafcast convert - -o F.leaf\n\v"
    "Slices are sorted by position; values are rescaled (HU); the world is the patient's, in mm. "
    "RLE, JPEG, JPEG-LS and, with OpenJPEG, JPEG 2000 are decoded; binary segments "
    "become labels.";

static bool gaps;

static status set(int key, const char *text) {
    (void)text;
    if (key != KEY_GAPS)
        return ST_AGAIN;
    gaps = true;
    return ST_OK;
}

static status open(mem *m, const import_request *q, slice_source *out) {
    return dicom_slices_open(m, q, gaps, out);
}

int main(int argc, char **argv) {
    const importer dicom = {.verb = "import-dicom",
                            .format = "DICOM",
                            .inputs = "FOLDER|F.dcm...",
                            .inputs_max = INT_MAX,
                            .doc = doc,
                            .options = options,
                            .set_option = set,
                            .open = open,
                            .list = dicom_slices_list};
    return importer_main(&dicom, argc, argv);
}
