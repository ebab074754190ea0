/* Single pass: every pixel gathers taps on a golden-angle spiral; a tap that does not reach it repeats the mean.
 *
 *     cc -std=c99 -O2 -o singlepass singlepass.c -lm
 *     singlepass --case CASE_FOLDER --out OUT_FOLDER
 * Reads CASE/params.txt and CASE/inputs/color.f32 (H W 3), depth.f32 and coc.f32 (H W); writes OUT/image.f32 (H W 3):
 * raw little-endian float32, rows in the order of the inputs. Circles are made of depth where params.txt has coc_scale.
 * All arithmetic is float32, with texture coordinates from 0 to 1, as on a graphics processor. Status 77 says that
 * params.txt asks for what is not here.
 * Read the case            read_params, read_floats
 * Walk a pixel's spiral    depth_of_field: colour between texels by color_at, depth at the nearest one by texel_at
 * Source: Gustafsson (2018), Bokeh Depth of Field in a Single Pass, Tuxedo Labs.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    float width, height;            /* px, whole */
    float max_blur_size;            /* px: circles are cut here */
    float rad_scale;                /* px^2: the radius grows by this over itself */
    float behind_factor;            /* a tap from behind counts up to this many times the pixel's own size */
    float radius_start, loop_bound, angle_start, angle_step; /* px; 0: rad_scale, max_blur_size. Radians */
    float row_step;                 /* 1: the sine of an angle points to later rows; -1: to earlier ones */
    float coc_scale, focus;         /* circle = coc_scale (1 / focus - 1 / depth) [px]; without, it is read */
    float *color, *depth, *coc;     /* (H W 3), (H W) [scene units], (H W) [px] */
} Picture;

#define AT(name) #name, offsetof(Picture, name)
static const struct { const char *key; size_t place; float least, greatest; } NUMBERS[] = {
    {AT(width), 1, 16384}, {AT(height), 1, 16384}, {AT(max_blur_size), 1e-6f, 1e6f}, {AT(rad_scale), 1e-3f, 256},
    {AT(behind_factor), 0, 1e6f}, {AT(radius_start), 1e-6f, 256}, {AT(loop_bound), 1e-6f, 256}, {AT(row_step), -1, 1},
    {AT(angle_start), -1e6, 1e6}, {AT(angle_step), -1e6, 1e6}, {AT(coc_scale), -1e9, 1e9}, {AT(focus), 1e-9f, 1e9},
};
static const char *const ONLY[][2] = { /* the one value that this port has of a key */
    {"method", "singlepass"}, {"depth_filter", "nearest"}, {"color_filter", "bilinear"}, {"order", "depth"},
    {"border", "clamp"}, {"max_taps", ""}, {"scale_x", "1.0"}, {"scale_y", "1.0"}, {"shift_x", "0.0"},
    {"shift_y", "0.0"},
};

static void fail(int status, const char *what, const char *why)
{
    fprintf(stderr, "singlepass: %s: %s\n", what, why);
    exit(status);
}

static FILE *open_in(const char *folder, const char *name, const char *mode)
{
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = length < (int)sizeof path ? fopen(path, mode) : NULL;
    if (!file)
        fail(2, path, "cannot be opened");
    return file;
}

static Picture read_params(const char *folder) /* lines "key value"; keys of other programs are passed over */
{
    Picture params = {.max_blur_size = 20.0f, .rad_scale = 0.5f, .behind_factor = 2.0f, .row_step = 1.0f};
    params.angle_step = 2.39996323f; /* the golden angle */
    char key[64], value[64], *end;
    FILE *file = open_in(folder, "params.txt", "r");
    while (fscanf(file, "%63s %63s", key, value) == 2) {
        for (size_t i = 0; i < sizeof NUMBERS / sizeof *NUMBERS; i++) {
            if (strcmp(key, NUMBERS[i].key)) continue;
            float read = strtof(value, &end);
            if (*end || !(read >= NUMBERS[i].least && read <= NUMBERS[i].greatest))
                fail(2, key, "no number, or out of range");
            *(float *)((char *)&params + NUMBERS[i].place) = read;
        }
        for (size_t i = 0; i < sizeof ONLY / sizeof *ONLY; i++)
            if (!strcmp(key, ONLY[i][0]) && strcmp(value, ONLY[i][1]))
                fail(77, key, "a value that this port does not have");
        if (!strcmp(key, "given") && !strcmp(value, "coc")) params.coc_scale = 0.0f; /* stands last */
    }
    fclose(file);
    if (params.width == 0.0f || params.height == 0.0f || (params.coc_scale != 0.0f && params.focus == 0.0f))
        fail(2, "params.txt", "width, height or focus is missing");
    params.radius_start = params.radius_start > 0.0f ? params.radius_start : params.rad_scale;
    params.loop_bound = params.loop_bound > 0.0f ? params.loop_bound : params.max_blur_size;
    return params;
}

