/* piece_volumes.c - the pieces of a mesh by volume and box: which face inward, which lie within others.
 *
 * A piece is what hangs together by vertices, or where bodies touch at vertices by edges. A closed one that
 * faces inward has a negative volume: it is the cavity of a piece around it, or it is inside out. The
 * volumes of all, each taken as positive, are the most that a solid of the mesh can have: where pieces
 * overlap it has less. Boxes say quickly what cannot lie within what; voxels, filled by two rules that
 * differ in nothing else, say whether something does.  Sums are taken around the middle of the mesh, so that
 * far coordinates keep their digits. */
#include "core/vec3.h"
#include "mesh/cross.h"
#include "pipeline/repair.h"

enum {
    MOST_TURNED = 4096, /* pieces beyond which none is turned: pairs of boxes would take long */
    MOST_RAYS = 1 << 24 /* times triangles that are looked at */
};

static void add_to_piece(bvxi_mesh_piece *s, const double p[3][3])
{
    s->volume6 += bvxi_vec_volume6(p[0], p[1], p[2]);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            if ((s->triangles == 0 && k == 0) || p[k][i] < s->low[i]) s->low[i] = p[k][i];
            if ((s->triangles == 0 && k == 0) || p[k][i] > s->high[i]) s->high[i] = p[k][i];
        }
    s->triangles++;
}

static void add_triangles(const bvx_mesh_view *mesh, const bvxi_piece_marks *by, const uint32_t *number,
                          const bvx_certificate *of, bvxi_mesh_piece *pieces)
{
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        uint32_t v[3];
        uint32_t const mark = bvxi_piece_mark(mesh, by, t);
        bvxi_mesh_piece *const part = &pieces[number[mark] - 1];

        bvxi_view_triangle(mesh, t, v);
        for (int k = 0; k < 3; k++) {
            bvxi_view_position(mesh, v[k], p[k]);
            for (int a = 0; a < 3; a++) p[k][a] -= 0.5 * of->box.low[a] + 0.5 * of->box.high[a];
        }
        part->mark = mark;
        add_to_piece(part, (const double(*)[3])p);
    }
}

uint32_t bvxi_piece_mark(const bvx_mesh_view *mesh, const bvxi_piece_marks *by, uint64_t t)
{
    uint32_t v[3];
    if (by->part != NULL) return by->part[t];
    bvxi_view_triangle(mesh, t, v);
    return by->piece[v[0]];
}

bvx_status bvxi_mesh_pieces_open(bvx_context *ctx, const bvx_mesh_view *mesh, const bvxi_piece_marks *by,
                                 const bvx_certificate *of, bvxi_mesh_piece **pieces, uint64_t *count)
{
    uint64_t const marks = by->part != NULL ? mesh->triangle_count : mesh->vertex_count;
    uint32_t *number;

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, marks * 4, "the numbers of the pieces", &number));
    for (uint64_t t = 0; t < mesh->triangle_count; t++) number[bvxi_piece_mark(mesh, by, t)] = 1;
    for (uint64_t n = *count = 0; n < marks; n++)
        if (number[n] != 0) number[n] = (uint32_t)++ * count;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, *count * sizeof **pieces, "the pieces' volumes", pieces));
    add_triangles(mesh, by, number, of, *pieces);
    bvxi_drop(ctx, number);
    return BVX_OK;
}

double bvxi_mesh_pieces_volume(const bvxi_mesh_piece *pieces, uint64_t count)
{
    double sum = 0;
    for (uint64_t n = 0; n < count; n++) sum += bvxi_absolute(pieces[n].volume6);
    return sum / 6;
}

static int is_within_box(const bvxi_mesh_piece *in, const bvxi_mesh_piece *out)
{
    for (int a = 0; a < 3; a++)
        if (!(in->low[a] > out->low[a] && in->high[a] < out->high[a])) return 0;
    return 1;
}

/* 1: the box of a piece that faces outward is around this one's. */
static int has_outer(const bvxi_mesh_piece *pieces, uint64_t count, const bvxi_mesh_piece *in)
{
    for (uint64_t m = 0; m < count; m++)
        if (pieces[m].volume6 > 0 && is_within_box(in, &pieces[m])) return 1;
    return 0;
}

/* 1: the piece faces inward, and no box of another is around its own. */
static int is_inverted_root(const bvxi_mesh_piece *pieces, uint64_t count, uint64_t n)
{
    if (!(pieces[n].volume6 < 0)) return 0;
    for (uint64_t m = 0; m < count; m++)
        if (is_within_box(&pieces[n], &pieces[m])) return 0;
    return 1;
}

uint64_t bvxi_mark_inside_out(bvxi_mesh_piece *pieces, uint64_t count)
{
    uint64_t marked = 0;

    if (count > MOST_TURNED) return 0;
    /* What lies in an inverted body is turned with it, so that its cavities stay cavities; not what is open. */
    for (uint64_t n = 0; n < count; n++) {
        if (!is_inverted_root(pieces, count, n)) continue;
        pieces[n].turned = 1;
        for (uint64_t m = 0; m < count; m++)
            if (is_within_box(&pieces[m], &pieces[n])) pieces[m].turned = pieces[m].volume6 != 0;
    }
    for (uint64_t n = 0; n < count; n++) marked += pieces[n].turned;
    return marked;
}

