/* bench_step.c - the experiment of "Model repair by a vector distance field": cuts by distances against cuts
 * by vectors.
 *
 *   bench_step FOLDER [PICTURES]   the step, then meshes of FOLDER (.gz by gzip); surfaces of the step go to
 *   PICTURES/step_*.ply
 *
 * The paper shows a step function with the feature points A, C, D, F (the corners of its profile) and the
 * samples B, E between them (on its flanks), without coordinates. So the step stands here at 16 x 16 places
 * on the lattice, along it and turned. The error is the paper's, in voxels: sqrt(1/3 sum over vertices of
 * dist(v, R)^2 times the area of the triangles at v / area), over the step's part of the surface. A feature
 * point survives where the surface comes within a tenth of a voxel of it, along all of its line.
 * Prints Markdown. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PHASES = 16, POINTS = 6, MODES = 4, ALONG = 9 };
static const char *const mode_names[MODES] = {"scalar", "vector", "vector, paper's clamps", "tangent"};
static const int32_t modes[MODES] = {BVX_EDGE_SCALAR, BVX_EDGE_VECTOR, BVX_EDGE_PAPER, BVX_EDGE_TANGENT};
static const char point_names[POINTS + 1] = "ABCDEF";
static const double near_enough = 0.1; /* [Units: voxels] */

/* ---- the step ---- */

/* Profile (x, z) of a slab with a ridge; unit voxels. */
enum { CORNERS = 8 };
static const double slab = 22.0, deep = 6.0, left = 8.0, width = 5.1, height = 4.9, length = 12.0;

typedef struct step {
    double p[2 * CORNERS][3];
    uint32_t t[32][3];
    uint32_t triangles;
    double point[POINTS][2][3]; /* both ends, inside the slab's, of the lines along y through A .. F */
} step;

static void turn_about_y(double p[3], double sine, double cosine)
{
    double const x = p[0] - slab / 2, z = p[2];
    p[0] = slab / 2 + cosine * x - sine * z;
    p[2] = sine * x + cosine * z;
}

static void add_triangle(step *s, uint32_t a, uint32_t b, uint32_t c)
{
    s->t[s->triangles][0] = a;
    s->t[s->triangles][1] = b;
    s->t[s->triangles++][2] = c;
}

/* The ridge's corner A stands at (left + dx, dz); then all is turned by an angle of that sine. */
static void make_step(step *s, double dx, double dz, double sine)
{
    double const x1 = left + dx, x2 = x1 + width, cosine = sqrt(1.0 - sine * sine);
    double const profile[CORNERS][2] = {{0, dz - deep},    {slab, dz - deep}, {slab, dz}, {x2, dz},
                                        {x2, dz + height}, {x1, dz + height}, {x1, dz},   {0, dz}};
    double const points[POINTS][2] = {{x1, dz},          {x1, dz + height / 2}, {x1, dz + height},
                                      {x2, dz + height}, {x2, dz + height / 2}, {x2, dz}};
    static const uint32_t cap[6][3] = {{0, 1, 6}, {0, 6, 7}, {1, 3, 6}, {1, 2, 3}, {3, 4, 5}, {3, 5, 6}};

    memset(s, 0, sizeof *s);
    for (uint32_t i = 0; i < CORNERS; i++)
        for (uint32_t end = 0; end < 2; end++) {
            double *const p = s->p[i + CORNERS * end];
            p[0] = profile[i][0];
            p[1] = end ? length : 0.0;
            p[2] = profile[i][1];
            turn_about_y(p, sine, cosine);
        }
    for (uint32_t i = 0; i < POINTS; i++)
        for (uint32_t end = 0; end < 2; end++) {
            double *const p = s->point[i][end];
            p[0] = points[i][0];
            p[1] = end ? length - 3 : 3;
            p[2] = points[i][1];
            turn_about_y(p, sine, cosine);
        }
    for (uint32_t i = 0; i < CORNERS; i++) {
        uint32_t const k = (i + 1) % CORNERS;
        add_triangle(s, i, k, k + CORNERS);
        add_triangle(s, i, k + CORNERS, i + CORNERS);
    }
    for (uint32_t i = 0; i < 6; i++) {
        add_triangle(s, cap[i][0], cap[i][2], cap[i][1]);
        add_triangle(s, cap[i][0] + CORNERS, cap[i][1] + CORNERS, cap[i][2] + CORNERS);
    }
    for (uint32_t i = 0; i < s->triangles; i++) { /* outwards */
        uint32_t const a = s->t[i][1];
        s->t[i][1] = s->t[i][2];
        s->t[i][2] = a;
    }
}

