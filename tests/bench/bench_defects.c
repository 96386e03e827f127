/* bench_defects.c - volumes of repaired shapes: each defect of tests/tools/defect_maker.h, at several
 * resolutions.
 *
 *   bench_defects [RESOLUTION...]   prints Markdown
 *
 * The error is against the volume that the shape has with its defect mended (of shells: half a pipe along
 * their rim included); where the defect leaves that open, against the middle. In brackets what is allowed.
 * The numbers are the same on every machine. */
#include "bench.h"

#include "tools/defect_maker.h"

enum { MOST_RESOLUTIONS = 8 };

static void one_repair(bvx_context *ctx, const defect_kind *kind, int32_t which, int32_t resolution,
                       defect_shape *shape)
{
    uint64_t seed = UINT64_C(0xdefec75);
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_repair_report r;
    bvx_mesh_view view;
    bvx_mesh out = {0};

    defect_begin(shape, which, &seed, resolution);
    kind->make(shape, &seed);
    view = maker_view(&shape->mesh);
    o.fit.resolution = resolution;
    o.report = &r;
    bench_try(ctx, bvx_repair(ctx, &view, &o, &out), kind->name);
    double const h = r.lattice.spacing[0];
    double const low = defect_low(shape, h);
    double const high = defect_high(shape, h);
    double const middle = 0.5 * (low + high);
    int const good = r.after.closed && r.after.edge_manifold && r.after.vertex_manifold && r.after.oriented;
    printf(" %+.2f (%.2f)%s |", 100 * (r.after.volume - middle) / middle, 50 * (high - low) / middle,
           !good                                           ? " NOT CLOSED"
           : r.after.volume < low || r.after.volume > high ? " BEYOND"
                                                           : "");
    bvx_mesh_free(ctx, &out);
}

int main(int argc, char **argv)
{
    int32_t resolution[MOST_RESOLUTIONS] = {16, 32, 64}, count = 3;
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);
    defect_shape shape;

    memset(&shape, 0, sizeof shape);
    if (argc > 1) count = 0;
    for (int i = 1; i < argc && count < MOST_RESOLUTIONS; i++) resolution[count++] = atoi(argv[i]);
    printf(
        "Volume after repair, error in %% (in brackets: what is allowed, either way).\n\n| shape | defect |");
    for (int32_t i = 0; i < count; i++) printf(" %d |", (int)resolution[i]);
    printf("\n|---|---|");
    for (int32_t i = 0; i < count; i++) printf("--:|");
    for (int kind = 0; kind < DEFECT_KINDS; kind++)
        for (int32_t which = 0; which < (defect_kinds[kind].any_shape ? DEFECT_SHAPES : 1); which++) {
            printf("\n| %s | %s |", defect_kinds[kind].any_shape ? defect_shape_names[which] : "",
                   defect_kinds[kind].name);
            for (int32_t i = 0; i < count; i++)
                one_repair(ctx, &defect_kinds[kind], which, resolution[i], &shape);
        }
    printf("\n");
    defect_end(&shape);
    bvx_context_destroy(ctx);
    return 0;
}
