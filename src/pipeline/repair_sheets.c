/* repair_sheets.c - sheets of a mesh that is repaired: triangles that enclose nothing are found, those that
 * together make a body are excepted, and shells are laid around the rest.
 *
 * Source: Jacobson, Kavan, Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized Winding
 * Numbers. 2013. */
#include "nearest/nearest.h"
#include "mesh/facet.h"
#include "pipeline/repair.h"

#include <math.h>

/* ---- Triangles of a body ---- */

/* Which triangles lie on the border of a body that the whole mesh makes: faces of a part that do not touch,
 * triangles torn apart.
 *
 * Across a triangle the winding number steps by 1. On a body's border it steps from about 0 to about 1, on a
 * lone sheet from a half below 0 to a half above. So the fraction of it tells, which is the same on either
 * side and that of the sheet over the holes.
 * Guarantee: each answer follows from the snapped triangles only. */

#define ENCLOSED_OFF 0.25 /* turns from a whole number */

enum { ENCLOSED_GRAIN = 256, ENCLOSED_PIECES = 1024 };

typedef struct enclosed_job {
    const bvxi_repair_job *job;
    uint8_t *answer;
    int32_t pieces;
} enclosed_job;

/* Is the winding number nearly whole at a point of the triangle's normal through its middle? */
static int is_whole_off(const bvxi_repair_job *job, const double middle[3], const double normal[3],
                        double off)
{
    const bvx_lattice *const l = &job->lattice;
    double const one = (double)((int64_t)1 << l->fraction_bits);
    int64_t place[3];
    /* The place in fixed point, as winding numbers take it. */
    for (int a = 0; a < 3; a++)
        place[a] = (int64_t)floor((middle[a] + normal[a] * off - l->origin[a]) / l->spacing[a] * one + 0.5);
    return bvxi_winding_off(job->winding, place) < ENCLOSED_OFF;
}

/* Half a voxel off on both sides: nearer, the gaps between torn triangles would show. */
static int is_enclosed(const bvxi_repair_job *job, uint64_t t)
{
    double const off = 0.5 * bvxi_largest_spacing(&job->lattice);
    double p[3][3], middle[3], n[3];

    bvxi_view_corners(&job->mesh, t, p);
    double const length = bvxi_facet_normal((const double(*)[3])p, n);
    if (!(length > 0)) return 0;
    for (int a = 0; a < 3; a++) {
        middle[a] = (p[0][a] + p[1][a] + p[2][a]) / 3.0;
        n[a] /= length;
    }
    return is_whole_off(job, middle, n, -off) && is_whole_off(job, middle, n, off);
}

static void ask_triangles(void *user, int32_t piece)
{
    const enclosed_job *const e = user;
    uint64_t begin, end;
    bvxi_piece(e->job->mesh.triangle_count, e->pieces, piece, &begin, &end);
    for (uint64_t t = begin; t < end; t++)
        if (e->answer[t] == BVXI_TRIANGLE_ASKED && is_enclosed(e->job, t))
            e->answer[t] = BVXI_TRIANGLE_ENCLOSED;
}

static bvx_status repair_enclosed(bvxi_repair_job *job, uint8_t *answer)
{
    const bvx_mesh_view *const by = &job->body;
    int const parted = job->sheets.triangle_count != 0;
    uint64_t const pieces = by->triangle_count / ENCLOSED_GRAIN + 1;
    bvxi_holes of_body;
    enclosed_job e;

    /* Sheets are left out of the body, so its holes are others. */
    if (parted)
        BVXI_TRY(bvxi_holes_open_rule(job->ctx, bvxi_repair_name, by, &job->lattice, job->fill, &of_body));
    BVXI_TRY(bvxi_winding_open(job->ctx, bvxi_repair_name, by, &job->lattice, job->fill,
                               parted ? &of_body : &job->holes, &job->winding));
    e.job = job;
    e.answer = answer;
    e.pieces = pieces < ENCLOSED_PIECES ? (int32_t)pieces : ENCLOSED_PIECES;
    /* No winding number where there is no body. */
    if (job->winding != NULL) BVXI_TRY(bvxi_each(job->ctx, "sheets", 0.0, 1.0, e.pieces, ask_triangles, &e));
    bvxi_winding_close(job->ctx, job->winding);
    job->winding = NULL;
    if (parted) bvxi_holes_close(job->ctx, &of_body);
    return BVX_OK;
}