static bvx_mesh_view step_view(const step *s)
{
    bvx_mesh_view v;

    memset(&v, 0, sizeof v);
    v.positions = s->p;
    v.indices = s->t;
    v.vertex_count = 2 * CORNERS;
    v.triangle_count = s->triangles;
    v.position_type = BVX_F64;
    v.index_type = BVX_U32;
    return v;
}

/* ---- the paper's error ---- */

typedef int32_t counts_fn(const void *user, const double p[3]);

static double triangle_area(const double *a, const double *b, const double *c)
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double const x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return 0.5 * sqrt(x * x + y * y + z * z);
}

/* Over the triangles all of whose vertices count (counts NULL: all); positions are doubles. */
static double paper_error(bvx_context *ctx, const bvx_closest *reference, const bvx_mesh *m,
                          counts_fn *counts, const void *user)
{
    const double *const p = m->positions;
    bvx_closest_point *const found = malloc((size_t)m->vertex_count * sizeof *found + 1);
    double sum = 0.0, area = 0.0;

    bench_try(ctx, bvx_closest_find(ctx, reference, p, m->vertex_count, found), "distances to the original");
    for (uint64_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *const t = m->triangles + 3 * i;
        const double *const a = p + 3 * (size_t)t[0];
        const double *const b = p + 3 * (size_t)t[1];
        const double *const c = p + 3 * (size_t)t[2];
        double one;
        if (counts != NULL && !(counts(user, a) && counts(user, b) && counts(user, c))) continue;
        one = triangle_area(a, b, c);
        area += one;
        for (int k = 0; k < 3; k++) sum += one * found[t[k]].distance * found[t[k]].distance;
    }
    free(found);
    return sqrt(sum / 3.0 / area);
}

/* ---- the step's experiment ---- */

typedef struct step_result {
    double error[MODES];
    int kept[MODES][POINTS];
} step_result;

/* Three voxels off the slab's ends, in the step's own frame: rotated back. */
typedef struct step_part {
    double sine, cosine, base;
} step_part;

static int32_t is_on_step(const void *user, const double p[3])
{
    const step_part *const s = user;
    double const x = p[0] - slab / 2, z = p[2];
    double const at = slab / 2 + s->cosine * x + s->sine * z, up = -s->sine * x + s->cosine * z;
    return at > 3 && at < slab - 3 && p[1] > 3 && p[1] < length - 3 && up > s->base - deep / 2;
}

/* Do all places along the line of a point lie near the surface? */
static int survives(bvx_context *ctx, const bvx_closest *surface, double const line[2][3])
{
    double p[ALONG][3];
    bvx_closest_point found[ALONG];

    for (int i = 0; i < ALONG; i++)
        for (int a = 0; a < 3; a++) p[i][a] = line[0][a] + (line[1][a] - line[0][a]) * i / (ALONG - 1);
    bench_try(ctx, bvx_closest_find(ctx, surface, p[0], ALONG, found), "a feature point");
    for (int i = 0; i < ALONG; i++)
        if (!(found[i].distance <= near_enough)) return 0;
    return 1;
}

static void measure_field(bvx_context *ctx, const bvx_mesh_view *v, const bvx_lattice *l, bvx_field *field)
{
    bvx_field_options o = {.struct_size = sizeof o};
    o.sign = BVX_FILL_PARITY;
    o.features = 1;
    bench_try(ctx, bvx_measure_field(ctx, v, l, &o, field), "the field");
}

