/* scenes/layouts.rs, c_ray. */
#define FLOOR 0
#define GLASS 0
#include "tracer.h"

static const struct material
    orange = {{0.875f, 0.25f, 0.0625f}, 0.0f, 1.0f, 1.0f, 50, 0.25f, 0.0f, 1.0f},
    green = {{0.125f, 0.75f, 0.25f}, 0.0f, 1.0f, 1.0f, 60, 0.375f, 0.0f, 1.0f},
    grey = {{0.5f, 0.5f, 0.625f}, 0.0f, 1.0f, 1.0f, 40, 0.75f, 0.0f, 1.0f},
    blue = {{0.125f, 0.25f, 0.5f}, 0.0f, 1.0f, 1.0f, 80, 0.75f, 0.0f, 1.0f};

static const struct sphere balls[] = {
    {{-1.5f, -0.25f, -3.5f}, 0.75f, &orange},
    {{1.5f, -0.375f, -4.5f}, 0.625f, &green},
    {{0.0f, -1000.0f, -5.0f}, 999.0f, &blue},
    {{0.0f, 0.0f, -6.0f}, 1.0f, &grey},
};
static const struct light lights[] = {
    {{-50.0f, 100.0f, 50.0f}, {1.0f, 1.0f, 1.0f}},
    {{40.0f, 40.0f, 150.0f}, {0.5f, 0.5f, 0.5f}},
};

static const struct scene scene = {
    .spheres = balls,
    .sphere_count = 4,
    .lights = lights,
    .light_count = 2,
    .background = {0.0f, 0.0f, 0.0f},
    .ambient = {0.0f, 0.0f, 0.0f},
    .depth = 5,
};
static const struct camera camera = {
    .eye = {0.0f, 0.5f, 1.0f},
    .corner = {-1.0f, 0.625f, -1.75f},
    .right = {2.0f, 0.0f, 0.0f},
    .down = {0.0f, -1.5f, 0.0f},
    .width = 64,
    .height = 48,
};

void render_row(uint32_t y, vec3 *row) { draw_row(&scene, &camera, y, row); }
