/* A ray tracer in plain C: what whitted is compared with.
 *
 * Written straight from the formulas, recursion and all, without any of whitted's shortcuts; but the
 * same formulas with the same order of operations, so that it has to show the same bits. A scene's
 * file says what it needs (FLOOR, GLASS), defines `scene` and `camera`, and includes this file in
 * between, so that the compiler sees all of a program at once.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct { float x, y, z; } vec3;

static inline vec3 vec(float x, float y, float z) { return (vec3){x, y, z}; }
static inline vec3 add(vec3 a, vec3 b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline vec3 sub(vec3 a, vec3 b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline vec3 mul(vec3 a, vec3 b) { return vec(a.x * b.x, a.y * b.y, a.z * b.z); }
static inline vec3 scale(vec3 a, float s) { return vec(a.x * s, a.y * s, a.z * s); }
static inline vec3 divide(vec3 a, float s) { return vec(a.x / s, a.y / s, a.z / s); }
static inline float dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec3 normalize(vec3 a) { return scale(a, 1.0f / __builtin_sqrtf(dot(a, a))); }
/* For a vector whose length is 1 but for rounding. */
static inline vec3 renormalize(vec3 a) { return scale(a, 1.5f - 0.5f * dot(a, a)); }

struct material {
    vec3 color;
    float ambient, diffuse, specular;
    uint32_t shininess;
    float reflectance, transmittance, ior;
};

struct sphere {
    vec3 center;
    float radius;
    const struct material *material;
};

struct light {
    vec3 position, color;
};

/* A horizontal plane of two kinds of square tiles. */
struct floor {
    vec3 point, normal;
    const struct material *tiles, *others;
};

struct scene {
    const struct sphere *spheres;
    int sphere_count;
    const struct floor *floor;
    const struct light *lights;
    int light_count;
    vec3 background, ambient;
    int depth;
};

struct camera {
    vec3 eye, corner, right, down;
    int width, height;
};

struct ray {
    vec3 origin, direction;
    float t_max;
    /* The surface that it leaves, which is not met again at its origin, and on which side. */
    const void *leaving;
    bool inside;
};

struct hit {
    vec3 point, normal;
    const struct material *material;
    const void *object;
    bool front;
};

static inline bool admits(const struct ray *ray, float t) { return t > 0.0f && t < ray->t_max; }

static inline vec3 at(const struct ray *ray, float t)
{
    return add(ray->origin, scale(ray->direction, t));
}

/* The quadratic, about the point of the ray that is closest to the center. */
static inline bool sphere_roots(const struct sphere *sphere, const struct ray *ray, float *entry,
                                float *exit)
{
    vec3 to_center = sub(sphere->center, ray->origin);
    float approach = dot(to_center, ray->direction);
    vec3 miss = sub(scale(ray->direction, approach), to_center);
    float along = dot(miss, ray->direction);
    float half_chord_squared = sphere->radius * sphere->radius - dot(miss, miss) + along * along;
    if (!(half_chord_squared >= 0.0f))
        return false;
    float half_chord = __builtin_sqrtf(half_chord_squared);
    *entry = approach - (half_chord + along);
    *exit = approach + (half_chord - along);
    return true;
}

/* The far end of the chord that begins at the ray's origin. */
static inline float sphere_chord(const struct sphere *sphere, const struct ray *ray)
{
    return 2.0f * dot(sub(sphere->center, ray->origin), ray->direction);
}

static inline float floor_distance(const struct floor *floor, const struct ray *ray)
{
    return dot(floor->normal, sub(floor->point, ray->origin)) / dot(floor->normal, ray->direction);
}

static inline const struct material *floor_material(const struct floor *floor, vec3 point)
{
    uint32_t x = (uint32_t)(point.x + 1024.0f), z = (uint32_t)(point.z + 1024.0f);
    return (x ^ z) & 1 ? floor->others : floor->tiles;
}

