/* bench_sections.c - bodies from section contours: Table 1 of "3D surface modelling in section data fields"
 * and more.
 *
 *   bench_sections FOLDER [RUNS]
 *
 * The paper gives times for an ore body on grids of 20 x 20 and 40 x 40 cells (0.823 s and 1.452 s, its
 * machine and number of sections are not told) and describes no data, so an ore-like body stands for it: 100
 * sections of a dipping lens that branches, with a barren core and satellites, 2 to 5 loops of 60 to 220
 * points each. The least of several runs: processor time of one thread, time of day of two. Distances from
 * the contours (their points and three places on every segment) to the mesh tell what each way of crossing
 * keeps. Writes FOLDER/ore.csv for other programs and the table as Markdown to standard output.
 *
 * A second table is of bodies made at once (bvx_build_bodies): three sectors of a ball, and as many columns as
 * there may be, on 12 parallel planes; what they take beside the ball alone tells what bodies that touch cost. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { JOINT_SECTIONS = 12, JOINT_ARC = 32, JOINT_MOST = 63, JOINT_ACROSS = 9 };
enum { ORE_SECTIONS = 100, ORE_POINTS = 100000, ORE_LOOPS = 800, ORE_PLACES = 4 };

static double ore_point[3 * ORE_POINTS], ore_position[ORE_SECTIONS];
static bvx_section_loop ore_loop[ORE_LOOPS];

/* A loop of a wavy ellipse; waves run on from section to section. */
static void add_ore_loop(bvx_sections *s, uint32_t section, const double centre[2], const double half[2],
                         double phase, int count, double waves)
{
    bvx_section_loop *const l = &s->loops[s->loop_count++];

    memset(l, 0, sizeof *l);
    l->first_point = s->point_count;
    l->point_count = (uint32_t)count;
    l->section = section;
    l->label = 1;
    for (int i = 0; i < count; i++) {
        double const a = 2.0 * 3.14159265358979323846 * i / count;
        double const r = 1.0 + waves * (0.5 * sin(3.0 * a + phase) + 0.3 * sin(7.0 * a - 2.0 * phase) +
                                        0.15 * sin(17.0 * a + 3.0 * phase));
        double *const p = s->points + 3 * s->point_count++;
        p[0] = centre[0] + half[0] * r * cos(a);
        p[1] = centre[1] + half[1] * r * sin(a);
        p[2] = s->positions[section];
    }
}

static void make_ore(bvx_sections *s)
{
    memset(s, 0, sizeof *s);
    s->points = ore_point;
    s->loops = ore_loop;
    s->positions = ore_position;
    s->normal[2] = 1.0;
    s->section_count = ORE_SECTIONS;
    for (uint32_t k = 0; k < ORE_SECTIONS; k++) {
        double const t = (double)k / (ORE_SECTIONS - 1);
        double const bulge = sqrt(t * (1.0 - t) * 4.0 + 0.02);
        double const phase = 6.0 * t;
        double const shift = 60.0 * t; /* the dip */
        double centre[2] = {500.0 + shift, 300.0 + 0.3 * shift}, half[2] = {220.0 * bulge, 90.0 * bulge};
        ore_position[k] = 5.0 * k;
        if (t > 0.62) { /* two branches */
            double const apart = 150.0 * (t - 0.62) / 0.38 + 95.0 * bulge;
            double const a[2] = {centre[0] - apart, centre[1] - 20.0};
            double const b[2] = {centre[0] + apart, centre[1] + 25.0};
            half[0] = 90.0 * bulge;
            half[1] = 70.0 * bulge;
            add_ore_loop(s, k, a, half, phase, 160, 0.22);
            add_ore_loop(s, k, b, half, phase + 1.0, 140, 0.22);
        } else {
            add_ore_loop(s, k, centre, half, phase, 220, 0.22);
            if (t > 0.15) { /* the barren core */
                double const core[2] = {55.0 * bulge, 22.0 * bulge};
                add_ore_loop(s, k, centre, core, -phase, 80, 0.2);
            }
        }
        if (t > 0.3 && t < 0.8) {
            double const at[2] = {centre[0] + 60.0, centre[1] + 190.0}, small[2] = {30.0, 22.0};
            add_ore_loop(s, k, at, small, 2.0 * phase, 60, 0.15);
        }
    }
}

static void write_ore(bvx_context *ctx, const char *folder, const bvx_sections *s)
{
    char path[1024];
    bvx_buffer file = {0};
    FILE *out;

    snprintf(path, sizeof path, "%s/ore.csv", folder);
    bench_try(ctx, bvx_write_sections(ctx, s, BVX_FORMAT_CSV, &file), "CSV");
    out = bench_open(path);
    if (fwrite(file.bytes, 1, (size_t)file.size, out) != file.size || fclose(out) != 0) exit(1);
    bvx_buffer_free(ctx, &file);
}

