/* thicken.c - walls of a closed body that are thinner than the lattice can hold: widened until it does.
 *
 * thin_walls.c says where they are. Centres beside them go inside up to half of what the wall lacks; what is
 * lost still, at the ends and corners of walls, goes inside itself. The surface of such a wall is then
 * measured off the mesh, and flatten.c puts it back.
 * Guarantee: the result follows from the mesh and the lattice only. Cost: the surface, and closest points at
 * thin places. */
#include "pipeline/thicken.h"

#include "pipeline/steps.h"

#define THIN_BESIDE 0.75  /* how far off a wall centres go inside [Units: largest spacings] */
#define THIN_BEYOND 0.05f /* a surface lies beyond the centres that it has inside */

enum { THIN_CRUMB = 8, THIN_MENDS = 4 };

typedef struct thin_job {
    bvxi_walls *walls;
    bvx_grid *inside;
    bvxi_thin *thin;
} thin_job;

/* ---- Walls made thicker ---- */

/* Outside centres around the set ones. */
static void widen_places(thin_job *t)
{
    const bvx_grid *const g = &t->walls->places;

    for (uint64_t n = 0; n < t->walls->count; n++) {
        int32_t at[3], low[3], high[3];

        if (t->walls->point[n].wall == BVXI_NO_WALL) continue;
        bvxi_bit_centre(g, t->walls->at[n], at);
        /* The places' neighbours, cut to the window. */
        for (int a = 0; a < 3; a++) {
            low[a] = at[a] > 0 ? at[a] - 1 : 0;
            high[a] = at[a] + 1 < g->size[a] ? at[a] + 1 : at[a];
        }
        for (int32_t z = low[2]; z <= high[2]; z++)
            for (int32_t y = low[1]; y <= high[1]; y++)
                for (int32_t x = low[0]; x <= high[0]; x++) {
                    uint64_t const bit = bvxi_centre_bit(g, x, y, z);
                    g->words[bit / 64] |= UINT64_C(1) << (bit & 63);
                }
    }
    /* Centres inside already need no place. */
    for (uint64_t i = 0; i < t->walls->bytes / 8; i++) g->words[i] &= ~t->inside->words[i];
}

static float thin_reach_of(const bvxi_wall *p)
{
    return p->wall == BVXI_NO_WALL ? 0.0f : (float)((BVXI_THIN_WALL - (double)p->wall) * 0.5);
}

/* Set centres that hang together across faces, from one on, until there are THIN_CRUMB or one of them is not
 * of the list of places: then it is no crumb. Returns how many, or 0. */
static int gather_crumb(const thin_job *t, uint64_t from, uint64_t found[THIN_CRUMB])
{
    const bvx_grid *const g = t->inside;
    int count = 1;

    found[0] = from;
    for (int n = 0; n < count; n++) {
        int32_t at[3];

        if ((t->walls->places.words[found[n] / 64] >> (found[n] & 63) & 1) == 0) return 0;
        bvxi_bit_centre(g, found[n], at);
        for (int side = 0; side < 6; side++) {
            int32_t to[3] = {at[0], at[1], at[2]};
            int known = 0;

            to[side / 2] += side % 2 * 2 - 1;
            if (to[side / 2] < 0 || to[side / 2] >= g->size[side / 2] ||
                !bvx_grid_get(g, to[0], to[1], to[2]))
                continue;
            uint64_t const bit = bvxi_centre_bit(g, to[0], to[1], to[2]);
            for (int k = 0; k < count; k++) known |= found[k] == bit;
            if (known) continue;
            if (count == THIN_CRUMB) return 0;
            found[count++] = bit;
        }
    }
    return count;
}

/* A few centres that reach neither the solid nor a wall of any size are no wall. */
static void drop_thin_crumbs(thin_job *t)
{
    uint64_t found[THIN_CRUMB];
    for (uint64_t n = 0; n < t->walls->count; n++) {
        if ((t->inside->words[t->walls->at[n] / 64] >> (t->walls->at[n] & 63) & 1) == 0) continue;
        int const count = gather_crumb(t, t->walls->at[n], found);
        for (int k = 0; k < count; k++) t->inside->words[found[k] / 64] &= ~(UINT64_C(1) << (found[k] & 63));
    }
}

