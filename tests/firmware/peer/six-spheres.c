/* scenes/layouts.rs, six_spheres. */
#define FLOOR 1
#define GLASS 1
#include "tracer.h"

static const struct material
    red = {{0.75f, 0.125f, 0.125f}, 0.125f, 0.75f, 0.5f, 20, 0.0f, 0.0f, 1.5f},
    green = {{0.25f, 0.625f, 0.25f}, 0.125f, 0.75f, 0.5f, 50, 0.125f, 0.0f, 1.5f},
    blue = {{0.25f, 0.375f, 0.75f}, 0.125f, 0.75f, 0.5f, 50, 0.0f, 0.0f, 1.5f},
    silver = {{0.875f, 0.875f, 0.875f}, 0.125f, 0.125f, 0.5f, 200, 0.75f, 0.0f, 1.5f},
    crystal = {{0.875f, 0.875f, 0.875f}, 0.125f, 0.0f, 0.5f, 200, 0.125f, 0.75f, 1.5f},
    white = {{0.75f, 0.75f, 0.75f}, 0.125f, 0.75f, 0.5f, 10, 0.0f, 0.0f, 1.5f},
    black = {{0.125f, 0.125f, 0.125f}, 0.125f, 0.75f, 0.5f, 10, 0.25f, 0.0f, 1.5f};

static const struct sphere balls[] = {
    {{-1.75f, 0.75f, -3.0f}, 0.75f, &red},    {{0.0f, 1.0f, -4.0f}, 1.0f, &silver},
    {{1.75f, 0.75f, -3.5f}, 0.75f, &green},   {{0.625f, 0.5f, -1.75f}, 0.5f, &crystal},
    {{-0.75f, 0.375f, -1.5f}, 0.375f, &blue}, {{1.5f, 0.25f, -1.25f}, 0.25f, &silver},
};
static const struct floor ground = {{0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, &white, &black};
static const struct light lights[] = {{{-3.0f, 6.0f, 2.0f}, {1.0f, 1.0f, 1.0f}}};

static const struct scene scene = {
    .spheres = balls,
    .sphere_count = 6,
    .floor = &ground,
    .lights = lights,
    .light_count = 1,
    .background = {0.25f, 0.5f, 0.75f},
    .ambient = {1.0f, 1.0f, 1.0f},
    .depth = 4,
};
static const struct camera camera = {
    .eye = {0.0f, 1.25f, 2.0f},
    .corner = {-1.0f, 0.625f, -1.75f},
    .right = {2.0f, 0.0f, 0.0f},
    .down = {0.0f, -1.5f, 0.0f},
    .width = 64,
    .height = 48,
};

void render_row(uint32_t y, vec3 *row) { draw_row(&scene, &camera, y, row); }
