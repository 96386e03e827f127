/* make_terrain.c - the bundled terrains: hills of 800 m x 600 m as an open TIN, and the same after a quarry
 * was dug and its spoil heaped up beside it.
 *
 *   make_terrain before|after OUT.ply
 *
 * Only + - * / and sqrt are used, so every machine writes the same bytes (compile with -ffp-contract=off).
 * Hills are round humps and noise of four octaves; the quarry goes down in benches of 22 m, the heap is a
 * cone cut flat. */
#include <stdint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 65, ROWS = 49, OCTAVES = 4 };

static const double STEP = 12.5; /* [Units: m] */

/* A number in [0, 1) for a place of the noise's grid. */
static double random_at(int32_t i, int32_t j, uint32_t layer)
{
    uint32_t h = (uint32_t)i * 0x9e3779b1u ^ (uint32_t)j * 0x85ebca77u ^ layer * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (double)((h ^ h >> 15) >> 8) / 16777216.0;
}

static double ease(double t)
{
    return t * t * (3.0 - 2.0 * t);
}

static double noise(double x, double y, uint32_t layer)
{
    int32_t const i = (int32_t)floor(x), j = (int32_t)floor(y);
    double const u = ease(x - i), v = ease(y - j);
    double const low = random_at(i, j, layer) * (1.0 - u) + random_at(i + 1, j, layer) * u;
    double const high = random_at(i, j + 1, layer) * (1.0 - u) + random_at(i + 1, j + 1, layer) * u;
    return low * (1.0 - v) + high * v;
}

static double hump(double x, double y, double at_x, double at_y, double wide, double high)
{
    double const dx = (x - at_x) / wide, dy = (y - at_y) / wide, d = 1.0 + dx * dx + dy * dy;
    return high / (d * d);
}

static double hills(double x, double y)
{
    double z = 40.0 + hump(x, y, 240.0, 380.0, 210.0, 150.0) + hump(x, y, 640.0, 150.0, 160.0, 70.0);
    double size = 190.0;
    double high = 34.0;
    for (uint32_t o = 0; o < OCTAVES; o++, size *= 0.47, high *= 0.45)
        z += high * (noise(x / size, y / size, o) - 0.5);
    return z;
}

/* Benches: deeper by 22 m for every 42 m inwards, over a wall half as wide. */
static double quarry(double x, double y)
{
    double const dx = (x - 350.0) / 1.2, dy = y - 255.0, inwards = (150.0 - sqrt(dx * dx + dy * dy)) / 42.0;
    double const bench = floor(inwards), wall = (inwards - bench) * 2.0;
    if (inwards <= 0.0) return 1e9;
    return 135.0 - 22.0 * (bench + (wall < 1.0 ? wall : 1.0));
}

static double heap(double x, double y)
{
    double const dx = (x - 600.0) / 1.3, dy = y - 400.0, side = 106.0 - 0.55 * sqrt(dx * dx + dy * dy);
    return side < 84.0 ? side : 84.0;
}

static double height(double x, double y, int after)
{
    double const z = hills(x, y), dug = quarry(x, y), heaped = heap(x, y);
    if (!after) return z;
    if (dug < z) return dug;
    return heaped > z ? heaped : z;
}

static unsigned char file[200000];
static size_t size;

static void put(const void *bytes, size_t n)
{
    if (size + n > sizeof file) {
        fprintf(stderr, "make_terrain: the mesh is larger than it should be\n");
        exit(1);
    }
    memcpy(file + size, bytes, n);
    size += n;
}

static void put_u32(uint32_t v)
{
    unsigned char const b[4] = {(unsigned char)(v & 255), (unsigned char)(v >> 8 & 255),
                                (unsigned char)(v >> 16 & 255), (unsigned char)(v >> 24)};
    put(b, 4);
}

static void put_float(double v)
{
    float const f = (float)v;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    put_u32(bits);
}

/* Vertices stand off their grid inside it, so that triangles are of many shapes. */
static void put_vertices(int after)
{
    for (int32_t j = 0; j < ROWS; j++)
        for (int32_t i = 0; i < COLUMNS; i++) {
            int const rim = i == 0 || j == 0 || i == COLUMNS - 1 || j == ROWS - 1;
            double const x = STEP * (i + (rim ? 0.0 : 0.6 * (random_at(i, j, 91) - 0.5)));
            double const y = STEP * (j + (rim ? 0.0 : 0.6 * (random_at(i, j, 92) - 0.5)));
            put_float(x);
            put_float(y);
            put_float(height(x, y, after));
        }
}

static void put_triangle(int32_t a, int32_t b, int32_t c)
{
    static const unsigned char three = 3;
    put(&three, 1);
    put_u32((uint32_t)a);
    put_u32((uint32_t)b);
    put_u32((uint32_t)c);
}

static void put_triangles(void)
{
    for (int32_t j = 0; j + 1 < ROWS; j++)
        for (int32_t i = 0; i + 1 < COLUMNS; i++) {
            int32_t const a = j * COLUMNS + i, b = a + 1, c = b + COLUMNS, d = a + COLUMNS;
            if (((i ^ j) & 1) == 0) {
                put_triangle(a, b, c);
                put_triangle(a, c, d);
            } else {
                put_triangle(a, b, d);
                put_triangle(b, c, d);
            }
        }
}

int main(int count, char **word)
{
    int const after = count == 3 && strcmp(word[1], "after") == 0;
    char head[512];
    FILE *out;

    if (count != 3 || (!after && strcmp(word[1], "before") != 0)) {
        fprintf(stderr, "usage: make_terrain before|after OUT.ply\n");
        return 2;
    }
    snprintf(
        head, sizeof head,
        "ply\nformat binary_little_endian 1.0\ncomment terrain %s digging, in metres, by tests/tools/make_terrain.c\n"
        "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
        "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
        word[1], COLUMNS * ROWS, 2 * (COLUMNS - 1) * (ROWS - 1));
    put(head, strlen(head));
    put_vertices(after);
    put_triangles();
    out = fopen(word[2], "wb");
    if (out == NULL || fwrite(file, 1, size, out) != size || fclose(out) != 0) {
        perror(word[2]);
        return 1;
    }
    return 0;
}
