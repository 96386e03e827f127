/* make_cloud.c - the bundled cloud of points: 800 points of a ball with a dent, with their normals, as a
 * scanner would write them.
 *
 *   make_cloud OUT.xyz
 *
 * Points go round from pole to pole by the golden angle, turned as complex numbers: only + - * / and sqrt are
 * used, so every machine writes the same bytes (compile with -ffp-contract=off). */
#include <math.h>
#include <stdio.h>

enum { POINTS = 800 };

int main(int argc, char **argv)
{
    static const double cosine = -0.7373688780783197, sine = 0.6754902942615238; /* of the golden angle */
    double c = 1.0, s = 0.0;
    FILE *const file = argc == 2 ? fopen(argv[1], "w") : NULL;

    if (file == NULL) {
        fprintf(stderr, "usage: make_cloud OUT.xyz\n");
        return 2;
    }
    fprintf(file, "# x y z nx ny nz\n");
    for (int i = 0; i < POINTS; i++) {
        double const z = 1.0 - (2.0 * i + 1.0) / POINTS, r = sqrt(1.0 - z * z), x = r * c, y = r * s;
        double const dent = x > 0.5 ? (x - 0.5) * (x - 0.5) * 1.2 : 0.0, next = c * cosine - s * sine;
        fprintf(file, "%.5f %.5f %.5f %.3f %.3f %.3f\n", x * (1.0 - dent), y * (1.0 - dent), z * (1.0 - dent),
                x, y, z);
        s = c * sine + s * cosine;
        c = next;
    }
    return fclose(file) != 0;
}