/* The mean and the greatest distance from the contours to the mesh. */
static void measure_contours(bvx_context *ctx, const bvx_sections *s, const bvx_mesh *mesh, double *mean,
                             double *most)
{
    static double place[3 * ORE_POINTS * ORE_PLACES];
    static bvx_closest_point found[ORE_POINTS * ORE_PLACES];
    bvx_closest *closest;
    bvx_mesh_view view;
    uint64_t n = 0;

    for (uint64_t i = 0; i < s->loop_count; i++) {
        const bvx_section_loop *const l = &s->loops[i];
        for (uint32_t j = 0; j < l->point_count; j++) {
            const double *const a = s->points + 3 * (l->first_point + j);
            const double *const b = s->points + 3 * (l->first_point + (j + 1) % l->point_count);
            for (int k = 0; k < ORE_PLACES; k++, n++)
                for (int c = 0; c < 3; c++)
                    place[3 * n + (uint64_t)c] = a[c] + (b[c] - a[c]) * k / ORE_PLACES;
        }
    }
    bvx_mesh_view_of(mesh, &view);
    bench_try(ctx, bvx_closest_create(ctx, &view, &closest), "nearest points");
    bench_try(ctx, bvx_closest_find(ctx, closest, place, n, found), "nearest points");
    bvx_closest_free(ctx, closest);
    *mean = *most = 0.0;
    for (uint64_t i = 0; i < n; i++) {
        *mean += found[i].distance / (double)n;
        if (found[i].distance > *most) *most = found[i].distance;
    }
}

/* The least time of several runs on two threads. */
static double time_two(const bvx_sections *s, const bvx_sections_options *o, int runs)
{
    static bench_memory memory;
    static bench_times times;
    bvx_context *const ctx = bench_context(2, BVX_CPU_BEST, &memory);

    memset(&times, 0, sizeof times);
    for (int i = 0; i < runs; i++) {
        bvx_mesh mesh = {0};
        double const start = bench_clock(2);
        bench_try(ctx, bvx_build_sections(ctx, s, o, &mesh), "body");
        bench_add(&times, bench_clock(2) - start);
        bvx_mesh_free(ctx, &mesh);
    }
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return bench_min(&times);
}

static void show_row(bvx_context *ctx, const bvx_sections *s, int32_t grid, int32_t crossings, int runs)
{
    static const char *const name[] = {"exact", "paper", "classic"};
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_sections_report report;
    bvx_certificate certificate;
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    static bench_times times;
    double mean, most;

    memset(&times, 0, sizeof times);
    memset(&report, 0, sizeof report);
    o.slabs.grid[0] = o.slabs.grid[1] = grid;
    o.slabs.crossings = crossings;
    o.report = &report;
    for (int i = 0; i < runs; i++) {
        double start;
        bvx_mesh_free(ctx, &mesh);
        start = bench_clock(1);
        bench_try(ctx, bvx_build_sections(ctx, s, &o, &mesh), "body");
        bench_add(&times, bench_clock(1) - start);
    }
    bvx_mesh_view_of(&mesh, &view);
    bench_try(ctx, bvx_mesh_check(ctx, &view, 0, &certificate), "certificate");
    measure_contours(ctx, s, &mesh, &mean, &most);
    printf("| %d x %d | %s | %.2f | %.2f | %s | %llu | %s | %llu, %llu | %.3g, %.3g | %.5g : %.5g |\n",
           (int)grid, (int)grid, name[crossings], bench_min(&times), time_two(s, &o, runs),
           grid == 20   ? "823"
           : grid == 40 ? "1452"
                        : "-",
           (unsigned long long)mesh.triangle_count,
           certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                   certificate.oriented
               ? "yes"
               : "NO",
           (unsigned long long)(report.unkept_edges + report.unkept_loops),
           (unsigned long long)report.unkept_points, mean, most, certificate.volume, report.prismoid_volume);
    fflush(stdout);
    bvx_mesh_free(ctx, &mesh);
}

/* ---- bodies at once ---- */

static void add_joint_point(bvx_sections *s, double x, double y, double z)
{
    double *const p = s->points + 3 * s->point_count++;

    p[0] = x;
    p[1] = y;
    p[2] = z;
    s->loops[s->loop_count - 1].point_count++;
}

static void add_joint_loop(bvx_sections *s, uint32_t section, int32_t label)
{
    bvx_section_loop *const l = &s->loops[s->loop_count++];

    memset(l, 0, sizeof *l);
    l->first_point = s->point_count;
    l->section = section;
    l->label = label;
}