/* What is lost still, at the ends and corners of walls, goes inside itself
 * and joins the centres of near. *more: 1 when there was any. */
static bvx_status mend_walls(thin_job *t, uint64_t *near, int *more)
{
    *more = 0;
    /* What the widened solid loses, near the walls only. */
    BVXI_TRY(BVXI_SHARE(t->walls->ctx, 0.0, 0.5, bvxi_walls_mark(t->walls)));
    for (uint64_t n = 0; n < t->walls->bytes / 8; n++) t->walls->places.words[n] &= near[n];
    BVXI_TRY(bvxi_walls_list(t->walls));
    if (t->walls->count == 0) return BVX_OK;
    BVXI_TRY(BVXI_SHARE(t->walls->ctx, 0.5, 1.0, bvxi_walls_ask(t->walls, 1.0)));
    for (uint64_t n = 0; n < t->walls->count; n++) {
        uint64_t const bit = UINT64_C(1) << (t->walls->at[n] & 63);
        if (t->walls->point[n].wall == BVXI_NO_WALL) continue;
        t->inside->words[t->walls->at[n] / 64] |= bit;
        *more = 1;
    }
    return BVX_OK;
}

/* What the surface of the centres beside the walls is to be measured with. */
static bvx_status keep_reach(thin_job *t)
{
    bvxi_sparse *const near = &t->thin->near;

    near->where = t->walls->places;
    t->walls->places.words = NULL;
    BVXI_TRY(bvxi_sparse_rank(t->walls->ctx, near));
    BVXI_TRY(bvxi_sparse_columns(t->walls->ctx, near, BVX_F32, BVXI_DISTANCES));
    for (uint64_t n = 0; n < t->walls->count; n++) {
        const bvxi_wall *const p = &t->walls->point[n];
        int const inside = (int)(t->inside->words[t->walls->at[n] / 64] >> (t->walls->at[n] & 63) & 1);
        float reach = thin_reach_of(p);

        /* A centre inside must lie within its reach, or the surface would pass on its wrong side. */
        if (inside && reach <= p->distance) reach = p->distance + THIN_BEYOND;
        ((float *)near->distances)[n] = p->sheet ? -reach : reach;
    }
    return BVX_OK;
}

/* Mend until nothing is lost; *mended: 1 when centres went inside that may
 * lie beyond the reach of their wall. */
static bvx_status mend_all(thin_job *t, uint64_t *near, int *mended)
{
    const bvx_mesh_view *const mesh = t->walls->mesh;
    bvx_mesh_view beside;
    uint32_t *corner;
    int more = 1;

    t->walls->unsummed = 1; /* of the solid as it was beyond is known */
    /* What a centre of near may lose is half a voxel off it: no other triangle can mark it. */
    BVXI_TRY(bvxi_triangles_near(t->walls->ctx, mesh, t->walls->cells, &t->walls->places, t->walls->unit, 0,
                                 &beside, &corner));
    if (beside.triangle_count != 0) t->walls->mesh = &beside;
    *mended = 0;
    for (int round = 0; more && round < THIN_MENDS; round++) {
        BVXI_TRY(BVXI_SHARE(t->walls->ctx, 0.4 + 0.1 * round, 0.5 + 0.1 * round, mend_walls(t, near, &more)));
        *mended |= more;
    }
    t->walls->mesh = mesh;
    bvxi_drop(t->walls->ctx, corner);
    memcpy(t->walls->places.words, near, (size_t)t->walls->bytes);
    return BVX_OK;
}

