/* bench_blend.c - how near a body comes to sections that were left out, by either blend.
 *
 *   bench_blend FILE...
 *
 * Each file is a stack of contours, or a mesh that is cut across z into so many sections. Every second section
 * is left out, the body is made of the others, and the distance from the contours left out (their points and
 * three places on every segment) to its surface is measured, in percent of the diagonal of all contours.
 * Kinks are the angles between the triangles on both sides of edges that lie in a section. The least
 * processor time of three runs on one thread. Writes a table as Markdown to standard output. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLEND_CUTS = 31, BLEND_PLACES = 4, BLEND_RUNS = 3 };

/* ---- stacks ---- */

static void *blend_get(size_t bytes)
{
    void *const block = calloc(1, bytes + 1);

    if (block == NULL) exit(1);
    return block;
}

static void cut_mesh(bvx_context *ctx, const bvx_mesh *mesh, bvx_sections *sections)
{
    bvx_slice_options o = {.struct_size = sizeof o};
    bvx_certificate c;
    bvx_mesh_view view;

    bvx_mesh_view_of(mesh, &view);
    bench_try(ctx, bvx_mesh_check(ctx, &view, 1, &c), "bounds");
    o.spacing = (c.box.high[2] - c.box.low[2]) / BLEND_CUTS;
    bench_try(ctx, bvx_slice_mesh(ctx, &view, &o, sections), "sections");
}

static void read_stack(bvx_context *ctx, const char *path, bvx_sections *sections)
{
    size_t const length = strlen(path);
    char *const name = blend_get(length);
    int32_t format;

    memcpy(name, path, length);
    if (length > 3 && strcmp(name + length - 3, ".gz") == 0) name[length - 3] = 0;
    format = bvx_format_of_name(name);
    free(name);
    if (format == BVX_FORMAT_CSL || format == BVX_FORMAT_CSV) {
        size_t size;
        uint8_t *const bytes = bench_read_file(path, &size);
        if (bytes == NULL) exit(1);
        bench_try(ctx, bvx_read_sections(ctx, bytes, size, format, NULL, sections), path);
        free(bytes);
    } else {
        bvx_mesh mesh = {0};
        if (!bench_read_mesh(ctx, path, &mesh)) exit(1);
        cut_mesh(ctx, &mesh, sections);
        bvx_mesh_free(ctx, &mesh);
    }
}

