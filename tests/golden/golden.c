/* golden.c - recompute the golden values and compare them with fixtures/golden/.
 *
 *   golden [--threads N]                 compare; one line a difference; the last line is "N passed, N
 *   failed"
 *   golden --portable, --avx2           by this code only; a processor that has none of it ends with status
 *   77
 *   golden --brief                       without the cases that take an emulator minutes
 *   golden --print                      and print every line as computed (make matrix compares these between
 *   builds)
 *   golden --flush                      with denormal numbers flushed to zero, as games set it (x86 with SSE,
 *   aarch64)
 *   golden --write                      store what is computed now (make golden, which also shows the
 *   difference)
 *
 * A golden file holds one line a case: its name, then key=value pairs. A case computes its values and hands
 * them to golden_u64, golden_hex or golden_text between golden_begin and golden_end; a group of cases is one
 * function and one file. The same values must come out on every machine, compiler and thread count, so a
 * value depends on none. */
#include "bitvox_io.h"
#include "bare_case.h"
#include "core/core.h"
#include "grid/grid.h"
#include "shapes.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

enum { MAX_LINE = 2048, MAX_LINES = 1024 };

typedef struct golden {
    bvx_context *context;
    FILE *out;               /* where lines go with --write; NULL: compare */
    char *stored[MAX_LINES]; /* lines of the file, in order */
    int used[MAX_LINES];     /* 1: a case has met this line */
    int stored_count;
    char line[MAX_LINE]; /* the case being made */
    int passed, failed;
    int print; /* 1: every line is shown as computed */
    int brief; /* 1: long cases are left out */
} golden;

/* 1 when this processor was told to take denormal numbers for zero and to make none. */
static int flush_denormals(void)
{
#if defined(__SSE2__)
    _mm_setcsr(_mm_getcsr() | 0x8040);
    return 1;
#elif defined(__aarch64__) && defined(__GNUC__)
    uint64_t mode;
    __asm__ volatile("mrs %0, fpcr" : "=r"(mode));
    __asm__ volatile("msr fpcr, %0" : : "r"(mode | UINT64_C(1) << 24));
    return 1;
#else
    return 0;
#endif
}

static void append(golden *g, const char *text)
{
    size_t const used = strlen(g->line);
    if (used + strlen(text) >= sizeof g->line) {
        fprintf(stderr, "golden: a line is too long: %.60s\n", g->line);
        exit(2);
    }
    memcpy(g->line + used, text, strlen(text) + 1);
}

static void golden_begin(golden *g, const char *name)
{
    g->line[0] = 0;
    append(g, name);
}

static void golden_text(golden *g, const char *key, const char *value)
{
    append(g, " ");
    append(g, key);
    append(g, "=");
    append(g, value);
}

static void golden_u64(golden *g, const char *key, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%" PRIu64, value);
    golden_text(g, key, text);
}

static void golden_hex(golden *g, const char *key, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, value);
    golden_text(g, key, text);
}

static int same_name(const char *a, const char *b)
{
    size_t const n = strcspn(a, " ");
    return n == strcspn(b, " ") && memcmp(a, b, n) == 0;
}

/* 1 when the case is left out: nineteen twentieths of the whole time are theirs, which an emulator makes half an
 * hour. What they show of byte order, another row of their stage shows too. */
static int golden_skips(golden *g, const char *name)
{
    static const char *const names[] = {"soup_65_auto",
                                        "soup_40",
                                        "soup_32",
                                        "soup_32_vote",
                                        "soup_24",
                                        "torus_by_error",
                                        "label_surfaces",
                                        "label_surfaces_fewer",
                                        "bodies",
                                        "oblique",
                                        "knot_f32",
                                        "specks_cubic",
                                        "thin_disc_48",
                                        "torus_flipped",
                                        "torus_48_open_hull",
                                        "torus_measured_f64_sharp",
                                        "torus_40",
                                        "torus_48_open_vote",
                                        "torus_48_open_shell",
                                        "walls",
                                        "specks_stretched",
                                        "torus_90_open",
                                        "soup_65_nonzero",
                                        "soup_65",
                                        "torus_48_closed_hull",
                                        "torus_enclosed",
                                        "torus_48_open",
                                        "torus_40_shell",
                                        "soup",
                                        "torus_8_by_5",
                                        "torus_stretched",
                                        "torus_130",
                                        "knot_f64",
                                        "torus_x"};
    int is_long = 0;

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) is_long |= strcmp(name, names[i]) == 0;
    if (!g->brief || !is_long) return 0;
    for (int i = 0; i < g->stored_count; i++) g->used[i] |= same_name(g->stored[i], name);
    return 1;
}