/* ---- Sheets ---- */

/* Which pieces of a mesh enclose nothing, and the shells that they become.
 *
 * A piece is a sheet when a lid over its holes would be nearly as large as itself (terrain: a lid of 0.7 of
 * its area or more), or when it is open, or as narrow as a rod (or in any case, by BVX_THIN_SHELL), and the
 * solid has no voxel close behind most of its area, on either side: what is thinner than a voxel, surfaces
 * that lie in themselves. Thin walls of closed pieces are kept as such (thicken.c). The lid is measured by
 * the vector area of each loop of open edges, which no way of closing it can fall below. A piece of large lid
 * is no sheet where the pieces together enclose something (see above): a face of a part whose faces
 * do not touch, the lid of a pot. A lid over all of these must be small in its turn, by themselves or with
 * the bodies that have holes, and they must enclose it without what are sheets. A shell is what lies within
 * half its thickness of the sheets: closed for any sheet. Guarantee: sums go by triangle, so the answer
 * follows from the mesh and the lattice only. */

#define SHEET_LID    0.7   /* of a piece's area */
#define SHEET_KEPT   0.5   /* of a piece's area */
#define SHEET_THIN   0.005 /* largest spacings of volume an area: a wall of a hundredth of it */
#define SHEET_JOINED 0.5   /* of a piece's area is enclosed by all */

enum { SHEET_ROUNDS = 8 };

/* What a piece is like, by its least vertex. */
typedef struct piece_sums {
    double area, kept, lid, joined;
    double low[3], high[3], first[3]; /* its box, a corner of it */
    double volume;                    /* with its sign */
    uint64_t triangles;
    int32_t open; /* 1: has loops of open edges */
    /* 1: is thinner than a bar of one voxel, or encloses next to nothing;
     * by BVX_THIN_SHELL any piece may be a sheet */
    int32_t rod;
} piece_sums;

/* The pieces in the order of their least vertices. */
typedef struct all_sums {
    piece_sums *piece;
    uint32_t *number; /* of each piece, at its least vertex */
    uint64_t count;
} all_sums;

/* What is summed of the piece that a vertex is in. */
static piece_sums *sums_of(const bvxi_repair_job *job, const all_sums *sums, uint32_t vertex)
{
    return &sums->piece[sums->number[job->piece[vertex]]];
}

/* Is there solid half a voxel or a voxel behind a triangle's middle, on
 * either side? step: a voxel of the largest spacing, in voxels. */
static int has_solid_behind(const bvx_grid *solid, const double step[3], const double p[3][3],
                            const double n[3], double length)
{
    static const double depth[4] = {-1.0, -0.5, 1.0, 0.5}; /* the likeliest first */
    double const part = 1.0 / length;
    double middle[3], way[3], at[3];

    /* In voxels, as the grid is looked at. */
    for (int a = 0; a < 3; a++) {
        middle[a] = ((p[0][a] + p[1][a] + p[2][a]) * (1.0 / 3.0) - solid->lattice.origin[a]) /
                    solid->lattice.spacing[a];
        way[a] = n[a] * part * step[a];
    }
    for (int d = 0; d < 4; d++) {
        for (int a = 0; a < 3; a++) at[a] = middle[a] + way[a] * depth[d];
        if (bvxi_grid_at(solid, at)) return 1;
    }
    return 0;
}

/* A triangle's piece and corners, and its normal as long as twice its area, which is returned. */
static double normal_of(const bvxi_repair_job *job, const all_sums *sums, uint64_t t, piece_sums **piece,
                        double p[3][3], double n[3])
{
    uint32_t c[3];
    bvxi_view_triangle(&job->mesh, t, c);
    *piece = sums_of(job, sums, c[0]);
    for (int k = 0; k < 3; k++) bvxi_view_position(&job->mesh, c[k], p[k]);
    return bvxi_facet_normal((const double(*)[3])p, n);
}