static bool closest_hit(const struct scene *scene, struct ray ray, struct hit *hit)
{
    const struct sphere *nearest = NULL;
    for (int i = 0; i < scene->sphere_count; i++) {
        const struct sphere *sphere = &scene->spheres[i];
        float t, exit;
        if (ray.leaving == sphere) {
            if (!ray.inside)
                continue;
            t = sphere_chord(sphere, &ray);
        } else {
            if (!sphere_roots(sphere, &ray, &t, &exit))
                continue;
            if (!(t > 0.0f))
                t = exit;
        }
        if (admits(&ray, t)) {
            ray.t_max = t;
            nearest = sphere;
        }
    }
    bool on_floor = false;
#if FLOOR
    if (ray.leaving != scene->floor) {
        float t = floor_distance(scene->floor, &ray);
        if (admits(&ray, t)) {
            ray.t_max = t;
            on_floor = true;
        }
    }
#endif
    if (!nearest && !on_floor)
        return false;
    hit->point = at(&ray, ray.t_max);
    vec3 outward;
    if (on_floor) {
        hit->object = scene->floor;
        hit->material = floor_material(scene->floor, hit->point);
        outward = scene->floor->normal;
    } else {
        hit->object = nearest;
        hit->material = nearest->material;
        outward = normalize(sub(hit->point, nearest->center));
    }
    hit->front = dot(outward, ray.direction) <= 0.0f;
    hit->normal = hit->front ? outward : vec(-outward.x, -outward.y, -outward.z);
    return true;
}

#if GLASS

static inline float float_of(uint32_t bits)
{
    float x;
    __builtin_memcpy(&x, &bits, sizeof x);
    return x;
}

