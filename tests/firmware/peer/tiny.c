/* scenes/layouts.rs, tiny. */
#define FLOOR 1
#define GLASS 1
#include "tracer.h"

static const struct material
    ivory = {{0.375f, 0.375f, 0.25f}, 0.0f, 0.625f, 0.25f, 50, 0.125f, 0.0f, 1.5f},
    glass = {{0.625f, 0.75f, 0.75f}, 0.0f, 0.0f, 0.5f, 125, 0.125f, 0.75f, 1.5f},
    rubber = {{0.25f, 0.125f, 0.125f}, 0.0f, 0.875f, 0.125f, 10, 0.0f, 0.0f, 1.5f},
    mirror = {{1.0f, 1.0f, 1.0f}, 0.0f, 0.0f, 0.875f, 1000, 0.75f, 0.0f, 1.5f},
    white = {{0.25f, 0.25f, 0.25f}, 0.0f, 1.0f, 0.0f, 1, 0.0f, 0.0f, 1.5f},
    amber = {{0.25f, 0.1875f, 0.0625f}, 0.0f, 1.0f, 0.0f, 1, 0.0f, 0.0f, 1.5f};

static const struct sphere balls[] = {
    {{-3.0f, 0.0f, -16.0f}, 2.0f, &ivory},
    {{-1.0f, -1.5f, -12.0f}, 2.0f, &glass},
    {{1.5f, -0.5f, -18.0f}, 3.0f, &rubber},
    {{7.0f, 5.0f, -18.0f}, 4.0f, &mirror},
};
static const struct floor ground = {{0.0f, -4.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, &white, &amber};
static const struct light lights[] = {
    {{-20.0f, 20.0f, 20.0f}, {1.5f, 1.5f, 1.5f}},
    {{30.0f, 50.0f, -25.0f}, {1.75f, 1.75f, 1.75f}},
    {{30.0f, 20.0f, 30.0f}, {1.75f, 1.75f, 1.75f}},
};

static const struct scene scene = {
    .spheres = balls,
    .sphere_count = 4,
    .floor = &ground,
    .lights = lights,
    .light_count = 3,
    .background = {0.25f, 0.625f, 0.75f},
    .ambient = {0.0f, 0.0f, 0.0f},
    .depth = 4,
};
static const struct camera camera = {
    .eye = {0.0f, 0.0f, 0.0f},
    .corner = {-1.0f, 0.625f, -1.75f},
    .right = {2.0f, 0.0f, 0.0f},
    .down = {0.0f, -1.5f, 0.0f},
    .width = 64,
    .height = 48,
};

void render_row(uint32_t y, vec3 *row) { draw_row(&scene, &camera, y, row); }