static void run_step(bvx_context *ctx, double dx, double dz, double sine, const char *pictures,
                     step_result *r)
{
    double const origin[3] = {-6, -4, -16}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {36, 20, 36};
    step_part const part = {sine, sqrt(1.0 - sine * sine), dz};
    bvx_lattice l;
    bvx_field field;
    bvx_closest *reference = NULL;
    step s;
    bvx_mesh_view v;

    make_step(&s, dx, dz, sine);
    v = step_view(&s);
    memset(&field, 0, sizeof field);
    bench_try(ctx, bvx_lattice_make(ctx, origin, spacing, dims, &l), "the lattice");
    bench_try(ctx, bvx_closest_create(ctx, &v, &reference), "the step");
    measure_field(ctx, &v, &l, &field);
    for (int i = 0; i < MODES; i++) {
        bvx_field_surface_options o = {.struct_size = sizeof o};
        bvx_mesh m;
        bvx_mesh_view w;
        bvx_closest *surface = NULL;
        memset(&m, 0, sizeof m);
        o.placing.interpolation = modes[i];
        o.placing.position_type = BVX_F64;
        bench_try(ctx, bvx_extract_field_surface(ctx, &field, &v, &o, &m), mode_names[i]);
        bvx_mesh_view_of(&m, &w);
        bench_try(ctx, bvx_closest_create(ctx, &w, &surface), mode_names[i]);
        r->error[i] = paper_error(ctx, reference, &m, is_on_step, &part);
        for (int k = 0; k < POINTS; k++)
            r->kept[i][k] = survives(ctx, surface, (const double(*)[3])s.point[k]);
        if (pictures != NULL) {
            char path[1024];
            snprintf(path, sizeof path, "%s/step_%d.ply", pictures, i);
            bench_write_mesh(ctx, path, &m);
        }
        bvx_closest_free(ctx, surface);
        bvx_mesh_free(ctx, &m);
    }
    bvx_closest_free(ctx, reference);
    bvx_field_free(ctx, &field);
}

static void print_kept(const int kept[POINTS])
{
    int none = 1;
    for (int k = 0; k < POINTS; k++)
        if (kept[k]) {
            printf("%c", point_names[k]);
            none = 0;
        }
    if (none) printf("none");
}

/* All places of the step: mean errors, at how many the gain is what the
 * paper tells, and at how many each point survives. */
static void run_places(bvx_context *ctx, const char *name, double sine)
{
    double error[MODES] = {0};
    int better[MODES] = {0}, gained[MODES] = {0};
    int kept[MODES][POINTS] = {{0}};

    for (int n = 0; n < PHASES * PHASES; n++) {
        step_result r;
        run_step(ctx, (n % PHASES + 0.5) / PHASES, (n / PHASES + 0.5) / PHASES, sine, NULL, &r);
        for (int i = 0; i < MODES; i++) {
            error[i] += r.error[i] / (PHASES * PHASES);
            better[i] += r.error[i] < r.error[0];
            gained[i] += r.error[i] <= (1.0 - 0.168) * r.error[0];
            for (int k = 0; k < POINTS; k++) kept[i][k] += r.kept[i][k];
        }
    }
    for (int i = 0; i < MODES; i++) {
        printf("| %s | %s | %.4f | %.1f %% | %d | %d |", name, mode_names[i], error[i],
               100 * (1 - error[i] / error[0]), better[i], gained[i]);
        for (int k = 0; k < POINTS; k++) printf(" %d |", kept[i][k]);
        printf("\n");
    }
}

/* ---- other shapes ---- */

