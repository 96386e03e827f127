/* bench_makers.c - hulls of double walls, levels that enclose, mass of what is spoilt, whether a mesh can be made.
 *
 *   bench_makers MESH_FOLDER   prints Markdown
 *
 * Double walls are made as generators make them: both surfaces one voxel from a mesh, by its unsigned distances; the
 * outer one, by signed distances, is the truth. Hulls take all threads and the time of day, since people wait for
 * them; the rest one thread and processor time. One run each, of levels that enclose the least of five. */
#include "bench_models.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    DOUBLE_RESOLUTION = 512,
    DOUBLE_MARGIN = 4,
    SAMPLES = 200000,
    SPOILT_PARTS = 5,
    ENCLOSURES = 5 /* runs */
};

static double diagonal(bvx_context *ctx, const bvx_mesh_view *mesh)
{
    bvx_certificate c;
    double sum = 0;

    bench_try(ctx, bvx_mesh_check(ctx, mesh, 1, &c), "check");
    for (int a = 0; a < 3; a++) sum += (c.box.high[a] - c.box.low[a]) * (c.box.high[a] - c.box.low[a]);
    return sqrt(sum);
}

/* All that is one voxel from the mesh; signed: outside only. */
static void make_walls(bvx_context *ctx, const bvx_mesh_view *mesh, int is_signed, bvx_mesh *walls)
{
    bvx_field_options o = {.struct_size = sizeof o, .sign = is_signed ? BVX_FILL_AUTO : BVX_FILL_NONE};
    bvx_scalar_options s = {.struct_size = sizeof s, .below = 1};
    bvx_lattice lattice;
    bvx_volume_view volume = {.sample_type = BVX_SAMPLE_F32};
    bvx_field field = {0};
    float *values;

    bench_try(ctx, bvx_lattice_fit(ctx, mesh, DOUBLE_RESOLUTION, &lattice), "lattice");
    for (int a = 0; a < 3; a++) {
        lattice.origin[a] -= DOUBLE_MARGIN * lattice.spacing[a];
        lattice.dims[a] += 2 * DOUBLE_MARGIN;
        volume.size[a] = lattice.dims[a];
    }
    bench_try(ctx, bvx_measure_field(ctx, mesh, &lattice, &o, &field), "field");
    values = malloc((size_t)lattice.dims[0] * (size_t)lattice.dims[1] * (size_t)lattice.dims[2] *
                    sizeof *values);
    if (values == NULL) exit(1);
    bench_try(ctx, bvx_field_dense(ctx, &field, 0, values), "values");
    bvx_field_free(ctx, &field);
    volume.samples = values;
    volume.lattice = lattice;
    s.level = lattice.spacing[0];
    bench_try(ctx, bvx_extract_scalar(ctx, &volume, &s, walls), "walls");
    free(values);
}

static void one_hull(bvx_context *all, const bench_model *m)
{
    uint64_t const wanted[2] = {100000, 15000};
    bvx_mesh walls = {0}, outer = {0}, levels[2] = {{0}, {0}};
    bvx_hull_options o = {.struct_size = sizeof o, .targets = {.triangles = wanted}};
    bvx_mesh_view view, truth;

    make_walls(all, &m->view, 0, &walls);
    make_walls(all, &m->view, 1, &outer);
    bvx_mesh_view_of(&walls, &view);
    bvx_mesh_view_of(&outer, &truth);
    double const size = diagonal(all, &truth), start = bench_clock(2);
    bench_try(all, bvx_hull(all, &view, &o, 2, levels), m->name);
    double const ms = bench_clock(2) - start;
    for (int i = 0; i < 2; i++) {
        bvx_distance_report d;
        bvx_certificate c;

        bvx_mesh_view_of(&levels[i], &view);
        bench_try(all, bvx_mesh_distance(all, &view, &truth, SAMPLES, 1, &d), "distance");
        bench_try(all, bvx_mesh_check(all, &view, 0, &c), "check");
        printf("| %s | %llu | %llu | %.0f | %.4f | %.4f | %s |\n", m->name,
               (unsigned long long)walls.triangle_count, (unsigned long long)levels[i].triangle_count, ms,
               100 * d.mean_a_to_b / size, 100 * d.mean_b_to_a / size,
               c.closed && c.oriented && c.edge_manifold && c.vertex_manifold ? "yes" : "NO");
        bvx_mesh_free(all, &levels[i]);
    }
    bvx_mesh_free(all, &walls);
    bvx_mesh_free(all, &outer);
}

/* At most percent of the diagonal away. */
static void one_enclosure(bvx_context *ctx, const bench_model *m, double percent, uint64_t triangles)
{
    uint64_t const wanted[1] = {triangles};
    double const size = diagonal(ctx, &m->view);
    bvx_mesh level = {0};
    bvx_hull_options o = {
        .struct_size = sizeof o, .targets = {.triangles = wanted}, .enclose = 0.01 * percent * size};
    bvx_mesh_view view;
    bvx_distance_report d;
    bvx_certificate c;
    bvx_measure_report inside;

    double ms = HUGE_VAL;

    for (int i = 0; i < ENCLOSURES; i++) {
        double const start = bench_clock(1);

        bvx_mesh_free(ctx, &level);
        bench_try(ctx, bvx_hull(ctx, &m->view, &o, 1, &level), m->name);
        if (bench_clock(1) - start < ms) ms = bench_clock(1) - start;
    }
    bvx_mesh_view_of(&level, &view);
    bench_try(ctx, bvx_mesh_distance(ctx, &view, &m->view, SAMPLES, 1, &d), "distance");
    bench_try(ctx, bvx_mesh_check(ctx, &view, 0, &c), "check");
    bench_try(ctx, bvx_measure(ctx, &m->view, NULL, &inside), "mass");
    printf("| %s | %llu | %g | %llu | %.0f | %.2f | %.2f |\n", m->name,
           (unsigned long long)m->view.triangle_count, percent, (unsigned long long)level.triangle_count, ms,
           100 * d.max_a_to_b / size, 100 * (c.volume / inside.volume - 1));
    bvx_mesh_free(ctx, &level);
}

