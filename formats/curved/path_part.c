#include "formats/curved/path_part.h"

void path_crossings_add(path_crossings *s, const path_end *e) {
    if (s->count == PATH_CROSSINGS)
        return;
    int i = s->count++;
    for (; i > 0 && s->end[i - 1].t > e->t; i--)
        s->end[i] = s->end[i - 1];
    s->end[i] = *e;
}

int path_parts(const path_crossings in_out[2], bool folded, path_part out[PATH_PARTS]) {
    int count = 0;
    for (int i = 0; i < in_out[0].count && i < in_out[1].count && i < PATH_PARTS; i++) {
        const path_end *in = &in_out[0].end[i], *to = &in_out[1].end[i];
        const bool back = folded && to->t < in->t;
        out[count++] = back ? (path_part){{*to, *in}} : (path_part){{*in, *to}};
    }
    return count;
}

bool path_parts_at(const path_part part[], int count, double t, path_end *out) {
    for (int i = 0; i < count; i++) {
        const path_end *from = &part[i].end[0], *to = &part[i].end[1];
        if (!(from->t <= t && t < to->t))
            continue;
        const double share = (t - from->t) / (to->t - from->t);
        out->t = t;
        out->value = from->value + share * (to->value - from->value);
        for (int a = 0; a < 3; a++)
            out->at[a] = from->at[a] + share * (to->at[a] - from->at[a]);
        return true;
    }
    return false;
}

void path_part_walk(const path_part *part, path_look *look, void *ctx) {
    struct {
        path_end end;
        int depth;
    } ahead[PATH_DEPTH + 1];
    path_end here = part->end[0];
    int count = 1;
    ahead[0].end = part->end[1];
    ahead[0].depth = 0;
    while (count > 0) {
        const int depth = ahead[count - 1].depth;
        path_end middle;
        if (look(ctx, &here, &ahead[count - 1].end, depth, &middle) && depth < PATH_DEPTH) {
            ahead[count - 1].depth = depth + 1;
            ahead[count].end = middle;
            ahead[count++].depth = depth + 1;
        } else {
            here = ahead[--count].end;
        }
    }
}