static int compare_numbers(const void *a, const void *b)
{
    double const x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* 1 when a section is left out: every second one in order, but not the last. */
static int *choose_sections(const bvx_sections *s)
{
    double *const order = blend_get(s->section_count * sizeof *order);
    int *const left_out = blend_get(s->section_count * sizeof *left_out);

    memcpy(order, s->positions, s->section_count * sizeof *order);
    qsort(order, s->section_count, sizeof *order, compare_numbers);
    for (uint64_t i = 0; i < s->section_count; i++)
        for (uint64_t rank = 1; rank + 1 < s->section_count; rank += 2)
            if (order[rank] == s->positions[i]) left_out[i] = 1;
    free(order);
    return left_out;
}

/* The stack without what is left out; points are those of the whole stack. */
static void keep_rest(const bvx_sections *s, const int *left_out, bvx_sections *kept)
{
    uint32_t *const number = blend_get(s->section_count * sizeof *number);

    *kept = *s;
    kept->owned = 0;
    kept->loops = blend_get(s->loop_count * sizeof *kept->loops);
    kept->positions = blend_get(s->section_count * sizeof *kept->positions);
    kept->loop_count = kept->section_count = 0;
    for (uint32_t i = 0; i < s->section_count; i++) {
        if (left_out[i]) continue;
        number[i] = (uint32_t)kept->section_count;
        kept->positions[kept->section_count++] = s->positions[i];
    }
    for (uint64_t i = 0; i < s->loop_count; i++) {
        if (left_out[s->loops[i].section]) continue;
        kept->loops[kept->loop_count] = s->loops[i];
        kept->loops[kept->loop_count++].section = number[s->loops[i].section];
    }
    free(number);
}

/* ---- measures ---- */

static double diagonal_of(const bvx_sections *s)
{
    double sum = 0.0;

    for (int k = 0; k < 3; k++) {
        double low = 1e300, high = -1e300;
        for (uint64_t i = 0; i < s->point_count; i++) {
            double const x = s->points[3 * i + (uint64_t)k];
            if (x < low) low = x;
            if (x > high) high = x;
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

/* The mean distance from what was left out to the surface. */
static double distance_to_rest(bvx_context *ctx, const bvx_sections *s, const int *left_out,
                               const bvx_mesh_view *view)
{
    double *const place = blend_get(s->point_count * BLEND_PLACES * 3 * sizeof *place);
    bvx_closest_point *const found = blend_get(s->point_count * BLEND_PLACES * sizeof *found);
    bvx_closest *closest;
    double mean = 0.0;
    uint64_t n = 0;

    for (uint64_t i = 0; i < s->loop_count; i++) {
        const bvx_section_loop *const l = &s->loops[i];
        for (uint32_t j = 0; j < l->point_count && left_out[l->section]; j++) {
            const double *const a = s->points + 3 * (l->first_point + j);
            const double *const b = s->points + 3 * (l->first_point + (j + 1) % l->point_count);
            for (int k = 0; k < BLEND_PLACES; k++, n++)
                for (int c = 0; c < 3; c++)
                    place[3 * n + (uint64_t)c] = a[c] + (b[c] - a[c]) * k / BLEND_PLACES;
        }
    }

    bench_try(ctx, bvx_closest_create(ctx, view, &closest), "nearest points");
    bench_try(ctx, bvx_closest_find(ctx, closest, place, n, found), "nearest points");
    bvx_closest_free(ctx, closest);
    for (uint64_t i = 0; i < n; i++) mean += found[i].distance / (double)n;
    free(found);
    free(place);
    return mean;
}

static void triangle_normal(const double *p, const uint32_t *t, double n[3])
{
    const double *const a = p + 3 * (uint64_t)t[0], *const b = p + 3 * (uint64_t)t[1];
    const double *const c = p + 3 * (uint64_t)t[2];
    double length = 0.0;

    for (int k = 0; k < 3; k++) {
        int const i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
        length += n[k] * n[k];
    }
    for (int k = 0; k < 3 && length > 0.0; k++) n[k] /= sqrt(length);
}

typedef struct blend_edge {
    uint32_t low, high, triangle;
} blend_edge;

static int compare_edges(const void *a, const void *b)
{
    const blend_edge *const x = a, *const y = b;

    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    return (x->high > y->high) - (x->high < y->high);
}

static int is_on_section(const bvx_sections *kept, const double *p)
{
    for (uint64_t i = 1; i + 1 < kept->section_count; i++)
        if (fabs(p[2] - kept->positions[i]) < 1e-12 * (1.0 + fabs(p[2]))) return 1;
    return 0;
}

/* The median angle over the edges in sections but the first and the last [Units: degrees]. */
static double kinks_of(const bvx_sections *kept, const bvx_mesh *mesh)
{
    const double *const p = mesh->positions;
    blend_edge *const edge = blend_get(3 * mesh->triangle_count * sizeof *edge);
    double *const angle = blend_get(3 * mesh->triangle_count * sizeof *angle), median;
    uint64_t n = 0, edges = 0;

    for (uint64_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t const a = mesh->triangles[3 * t + (uint64_t)k];
            uint32_t const b = mesh->triangles[3 * t + (uint64_t)((k + 1) % 3)];
            if (p[3 * (uint64_t)a + 2] != p[3 * (uint64_t)b + 2] || !is_on_section(kept, p + 3 * (uint64_t)a))
                continue;
            edge[edges++] = (blend_edge){a < b ? a : b, a < b ? b : a, (uint32_t)t};
        }
    qsort(edge, edges, sizeof *edge, compare_edges);
    for (uint64_t i = 0; i + 1 < edges; i++) {
        double a[3], b[3], dot;
        if (compare_edges(&edge[i], &edge[i + 1]) != 0) continue;
        triangle_normal(p, mesh->triangles + 3 * (uint64_t)edge[i].triangle, a);
        triangle_normal(p, mesh->triangles + 3 * (uint64_t)edge[i + 1].triangle, b);
        dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        angle[n++] = acos(dot > 1.0 ? 1.0 : dot < -1.0 ? -1.0 : dot) * (180.0 / 3.14159265358979323846);
    }
    qsort(angle, n, sizeof *angle, compare_numbers);
    median = n == 0 ? 0.0 : angle[n / 2];
    free(angle);
    free(edge);
    return median;
}

/* ---- the table ---- */

static void show_blend(bvx_context *ctx, const char *name, const bvx_sections *s, const int *left_out,
                       const bvx_sections *kept, int32_t layers, int32_t blend)
{
    static const char *const names[] = {"linear", "cubic"};
    static bench_times times;
    bvx_sections_report report;
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_certificate c;
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    uint64_t pairs = 0;

    memset(&times, 0, sizeof times);
    o.slabs.layers = layers;
    o.slabs.blend = blend;
    o.mend = 1;
    o.report = &report;
    for (int i = 0; i < BLEND_RUNS; i++) {
        double start;
        bvx_mesh_free(ctx, &mesh);
        start = bench_clock(1);
        bench_try(ctx, bvx_build_sections(ctx, kept, &o, &mesh), name);
        bench_add(&times, bench_clock(1) - start);
    }
    bvx_mesh_view_of(&mesh, &view);
    bench_try(ctx, bvx_mesh_check(ctx, &view, 0, &c), "certificate");
    bench_try(ctx, bvx_mesh_crossings(ctx, &view, &pairs, NULL, 0), "crossings");
    printf("| %s | %d | %s | %.3f | %.1f | %.4f | %lld | %llu | %llu | %s | %.1f |\n", name, (int)layers,
           names[blend], 100.0 * distance_to_rest(ctx, s, left_out, &view) / diagonal_of(s),
           kinks_of(kept, &mesh), c.volume / report.prismoid_volume, (long long)c.euler,
           (unsigned long long)pairs, (unsigned long long)mesh.triangle_count,
           c.closed && c.edge_manifold && c.vertex_manifold && c.oriented ? "yes" : "NO", bench_min(&times));
    fflush(stdout);
    bvx_mesh_free(ctx, &mesh);
}

int main(int argc, char **argv)
{
    static const int32_t layers[] = {1, 2, 4, 8};
    static bench_memory memory;
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, &memory);

    printf(
        "| stack | layers | blend | left out to surface, %% of the diagonal | kinks, degrees | volume : prismoids | "
        "Euler | crossing pairs | triangles | closed, manifold | ms |\n"
        "|---|--:|---|--:|--:|--:|--:|--:|--:|---|--:|\n");
    for (int i = 1; i < argc; i++) {
        const char *const slash = strrchr(argv[i], '/');
        bvx_sections s = {0}, kept;
        int *left_out;

        read_stack(ctx, argv[i], &s);
        left_out = choose_sections(&s);
        keep_rest(&s, left_out, &kept);
        for (size_t k = 0; k < sizeof layers / sizeof *layers; k++)
            for (int32_t blend = BVX_BLEND_LINEAR; blend <= BVX_BLEND_CUBIC; blend++)
                show_blend(ctx, slash == NULL ? argv[i] : slash + 1, &s, left_out, &kept, layers[k], blend);
        free(kept.loops);
        free(kept.positions);
        free(left_out);
        bvx_sections_free(ctx, &s);
    }
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return 0;
}
