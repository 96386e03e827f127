/* bench_models.c - models for the measuring programs: from files, generated, with their holes closed. */
#include "bench_models.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *room_for(uint64_t count, size_t size)
{
    void *const p = malloc((size_t)count * size + 1);
    if (p == NULL) {
        fprintf(stderr, "bench: no memory for a model\n");
        exit(1);
    }
    return p;
}

/* The view shows the arrays for the baselines. */
static void show_arrays(bench_model *m)
{
    memset(&m->view, 0, sizeof m->view);
    m->view.positions = m->points;
    m->view.indices = m->triangles;
    m->view.vertex_count = m->point_count;
    m->view.triangle_count = m->triangle_count;
    m->view.position_type = BVX_F64;
    m->view.index_type = BVX_U32;
}

int bench_model_open(bvx_context *ctx, const char *folder, const char *file, const char *name, bench_model *m)
{
    char path[1024];

    memset(m, 0, sizeof *m);
    m->name = name;
    snprintf(path, sizeof path, "%s/%s", folder, file);
    if (!bench_read_mesh(ctx, path, &m->mesh)) return 0;
    m->point_count = m->mesh.vertex_count;
    m->triangle_count = m->mesh.triangle_count;
    m->points = room_for(m->point_count * 3, sizeof *m->points);
    m->triangles = room_for(m->triangle_count * 3, sizeof *m->triangles);
    for (uint64_t i = 0; i < m->point_count * 3; i++)
        m->points[i] = m->mesh.position_type == BVX_F64 ? ((const double *)m->mesh.positions)[i]
                                                        : (double)((const float *)m->mesh.positions)[i];
    memcpy(m->triangles, m->mesh.triangles, (size_t)m->triangle_count * 3 * sizeof *m->triangles);
    bvx_mesh_view_of(&m->mesh, &m->view);
    return 1;
}

void bench_model_free(bvx_context *ctx, bench_model *m)
{
    bvx_mesh_free(ctx, &m->mesh);
    free(m->points);
    free(m->triangles);
    memset(m, 0, sizeof *m);
}

/* ---- the ball ---- */

/* An edge with the triangle side that it came from. */
typedef struct side {
    uint32_t low, high; /* vertices */
    uint64_t number;    /* 3 triangle + corner */
} side;

static int compare_sides(const void *a, const void *b)
{
    const side *const x = a, *const y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

/* All sides of all triangles, those of one edge together. */
static side *sorted_sides(const uint32_t *triangles, uint64_t triangle_count)
{
    side *const sides = room_for(triangle_count * 3, sizeof *sides);

    for (uint64_t n = 0; n < triangle_count * 3; n++) {
        uint32_t const a = triangles[n], b = triangles[n % 3 == 2 ? n - 2 : n + 1];
        sides[n].low = a < b ? a : b;
        sides[n].high = a < b ? b : a;
        sides[n].number = n;
    }
    qsort(sides, (size_t)triangle_count * 3, sizeof *sides, compare_sides);
    return sides;
}

static void put_on_ball(double *p)
{
    double const length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int i = 0; i < 3; i++) p[i] /= length;
}

/* Each triangle becomes four; each edge gets one point. */
static void quarter(bench_model *m)
{
    uint64_t const n = m->triangle_count, edges = n * 3 / 2;
    side *const sides = sorted_sides(m->triangles, n);
    uint32_t *const middle = room_for(n * 3, sizeof *middle), *const finer = room_for(n * 12, sizeof *finer);
    double *const points = room_for((m->point_count + edges) * 3, sizeof *points);

    memcpy(points, m->points, (size_t)m->point_count * 3 * sizeof *points);
    for (uint64_t e = 0; e < edges; e++) { /* closed: sides come in pairs */
        double *const p = points + 3 * (m->point_count + e);
        for (uint64_t i = 0; i < 3; i++)
            p[i] = m->points[3 * (uint64_t)sides[2 * e].low + i] +
                   m->points[3 * (uint64_t)sides[2 * e].high + i];
        put_on_ball(p);
        middle[sides[2 * e].number] = middle[sides[2 * e + 1].number] = (uint32_t)(m->point_count + e);
    }
    for (uint64_t t = 0; t < n; t++) {
        const uint32_t *const c = m->triangles + 3 * t, *const d = middle + 3 * t;
        uint32_t const four[12] = {c[0], d[0], d[2], c[1], d[1], d[0], c[2], d[2], d[1], d[0], d[1], d[2]};
        memcpy(finer + 12 * t, four, sizeof four);
    }
    free(sides);
    free(middle);
    free(m->points);
    free(m->triangles);
    m->points = points;
    m->triangles = finer;
    m->point_count += edges;
    m->triangle_count = 4 * n;
}

