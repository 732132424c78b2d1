#include "formats/leaf/leaf_head.h"

#include <string.h>

#include "formats/base/colour_field.h"
#include "formats/base/text.h"
#include "formats/leaf/curvilinear_zones.h"

void leaf_head_text(char *to, size_t size, const char *text) {
    char name[TEXT_NAME_MAX];
    text_name(name, size, text);
    memcpy(to, name, strlen(name));
}

static void fill_common(leaf_header *h, const leaf_layout *l, const leaf_parameters *p) {
    memcpy(h->magic, LEAF_MAGIC, sizeof h->magic);
    h->version = LEAF_VERSION;
    h->sample_type = l->type;
    h->levels = l->levels;
    h->run_align_log2 = p->run_align_log2;
    h->codec = p->codec;
    h->treelets = l->treelets;
}

void leaf_head_grid(leaf_header *h, const leaf_layout *l, const leaf_parameters *p, const grid *g,
                    const leaf_sets *sets) {
    fill_common(h, l, p);
    h->kind = g->heights ? LEAF_KIND_HEIGHTS : LEAF_KIND_GRID;
    h->source_type = grid_source(g);
    memcpy(h->dims, g->dims, sizeof h->dims);
    h->cells_log2 = p->cells_log2;
    h->halo = p->halo;
    h->block_log2 = LEAF_BLOCK_LOG2;
    h->rectilinear = grid_is_rectilinear(g);
    h->outside = p->slices ? LEAF_IN_SLICES : l->outside;
    h->bare = l->sampled < l->levels;
    h->outside_chunks = p->chunk_count;
    h->fields = sets->fields;
    h->steps = sets->steps;
    /* The name of a lone field says nothing, unless it says that these are colours. */
    const bool colours = g->heights && sets->names && strcmp(sets->names[0], COLOUR_FIELD) == 0;
    if (l->sets > 1 || h->segments || colours)
        leaf_head_text(h->field, sizeof h->field, sets->names ? sets->names[0] : "");
    memcpy(h->to_world, g->to_world, sizeof h->to_world);
    leaf_head_text(h->name, sizeof h->name, g->name);
}

void leaf_head_mesh(leaf_header *h, const leaf_layout *l, const leaf_parameters *p,
                    const leaf_mesh *mesh) {
    fill_common(h, l, p);
    h->kind = mesh->kind;
    h->source_type = SAMPLE_F32;
    h->fields = mesh->fields;
    h->steps = mesh->steps;
    h->to_world[0] = h->to_world[5] = h->to_world[10] = 1;
    h->treelet_tets = mesh->treelet_tets;
    h->leaf_tets = mesh->leaf_tets;
    h->gradients = mesh->gradients;
    h->moving = mesh->moving;
    leaf_head_text(h->name, sizeof h->name, mesh->name);
    leaf_head_text(h->field, sizeof h->field, mesh->field);
}

void leaf_head_curvilinear(leaf_header *h, const leaf_layout *l, const leaf_parameters *p,
                           const leaf_curvilinear *g) {
    fill_common(h, l, p);
    h->kind = LEAF_KIND_CURVILINEAR;
    h->source_type = SAMPLE_F32;
    h->cells_log2 = CURVILINEAR_LOG2;
    h->block_log2 = LEAF_BLOCK_LOG2;
    h->fields = g->sets.fields;
    h->steps = g->sets.steps;
    h->zones = g->zones;
    h->moving = g->moving;
    h->to_world[0] = h->to_world[5] = h->to_world[10] = 1;
    leaf_head_text(h->name, sizeof h->name, g->name);
    if (g->sets.names)
        leaf_head_text(h->field, sizeof h->field, g->sets.names[0]);
}