static float *read_floats(const char *folder, const char *name, size_t count)
{
    unsigned char bytes[4];
    float *values = calloc(count, sizeof *values);
    FILE *file = open_in(folder, name, "rb");
    if (!values) fail(2, name, "does not fit in memory");
    for (size_t i = 0; i < count; i++) {
        if (fread(bytes, 1, 4, file) != 4)
            fail(2, name, "too short for width and height");
        uint32_t bits = bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
        memcpy(&values[i], &bits, 4);
    }
    if (fgetc(file) != EOF)
        fail(2, name, "too long for width and height");
    fclose(file);
    return values;
}

static void write_floats(const char *folder, const char *name, const float *values, size_t count)
{
    FILE *file = open_in(folder, name, "wb");
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], 4);
        for (int shift = 0; shift < 32; shift += 8)
            fputc((int)(bits >> shift & 255u), file);
    }
    if (ferror(file) | fclose(file)) /* both */
        fail(2, name, "cannot be written");
}

static int clamped(float index, int count) /* to the edge */
{
    return (int)fminf(fmaxf(index, 0.0f), (float)(count - 1));
}

/* The nearest texel of a place (u, v) in 0 .. 1: its index into depth and circle. */
static size_t texel_at(const Picture *p, float u, float v)
{
    int x = clamped(floorf(u * (float)p->width), p->width);
    int y = clamped(floorf(v * (float)p->height), p->height);
    return (size_t)y * (size_t)p->width + (size_t)x;
}

/* One channel of the colour at (u, v): bilinear between the centres of texels. */
static float color_at(const Picture *p, float u, float v, int channel)
{
    float x = u * (float)p->width - 0.5f, y = v * (float)p->height - 0.5f; /* in centres of texels */
    float across = x - floorf(x), down = y - floorf(y);
    int x0 = clamped(floorf(x), p->width), x1 = clamped(floorf(x) + 1.0f, p->width);
    int y0 = clamped(floorf(y), p->height), y1 = clamped(floorf(y) + 1.0f, p->height);
    const float *first = p->color + (size_t)y0 * (size_t)p->width * 3 + channel;
    const float *second = p->color + (size_t)y1 * (size_t)p->width * 3 + channel;
    float a = first[3 * x0] * (1.0f - across) + first[3 * x1] * across;
    float b = second[3 * x0] * (1.0f - across) + second[3 * x1] * across;
    return a * (1.0f - down) + b * down;
}

static float size_at(const Picture *p, size_t texel) /* radius of the circle of confusion [px] */
{
    return fminf(fabsf(p->coc[texel]), p->max_blur_size);
}

static float smoothstep(float low, float high, float value)
{
    float t = fminf(fmaxf((value - low) / (high - low), 0.0f), 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/* The blurred colour of pixel (x, y). The order of the taps matters: each blends into the mean of those before. */
static void depth_of_field(const Picture *p, int x, int y, float *color)
{
    float pixel_u = 1.0f / (float)p->width, pixel_v = 1.0f / (float)p->height;
    float u = ((float)x + 0.5f) * pixel_u, v = ((float)y + 0.5f) * pixel_v;
    size_t center = texel_at(p, u, v);
    float center_size = size_at(p, center);
    float total = 1.0f, angle = p->angle_start;
    for (int c = 0; c < 3; c++)
        color[c] = color_at(p, u, v, c);
    for (float radius = p->radius_start; radius < p->loop_bound; radius += p->rad_scale / radius) {
        float tap_u = u + cosf(angle) * pixel_u * radius;
        float tap_v = v + sinf(angle) * pixel_v * radius * p->row_step;
        size_t texel = texel_at(p, tap_u, tap_v);
        float size = size_at(p, texel);
        if (p->depth[texel] > p->depth[center])
            size = fminf(size, p->behind_factor * center_size);
        float m = smoothstep(radius - 0.5f, radius + 0.5f, size);
        for (int c = 0; c < 3; c++)
            color[c] += color[c] / total * (1.0f - m) + color_at(p, tap_u, tap_v, c) * m;
        total += 1.0f;
        angle += p->angle_step;
    }
    for (int c = 0; c < 3; c++)
        color[c] /= total;
}

int main(int count, char **words)
{
    if (count != 5 || strcmp(words[1], "--case") || strcmp(words[3], "--out"))
        fail(2, "usage", "singlepass --case CASE_FOLDER --out OUT_FOLDER");
    Picture picture = read_params(words[2]);
    size_t pixels = (size_t)picture.width * (size_t)picture.height;
    picture.color = read_floats(words[2], "inputs/color.f32", 3 * pixels);
    picture.depth = read_floats(words[2], "inputs/depth.f32", pixels);
    picture.coc = read_floats(words[2], "inputs/coc.f32", pixels);
    for (size_t i = 0; picture.coc_scale != 0.0f && i < pixels; i++)
        picture.coc[i] = picture.coc_scale * (1.0f / picture.focus - 1.0f / picture.depth[i]);
    float *image = calloc(3 * pixels, sizeof *image);
    if (!image) fail(2, "image.f32", "does not fit in memory");
    for (size_t i = 0; i < pixels; i++)
        depth_of_field(&picture, (int)(i % (size_t)picture.width), (int)(i / (size_t)picture.width), image + 3 * i);
    write_floats(words[4], "image.f32", image, 3 * pixels);
    return 0; /* the system takes the memory back */
}