static double squared_distance(const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

/* 1 when a, b, c run counter-clockwise as seen from outside. */
static int faces_outwards(const double *a, const double *b, const double *c)
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) >
           0.0;
}

/* Its twelve points are the turns of (0, +-1, +-g); its triangles are all
 * threes of them at distance 2 from each other. */
static void icosahedron(bench_model *m)
{
    double const g = (1.0 + sqrt(5.0)) / 2.0;

    m->points = room_for(36, sizeof *m->points);
    m->triangles = room_for(60, sizeof *m->triangles);
    for (int n = 0; n < 12; n++) {
        double *const p = m->points + 3 * n;
        p[n % 3] = 0.0;
        p[(n + 1) % 3] = n / 3 % 2 ? 1.0 : -1.0;
        p[(n + 2) % 3] = n / 6 ? g : -g;
    }
    m->point_count = 12;
    for (uint32_t a = 0; a < 12; a++)
        for (uint32_t b = a + 1; b < 12; b++)
            for (uint32_t c = b + 1; c < 12; c++) {
                const double *const p = m->points + 3 * a;
                const double *const q = m->points + 3 * b;
                const double *const r = m->points + 3 * c;
                if (squared_distance(p, q) > 4.1 || squared_distance(q, r) > 4.1 ||
                    squared_distance(r, p) > 4.1)
                    continue;
                uint32_t *const t = m->triangles + 3 * m->triangle_count++;
                t[0] = a;
                t[1] = faces_outwards(p, q, r) ? b : c;
                t[2] = b + c - t[1];
            }
    for (int n = 0; n < 12; n++) put_on_ball(m->points + 3 * n);
}

void bench_model_ball(int halvings, const char *name, bench_model *m)
{
    memset(m, 0, sizeof *m);
    m->name = name;
    icosahedron(m);
    for (int i = 0; i < halvings; i++) quarter(m);
    show_arrays(m);
}

/* ---- holes ---- */

int bench_model_close(bench_model *m)
{
    side *const sides = sorted_sides(m->triangles, m->triangle_count);
    uint64_t const n = m->triangle_count * 3;
    /* against the open side: as the cap's triangle goes */
    uint32_t *const next = room_for(m->point_count, sizeof *next);
    uint64_t open = 0;
    int loops = 0;

    memset(next, 0xff, (size_t)m->point_count * sizeof *next);
    for (uint64_t i = 0, k; i < n; i = k) {
        for (k = i + 1; k < n && sides[k].low == sides[i].low && sides[k].high == sides[i].high; k++)
            continue;
        if (k - i != 1) continue;
        uint64_t const s = sides[i].number;
        next[m->triangles[s % 3 == 2 ? s - 2 : s + 1]] = m->triangles[s];
        open++;
    }
    free(sides);
    m->points = realloc(m->points, (size_t)(m->point_count + open) * 3 * sizeof *m->points);
    m->triangles = realloc(m->triangles, (size_t)(m->triangle_count + open) * 3 * sizeof *m->triangles);
    if (m->points == NULL || m->triangles == NULL) exit(1);
    uint64_t const old_points = m->point_count;
    for (uint64_t v = 0; v < old_points; v++) {
        uint32_t const middle = (uint32_t)m->point_count;
        double sum[3] = {0.0, 0.0, 0.0};
        uint64_t count = 0;
        if (next[v] == UINT32_MAX) continue;
        for (uint32_t a = (uint32_t)v, b; next[a] != UINT32_MAX; a = b) {
            uint32_t *const t = m->triangles + 3 * m->triangle_count++;
            b = next[a];
            next[a] = UINT32_MAX;
            t[0] = a;
            t[1] = b;
            t[2] = middle;
            for (int i = 0; i < 3; i++) sum[i] += m->points[3 * (size_t)a + (size_t)i];
            count++;
        }
        for (int i = 0; i < 3; i++) m->points[3 * (size_t)middle + (size_t)i] = sum[i] / (double)count;
        m->point_count++;
        loops++;
    }
    free(next);
    show_arrays(m);
    return loops;
}

/* ---- targets ---- */

void bench_say_target(FILE *file, const char *title, double value, const char *unit, double target, int below)
{
    fprintf(file, "{\"title\": \"%s\", \"value\": %.6g, \"unit\": \"%s\", \"target\": %.6g, \"below\": %s}\n",
            title, value, unit, target, below ? "true" : "false");
    fflush(file);
}