/* What a sector of a ball has on a plane: the middle and an arc; one sector is the whole circle. */
static void add_sector(bvx_sections *s, uint32_t section, int number, int sectors)
{
    double const z = s->positions[section], r = sqrt(1.0 - z * z);
    int const points = 3 * JOINT_ARC / sectors;

    add_joint_loop(s, section, number + 1);
    if (sectors > 1) add_joint_point(s, 0.0, 0.0, z);
    for (int i = 0; i < points + (sectors > 1); i++) {
        int const of = (number * points + i) % (sectors * points);
        double const a = 2.0 * 3.14159265358979323846 * of / (sectors * points);
        add_joint_point(s, r * cos(a), r * sin(a), z);
    }
}

static void add_column(bvx_sections *s, uint32_t section, int number)
{
    static const int corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

    add_joint_loop(s, section, number + 1);
    for (int i = 0; i < 4; i++)
        add_joint_point(s, (number % JOINT_ACROSS + corner[i][0]) / 5.0,
                        (number / JOINT_ACROSS + corner[i][1]) / 5.0, s->positions[section]);
}

static void make_joint(bvx_sections *s, int bodies)
{
    memset(s, 0, sizeof *s);
    s->points = ore_point;
    s->loops = ore_loop;
    s->positions = ore_position;
    s->normal[2] = 1.0;
    s->section_count = JOINT_SECTIONS;
    for (uint32_t k = 0; k < JOINT_SECTIONS; k++) {
        s->positions[k] = -0.9 + 1.8 * k / (JOINT_SECTIONS - 1);
        for (int i = 0; i < bodies; i++) {
            if (bodies == JOINT_MOST) add_column(s, k, i);
            else add_sector(s, k, i, bodies);
        }
    }
}

static void show_joint_row(bvx_context *ctx, int bodies, int32_t cells, int runs)
{
    static bvx_mesh mesh[JOINT_MOST];
    static bench_times times;
    int32_t label[JOINT_MOST];
    bvx_sections s;
    bvx_sections_options o = {.struct_size = sizeof o};
    uint64_t triangles = 0;
    int sound = 1, spheres = 0;

    make_joint(&s, bodies);
    memset(&times, 0, sizeof times);
    o.cells = cells;
    for (int i = 0; i < bodies; i++) label[i] = i + 1;
    bvx_memory_reset_peak(ctx);
    for (int i = 0; i < runs; i++) {
        double start;
        for (int b = 0; b < bodies; b++) bvx_mesh_free(ctx, &mesh[b]);
        start = bench_clock(1);
        bench_try(ctx, bvx_build_bodies(ctx, &s, &o, label, (uint32_t)bodies, mesh), "bodies at once");
        bench_add(&times, bench_clock(1) - start);
    }
    for (int b = 0; b < bodies; b++) {
        bvx_certificate c;
        bvx_mesh_view view;
        bvx_mesh_view_of(&mesh[b], &view);
        bench_try(ctx, bvx_mesh_check(ctx, &view, 0, &c), "certificate");
        sound &= c.closed && c.edge_manifold && c.vertex_manifold && c.oriented;
        spheres += c.euler == 2;
        triangles += mesh[b].triangle_count;
    }
    printf("| %d | %d | %.0f | %.0f | %llu | %s | %d |\n", bodies, (int)cells, bench_min(&times),
           (double)bvx_memory_peak(ctx) / 1e6, (unsigned long long)triangles, sound ? "yes" : "NO", spheres);
    fflush(stdout);
    for (int b = 0; b < bodies; b++) bvx_mesh_free(ctx, &mesh[b]);
}

/* From the C library's heap: each body has blocks of its own, and there are many. */
static void show_joint_table(int runs)
{
    static const int bodies[] = {1, 3, JOINT_MOST};
    static const int32_t cells[] = {64, 128, 256};
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);

    printf("\nBodies at once: sectors of a ball, then columns, on %d planes\n\n", JOINT_SECTIONS);
    printf(
        "| bodies | cells | ms | MB | triangles | closed, manifold | without handles |\n|--:|--:|--:|--:|--:|---|--:|\n");
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++)
        /* So many at 256 cells take 3.4 GB, which not every machine has. */
        for (size_t k = 0; k < sizeof cells / sizeof *cells - (bodies[i] == JOINT_MOST); k++)
            show_joint_row(ctx, bodies[i], cells[k], k == 0 ? runs : 1);
    bvx_context_destroy(ctx);
}

/* ---- planes of any direction ---- */

enum { ANY_PLANES = 30, ANY_POINTS = 100, ANY_CELLS = 256 };

static double any_point[3 * ANY_PLANES * ANY_POINTS], any_normal[3 * ANY_PLANES], any_position[ANY_PLANES];
static bvx_section_loop any_loop[ANY_PLANES];

