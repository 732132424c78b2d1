#include "render/bench/bench_figure.h"

#include <math.h>

#include "render/app/image_out.h"
#include "render/experiments/intersect.h"
#include "render/grid/surface.h"
#include "render/look/camera.h"
#include "render/ray/affine.h"
#include "render/surface/shade.h"

/* Two sheets, one at each end of the diagonal that the camera looks along. */
static const float SAMPLES[8] = {0.0f, 0.9f, 1.0f, 0.2f, 0.1f, 1.0f, 0.8f, 0.0f};
static const double ISO = 0.42;

static const leafcast_camera VIEW = {.size = sizeof(leafcast_camera),
                                     .eye = {-1.6, -2.0, 1.3},
                                     .look_at = {0.5, 0.5, 0.48},
                                     .up = {0.0, 0.0, 1.0},
                                     .fov = 26.0};

static void colour_of(const leafcast_scene *scene, const cell_visit *v, const hit *h,
                      const double direction[3], float rgb[3]) {
    static const float gold[3] = {0.83f, 0.62f, 0.24f}, white[3] = {1.0f, 1.0f, 1.0f};
    static const double unit[3] = {1.0, 1.0, 1.0};
    const double s = v->t_out > v->t_in ? (h->t - v->t_in) / (v->t_out - v->t_in) : 0.0;
    double at[3], gradient[3];
    float normal[3] = {0.0f, 0.0f, 0.0f}, eye[3];
    for (int a = 0; a < 3; a++) {
        at[a] = v->in[a] + s * (v->out[a] - v->in[a]);
        eye[a] = (float)-direction[a];
    }
    surface_trilinear(SAMPLES, at, unit, gradient);
    (void)shade_normal(gradient, normal); /* the eye, where it has none */
    const shade_point p = shade_point_of(scene, gold, normal, eye);
    shade_ambient(&p, rgb);
    shade_light(&p, eye, white, 1.0f, rgb);
}

/* Half of the picture. */
static uint64_t draw_half(const intersector *x, const camera *c, uint32_t side, uint32_t offset,
                          const leafcast_image *image, uint64_t *rays) {
    static const cell_box box = {
        {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, {true, true, true}};
    leafcast_scene scene = leafcast_scene_default();
    scene.shading = LEAFCAST_SHADING_PHONG;
    uint64_t seen = 0;
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t i = 0; i < side; i++) {
            const size_t pixel = (size_t)y * 2 * side + offset + i;
            ray r = {.t0 = 0.0, .t1 = INFINITY};
            cell_visit v;
            float rgb[3] = {1.0f, 1.0f, 1.0f};
            camera_ray(c, i + 0.5, y + 0.5, r.o, r.d);
            if (cell_visit_of(&r, &box, &v)) {
                const hit start = hit_before_all();
                hit h;
                const bool found = x->next_hit(&r, &v, SAMPLES, ISO, 0, 0, &start, &h);
                rgb[0] = rgb[1] = rgb[2] = 0.85f; /* the cell's silhouette */
                if (found)
                    colour_of(&scene, &v, &h, r.d, rgb);
                seen += found;
                ++*rays;
            }
            image->r[pixel] = rgb[0];
            image->g[pixel] = rgb[1];
            image->b[pixel] = rgb[2];
        }
    return seen;
}

status bench_figure_draw(mem *m, const char *path, bool force, uint32_t side,
                         bench_figure *result) {
    const size_t pixels = (size_t)side * side * 2;
    leafcast_camera view = VIEW;
    view.width = view.height = side;
    camera c;
    status st = image_out_check(&(image_out_options){.force = force}, path);
    if (st == ST_OK)
        st = camera_init(&c, &view);
    if (st)
        return st;
    float *planes = mem_array(m, 3 * pixels, sizeof *planes);
    if (!planes)
        return ST_NOMEM;
    const leafcast_image image = {.size = sizeof(leafcast_image),
                                  .r = planes,
                                  .g = planes + pixels,
                                  .b = planes + 2 * pixels};
    *result = (bench_figure){0};
    uint64_t twice = 0;
    result->left =
        draw_half(intersector_find(LEAFCAST_NEUBAUER), &c, side, 0, &image, &result->rays);
    result->right = draw_half(intersector_find(LEAFCAST_MARMITT), &c, side, side, &image, &twice);
    st = image_out_write(m, path, force,
                         &(picture){.width = 2 * side, .height = side, .image = &image});
    mem_free(m, planes);
    return st;
}