static void take_into_piece(piece_sums *piece, const double p[3][3])
{
    /* The first triangle opens the box. */
    for (int a = 0; a < 3 && piece->triangles == 0; a++)
        piece->low[a] = piece->high[a] = piece->first[a] = p[0][a];
    for (int k = 0; k < 3; k++) bvxi_widen(piece->low, piece->high, p[k], 3);
    /* From a corner of the piece, so that large coordinates do not take the digits. */
    for (int a = 0; a < 3; a++) {
        int const i = (a + 1) % 3, j = (a + 2) % 3;
        double const *const o = piece->first;

        piece->volume += ((p[1][i] - o[i]) * (p[2][j] - o[j]) - (p[1][j] - o[j]) * (p[2][i] - o[i])) *
                         (p[0][a] - o[a]) / 6.0;
    }
    piece->triangles++;
}

/* Pieces of less area than a bar one voxel square of their diagonal's length: they may pass between all lines
 * of centres. And pieces whose triangles look to either side at random, so that their volume is next to
 * none. */
static void find_rods(const bvxi_repair_job *job, all_sums *sums)
{
    double const side = bvxi_largest_spacing(&job->lattice);

    if (job->options->thin == BVX_THIN_DROP) return;

    for (uint64_t i = 0; i < sums->count; i++) {
        piece_sums *const s = &sums->piece[i];
        double length = 0;

        if (job->options->thin == BVX_THIN_SHELL) {
            s->rod = 1;
            continue;
        }

        for (int a = 0; a < 3; a++) length += (s->high[a] - s->low[a]) * (s->high[a] - s->low[a]);
        s->rod = s->triangles != 0 && (s->area < 4.0 * side * sqrt(length) ||
                                       bvxi_absolute(s->volume) < SHEET_THIN * side * s->area);
    }
}

/* The loops' vector areas go to their pieces. */
static void sum_loops(const bvxi_repair_job *job, const bvxi_holes *holes, all_sums *sums)
{
    uint64_t begin = 0;

    for (uint64_t l = 0; l < holes->loops; begin = holes->loop_end[l++]) {
        /* A fan from the loop's first vertex: any would have the same sum. */
        double first[3], sum[3] = {0, 0, 0};
        bvxi_view_position(&job->mesh, holes->vertex[begin], first);
        for (uint64_t i = begin + 1; i + 1 < holes->loop_end[l]; i++) {
            double p[3][3], n[3];
            memcpy(p[0], first, sizeof first);
            bvxi_view_position(&job->mesh, holes->vertex[i], p[1]);
            bvxi_view_position(&job->mesh, holes->vertex[i + 1], p[2]);
            bvxi_facet_cross((const double(*)[3])p, n);
            for (int a = 0; a < 3; a++) sum[a] += 0.5 * n[a];
        }
        sums_of(job, sums, holes->vertex[begin])->lid += bvxi_vec_length(sum);
        sums_of(job, sums, holes->vertex[begin])->open = 1;
    }
}

/* By the plain loops: an edge of two triangles that run one way is no hole. */
static bvx_status sum_lids(bvxi_repair_job *job, all_sums *sums)
{
    bvxi_holes holes;

    if (job->report.before.boundary_edges + job->report.before.nonmanifold_edges == 0) return BVX_OK;
    if (!job->holes.repeated) {
        sum_loops(job, &job->holes, sums);
        return BVX_OK;
    }
    BVXI_TRY(
        bvxi_holes_open_rule(job->ctx, bvxi_repair_name, &job->mesh, &job->lattice, BVX_FILL_VOTE, &holes));
    sum_loops(job, &holes, sums);
    bvxi_holes_close(job->ctx, &holes);
    return BVX_OK;
}

/* By its own lid. */
static int is_open_piece(const piece_sums *s)
{
    return s->lid >= SHEET_LID * s->area && s->kept >= SHEET_KEPT * s->area;
}

static int is_joined(const piece_sums *s)
{
    return is_open_piece(s) && s->joined > SHEET_JOINED * s->area;
}

static int is_sheet(const piece_sums *s)
{
    /* A joined piece is part of a body, whatever its lid is. */
    if (!(s->area > 0) || is_joined(s)) return 0;
    return s->lid >= SHEET_LID * s->area || ((s->open || s->rod) && s->kept < SHEET_KEPT * s->area);
}

/* Triangles of bodies that the solid misses: more voxels would find them, and a shell of voxels is thicker
 * than they are. */