static void run_mesh(bvx_context *ctx, const char *folder, const char *file, int32_t resolution)
{
    char path[1024];
    bvx_mesh in;
    bvx_mesh_view v;
    bvx_lattice l;
    bvx_lattice_options o = {.struct_size = sizeof o};
    bvx_field field;
    bvx_closest *reference = NULL;
    double error[MODES + 1];
    bvx_field_surface_report report[MODES + 1];

    memset(&in, 0, sizeof in);
    memset(&field, 0, sizeof field);
    snprintf(path, sizeof path, "%s/%s", folder, file);
    if (!bench_read_mesh(ctx, path, &in)) {
        printf("| %s is missing | | | | | | | | | |\n", file);
        return;
    }
    bvx_mesh_view_of(&in, &v);
    o.resolution = resolution;
    o.padding = 2;
    bench_try(ctx, bvx_lattice_fit_with(ctx, &v, &o, &l), file);
    bench_try(ctx, bvx_closest_create(ctx, &v, &reference), file);
    measure_field(ctx, &v, &l, &field);
    for (int i = 0; i <= MODES; i++) { /* the last: sharp */
        bvx_field_surface_options so = {.struct_size = sizeof so};
        bvx_mesh m;
        memset(&m, 0, sizeof m);
        so.placing.interpolation = i < MODES ? modes[i] : BVX_EDGE_VECTOR;
        so.placing.position_type = BVX_F64;
        so.placing.sharp = BVX_SHARP_NEVER + (i == MODES);
        so.report = &report[i];
        bench_try(ctx, bvx_extract_field_surface(ctx, &field, &v, &so, &m), file);
        error[i] = paper_error(ctx, reference, &m, NULL, NULL) / l.spacing[0];
        bvx_mesh_free(ctx, &m);
    }
    printf("| %s | %d | %.5f | %.5f | %.1f %% | %.5f | %.5f | %.1f %% | %.5f | %llu of %llu |\n", file,
           (int)resolution, error[0], error[1], 100 * (1 - error[1] / error[0]), error[2], error[3],
           100 * (1 - error[3] / error[0]), error[4], (unsigned long long)report[1].scalar,
           (unsigned long long)report[1].edges);
    bvx_closest_free(ctx, reference);
    bvx_field_free(ctx, &field);
    bvx_mesh_free(ctx, &in);
}

int main(int argc, char **argv)
{
    static const char *const files[] = {"fandisk.obj.gz", "rocker-arm.obj.gz", "unit_sphere.stl.gz",
                                        "blobby-shuffled.off.gz", "dragon_100k.obj.gz"};
    bvx_context *const ctx = bench_context(0, BVX_CPU_BEST, NULL);
    step_result r;

    if (argc < 2) {
        fprintf(stderr, "usage: bench_step FOLDER [PICTURES]\n");
        return 2;
    }
    printf(
        "The step at one place (voxels; the paper: scalar 0.433, vector 0.360, 16.8 %% less; A kept of A, C, D, F, then A, D, F):\n\n");
    run_step(ctx, 0.43, 0.43, 0.0, argc > 2 ? argv[2] : NULL, &r);
    printf("| cuts | error | less | kept |\n|---|---|---|---|\n");
    for (int i = 0; i < MODES; i++) {
        printf("| %s | %.4f | %.1f %% | ", mode_names[i], r.error[i], 100 * (1 - r.error[i] / r.error[0]));
        print_kept(r.kept[i]);
        printf(" |\n");
    }
    printf(
        "\nThe step at %d places on the lattice: mean error, how much less than by distances; places with a smaller error and with one\n"
        "smaller by 16.8 %% or more; places at which each point survives.\n\n",
        PHASES * PHASES);
    printf(
        "| step | cuts | error | less | smaller | by 16.8 %% | A | B | C | D | E | F |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    run_places(ctx, "along the lattice", 0.0);
    run_places(ctx, "turned by 10 degrees", 0.17364817766693033);
    run_places(ctx, "turned by 30 degrees", 0.5);
    printf(
        "\nOther shapes (the same error, in voxels; scalar fallbacks of vector):\n\n"
        "| shape | resolution | scalar | vector | less | paper's clamps | tangent | less | vector, sharp | by distances |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        for (int32_t resolution = 32; resolution <= 128; resolution *= 2)
            run_mesh(ctx, argv[1], files[i], resolution);
    bvx_context_destroy(ctx);
    return 0;
}
