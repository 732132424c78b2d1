#include "formats/leaf/triangle_facts.h"

#include "formats/leaf/triangle_geometry.h"

/* Bytes before compression: positions, normals and values of the vertices, vertices of the
 * triangles. */
static double raw_bytes(const leaf_file *f) {
    const leaf_header *h = &f->header;
    const double place = triangle_have_normals(f) ? 16 : 12;
    return (double)h->vertices * (place * (double)f->layout.places + 4 * (double)f->layout.sets) +
           4 * TRIANGLE_CORNERS * (double)h->tets;
}

static void tell_cells(const leaf_header *h, const fact_sheet *to) {
    fact_sheet_line(to, "surface", "%llu triangles, %llu vertices", (unsigned long long)h->tets,
                    (unsigned long long)h->vertices);
    if (h->flat)
        fact_sheet_line(to, "triangles", "%llu without an area", (unsigned long long)h->flat);
    if (h->repeated || h->bad)
        fact_sheet_line(to, "left out",
                        "%llu triangles with a vertex twice, %llu with one that is none",
                        (unsigned long long)h->repeated, (unsigned long long)h->bad);
    fact_sheet_whole(to, "triangles", h->tets);
    fact_sheet_whole(to, "vertices", h->vertices);
    fact_sheet_whole(to, "flat", h->flat);
    fact_sheet_whole(to, "repeated", h->repeated);
    fact_sheet_whole(to, "bad", h->bad);
}

static void tell(const leaf_file *f, const fact_sheet *to) {
    const leaf_header *h = &f->header;
    const double raw = raw_bytes(f), each = (double)h->file_bytes / (double)h->tets;
    leaf_tell_begin(f, to);
    tell_cells(h, to);
    leaf_tell_print_fields(f, to);
    leaf_tell_values(f, to, "values", 1);
    leaf_tell_print_steps(f, to);
    leaf_tell_bounds(f, to);
    if (triangle_have_normals(f))
        fact_sheet_line(to, "normals", "at the vertices, 4 bytes each");
    fact_sheet_line(to, "treelets", "%llu of up to %u triangles, runs at %u, %s",
                    (unsigned long long)h->treelets, h->treelet_tets, 1U << h->run_align_log2,
                    leaf_tell_codec(f));
    fact_sheet_line(to, "file", "%llu bytes, %.2f a triangle, %.3f of the surface",
                    (unsigned long long)h->file_bytes, each, (double)h->file_bytes / raw);
    leaf_tell_bytes(f, to, raw);
    fact_sheet_real(to, "bytes_per_triangle", each);
    fact_sheet_flag(to, "moving", h->moving);
    fact_sheet_flag(to, "normals", triangle_have_normals(f));
    leaf_tell_set_fields(f, to);
}

const leaf_teller triangle_facts = {
    .name = "triangles", .cells = "triangles", .is_surface = true, .tell = tell};
