/* make_volume.c - the bundled volumes: waves, samples of 8 bits behind a detached NRRD head, and a label map
 * of 3 round bodies.
 *
 *   make_volume waves|labels OUT
 *
 * Only + - * / are used, so every machine writes the same bytes (compile with -ffp-contract=off). The waves
 * are products of parabolas along the axes and fall off towards the sides. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { X = 48, Y = 40, Z = 32 };

/* A smooth wave of period 1 from -1 to 1. */
static double wave(double t)
{
    double const u = t - (double)(int)t;
    return u < 0.5 ? 16.0 * u * (0.5 - u) : -16.0 * (u - 0.5) * (1.0 - u);
}

static uint8_t wave_at(int x, int y, int z)
{
    double const u = (x + 0.5) / X, v = (y + 0.5) / Y, w = (z + 0.5) / Z;
    double const near = 64.0 * u * (1.0 - u) * v * (1.0 - v) * w * (1.0 - w);
    double const value = 140.0 * near +
                         40.0 * (wave(2.0 * u + 0.1) * wave(2.0 * v) + wave(2.0 * v + 0.3) * wave(2.0 * w));
    return (uint8_t)(value < 0.0 ? 0.0 : value > 255.0 ? 255.0 : value);
}

static uint8_t label_at(int x, int y, int z)
{
    static const int ball[3][4] = {{14, 14, 12, 9}, {30, 20, 18, 11}, {12, 30, 20, 7}};
    static const uint8_t label[3] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        int const dx = x - ball[i][0], dy = y - ball[i][1], dz = z - ball[i][2];
        if (dx * dx + dy * dy + dz * dz <= ball[i][3] * ball[i][3]) return label[i];
    }
    return 0;
}

int main(int count, char **word)
{
    static uint8_t samples[X * Y * Z];
    int const labels = count == 3 && strcmp(word[1], "labels") == 0;
    FILE *file;
    int good;

    if (count != 3 || (!labels && strcmp(word[1], "waves") != 0)) {
        fprintf(stderr, "usage: make_volume waves|labels OUT\n");
        return 2;
    }
    for (int z = 0; z < Z; z++)
        for (int y = 0; y < Y; y++)
            for (int x = 0; x < X; x++)
                samples[(z * Y + y) * X + x] = labels ? label_at(x, y, z) : wave_at(x, y, z);
    file = fopen(word[2], "wb");
    if (file == NULL) return 1;
    if (labels) {
        char head[128];
        int const n = snprintf(head, sizeof head,
                               "{'descr': '|u1', 'fortran_order': True, 'shape': (%d, %d, %d), }", X, Y, Z);
        memset(head + n, ' ', (size_t)(117 - n));
        head[117] = '\n';
        fwrite("\x93NUMPY\x01\x00\x76\x00", 1, 10, file);
        fwrite(head, 1, 118, file);
    }
    good = fwrite(samples, 1, sizeof samples, file) == sizeof samples;
    return fclose(file) == 0 && good ? 0 : 1;
}