/* The walls of the list of seeds. */
static bvx_status widen(thin_job *t)
{
    double const reach = BVXI_WALL_REACH + BVXI_WALL_BESIDE;
    uint64_t *near;
    int mended = 0;

    /* From here on only what lies around the walls matters; most places had none. A search for walls that stand on
     * other parts reaches further still. */
    BVXI_TRY(bvxi_walls_near(t->walls, t->walls->parts ? reach + BVXI_WALL_BESIDE : reach));
    if (t->walls->parts)
        BVXI_TRY(bvxi_triangles_near(t->walls->ctx, &t->walls->near, NULL, &t->walls->places,
                                     reach * t->walls->unit, 1, &t->thin->mesh, &t->thin->corner));
    widen_places(t);
    BVXI_TRY(bvxi_walls_list(t->walls));
    BVXI_TRY(BVXI_SHARE(t->walls->ctx, 0.0, 0.4, bvxi_walls_ask(t->walls, THIN_BESIDE)));
    for (uint64_t n = 0; n < t->walls->count; n++)
        if (t->walls->point[n].distance < thin_reach_of(&t->walls->point[n]))
            t->inside->words[t->walls->at[n] / 64] |= UINT64_C(1) << (t->walls->at[n] & 63);

    BVXI_TRY(
        bvxi_alloc(t->walls->ctx, BVXI_SCRATCH, t->walls->bytes, "the centres beside thin walls", &near));
    memcpy(near, t->walls->places.words, (size_t)t->walls->bytes);

    /* The answers for all centres are kept while mending asks for some. */
    bvxi_walls asked = *t->walls;
    t->walls->at = NULL;
    t->walls->point = NULL;
    t->walls->count = 0;
    bvx_status const status = mend_all(t, near, &mended);
    bvxi_drop(t->walls->ctx, near);

    /* Without that, the first answers are still those of all centres. */
    bvxi_walls_drop(mended ? &asked : t->walls);
    if (!mended) {
        t->walls->at = asked.at;
        t->walls->point = asked.point;
        t->walls->count = asked.count;
    }
    if (status != BVX_OK) return status;
    if (mended) BVXI_TRY(bvxi_walls_list(t->walls));
    if (mended) BVXI_TRY(BVXI_SHARE(t->walls->ctx, 0.8, 1.0, bvxi_walls_ask(t->walls, 1.0)));
    drop_thin_crumbs(t);
    return keep_reach(t);
}

bvx_status bvxi_thicken(bvxi_walls *walls, bvx_grid *inside, bvxi_thin *thin)
{
    thin_job t = {.walls = walls, .inside = inside, .thin = thin};
    BVXI_TRY(widen(&t));
    if (thin->corner != NULL) return BVX_OK;
    /* The triangles that were asked go on to the surface, as the centres have. */
    thin->corner = walls->corner;
    thin->mesh = walls->near;
    walls->corner = NULL;
    return BVX_OK;
}

/* ---- The surface of thickened walls ---- */

void bvxi_thin_value(double thick, double vector[3], double *distance)
{
    double const d = *distance, scale = d > 0 ? (d - thick) / d : 0;
    for (int a = 0; a < 3; a++) vector[a] *= scale;
    *distance = d - thick;
}

void bvxi_thin_values(const bvxi_thin *thin, const bvxi_sparse *values)
{
    const bvx_grid *const where = &values->where;
    const uint64_t *const beside = thin->near.where.words;
    const float *const reaches = thin->near.distances;
    double *const vectors = values->vectors, *const distances = values->distances;
    size_t const words = (size_t)where->words_per_row, rows = (size_t)bvxi_grid_rows(where);
    double const unit = bvxi_largest_spacing(&where->lattice);

    for (size_t i = 0; beside != NULL && i < words * rows; i++) {
        uint64_t n = values->first[i / words], m = thin->near.first[i / words];

        if ((where->words[i] & beside[i]) == 0) continue;
        for (size_t k = i - i % words; k < i; k++) {
            n += bvxi_popcount(where->words[k]);
            m += bvxi_popcount(beside[k]);
        }
        for (uint64_t bits = where->words[i]; bits != 0; bits &= bits - 1, n++) {
            uint64_t const bit = bits & (~bits + 1);
            if ((beside[i] & bit) == 0) continue;
            double const reach = reaches[m + bvxi_popcount(beside[i] & (bit - 1))];
            bvxi_thin_value((reach < 0 ? -reach : reach) * unit, vectors + 3 * n, &distances[n]);
        }
    }
}
