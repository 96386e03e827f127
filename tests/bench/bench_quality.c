/* bench_quality.c - how near the levels of detail come to the original: ours in many settings, and any mesh
 * by file.
 *
 *   bench_quality ours ORIGINAL FOLDER     makes levels of 27,000 and 4,000 triangles at most, writes the
 *   default ones
 *   bench_quality judge ORIGINAL LEVEL...  judges meshes in files
 *
 * One judge for all: bvx_mesh_distance with 200,000 samples a way and the certificate of bvx_mesh_check.
 * Distances are in percent of the diagonal of the original's bounds; two-way is the mean of both ways' means.
 * Results are lines of JSON on standard output, a table goes to standard error. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 200000, SEED = 1, TARGETS = 2 };
static const uint64_t targets[TARGETS] = {27000, 4000};

typedef struct original {
    bvx_mesh mesh;
    bvx_mesh_view view;
    double diagonal, volume;
} original;

static double diagonal_of(const bvx_certificate *c)
{
    double sum = 0.0;
    for (int a = 0; a < 3; a++) sum += (c->box.high[a] - c->box.low[a]) * (c->box.high[a] - c->box.low[a]);
    return sqrt(sum);
}

static void load(bvx_context *ctx, const char *path, original *o)
{
    bvx_certificate c;

    if (!bench_read_mesh(ctx, path, &o->mesh)) {
        fprintf(stderr, "bench_quality: %s cannot be read\n", path);
        exit(1);
    }
    bvx_mesh_view_of(&o->mesh, &o->view);
    bench_try(ctx, bvx_mesh_check(ctx, &o->view, 0, &c), path);
    o->diagonal = diagonal_of(&c);
    o->volume = c.volume;
}

/* One line of results; settings is empty or JSON members that end in a comma. */
static void judge(bvx_context *ctx, const original *o, const bvx_mesh *level, const char *name,
                  const char *settings)
{
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_distance_report d;

    bvx_mesh_view_of(level, &view);
    bench_try(ctx, bvx_mesh_check(ctx, &view, 1, &c), name); /* welded: as good as each mesh can be seen */
    bench_try(ctx, bvx_mesh_distance(ctx, &view, &o->view, SAMPLES, SEED, &d), name);
    double const percent = 100.0 / o->diagonal;
    printf(
        "{\"name\": \"%s\", %s\"triangles\": %llu, \"two_way\": %.6g, \"to_original\": %.6g, \"from_original\": %.6g, "
        "\"max\": %.6g, \"normal_to\": %.6g, \"normal_from\": %.6g, \"boundary_edges\": %llu, \"nonmanifold_edges\": %llu, "
        "\"nonmanifold_vertices\": %llu, \"flipped_edges\": %llu, \"components\": %llu, \"volume\": %.6g}\n",
        name, settings, (unsigned long long)level->triangle_count, d.mean * percent, d.mean_a_to_b * percent,
        d.mean_b_to_a * percent, d.max * percent, d.normal_a_to_b, d.normal_b_to_a,
        (unsigned long long)c.boundary_edges, (unsigned long long)c.nonmanifold_edges,
        (unsigned long long)c.nonmanifold_vertices, (unsigned long long)c.flipped_edges,
        (unsigned long long)c.components, 100.0 * c.volume / o->volume);
    fflush(stdout);
    fprintf(stderr,
            "%-44s %7llu  two-way %.4f  to %.4f  from %.4f  max %.3f  normals %.4f %.4f  volume %.2f  %s\n",
            name, (unsigned long long)level->triangle_count, d.mean * percent, d.mean_a_to_b * percent,
            d.mean_b_to_a * percent, d.max * percent, d.normal_a_to_b, d.normal_b_to_a,
            100.0 * c.volume / o->volume,
            c.closed && c.edge_manifold && c.vertex_manifold ? "closed manifold"
                                                             : "not closed or not manifold");
}

/* ---- ours ---- */

typedef struct setting {
    int32_t grid, method, edge_samples;
    double threshold, collapse;
    const char *shown; /* written to the folder under this name, for pictures and a second judge */
} setting;

enum { EDGE = BVX_LOD_EDGE_RATIO, COVER = BVX_LOD_COVERAGE };