static uint64_t count_thin_shelled(const all_sums *sums, double side)
{
    uint64_t count = 0;
    for (uint64_t i = 0; i < sums->count; i++) {
        piece_sums const *const s = &sums->piece[i];
        if (is_sheet(s) && s->lid < SHEET_LID * s->area && s->kept < SHEET_KEPT * s->area &&
            bvxi_absolute(s->volume) >= SHEET_THIN * side * s->area)
            count += s->triangles;
    }
    return count;
}

/* Triangles of bodies first, those of sheets last; pieces without area are
 * left out. Without sheets the body is the mesh. */
static bvx_status list_parted(bvxi_repair_job *job, const all_sums *sums)
{
    uint64_t sheet_triangles = 0, next[2];
    uint32_t c[3];

    /* Counted first: bodies from the front, sheets from where they begin. */
    job->facts.shelled_area = 0;
    for (uint64_t i = 0; i < sums->count; i++)
        if (is_sheet(&sums->piece[i])) {
            sheet_triangles += sums->piece[i].triangles;
            job->facts.shelled_area += sums->piece[i].area;
        }
    job->body = job->mesh;
    memset(&job->sheets, 0, sizeof job->sheets);
    if (sheet_triangles == 0) return BVX_OK;
    next[0] = 0;
    next[1] = job->mesh.triangle_count - sheet_triangles;
    if (job->parted == NULL)
        BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->mesh.triangle_count * 12, "the triangles of sheets",
                            &job->parted));
    bvxi_repair_view(job, job->parted + 3 * next[1], sheet_triangles, &job->sheets);
    for (uint64_t t = 0; t < job->mesh.triangle_count; t++) {
        bvxi_view_triangle(&job->mesh, t, c);
        const piece_sums *piece = sums_of(job, sums, c[0]);
        if (piece->area > 0) memcpy(job->parted + 3 * next[is_sheet(piece)]++, c, sizeof c);
    }
    bvxi_repair_view(job, job->parted, next[0], &job->body);
    return BVX_OK;
}

/* ---- Open pieces that make a body together ---- */

/* The triangles of joined pieces are to be asked again; none where a lid over all of them would be large,
 * also together with the bodies whose holes they may close. Returns how many. */
static uint64_t ask_joined_pieces(const bvxi_repair_job *job, all_sums *sums, uint8_t *answer)
{
    double all[3] = {0, 0, 0}, area = 0, p[3][3], n[3];
    uint64_t count = 0;
    piece_sums *piece;

    /* One lid over all that remain: the sum of their vectors. */
    for (uint64_t t = 0; t < job->mesh.triangle_count; t++) {
        if (answer[t] == 0) continue;
        double const length = normal_of(job, sums, t, &piece, p, n);
        answer[t] = is_joined(piece) ? BVXI_TRIANGLE_ASKED : 0;
        if (answer[t] == 0) continue;
        for (int a = 0; a < 3; a++) all[a] += 0.5 * n[a];
        area += 0.5 * length;
        count++;
    }
    if (bvxi_vec_length(all) < SHEET_LID * area) return count;

    /* Large by themselves they may still close the holes of bodies, whose vectors are the opposite, as a lid does
     * that of a pot. */
    for (uint64_t t = 0; t < job->mesh.triangle_count && count != 0; t++) {
        normal_of(job, sums, t, &piece, p, n);
        if (!piece->open || is_open_piece(piece) || is_sheet(piece)) continue;
        for (int a = 0; a < 3; a++) all[a] += 0.5 * n[a];
    }
    if (count != 0 && bvxi_vec_length(all) < SHEET_LID * area) return count;
    for (uint64_t i = 0; i < sums->count; i++) sums->piece[i].joined = 0;
    return 0;
}