static double any_random(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* A circle of the ball of radius 1 on a plane: points about its middle, in two directions across the normal. */
static void add_any_circle(bvx_sections *s, uint32_t k, const double n[3], double height)
{
    double const radius = sqrt(1.0 - height * height), flat = sqrt(n[0] * n[0] + n[1] * n[1]);
    double const u[3] = {-n[1] / flat, n[0] / flat, 0.0};
    double const v[3] = {-n[2] * u[1], n[2] * u[0], n[0] * u[1] - n[1] * u[0]};

    memset(&any_loop[k], 0, sizeof any_loop[k]);
    any_loop[k].first_point = s->point_count;
    any_loop[k].point_count = ANY_POINTS;
    any_loop[k].section = k;
    any_loop[k].label = 1;
    for (int i = 0; i < ANY_POINTS; i++, s->point_count++) {
        double const a = 2.0 * 3.14159265358979323846 * i / ANY_POINTS;
        for (int c = 0; c < 3; c++)
            s->points[3 * s->point_count + (uint64_t)c] = height * n[c] +
                                                          radius * (cos(a) * u[c] + sin(a) * v[c]);
    }
}

static void make_any_planes(bvx_sections *s)
{
    uint64_t seed = 30;

    memset(s, 0, sizeof *s);
    s->points = any_point;
    s->loops = any_loop;
    s->positions = any_position;
    s->normals = any_normal;
    s->section_count = s->loop_count = ANY_PLANES;
    for (uint32_t k = 0; k < ANY_PLANES; k++) {
        double *const n = any_normal + 3 * k, square;

        /* From a cube until it falls into its ball, but not along z, which has no direction across. */
        do {
            for (int c = 0; c < 3; c++) n[c] = 2.0 * any_random(&seed) - 1.0;
            square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        } while (square > 1.0 || n[0] * n[0] + n[1] * n[1] < 0.01);
        for (int c = 0; c < 3; c++) n[c] /= sqrt(square);
        any_position[k] = 0.8 * any_random(&seed) - 0.4;
        add_any_circle(s, k, n, any_position[k]);
    }
}

/* Time of day by one and two threads, and the most memory. */
static void show_any_planes(int runs)
{
    bvx_sections s;
    bvx_sections_options o = {.struct_size = sizeof o};

    make_any_planes(&s);
    o.cells = ANY_CELLS;
    printf("\nA ball by %d random planes of %d points, %d cells\n\n", ANY_PLANES, ANY_POINTS, ANY_CELLS);
    printf("| threads | s | peak MiB | triangles |\n|--:|--:|--:|--:|\n");
    for (int32_t threads = 1; threads <= 2; threads++) {
        bvx_context_options options = {.struct_size = sizeof options};
        bvx_context *ctx;
        double least = 1e300;
        uint64_t triangles = 0;

        options.threads = threads;
        if (bvx_context_create(&options, &ctx) != BVX_OK) exit(1);
        for (int i = 0; i < runs; i++) {
            bvx_mesh mesh = {0};
            double const start = bench_clock(2);
            bench_try(ctx, bvx_build_sections(ctx, &s, &o, &mesh), "body");
            least = bench_clock(2) - start < least ? bench_clock(2) - start : least;
            triangles = mesh.triangle_count;
            bvx_mesh_free(ctx, &mesh);
        }
        printf("| %d | %.2f | %.0f | %llu |\n", (int)threads, least / 1e3,
               (double)bvx_memory_peak(ctx) / 1048576.0, (unsigned long long)triangles);
        bvx_context_destroy(ctx);
    }
}

int main(int argc, char **argv)
{
    static const int32_t grids[] = {20, 40, 400};
    static bench_memory memory;
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, &memory);
    bvx_sections ore;

    if (argc < 2) {
        fprintf(stderr, "usage: bench_sections FOLDER [RUNS]\n");
        return 2;
    }
    int const runs = argc > 2 ? atoi(argv[2]) : 9;
    make_ore(&ore);
    write_ore(ctx, argv[1], &ore);
    printf("An ore-like body: %d sections, %llu loops, %llu points\n\n", ORE_SECTIONS,
           (unsigned long long)ore.loop_count, (unsigned long long)ore.point_count);
    printf(
        "| grid | crossings | ms | two threads: ms | the paper's ms | triangles | closed, manifold | edges and loops, points not kept | contour to "
        "mesh: mean, most | volume : prismoids |\n|--:|---|--:|--:|--:|--:|---|--:|--:|--:|\n");
    for (size_t i = 0; i < sizeof grids / sizeof *grids; i++)
        for (int32_t crossings = BVX_CROSSINGS_EXACT; crossings <= BVX_CROSSINGS_CLASSIC; crossings++)
            show_row(ctx, &ore, grids[i], crossings, runs);
    show_any_planes(runs < 5 ? runs : 5);
    show_joint_table(runs < 3 ? runs : 3);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return 0;
}