static void golden_end(golden *g)
{
    int at = 0;

    if (g->out != NULL) {
        fprintf(g->out, "%s\n", g->line);
        return;
    }
    if (g->print) printf("= %s\n", g->line);
    while (at < g->stored_count && (g->used[at] || !same_name(g->stored[at], g->line))) at++;
    if (at == g->stored_count) {
        printf("FAIL not stored: %s\n", g->line);
        g->failed++;
        return;
    }
    g->used[at] = 1;
    if (strcmp(g->stored[at], g->line) == 0) {
        g->passed++;
    } else {
        printf("FAIL stored: %s\n     now:    %s\n", g->stored[at], g->line);
        g->failed++;
    }
}

/* A call that fails is a difference too: the line then holds the status and
 * why. Returns 1 when the call was good. */
static int golden_good(golden *g, bvx_status status)
{
    if (status == BVX_OK) return 1;
    golden_text(g, "status", bvx_status_text(status));
    golden_text(g, "message", bvx_last_message(g->context));
    return 0;
}

/* ---- Cases ---- */

static void hash_cases(golden *g)
{
    static const char digits[] = "123456789";

    golden_begin(g, "empty");
    golden_hex(g, "hash", bvx_hash(digits, 0, 0));
    golden_end(g);
    golden_begin(g, "one_word");
    golden_hex(g, "hash", bvx_hash(digits, 8, 0));
    golden_end(g);
    golden_begin(g, "word_and_rest");
    golden_hex(g, "hash", bvx_hash(digits, 9, 0));
    golden_hex(g, "seeded", bvx_hash(digits, 9, UINT64_C(0x0123456789abcdef)));
    golden_end(g);
}

/* A sheared pattern over a window that starts within a word of its lattice. */
static void grid_cases(golden *g)
{
    static const double origin[3] = {-1.5, 0.25, 10.0}, spacing[3] = {0.5, 0.25, 1.0};
    static const int32_t dims[3] = {200, 9, 7};
    static const bvx_window window = {{30, 1, 2}, {130, 7, 4}};
    bvx_lattice lattice;
    bvx_grid grid = {0};
    uint64_t count = 0, hash = 0;

    golden_begin(g, "pattern_in_window");
    if (golden_good(g, bvx_lattice_make(g->context, origin, spacing, dims, &lattice)) &&
        golden_good(g, bvx_grid_create(g->context, &lattice, &window, &grid))) {
        for (int32_t z = 0; z < 4; z++)
            for (int32_t y = 0; y < 7; y++)
                for (int32_t x = 0; x < 130; x++) bvx_grid_set(&grid, x, y, z, (x + 3 * y + 5 * z) % 11 < 4);
        if (golden_good(g, bvx_grid_count(g->context, &grid, &count)) &&
            golden_good(g, bvx_grid_hash(g->context, &grid, &hash))) {
            golden_u64(g, "set", count);
            golden_hex(g, "bits", hash);
        }
    }
    golden_end(g);
    bvx_grid_free(g->context, &grid);
}

/* ---- The main job: solid, surface, levels ---- */

static shape golden_shape; /* large, so not on the stack */

typedef struct solid_case {
    const char *name;
    int32_t resolution, fill;
    bvx_window window;
} solid_case;

static void surface_values(golden *g, const bvx_grid *solid, const char *key,
                           const bvx_extract_options *options)
{
    bvx_mesh mesh = {0};
    uint64_t hash = 0;

    if (golden_good(g, bvx_extract_surface(g->context, solid, options, &mesh)) &&
        golden_good(g, bvx_mesh_hash(g->context, &mesh, &hash))) {
        if (strcmp(key, "surface") == 0) golden_u64(g, "triangles", mesh.triangle_count);
        golden_hex(g, key, hash);
    }
    bvx_mesh_free(g->context, &mesh);
}

static void surfaces_of(golden *g, const bvx_grid *solid)
{
    bvx_extract_options options = {.struct_size = sizeof options};

    surface_values(g, solid, "surface", &options);
    options.face_rule = BVX_FACE_JOIN;
    options.position_type = BVX_F64;
    surface_values(g, solid, "joined_f64", &options);
    options.open_sides = 63;
    options.local_frame = 1;
    surface_values(g, solid, "open_local", &options);
}