int bvxi_cavities_lie_within(const bvxi_mesh_piece *pieces, uint64_t count)
{
    for (uint64_t n = 0; n < count; n++)
        if (!(pieces[n].volume6 > 0) && !has_outer(pieces, count, &pieces[n])) return 0;
    return 1;
}

bvx_status bvxi_fill_twice(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                           const int32_t rule[2], uint64_t *words[2])
{
    uint64_t const bytes = bvx_grid_bound(lattice, NULL) * 8;
    bvx_voxelize_options o = {.struct_size = sizeof o};

    for (int i = 0; i < 2; i++) {
        bvx_grid grid = {.word_capacity = bytes / 8};

        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the pieces' solids", &words[i]));
        grid.words = words[i];
        o.fill = rule[i];
        BVXI_TRY(BVXI_SHARE(ctx, 0.5 * i, 0.5 * (i + 1), bvx_voxelize_solid(ctx, mesh, lattice, &o, &grid)));
    }
    return BVX_OK;
}

/* ---- Bodies ---- */

typedef struct apart_job {
    const bvx_mesh_view *mesh;
    bvxi_mesh_piece *pieces;
    uint64_t count, bodies;
    uint32_t *group;  /* of each vertex, to be joined; at first its piece's mark */
    uint32_t *number; /* of each vertex: its piece */
    uint8_t *odd;     /* of each piece: a ray crosses it an odd number of times */
} apart_job;

/* Which pieces a ray from one, aslant to all that is modelled, is in, of those whose boxes hold it. */
static void cast_from(apart_job *job, const bvxi_mesh_piece *from, const double beyond[3])
{
    double p[3], q[3][3];
    const double *const ray[3] = {p, beyond, beyond}, *const triangle[3] = {q[0], q[1], q[2]};

    memset(job->odd, 0, (size_t)job->count);
    bvxi_view_position(job->mesh, from->mark, p);
    for (uint64_t t = 0; t < job->mesh->triangle_count; t++) {
        uint32_t c[3], n;

        bvxi_view_triangle(job->mesh, t, c);
        n = job->number[c[0]];
        if (!is_within_box(from, &job->pieces[n])) continue;
        for (int k = 0; k < 3; k++) bvxi_view_position(job->mesh, c[k], q[k]);
        job->odd[n] ^= (uint8_t)bvxi_triangles_cross(triangle, ray);
    }
}

/* Boxes alone decide where rays would take long. */
static void join_enclosed(apart_job *job, const double beyond[3])
{
    uint64_t rays = 0;

    for (uint64_t n = 0; n < job->count; n++)
        for (uint64_t m = 0, cast = 0; m < job->count; m++) {
            if (!is_within_box(&job->pieces[n], &job->pieces[m])) continue;
            if (!cast && rays < MOST_RAYS / job->mesh->triangle_count) {
                cast_from(job, &job->pieces[n], beyond);
                rays += cast = 1;
            }
            if (!cast || job->odd[m])
                job->bodies -= (uint64_t)bvxi_join(job->group, (uint32_t)job->pieces[n].mark,
                                                   (uint32_t)job->pieces[m].mark);
        }
}

bvx_status bvxi_bodies_apart(bvx_context *ctx, const bvx_mesh_view *mesh, uint64_t *bodies)
{
    static const double aslant[3] = {0.3719, 0.6131, 0.2357};
    uint64_t const bytes = mesh->vertex_count * 4;
    bvxi_welded welded = {.view = mesh};
    apart_job job = {.mesh = mesh};
    bvxi_piece_marks by = {0};
    bvx_certificate of;
    uint32_t *representative;
    double beyond[3];

    *bodies = 0;
    bvxi_view_used_bounds(mesh, of.box.low, of.box.high);
    memcpy(welded.low, of.box.low, sizeof welded.low);
    memcpy(welded.high, of.box.high, sizeof welded.high);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' places", &representative));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' pieces", &job.group));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the pieces' numbers", &job.number));
    BVXI_TRY(bvxi_weld(ctx, mesh, representative, &welded.different));
    welded.representative = representative;
    bvxi_pieces(mesh, representative, job.group);
    by.piece = job.group;
    BVXI_TRY(bvxi_mesh_pieces_open(ctx, mesh, &by, &of, &job.pieces, &job.count));
    if (job.count > MOST_TURNED) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.count, "the pieces around", &job.odd));
    for (uint64_t n = 0; n < job.count; n++) job.number[job.pieces[n].mark] = (uint32_t)n;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) job.number[v] = job.number[job.group[v]];

    for (int a = 0; a < 3; a++) beyond[a] = of.box.high[a] + aslant[a] * (of.box.high[a] - of.box.low[a]);
    job.bodies = job.count;
    join_enclosed(&job, beyond);
    uint64_t pairs;
    uint32_t *pair, a[3], b[3];
    BVXI_TRY(bvxi_mesh_crossings(ctx, &welded, UINT64_MAX, &pair, &pairs));
    for (uint64_t i = 0; i < pairs; i++) {
        bvxi_view_triangle(job.mesh, pair[2 * i], a);
        bvxi_view_triangle(job.mesh, pair[2 * i + 1], b);
        job.bodies -= (uint64_t)bvxi_join(job.group, a[0], b[0]);
    }
    *bodies = job.bodies;
    return BVX_OK;
}
