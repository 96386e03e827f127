/* make_fixture.c - the bundled mesh fixtures/knot.ply: a rope of four strands, tied to a trefoil knot.
 *
 *   make_fixture OUT.ply
 *
 * Only + - * / and sqrt are used, so every machine writes the same bytes (compile with -ffp-contract=off).
 * Circles come from halving a right angle and turning on; multiples of an angle from products of complex
 * numbers. The knot runs twice around the axis and three times around a torus. The rope is a grid of rings
 * and spokes closed in both directions, so every edge has two triangles; each quad is split along its shorter
 * diagonal. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    RINGS = 480, /* along the knot */
    SPOKES = 40, /* around the tube */
    STRANDS = 4, /* of the rope */
    TWIST = 10,  /* turns of the strands along the knot */
    CIRCLE = 480 /* least common multiple of RINGS and SPOKES: angles are counted in its parts */
};

static const double MAJOR = 2.5, MINOR = 1.0, TUBE = 0.56, GROOVE = 0.3;

typedef struct turn {
    double c, s; /* cosine and sine */
} turn;

static turn multiply(turn a, turn b)
{
    turn const r = {a.c * b.c - a.s * b.s, a.c * b.s + a.s * b.c};
    return r;
}

/* A direction of length 1. */
static turn unit(double c, double s)
{
    double const length = sqrt(c * c + s * s);
    turn const r = {c / length, s / length};
    return r;
}

/* One part in 480 = 2^5 * 15 of a circle: a fifteenth is two fifths less a third, halved five times. */
static turn smallest_turn(void)
{
    double const c5 = (sqrt(5.0) - 1.0) / 4.0; /* cosine of 72 degrees */
    turn const fifth = {c5, sqrt(1.0 - c5 * c5)}, third_back = {-0.5, -sqrt(0.75)};
    turn t = multiply(multiply(fifth, fifth), third_back);

    for (int i = 0; i < 5; i++) {
        double const c = sqrt((1.0 + t.c) / 2.0);
        turn const half = {c, t.s / (2.0 * c)};
        t = half;
    }
    return t;
}

static turn circle[CIRCLE];

static void fill_circle(void)
{
    turn const step = smallest_turn();
    circle[0].c = 1.0;
    circle[0].s = 0.0;
    for (int i = 1; i < CIRCLE; i++) {
        turn const next = multiply(circle[i - 1], step);
        circle[i] = unit(next.c, next.s);
    }
}

/* The turn of n parts; any n. */
static turn angle(long n)
{
    return circle[(n % CIRCLE + CIRCLE) % CIRCLE];
}

/* A vertex: ring i, spoke j. The tube's cross section stands square to the knot, between the torus' normal
 * and the direction square to that and to the knot. */
static void place(int i, int j, float out[3])
{
    long const t = (long)i * (CIRCLE / RINGS), u = (long)j * (CIRCLE / SPOKES);
    turn const a = angle(2 * t), b = angle(3 * t); /* around the axis, around the torus */
    turn const groove = angle(STRANDS * u), spoke = angle(u - TWIST * t); /* spokes wind with the strands */
    double const r = MAJOR + MINOR * b.c;
    double const centre[3] = {r * a.c, r * a.s, MINOR * b.s};
    double const normal[3] = {b.c * a.c, b.c * a.s, b.s};
    double const speed[3] = {-3.0 * MINOR * b.s * a.c - 2.0 * r * a.s,
                             -3.0 * MINOR * b.s * a.s + 2.0 * r * a.c, 3.0 * MINOR * b.c};
    double const across[3] = {speed[1] * normal[2] - speed[2] * normal[1],
                              speed[2] * normal[0] - speed[0] * normal[2],
                              speed[0] * normal[1] - speed[1] * normal[0]};
    double const length = sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
    double const carved = 0.5 + 0.5 * groove.c, deep = carved * carved; /* round strands, narrow grooves */
    double const radius = TUBE * (1.0 - GROOVE * deep);
    for (int k = 0; k < 3; k++)
        out[k] = (float)(centre[k] + radius * (spoke.c * normal[k] + spoke.s * across[k] / length));
}

static float vertex[RINGS * SPOKES][3];
static int32_t triangle[2 * RINGS * SPOKES][3];

static int32_t number(int i, int j)
{
    return (int32_t)(i % RINGS * SPOKES + j % SPOKES);
}

static double distance2(int32_t a, int32_t b)
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double const d = (double)vertex[a][k] - (double)vertex[b][k];
        sum += d * d;
    }
    return sum;
}

static void set(int32_t *t, int32_t a, int32_t b, int32_t c)
{
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static void build(void)
{
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < SPOKES; j++) place(i, j, vertex[number(i, j)]);
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < SPOKES; j++) {
            int32_t const a = number(i, j);
            int32_t const b = number(i, j + 1);
            int32_t const c = number(i + 1, j + 1);
            int32_t const d = number(i + 1, j);
            int32_t *const t = triangle[2 * (i * SPOKES + j)];
            if (distance2(a, c) <= distance2(b, d)) {
                set(t, a, b, c);
                set(t + 3, a, c, d);
            } else {
                set(t, a, b, d);
                set(t + 3, b, c, d);
            }
        }
}

/* ---- PLY, binary, little-endian on any machine ---- */

static unsigned char file[1000000];
static size_t size;

static void put(const void *bytes, size_t n)
{
    if (size + n > sizeof file) {
        fprintf(stderr, "make_fixture: the mesh is larger than it should be\n");
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

static void write_ply(void)
{
    static const unsigned char three = 3;
    char head[512];

    snprintf(head, sizeof head,
             "ply\nformat binary_little_endian 1.0\ncomment rope knot by tests/tools/make_fixture.c\n"
             "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
             "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
             RINGS * SPOKES, 2 * RINGS * SPOKES);
    put(head, strlen(head));
    for (int i = 0; i < RINGS * SPOKES; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t bits;
            memcpy(&bits, &vertex[i][k], sizeof bits);
            put_u32(bits);
        }
    for (int i = 0; i < 2 * RINGS * SPOKES; i++) {
        put(&three, 1);
        for (int k = 0; k < 3; k++) put_u32((uint32_t)triangle[i][k]);
    }
}

int main(int count, char **word)
{
    FILE *out;

    if (count != 2) {
        fprintf(stderr, "usage: make_fixture OUT.ply\n");
        return 2;
    }
    fill_circle();
    build();
    write_ply();
    out = fopen(word[1], "wb");
    if (out == NULL || fwrite(file, 1, size, out) != size || fclose(out) != 0) {
        perror(word[1]);
        return 1;
    }
    return 0;
}