static inline uint32_t bits_of(float x)
{
    uint32_t bits;
    __builtin_memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float log2_of(float x)
{
    uint32_t offset = bits_of(x) - 0x3f3504f3;
    int32_t exponent = (int32_t)offset >> 23;
    float significand = float_of((offset & 0x007fffff) + 0x3f3504f3);
    float s = (significand - 1.0f) / (significand + 1.0f);
    float z = s * s;
    return (float)exponent + s * (2.8853904f + z * (0.9615883f + z * 0.5957817f));
}

static float exp2_of(float x)
{
    if (!(x >= -126.0f))
        return 0.0f;
    float rounded = (x + 12582912.0f) - 12582912.0f;
    float f = x - rounded;
    float p = 0.693147f
        + f * (0.24022242f + f * (0.055507337f + f * (0.009671513f + f * 0.0013264727f)));
    return (1.0f + f * p) * float_of((uint32_t)((int32_t)rounded + 127) << 23);
}

/* Products of floats depend on their order, sums of whole numbers do not: units of 2^-24 of -log2. */
static inline uint32_t optical_depth(float transmittance)
{
    return (uint32_t)(-log2_of(transmittance) * 16777216.0f);
}

#endif

/* Share of light that passes along the ray. */
static float transmittance(const struct scene *scene, const struct ray *ray)
{
#if GLASS
    uint32_t sum = 0;
#endif
    for (int i = 0; i < scene->sphere_count; i++) {
        const struct sphere *sphere = &scene->spheres[i];
        uint32_t crossings = 0;
        if (ray->leaving == sphere) {
            crossings = ray->inside && admits(ray, sphere_chord(sphere, ray));
        } else {
            float entry, exit;
            if (sphere_roots(sphere, ray, &entry, &exit))
                crossings = admits(ray, entry) + admits(ray, exit);
        }
        if (crossings > 0) {
#if GLASS
            if (!(sphere->material->transmittance > 0.0f))
                return 0.0f;
            sum += crossings * optical_depth(sphere->material->transmittance);
#else
            return 0.0f;
#endif
        }
    }
#if FLOOR
    /* Opaque. */
    if (ray->leaving != scene->floor && admits(ray, floor_distance(scene->floor, ray)))
        return 0.0f;
#endif
#if GLASS
    if (sum == 0)
        return 1.0f;
    return exp2_of(-((float)(sum >> 24) + (float)(sum & 0x00ffffff) / 16777216.0f));
#else
    return 1.0f;
#endif
}

static float power(float x, uint32_t n)
{
    float result = 1.0f;
    for (;;) {
        if (n & 1)
            result *= x;
        n >>= 1;
        if (n == 0)
            return result;
        x *= x;
    }
}

static vec3 direct_light(const struct scene *scene, const struct hit *hit, vec3 mirrored,
                         float throughput)
{
    const struct material *material = hit->material;
    vec3 sum = scale(mul(material->color, scene->ambient), material->ambient * throughput);
    for (int i = 0; i < scene->light_count; i++) {
        const struct light *light = &scene->lights[i];
        vec3 to_light = sub(light->position, hit->point);
        float height = dot(hit->normal, to_light);
        if (!(height > 0.0f))
            continue;
        float distance = __builtin_sqrtf(dot(to_light, to_light));
        float reciprocal = 1.0f / distance;
        vec3 direction = scale(to_light, reciprocal);
        struct ray shadow = {hit->point, direction, distance, hit->object, !hit->front};
        float passed = transmittance(scene, &shadow);
        if (!(passed > 0.0f))
            continue;
        vec3 term = scale(material->color, material->diffuse * (height * reciprocal));
        float cosine = dot(mirrored, direction);
        if (cosine > 0.0f && material->specular > 0.0f) {
            float highlight = material->specular * power(cosine, material->shininess);
            term = add(term, vec(highlight, highlight, highlight));
        }
        sum = add(sum, scale(mul(term, scale(light->color, throughput)), passed));
    }
    return sum;
}

/* Adds the light that arrives along the ray, weighed by `throughput`. */
static void trace(const struct scene *scene, const struct ray *ray, float throughput, int depth,
                  vec3 *radiance)
{
    struct hit hit;
    if (!closest_hit(scene, *ray, &hit)) {
        *radiance = add(*radiance, scale(scene->background, throughput));
        return;
    }
    const struct material *material = hit.material;
    float cosine = dot(ray->direction, hit.normal);
    vec3 mirrored = sub(ray->direction, scale(hit.normal, 2.0f * cosine));
    *radiance = add(*radiance, direct_light(scene, &hit, mirrored, throughput));
    if (depth >= scene->depth)
        return;

    float reflectance = material->reflectance;
#if GLASS
    vec3 refracted;
    bool refracts = false;
    if (material->transmittance > 0.0f) {
        float eta = hit.front ? 1.0f / material->ior : material->ior;
        float cosine_squared = 1.0f - eta * eta * (1.0f - cosine * cosine);
        if (cosine_squared >= 0.0f) {
            float along = eta * -cosine - __builtin_sqrtf(cosine_squared);
            refracted = renormalize(add(scale(ray->direction, eta), scale(hit.normal, along)));
            refracts = true;
        } else {
            /* Total internal reflection. */
            reflectance += material->transmittance;
        }
    }
#endif
    if (reflectance > 0.0f) {
        struct ray child = {hit.point, renormalize(mirrored), __builtin_inff(), hit.object,
                            !hit.front};
        trace(scene, &child, throughput * reflectance, depth + 1, radiance);
    }
#if GLASS
    if (refracts) {
        struct ray child = {hit.point, refracted, __builtin_inff(), hit.object, hit.front};
        trace(scene, &child, throughput * material->transmittance, depth + 1, radiance);
    }
#endif
}

static inline float positive(float x) { return x > 0.0f ? x : 0.0f; }

static void draw_row(const struct scene *scene, const struct camera *camera, uint32_t y, vec3 *row)
{
    vec3 down = divide(camera->down, (float)camera->height);
    vec3 step = divide(camera->right, (float)camera->width);
    vec3 start = add(camera->corner, scale(down, (float)y + 0.5f));
    for (int x = 0; x < camera->width; x++) {
        vec3 direction = normalize(add(start, scale(step, (float)x + 0.5f)));
        struct ray ray = {camera->eye, direction, __builtin_inff(), NULL, false};
        vec3 radiance = vec(0.0f, 0.0f, 0.0f);
        trace(scene, &ray, 1.0f, 1, &radiance);
        row[x] = vec(positive(radiance.x), positive(radiance.y), positive(radiance.z));
    }
}
