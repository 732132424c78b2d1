/* leafcast import-images - writes a stack of images as NRRD. */
#include <limits.h>
#include <math.h>

#include "formats/base/num.h"
#include "prep/import/images/image_slices.h"
#include "prep/import/importer.h"
#include "prep/import/importer_options.h"

enum { KEY_SPACING = IMPORT_KEY_OWN, KEY_AS_GIVEN };

static const struct argp_option options[] = {
    {"spacing", KEY_SPACING, "X,Y,Z", CLI_BASIC,
     "distances of pixels and slices (default: what the tags say, else 1)", 0},
    {"field", IMPORT_KEY_FIELD, "NAME", 0,
     "the channel to take, such as R (default: of colours their luminance)", 0},
    IMPORT_COMPONENT,
    IMPORT_STEP,
    {"as-given", KEY_AS_GIVEN, NULL, 0,
     "slices in the order in which the files are named, not by their names", 0},
    IMPORT_LIST("channels"),
    IMPORT_END};

static image_wish wish;

static status set_spacing(const char *text) {
    const status st = num_doubles(text, "--spacing", ", ", 3, wish.spacing);
    for (int a = 0; a < 3 && st == ST_OK; a++)
        if (!isfinite(wish.spacing[a]) || wish.spacing[a] == 0)
            return status_describe(ST_USAGE, "--spacing: \"%s\": expected three numbers but 0",
                                   text);
    return st;
}

static status set_option(int key, const char *text) {
    switch (key) {
    case KEY_SPACING: return set_spacing(text);
    case KEY_AS_GIVEN: wish.as_given = true; return ST_OK;
    default: return ST_AGAIN;
    }
}

static status open_images(mem *m, const import_request *q, slice_source *out) {
    return image_slices_open(m, q, &wish, out);
}

static status list_images(mem *m, const import_request *q, const import_list *to) {
    return image_slices_list(m, q, &wish, to);
}

int main(int argc, char **argv) {
    static const importer row = {
        .verb = "import-images",
        .format = "OpenImageIO",
        .inputs = "IMAGE...|FOLDER",
        .inputs_max = INT_MAX,
        .doc = "Write a stack of images as NRRD, to standard output or -o: the pages of a TIFF, or "
               "the files of a folder, or those that are named, sorted so that img2 comes before "
               "img10. All have one size and type; the top row has y = 0.\v"
               "Example:\n  leafcast import-images scan/ --spacing 0.1,0.1,0.5 -o scan.nrrd",
        .options = options,
        .set_option = set_option,
        .open = open_images,
        .list = list_images};
    return importer_main(&row, argc, argv);
}