/* Asked by all, then by what remains without those that turned out as sheets, until no more do. */
static bvx_status join_open_pieces(bvxi_repair_job *job, all_sums *sums)
{
    uint64_t const bytes = job->mesh.triangle_count;
    uint64_t asked, before = 0;
    uint8_t *answer;

    if (job->fill == BVX_FILL_PARITY) return BVX_OK;
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, bytes, "the open triangles", &answer));

    /* The triangles of open pieces are to be asked. Returns how many. */
    uint64_t count = 0;
    uint32_t c[3];

    for (uint64_t t = 0; t < job->mesh.triangle_count; t++) {
        bvxi_view_triangle(&job->mesh, t, c);
        answer[t] = is_open_piece(sums_of(job, sums, c[0])) ? BVXI_TRIANGLE_ASKED : 0;
        count += answer[t] != 0;
    }
    asked = count;

    /* Each round leaves out what turned out as sheets, which changes the winding number. */
    for (int round = 0; asked != 0 && asked != before; round++) {
        before = asked;
        if (round > 0) BVXI_TRY(list_parted(job, sums));
        BVXI_TRY(repair_enclosed(job, answer));
        if (round >= SHEET_ROUNDS) memset(answer, 0, (size_t)bytes);

        /* By the area of what lies on a common body's border. */
        for (uint64_t i = 0; i < sums->count; i++) sums->piece[i].joined = 0;
        for (uint64_t t = 0; t < bytes; t++) {
            double p[3][3], n[3];
            piece_sums *piece;
            if (answer[t] != BVXI_TRIANGLE_ENCLOSED) continue;
            double const length = normal_of(job, sums, t, &piece, p, n);
            piece->joined += 0.5 * length;
        }
        asked = ask_joined_pieces(job, sums, answer);
    }
    bvxi_drop(job->ctx, answer);
    return BVX_OK;
}

bvx_status bvxi_repair_part(bvxi_repair_job *job)
{
    all_sums sums;

    job->body = job->mesh;
    if (job->options->shell == 0) return BVX_OK;

    /* Number the pieces, and open their sums. */
    memset(&sums, 0, sizeof sums);
    BVXI_TRY(BVXI_ARRAY(job->ctx, job->given->vertex_count, "the pieces' numbers", sums.number));
    /* A piece is named after its least vertex. */
    for (uint64_t v = 0; v < job->given->vertex_count; v++)
        if (job->piece[v] == v) sums.number[v] = (uint32_t)sums.count++;
    BVXI_TRY(BVXI_ZEROS(job->ctx, sums.count, "the pieces' areas", sums.piece));

    double step[3];

    /* A step of one voxel of the largest spacing along each axis. */
    for (int a = 0; a < 3; a++) step[a] = bvxi_largest_spacing(&job->lattice) / job->lattice.spacing[a];
    for (uint64_t t = 0; t < job->mesh.triangle_count; t++) {
        double p[3][3], n[3];
        piece_sums *piece;
        double const length = normal_of(job, &sums, t, &piece, p, n);
        take_into_piece(piece, (const double(*)[3])p);
        if (!(length > 0)) continue;
        piece->area += 0.5 * length;
        if (has_solid_behind(&job->solid, step, (const double(*)[3])p, n, length))
            piece->kept += 0.5 * length;
    }

    find_rods(job, &sums);
    BVXI_TRY(sum_lids(job, &sums));
    BVXI_TRY(join_open_pieces(job, &sums));
    BVXI_TRY(list_parted(job, &sums));
    job->facts.thin_shelled = count_thin_shelled(&sums, bvxi_largest_spacing(&job->lattice));
    bvxi_drop(job->ctx, sums.piece);
    bvxi_drop(job->ctx, sums.number);
    job->report.shelled_triangles = job->sheets.triangle_count;
    return BVX_OK;
}

bvx_status bvxi_repair_lay_shells(bvxi_repair_job *job)
{
    double const most = bvxi_largest_spacing(&job->lattice);
    uint64_t const words = job->grid_bytes / 8, rows = bvxi_grid_rows(&job->inside);
    bvxi_nearest *nearest = NULL;
    uint64_t *first = NULL;
    bvx_grid band = job->inside;

    BVXI_TRY(bvxi_nearest_open(bvxi_call_of(job->ctx, bvxi_repair_name, "shells", 0.0, 0.3), &job->sheets,
                               &job->lattice, &nearest));
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, job->grid_bytes, "the shells", &band.words));
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, (rows + 1) * 8, "the shells' rows", &first));
    BVXI_TRY(bvxi_nearest_band(bvxi_call_of(job->ctx, NULL, "shells", 0.3, 1.0), nearest,
                               0.5 * job->options->shell * most, &band, first));
    for (uint64_t i = 0; i < words; i++) job->inside.words[i] |= band.words[i];
    return BVX_OK;
}
