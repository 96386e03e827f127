/* bench_models.h - models for the measuring programs: from files, generated, with their holes closed. */
#ifndef BENCH_MODELS_H
#define BENCH_MODELS_H

#include "bench.h"

typedef struct bench_model {
    const char *name;
    bvx_mesh mesh;      /* as read; empty for others */
    bvx_mesh_view view; /* what the library is given */
    double *points;     /* the same in doubles and 32-bit numbers, for the baselines */
    uint32_t *triangles;
    uint64_t point_count, triangle_count;
} bench_model;

/* 0 when there is no such file. */
int bench_model_open(bvx_context *ctx, const char *folder, const char *file, const char *name,
                     bench_model *model);

/* A ball: the icosahedron, each triangle cut in four halvings times, its points pulled to radius 1. */
void bench_model_ball(int halvings, const char *name, bench_model *model);

/* Each loop of open edges gets a fan of triangles around the mean of its points. Returns the number of
 * loops. */
int bench_model_close(bench_model *model);

void bench_model_free(bvx_context *ctx, bench_model *model);

/* ---- what was measured beside what was to be reached: one line of JSON each, for report.py ---- */

/* below 1: value must not exceed target, else it must not be less. */
void bench_say_target(FILE *file, const char *title, double value, const char *unit, double target,
                      int below);

#endif
