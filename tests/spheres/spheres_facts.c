#include "tests/spheres/spheres_facts.h"

#include "formats/leaf/leaf_cells.h"

static void tell(const leaf_file *f, const fact_sheet *to) {
    leaf_tell_begin(f, to);
    fact_sheet_count(to, "spheres", "spheres",
                     leaf_cells_directory_of(f)->first[f->layout.treelets]);
    leaf_tell_values(f, to, "values", 1);
    leaf_tell_bytes(f, to, (double)f->header.payload_bytes);
}

const leaf_teller spheres_facts = {
    .name = "spheres", .cells = "spheres", .drawn = "spheres", .tell = tell};
