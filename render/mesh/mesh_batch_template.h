/* mesh_batch_template.h - mesh_batch_X() of mesh_batch.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_BATCH_TEMPLATE_H
#define RENDER_MESH_MESH_BATCH_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/mesh_batch_tets_template.h"

#include "render/flat/flat_batch_template.h"
#include "render/mesh/mesh_batch.h"
#include "render/mesh/mesh_tracer.h"

void SIMD_NAME(mesh_batch)(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters);

_Static_assert(sizeof(flat_batch) <= MESH_BATCH_SCRATCH, "a batch has room in its scratch");
_Static_assert((int)MESH_CHILDREN == (int)NODE_BOXES, "a node's children fill boxes");

enum { BATCH_TREELET_STACK = MESH_DEPTH_MAX * (MESH_CHILDREN - 1) + 1 };

/* ---- Nodes ---- */

/* Turns a treelet's codes into planes of the frame. */
typedef struct code_frame {
    float lo[3], hi[3], step[3];
    bool back[3];
} code_frame;

SIMD code_frame code_frame_of(const beam_frame *f, const resident_mesh *at) {
    code_frame c;
    for (int a = 0; a < 3; a++) {
        const double scale = f->scale * f->sign[a];
        const float corner = (float)(((double)at->planes.lo[a] - f->centre[a]) * scale);
        c.lo[a] = corner - f->slack[a];
        c.hi[a] = corner + f->slack[a];
        c.step[a] = (float)((double)at->planes.step[a] * scale);
        c.back[a] = f->sign[a] < 0.0;
    }
    return c;
}

typedef uint8_t codes16 __attribute__((vector_size(16)));
typedef uint16_t words16 __attribute__((vector_size(32)));
typedef int32_t ints16 __attribute__((vector_size(64)));
typedef float floats16 __attribute__((vector_size(64)));
typedef float floats8 __attribute__((vector_size(32)));

/* A node's codes as floats, 48 bytes in a row: the lower planes of all axes, then the upper
 * ones. */
typedef struct node_codes {
    float of[2][3][MESH_CHILDREN];
} node_codes;

SIMD void codes_of_node(const mesh_node *node, node_codes *out) {
    for (unsigned k = 0; k < 3; k++) {
        codes16 c;
        memcpy(&c, (const char *)node + sizeof c * k, sizeof c);
        const words16 words = __builtin_convertvector(c, words16);
        const ints16 ints = __builtin_convertvector(words, ints16);
        const floats16 floats = __builtin_convertvector(ints, floats16);
        memcpy((char *)out + sizeof floats * k, &floats, sizeof floats);
    }
}

SIMD void boxes_of_node(const code_frame *f, const mesh_node *node, beam_boxes *b) {
    node_codes codes;
    codes_of_node(node, &codes);
    for (int a = 0; a < 3; a++) {
        floats8 lower, upper;
        memcpy(&lower, codes.of[f->back[a]][a], sizeof lower);
        memcpy(&upper, codes.of[!f->back[a]][a], sizeof upper);
        lower = f->lo[a] + lower * f->step[a];
        upper = f->hi[a] + upper * f->step[a];
        memcpy(b->lo[a], &lower, sizeof lower);
        memcpy(b->hi[a], &upper, sizeof upper);
    }
}

static int open_node(flat_batch *w, const code_frame *planes, const resident_mesh *at,
                     const batch_pending *p, batch_pending *stack, int top) {
    const mesh_node *node = &at->nodes[p->i];
    const unsigned active = at->active->children[p->i];
    uint32_t wanted[BEAM_BOXES], met[BEAM_BOXES];
    beam_boxes b;
    w->counters->nodes++;
    boxes_of_node(planes, node, &b);
    leave_idle(&b, MESH_CHILDREN);
    for (unsigned c = 0; c < MESH_CHILDREN; c++)
        wanted[c] = p->beams;
    const unsigned left = meet_boxes(&w->beams, &b, active, p->beams, wanted, met);
    const int bottom = top;
    top = push_boxes(w, &b, left, met, stack, top);
    for (int k = bottom; k < top; k++) {
        stack[k].i = node->child[stack[k].i];
        if (!(stack[k].i & MESH_LEAF))
            __builtin_prefetch(&at->nodes[stack[k].i]);
    }
    return top;
}

static void batch_treelet(flat_batch *w, const treelet *of, uint32_t beams) {
    const resident_mesh *at = resident_mesh_of(of);
    const code_frame planes = code_frame_of(&w->frame, at);
    const uint16_t *first = mesh_leaf_first(&at->mesh, at->head.payload);
    batch_pending stack[BATCH_TREELET_STACK];
    int top = 0;
    stack[top++] = (batch_pending){0, 0, beams};
    while (top > 0) {
        batch_pending p = stack[--top];
        p.beams &= w->alive;
        if (!p.beams)
            continue;
        if (p.i & MESH_LEAF) {
            const uint32_t leaf = p.i & ~(uint32_t)MESH_LEAF;
            walk_leaf(w, at, first[leaf], first[leaf + 1], p.beams);
        } else {
            top = open_node(w, &planes, at, &p, stack, top);
        }
    }
    if (w->cells.count > 0)
        walk_tets(w, at);
}

static surface_point batch_point(const flat_batch *w, const treelet *at, const ray *r,
                                 const hit *h) {
    return mesh_tracer_surface(w->tr, at, r, h);
}

static double batch_cells_across(const flat_batch *w) {
    return cbrt((double)w->tr->treelets->file->header.tets);
}

void SIMD_NAME(mesh_batch)(const tracer *tr, ray_batch *b, void *scratch, ray_counters *counters) {
    walk_batch(scratch, tr, b, false, counters);
}

#endif
#endif