/* The widest of each model adds no more volume than alpha wrapping does at that count (peers_makers.py). */
static void all_enclosures(bvx_context *ctx, const bench_model *m)
{
    double const widest = strcmp(m->name, "rocker-arm") == 0 ? 15 : strcmp(m->name, "fandisk") == 0 ? 9 : 11;

    one_enclosure(ctx, m, 1, 1000);
    one_enclosure(ctx, m, 4, 5000);
    one_enclosure(ctx, m, widest, 1000);
}

/* The mesh with each fifth triangle turned, or without it. */
static void one_mass(bvx_context *ctx, const bench_model *m, const char *how)
{
    uint32_t *const t = malloc((size_t)m->triangle_count * 12 + 1);
    bvx_mesh_view view = {0};
    bvx_measure_report r;
    bvx_certificate sound;
    uint64_t count = 0;

    if (t == NULL) exit(1);
    for (uint64_t i = 0; i < m->triangle_count; i++) {
        int const spoilt = i % SPOILT_PARTS == 0, turned = spoilt && how[0] == 'f';

        if (spoilt && how[0] == 't') continue;
        for (int k = 0; k < 3; k++)
            t[3 * count + (uint64_t)k] = m->triangles[3 * i + (uint64_t)(turned ? 2 - k : k)];
        count++;
    }
    view.positions = m->points;
    view.position_type = BVX_F64;
    view.vertex_count = m->point_count;
    view.indices = t;
    view.index_type = BVX_U32;
    view.triangle_count = count;
    bench_try(ctx, bvx_mesh_check(ctx, &m->view, 1, &sound), "check");
    double const start = bench_clock(1);
    bench_try(ctx, bvx_measure(ctx, &view, NULL, &r), m->name);
    printf("| %s | %s | %.1f | %.5f | %.5f |\n", m->name, how, bench_clock(1) - start,
           100 * fabs(r.volume / sound.volume - 1), 100 * r.volume_error / sound.volume);
    free(t);
}

static void one_inspection(bvx_context *ctx, const bench_model *m)
{
    bvx_inspect_options o = {.struct_size = sizeof o};
    bvx_inspect_report r;
    double const start = bench_clock(1);

    bench_try(ctx, bvx_inspect(ctx, &m->view, &o, &r), m->name);
    printf("| %s | %llu | %.0f | %llu |\n", m->name, (unsigned long long)m->view.triangle_count,
           bench_clock(1) - start, (unsigned long long)r.crossings);
}

/* Each model that is there. */
static void for_each(bvx_context *ctx, const char *folder, const char *const *file, int count,
                     void (*run)(bvx_context *, const bench_model *))
{
    for (int i = 0; i < count; i++) {
        bench_model m;

        char name[32] = "";

        memcpy(name, file[i], strcspn(file[i], "."));
        if (!bench_model_open(ctx, folder, file[i], name, &m)) continue;
        run(ctx, &m);
        bench_model_free(ctx, &m);
    }
}

static void all_masses(bvx_context *ctx, const bench_model *m)
{
    one_mass(ctx, m, "as it is");
    one_mass(ctx, m, "flipped");
    one_mass(ctx, m, "torn");
}

int main(int argc, char **argv)
{
    static const char *const large[] = {"dragon_vrip_871414.ply.gz"};
    static const char *const small[] = {"rocker-arm.obj.gz", "fandisk.obj.gz", "cow.obj.gz"};
    static const char *const closed[] = {"rocker-arm.obj.gz", "fandisk.obj.gz", "nefertiti_100k.obj.gz"};
    static const char *const checked[] = {"rocker-arm.obj.gz", "dragon_100k.obj.gz"};
    bvx_context *const one = bench_context(1, BVX_CPU_BEST, NULL), *const all = bench_context(0, BVX_CPU_BEST,
                                                                                              NULL);

    if (argc < 2) return 2;
    printf(
        "Hulls of double walls, both levels in one call: distances in %% of the diagonal.\n\n"
        "| model | triangles in | out | time of day [ms] | hull to outer wall | wall to hull | closed, manifold |\n"
        "|---|--:|--:|--:|--:|--:|---|\n");
    for_each(all, argv[1], large, 1, one_hull);
    printf("\nLevels that enclose: at most so far from the mesh, and the farthest, in %% of the diagonal.\n\n"
           "| model | triangles in | at most | out | ms | farthest | added volume [%%] |\n"
           "|---|--:|--:|--:|--:|--:|--:|\n");
    for_each(one, argv[1], small, 3, all_enclosures);
    printf("\nVolume of what is spoilt, one triangle in five, in %% of that of the mesh as it is.\n\n"
           "| model | | ms | error | bound |\n|---|---|--:|--:|--:|\n");
    for_each(one, argv[1], closed, 3, all_masses);
    printf("\nWhether it can be made: soundness, walls, gaps, cavities, layers at 256 voxels.\n\n"
           "| model | triangles | ms | crossing pairs |\n|---|--:|--:|--:|\n");
    for_each(one, argv[1], checked, 2, one_inspection);
    bvx_context_destroy(one);
    bvx_context_destroy(all);
    return 0;
}
