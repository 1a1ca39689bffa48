/* SPDX-License-Identifier: Apache-2.0 */
/* Relights a package as a game would: lists its elements, sets some, updates, writes a page.
 *
 *   relight PACKAGE [NAME=WEIGHT ...] [NAME:R,G,B ...] [NAME@DEGREES/OPEN_DEGREES ...] [-o PAGE FILE.ppm EXPOSURE]
 *
 *   NAME=WEIGHT   strength of a light set, openness of a door, presence of a toggle
 *   NAME:R,G,B    colour of a light set, relative to the bake
 *   NAME@A/B      a hinged door at angle A that was baked open at angle B
 *   -o            page PAGE as a picture, W/m^2 times EXPOSURE
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ajar_runtime.h"

/* A game would report and go on without the light; this program ends. */
static void check(ajar_runtime_result result, const char* what) {
    if (result == AJAR_RUNTIME_OK) return;
    fprintf(stderr, "relight: %s: %s\n", what, ajar_runtime_error_message());
    exit(1);
}

static void list_elements(ajar_runtime light) {
    static const char* const kinds[] = {"light set", "door", "toggle"};
    uint32_t count = 0;
    check(ajar_runtime_element_count(light, &count), "elements");
    for (uint32_t i = 0; i < count; ++i) {
        ajar_runtime_element e;
        ajar_runtime_element_init(&e);
        check(ajar_runtime_get_element(light, i, &e), "element");
        printf("%-10s %-24s weight %g, reaches %llu texels\n", kinds[e.kind], e.name, (double)e.weight,
               (unsigned long long)e.texels);
    }
}

static uint32_t find(ajar_runtime light, const char* name) {
    uint32_t element = 0;
    check(ajar_runtime_find_element(light, name, &element), name);
    return element;
}

/* One NAME=..., NAME:... or NAME@... */
static void apply(ajar_runtime light, const char* argument) {
    char name[256];
    float a, b, c;
    const float radians = 3.14159265f / 180.0f;
    if (sscanf(argument, "%255[^=]=%f", name, &a) == 2) {
        check(ajar_runtime_set_weight(light, find(light, name), a), name);
    } else if (sscanf(argument, "%255[^:]:%f,%f,%f", name, &a, &b, &c) == 4) {
        const float color[3] = {a, b, c};
        check(ajar_runtime_set_color(light, find(light, name), color), name);
    } else if (sscanf(argument, "%255[^@]@%f/%f", name, &a, &b) == 3) {
        const float openness = ajar_runtime_door_openness(a * radians, b * radians);
        check(ajar_runtime_set_weight(light, find(light, name), openness), name);
    } else {
        fprintf(stderr, "relight: cannot read \"%s\"\n", argument);
        exit(2);
    }
}

/* A game uploads the words of ajar_runtime_page_texels instead, inside ajar_runtime_page_dirty. */
static void write_picture(ajar_runtime light, uint32_t page, const char* path, float exposure) {
    uint32_t width = 0, height = 0;
    check(ajar_runtime_page_size(light, page, &width, &height), "page");
    const size_t count = (size_t)width * height * 3;
    float* pixels = malloc(count * sizeof *pixels);
    FILE* file = fopen(path, "wb");
    if (pixels == NULL || file == NULL) {
        fprintf(stderr, "relight: cannot write %s\n", path);
        exit(1);
    }
    check(ajar_runtime_read_irradiance(light, page, 3, pixels, count), "page");
    fprintf(file, "P6\n%u %u\n255\n", width, height);
    for (uint32_t y = height; y-- > 0;) /* the library's rows go up, a picture's down */
        for (size_t i = (size_t)y * width * 3; i < (size_t)(y + 1) * width * 3; ++i)
            fputc((int)(255.0f * powf(fminf(pixels[i] * exposure, 1.0f), 1.0f / 2.2f) + 0.5f), file);
    fclose(file);
    free(pixels);
}

int main(int argc, char** argv) {
    ajar_runtime light = NULL;
    ajar_runtime_stats stats;
    if (argc < 2) {
        fprintf(stderr, "usage: relight PACKAGE [NAME=WEIGHT ...] [-o PAGE FILE.ppm EXPOSURE]\n");
        return 2;
    }
    if (ajar_runtime_abi_version() != AJAR_RUNTIME_ABI_VERSION) {
        fprintf(stderr, "relight: the library is of another version\n");
        return 1;
    }
    check(ajar_runtime_open(argv[1], &light), argv[1]);
    int next = 2;
    while (next < argc && strcmp(argv[next], "-o") != 0) apply(light, argv[next++]);
    ajar_runtime_stats_init(&stats);
    check(ajar_runtime_update(light, &stats), "update");
    list_elements(light);
    printf("updated %llu texels on %u pages\n", (unsigned long long)stats.texels, stats.pages);
    if (next + 3 < argc)
        write_picture(light, (uint32_t)atoi(argv[next + 1]), argv[next + 2], (float)atof(argv[next + 3]));
    check(ajar_runtime_release(&light), "release");
    return 0;
}