static const setting settings[] = {
    {512, EDGE, 0, 0.5, 0.0, "edge-ratio"}, {512, COVER, 0, 0.5, 0.0, "coverage"},
    {512, EDGE, 0, 0.5, 4.0, "collapse-4"}, /* the three ways, as a user gets them */
    {256, EDGE, 0, 0.5, 0.0, NULL},         {1024, EDGE, 0, 0.5, 0.0, NULL},
    {256, COVER, 0, 0.5, 0.0, NULL},        {1024, COVER, 0, 0.5, 0.0, NULL},
    {512, EDGE, 0, 0.3, 0.0, NULL},         {512, EDGE, 0, 0.7, 0.0, NULL},
    {512, COVER, 0, 0.45, 0.0, NULL},       {512, COVER, 0, 0.4, 0.0, NULL},
    {512, EDGE, 4, 0.5, 0.0, NULL},         {512, EDGE, 16, 0.5, 0.0, NULL},
    {512, EDGE, 64, 0.5, 0.0, NULL},        {256, EDGE, 0, 0.5, 4.0, NULL},
    {1024, EDGE, 0, 0.5, 4.0, NULL},        {512, EDGE, 0, 0.5, 2.0, NULL},
    {512, EDGE, 0, 0.5, 8.0, NULL},         {512, COVER, 0, 0.5, 4.0, NULL},
};

static void one_level(bvx_context *ctx, const original *o, const setting *s, const bvx_grid *solid,
                      uint64_t target, const char *folder)
{
    bvx_mesh level = {0};
    bvx_lod_report report;
    bvx_lod_options options = {.struct_size = sizeof options};
    char name[160], members[320], path[1024];
    const char *const method = s->method == COVER ? "coverage" : "edge-ratio";
    int n = snprintf(name, sizeof name, "ours %s, grid %d", method, s->grid);

    if (s->threshold != 0.5) n += snprintf(name + n, sizeof name - (size_t)n, ", threshold %g", s->threshold);
    if (s->edge_samples != 0) n += snprintf(name + n, sizeof name - (size_t)n, ", steps %d", s->edge_samples);
    if (s->collapse != 0.0) n += snprintf(name + n, sizeof name - (size_t)n, ", collapse %g", s->collapse);
    options.sampling.method = s->method;
    options.sampling.edge_samples = s->edge_samples;
    options.sampling.threshold = s->threshold;
    options.collapse = s->collapse;
    options.target_triangles = &target;
    options.reports = &report;
    double const start = bench_clock(1);
    bench_try(ctx, bvx_build_lods(ctx, solid, &options, 1, &level), name);
    double const ms = bench_clock(1) - start;
    snprintf(
        members, sizeof members,
        "\"method\": \"%s\", \"grid\": %d, \"threshold\": %g, \"edge_samples\": %d, \"collapse\": %g, \"target\": %llu, "
        "\"resolution\": %d, \"ratio\": %.4g, \"ms\": %.3f, \"shown\": \"%s\", ",
        method, s->grid, s->threshold, s->edge_samples, s->collapse, (unsigned long long)target,
        report.resolution[0], report.ratio[0], ms, s->shown ? s->shown : "");
    judge(ctx, o, &level, name, members);
    if (s->shown) {
        snprintf(path, sizeof path, "%s/%s_%llu.ply", folder, s->shown, (unsigned long long)target);
        bench_write_mesh(ctx, path, &level);
    }
    bvx_mesh_free(ctx, &level);
}

static void ours(bvx_context *ctx, const original *o, const char *folder)
{
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        bvx_lattice lattice;
        bvx_grid solid = {0};
        bench_try(ctx, bvx_lattice_fit(ctx, &o->view, settings[i].grid, &lattice), "lattice");
        bench_try(ctx, bvx_voxelize_solid(ctx, &o->view, &lattice, NULL, &solid), "solid");
        for (int t = 0; t < TARGETS; t++) one_level(ctx, o, &settings[i], &solid, targets[t], folder);
        bvx_grid_free(ctx, &solid);
    }
}

int main(int argc, char **argv)
{
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);
    original o = {0};

    if (argc < 4 || (strcmp(argv[1], "ours") != 0 && strcmp(argv[1], "judge") != 0)) {
        fprintf(stderr,
                "usage: bench_quality ours ORIGINAL FOLDER\n       bench_quality judge ORIGINAL LEVEL...\n");
        return 2;
    }
    load(ctx, argv[2], &o);
    if (strcmp(argv[1], "ours") == 0) {
        ours(ctx, &o, argv[3]);
    } else {
        for (int i = 3; i < argc; i++) {
            bvx_mesh level;
            const char *const slash = strrchr(argv[i], '/');
            if (!bench_read_mesh(ctx, argv[i], &level)) {
                fprintf(stderr, "bench_quality: %s cannot be read\n", argv[i]);
                return 1;
            }
            judge(ctx, &o, &level, slash ? slash + 1 : argv[i], "");
            bvx_mesh_free(ctx, &level);
        }
    }
    bvx_mesh_free(ctx, &o.mesh);
    bvx_context_destroy(ctx);
    return 0;
}