static void levels_of(golden *g, const bvx_grid *solid)
{
    static const int32_t resolutions[3] = {24, 13, 6};
    static const char *const keys[2][3] = {{"ratio24", "ratio13", "ratio6"},
                                           {"coverage24", "coverage13", "coverage6"}};

    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++) {
        bvx_mesh levels[3] = {{0}};
        bvx_lod_options options = {.struct_size = sizeof options};
        options.sampling.method = method;
        options.resolutions = resolutions;
        if (!golden_good(g, bvx_build_lods(g->context, solid, &options, 3, levels))) return;
        for (int32_t l = 0; l < 3; l++) {
            uint64_t hash = 0;
            if (golden_good(g, bvx_mesh_hash(g->context, &levels[l], &hash)))
                golden_hex(g, keys[method][l], hash);
            bvx_mesh_free(g->context, &levels[l]);
        }
    }
}

static void collapsed_of(golden *g, const bvx_grid *solid)
{
    static const uint64_t target = 1500;
    bvx_mesh level = {0};
    bvx_lod_options options = {.struct_size = sizeof options};
    uint64_t hash = 0;

    options.target_triangles = &target;
    options.collapse = 2.5;
    if (golden_good(g, bvx_build_lods(g->context, solid, &options, 1, &level)) &&
        golden_good(g, bvx_mesh_hash(g->context, &level, &hash)))
        golden_hex(g, "collapsed", hash);
    bvx_mesh_free(g->context, &level);
}

static void solid_values(golden *g, const solid_case *c)
{
    bvx_voxelize_options options = {.struct_size = sizeof options};
    bvx_solid_report report = {0};
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_grid solid = {0};
    uint64_t count = 0, hash = 0;

    if (golden_skips(g, c->name)) return;
    shape_view(&golden_shape, &view);
    options.fill = c->fill;
    options.window = c->window;
    options.report = &report;
    golden_begin(g, c->name);
    if (golden_good(g, bvx_lattice_fit(g->context, &view, c->resolution, &lattice)) &&
        golden_good(g, bvx_voxelize_solid(g->context, &view, &lattice, &options, &solid)) &&
        golden_good(g, bvx_grid_count(g->context, &solid, &count)) &&
        golden_good(g, bvx_grid_hash(g->context, &solid, &hash))) {
        for (int32_t a = 0; a < 3; a++)
            golden_u64(g, a == 0 ? "nx" : a == 1 ? "ny" : "nz", (uint64_t)lattice.dims[a]);
        golden_u64(g, "set", count);
        golden_hex(g, "bits", hash);
        golden_u64(g, "crossings", report.crossings);
        golden_u64(g, "unbalanced", report.unbalanced_rows);
        surfaces_of(g, &solid);
        if (c->window.size[0] == 0) {
            levels_of(g, &solid);
            collapsed_of(g, &solid);
        }
    }
    golden_end(g);
    bvx_grid_free(g->context, &solid);
}

static void solid_cases(golden *g)
{
    static const solid_case torus[] = {
        {"torus_130", 130, BVX_FILL_PARITY, {{0, 0, 0}, {0, 0, 0}}},
        {"torus_64_nonzero", 64, BVX_FILL_NONZERO, {{0, 0, 0}, {0, 0, 0}}},
        {"torus_130_window", 130, BVX_FILL_PARITY, {{17, 5, 3}, {65, 70, 11}}},
    };
    static const solid_case ball[] = {{"ball_63", 63, BVX_FILL_PARITY, {{0, 0, 0}, {0, 0, 0}}}};
    static const solid_case soup[] = {
        {"soup_65", 65, BVX_FILL_PARITY, {{0, 0, 0}, {0, 0, 0}}},
        {"soup_65_nonzero", 65, BVX_FILL_NONZERO, {{0, 0, 0}, {0, 0, 0}}},
        {"soup_65_auto", 65, BVX_FILL_AUTO, {{0, 0, 0}, {0, 0, 0}}},
    };

    shape_torus(&golden_shape, 96, 40, 0.25, 7);
    for (size_t i = 0; i < sizeof torus / sizeof torus[0]; i++) solid_values(g, &torus[i]);
    shape_ball(&golden_shape, 20);
    solid_values(g, &ball[0]);
    shape_soup(&golden_shape, 300, 11);
    for (size_t i = 0; i < sizeof soup / sizeof soup[0]; i++) solid_values(g, &soup[i]);
}

/* The case that machines without an operating system compute too. */
static void bare_cases(golden *g)
{
    bare_result r = {0, 0, 0, 0};

    golden_begin(g, "torus_32_bare");
    if (golden_good(g, bare_case(g->context, &golden_shape, &r))) {
        golden_u64(g, "set", r.set);
        golden_hex(g, "bits", r.bits);
        golden_u64(g, "triangles", r.triangles);
        golden_hex(g, "mesh", r.mesh);
    }
    golden_end(g);
}

