/* piece_volumes.c - the pieces of a mesh by volume and box: which face inward, which lie within others.
 *
 * A piece is what hangs together by vertices, or where bodies touch at vertices by edges. A closed one that
 * faces inward has a negative volume: it is the cavity of a piece around it, or it is inside out. The
 * volumes of all, each taken as positive, are the most that a solid of the mesh can have: where pieces
 * overlap it has less. Boxes say quickly what cannot lie within what; voxels, filled by two rules that
 * differ in nothing else, say whether something does.  Sums are taken around the middle of the mesh, so that
 * far coordinates keep their digits. */
#include "mesh/view.h"
#include "pipeline/repair.h"

enum {
    MOST_TURNED = 4096 /* pieces beyond which none is turned: pairs of boxes would take long */
};

static void add_to_piece(bvxi_mesh_piece *s, const double p[3][3])
{
    double const *const a = p[0], *const b = p[1], *const c = p[2];

    s->volume6 += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]);

    /* Its box begins with its first corner. */
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            if ((s->triangles == 0 && k == 0) || p[k][i] < s->low[i]) s->low[i] = p[k][i];
            if ((s->triangles == 0 && k == 0) || p[k][i] > s->high[i]) s->high[i] = p[k][i];
        }
    s->triangles++;
}

/* Number the marks of pieces that have triangles, from 1 on; returns how many. */
static uint64_t number_pieces(const bvx_mesh_view *mesh, const bvxi_piece_marks *by, uint32_t *number,
                              uint64_t marks)
{
    uint32_t count = 0;

    for (uint64_t t = 0; t < mesh->triangle_count; t++) number[bvxi_piece_mark(mesh, by, t)] = 1;
    for (uint64_t n = 0; n < marks; n++)
        if (number[n] != 0) number[n] = ++count;
    return count;
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
    *count = number_pieces(mesh, by, number, marks);
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