#include "voxel_cases.h"
#include "field_cases.h"
#include "query_cases.h"
#include "section_cases.h"
#include "algebra_cases.h"
#include "morph_cases.h"
#include "volume_cases.h"
#include "component_cases.h"
#include "level_cases.h"

static const struct {
    const char *file;
    void (*run)(golden *g);
} groups[] = {
    {"hash", hash_cases},
    {"grid", grid_cases},
    {"solid", solid_cases},
    {"bare", bare_cases},
    {"voxel_surface", voxel_surface_cases},
    {"fills", fill_cases},
    {"octree", octree_cases},
    {"field", field_cases},
    {"repair", repair_cases},
    {"questions", question_cases},
    {"tree_questions", tree_question_cases},
    {"files", file_cases},
    {"pictures", picture_cases},
    {"sections", section_cases},
    {"algebra", algebra_cases},
    {"morphology", morph_cases},
    {"volumes", volume_cases},
    {"components", component_cases},
    {"clouds", cloud_cases},
    {"levels", level_cases},
};

/* ---- Files ---- */

static void read_stored(golden *g, const char *path)
{
    char line[MAX_LINE];
    FILE *const file = fopen(path, "r");

    g->stored_count = 0;
    if (file == NULL) return;
    while (fgets(line, sizeof line, file) != NULL && g->stored_count < MAX_LINES) {
        size_t const size = strcspn(line, "\r\n");
        char *const kept = malloc(size + 1);
        if (kept == NULL) exit(2);
        memcpy(kept, line, size);
        kept[size] = 0;
        if (size == 0) {
            free(kept);
            continue;
        }
        g->used[g->stored_count] = 0;
        g->stored[g->stored_count++] = kept;
    }
    fclose(file);
}

/* Lines that no case meets any more are differences too. */
static void end_stored(golden *g)
{
    for (int i = 0; i < g->stored_count; i++) {
        if (!g->used[i]) {
            printf("FAIL stored, but no case makes it: %s\n", g->stored[i]);
            g->failed++;
        }
        free(g->stored[i]);
    }
}

static int run_groups(golden *g, int write)
{
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; i++) {
        char path[256];
        snprintf(path, sizeof path, "fixtures/golden/%s.txt", groups[i].file);
        if (!write) {
            read_stored(g, path);
            groups[i].run(g);
            end_stored(g);
            continue;
        }
        g->out = fopen(path, "w");
        if (g->out == NULL) {
            fprintf(stderr, "golden: cannot write %s; run it from the top folder\n", path);
            return 1;
        }
        groups[i].run(g);
        if (fclose(g->out) != 0) return 1;
    }
    if (!write) printf("%d passed, %d failed\n", g->passed, g->failed);
    return g->failed != 0;
}

int main(int argc, char **argv)
{
    static golden g;
    bvx_context_options options = {.struct_size = sizeof options};
    int write = 0, result;

    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--write") == 0) {
            write = 1;
        } else if (strcmp(argv[i], "--portable") == 0) {
            options.cpu = BVX_CPU_PORTABLE;
        } else if (strcmp(argv[i], "--avx2") == 0) {
            options.cpu = BVX_CPU_AVX2;
        } else if (strcmp(argv[i], "--brief") == 0) {
            g.brief = 1;
        } else if (strcmp(argv[i], "--print") == 0) {
            g.print = 1;
        } else if (strcmp(argv[i], "--flush") == 0) {
            if (!flush_denormals()) {
                fprintf(stderr, "golden: no way to flush denormal numbers is known for this processor\n");
                return 2;
            }
        } else if (strcmp(argv[i], "--threads") == 0 && i + 1 < argc) {
            options.threads = (int32_t)strtol(argv[++i], NULL, 10);
        } else {
            fprintf(
                stderr,
                "usage: golden [--write | --print | --brief] [--threads N] [--portable | --avx2] [--flush]\n");
            return 2;
        }
    }
    if (bvx_context_create(&options, &g.context) != BVX_OK) {
        fprintf(stderr, "golden: no context\n");
        return 2;
    }
    if (options.cpu != BVX_CPU_BEST && bvxi_cpu(g.context) != options.cpu) {
        puts("this processor or build has no such code");
        return 77;
    }
    result = run_groups(&g, write);
    bvx_context_destroy(g.context);
    return result;
}
