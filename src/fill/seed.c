/* seed.c - a voxel inside a surface by scanning lines of voxels, and one in each pocket: bvx_find_seed,
 * bvx_find_pockets.
 *
 * Source: Chen, Qiu, Fu, Ma. Fast voxelization based on triangulated irregular network model. 2010, algorithm
 * 2 (the depth buffer's idea: a voxel between the first and the last surface voxel of its lines along x, y
 * and z), with what it lacks. Printed, its steps 4 and 3 call each other for ever, 7 and 10 may lead back to
 * a row that was tried, and a row may miss the model: here the way from the middle row has a bounded number
 * of turns, then every gap of every row is looked at, spread evenly. Hidden in six directions does not prove
 * inside: the mesh is asked (vote.c).
 * Guarantee: what is found is hidden, and inside where a mesh was given; nothing found with no limit means
 * that no gap of any row begins with such a voxel. */
#include "fill/fills.h"
#include "components/room.h"

enum { SEED_TURNS = 64 };

static const char seed_name[] = "bvx_find_seed";
static const char pockets_name[] = "bvx_find_pockets";

/* ---- Is a voxel inside the mesh? ---- */

typedef struct seed_judge {
    bvx_context *ctx;
    const char *function;
    const bvx_mesh_view *mesh; /* NULL: hidden voxels are enough */
    const bvx_grid *surface;
    bvx_grid vote; /* over the surface's window, made when first requested; words are scratch */
} seed_judge;

static bvx_status vote_for_seeds(seed_judge *j, uint64_t bytes)
{
    bvx_solid_report unused = {0};
    bvxi_solid_job job;
    uint64_t *sure = NULL;
    BVXI_TRY(bvxi_solid_open(j->ctx, j->function, j->mesh, &j->surface->lattice, &job));
    BVXI_TRY(bvxi_alloc(j->ctx, BVXI_SCRATCH, bytes, "the grid of sure centres", &sure));
    return bvxi_vote(bvxi_solid_step(j->ctx, &job, 0.1, 1.0), &job, 0, &j->vote, sure, &unused);
}

static bvx_status make_seed_vote(seed_judge *j)
{
    uint64_t const bytes = bvxi_grid_words(j->surface) * 8;
    j->vote = *j->surface;
    BVXI_TRY(bvxi_alloc(j->ctx, BVXI_SCRATCH, bytes, "the vote", &j->vote.words));
    return BVXI_SCOPE(j->ctx, vote_for_seeds(j, bytes));
}

static bvx_status check_seed_mesh(seed_judge *j)
{
    if (j->mesh == NULL) return BVX_OK;
    BVXI_TRY(bvxi_view_check(j->ctx, j->function, j->mesh));
    if (j->mesh->triangle_count != 0) return BVX_OK;
    return bvxi_fail(j->ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", j->function);
}

/* ---- Lines ---- */

/* The first empty voxel behind `from` on the line, or `until`. */
static int32_t next_gap(const bvx_grid *g, const int32_t voxel[3], int axis, int32_t from, int32_t until)
{
    int32_t p[3] = {voxel[0], voxel[1], voxel[2]};
    for (p[axis] = from; p[axis] < until && bvx_grid_get(g, p[0], p[1], p[2]);) p[axis]++;
    return p[axis];
}

typedef struct seed_search {
    const bvx_grid *surface;
    seed_judge judge;
    bvx_seed seed;
    uint64_t limit, scanned;
    int32_t voxel[3];
    int32_t low[3], size[3]; /* the surface's box */
    int done;                /* found, or out of lines */
} seed_search;

static int scan_for_seed(seed_search *s, int axis, int32_t *low, int32_t *high)
{
    const bvx_grid *const g = s->surface;
    int32_t p[3] = {s->voxel[0], s->voxel[1], s->voxel[2]};

    /* First and last set voxel of the line through the voxel; 0 when there are not two with room between them. */
    s->scanned++;
    s->seed.scans[axis]++;
    *low = 0;
    *high = g->size[axis] - 1;
    for (p[axis] = *low; *low < *high && !bvx_grid_get(g, p[0], p[1], p[2]); p[axis] = *low) ++*low;
    for (p[axis] = *high; *high > *low && !bvx_grid_get(g, p[0], p[1], p[2]); p[axis] = *high) --*high;
    return *high - *low > 1;
}

static int may_scan(seed_search *s)
{
    if (s->limit != 0 && s->scanned >= s->limit) s->done = 1;
    return !s->done;
}

/* s->voxel is hidden: ask the mesh. */
static bvx_status judge_seed(seed_search *s)
{
    if (s->judge.mesh != NULL) {
        if (s->judge.vote.words == NULL) BVXI_TRY(make_seed_vote(&s->judge));
        /* Hidden, but outside: a hollow of the outside. */
        if (!bvx_grid_get(&s->judge.vote, s->voxel[0], s->voxel[1], s->voxel[2])) {
            s->seed.refused++;
            return BVX_OK;
        }
        s->seed.verified = 1;
    }
    memcpy(s->seed.voxel, s->voxel, sizeof s->seed.voxel);
    s->seed.found = s->done = 1;
    return BVX_OK;
}

/* Is voxel between the first and the last of its lines along y and z? -1: yes; else the axis where not, with
 * the line's ends; -2 when there are no more lines. */
static int look_across(seed_search *s, int32_t *low, int32_t *high)
{
    for (int axis = 1; axis < 3; axis++) {
        if (!may_scan(s)) return -2;
        if (!scan_for_seed(s, axis, low, high)) *high = *low;
        if (s->voxel[axis] <= *low || s->voxel[axis] >= *high) return axis;
    }
    return -1;
}

/* The paper's way from the middle row: steps 2 to 10. */
static bvx_status turn_from_middle(seed_search *s)
{
    /* The middle of the box, where most lines meet the model. */
    for (int32_t a = 0; a < 3; a++) s->voxel[a] = s->low[a] + s->size[a] / 2;
    s->seed.starts++;
    for (int32_t turn = 0; turn < SEED_TURNS && may_scan(s); turn++) {
        int32_t low, high;
        /* The middle row may miss the model. */
        if (!scan_for_seed(s, 0, &low, &high)) return BVX_OK;
        s->voxel[0] = next_gap(s->surface, s->voxel, 0, low, high);
        if (s->voxel[0] >= high) return BVX_OK;
        int const across = look_across(s, &low, &high);
        if (across == -1) return judge_seed(s);
        /* The line has no room between its ends. */
        if (across == -2 || high - low < 2) return BVX_OK;
        /* On along the line that it was not hidden on. */
        s->voxel[across] = next_gap(s->surface, s->voxel, across, low, high);
        if (s->voxel[across] >= high) return BVX_OK;
    }
    return BVX_OK;
}

/* All gaps of the row through s->voxel. */
static bvx_status look_at_gaps(seed_search *s)
{
    int32_t first, last, low, high;

    s->seed.starts++;
    if (!scan_for_seed(s, 0, &first, &last)) return BVX_OK;
    s->voxel[0] = first;

    while (!s->done) {
        int32_t const row[3] = {s->voxel[0], s->voxel[1], s->voxel[2]};
        s->voxel[0] = next_gap(s->surface, row, 0, s->voxel[0], last);
        if (s->voxel[0] >= last) return BVX_OK;
        if (look_across(s, &low, &high) == -1) BVXI_TRY(judge_seed(s));
        /* last ends it */
        while (!s->done && !bvx_grid_get(s->surface, s->voxel[0], s->voxel[1], s->voxel[2])) s->voxel[0]++;
    }
    return BVX_OK;
}

/* Every row of the box, far from each other at first: steps of about 0.618 of all, without a common
 * factor. */
static bvx_status look_at_rows(bvx_context *ctx, seed_search *s)
{
    uint64_t const rows = (uint64_t)s->size[1] * (uint64_t)s->size[2];
    uint64_t stride = rows / 8 * 5 + 1, at = rows / 2;

    for (;; stride++) {
        uint64_t a = rows, b = stride;
        while (b != 0) {
            uint64_t const r = a % b;
            a = b;
            b = r;
        }
        if (a == 1) break;
    }
    for (uint64_t n = 0; n < rows && may_scan(s); n++) {
        if (n % 4096 == 0) BVXI_TRY(bvxi_progress(ctx, "seed", (double)n / (double)rows));
        s->voxel[1] = s->low[1] + (int32_t)(at % (uint64_t)s->size[1]);
        s->voxel[2] = s->low[2] + (int32_t)(at / (uint64_t)s->size[1]);
        s->voxel[0] = 0;
        BVXI_TRY(look_at_gaps(s));
        at = (at + stride) % rows;
    }
    return BVX_OK;
}

/* The surface's box; 0 when it has no voxels. */
static int find_seed_box(seed_search *s)
{
    const bvx_grid *const g = s->surface;
    int32_t high[3] = {-1, -1, -1};

    /* From beyond both ends, so that the first voxel sets them. */
    for (int a = 0; a < 3; a++) s->low[a] = g->size[a];
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++) {
            bvxi_row_runs runs;
            int32_t begin, end, least = -1, most = 0;
            bvxi_row_runs_start(&runs, bvxi_grid_row(g, y, z), g->size[0], 0);
            /* A row's first and last run are its ends. */
            while (bvxi_row_runs_next(&runs, &begin, &end)) {
                if (least < 0) least = begin;
                most = end - 1;
            }
            if (least < 0) continue;
            s->low[0] = least < s->low[0] ? least : s->low[0];
            high[0] = most > high[0] ? most : high[0];
            s->low[1] = y < s->low[1] ? y : s->low[1];
            high[1] = y > high[1] ? y : high[1];
            s->low[2] = z < s->low[2] ? z : s->low[2];
            high[2] = z;
        }
    for (int a = 0; a < 3; a++) s->size[a] = high[a] - s->low[a] + 1;
    return high[2] >= 0;
}

static bvx_status run_find_seed(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                                uint64_t limit, bvx_seed *seed)
{
    seed_search s = {0};

    if (seed == NULL) return bvxi_fail_null(context, seed_name, "seed");
    BVXI_TRY(bvxi_grid_check(context, seed_name, surface));
    s.surface = s.judge.surface = surface;
    s.judge.ctx = context;
    s.judge.function = seed_name;
    s.judge.mesh = mesh;
    s.limit = limit;
    BVXI_TRY(check_seed_mesh(&s.judge));
    if (find_seed_box(&s)) {
        /* The paper's way first, as it takes a few lines only. */
        BVXI_TRY(turn_from_middle(&s));
        if (!s.done) BVXI_TRY(look_at_rows(context, &s));
    }
    *seed = s.seed;
    return BVX_OK;
}

bvx_status bvx_find_seed(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                         uint64_t limit, bvx_seed *seed)
{
    return BVXI_CALL(context, run_find_seed(context, surface, mesh, limit, seed));
}

/* ---- Pockets ---- */

typedef struct pocket_work {
    const seed_judge *judge;
    uint8_t *outside; /* by space: touches a side; when the mesh is asked: its least voxel is outside */
    uint64_t seen, count, capacity;
    int32_t *seeds;
} pocket_work;

static void judge_pocket(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    pocket_work *const w = user;
    if (w->judge->mesh == NULL) {
        if (bvxi_spaces_at_side(w->judge->surface, begin, end, y, z)) w->outside[space] = 1;
    } else if (space == w->seen) { /* spaces are numbered as they come */
        w->seen++;
        w->outside[space] = !bvx_grid_get(&w->judge->vote, begin, y, z);
    }
}

static void give_pocket(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    pocket_work *const w = user;

    (void)end;
    if (space != w->seen) return;
    w->seen++;
    if (w->outside[space]) return;
    if (w->count < w->capacity) {
        w->seeds[3 * w->count] = begin;
        w->seeds[3 * w->count + 1] = y;
        w->seeds[3 * w->count + 2] = z;
    }
    w->count++;
}

static bvx_status run_find_pockets(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                                   int32_t *seeds, uint64_t capacity, uint64_t *count)
{
    seed_judge judge = {.ctx = context, .function = pockets_name, .mesh = mesh, .surface = surface};
    pocket_work work = {&judge, NULL, 0, 0, seeds != NULL ? capacity : 0, seeds};
    bvxi_spaces spaces;

    if (count == NULL) return bvxi_fail_null(context, pockets_name, "count");
    BVXI_TRY(bvxi_grid_check(context, pockets_name, surface));
    BVXI_TRY(check_seed_mesh(&judge));
    if (mesh != NULL) BVXI_TRY(make_seed_vote(&judge));
    BVXI_TRY(bvxi_spaces_open(context, pockets_name, "pockets", surface, 1, BVXI_CONNECT_6, &spaces));
    BVXI_TRY(bvxi_alloc_zero(context, BVXI_SCRATCH, spaces.count, "the pockets' sides", &work.outside));
    bvxi_spaces_each(&spaces, judge_pocket, &work);
    work.seen = 0;
    bvxi_spaces_each(&spaces, give_pocket, &work);
    *count = work.count;
    if (seeds != NULL && work.count > capacity)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: there are %u pockets, the array given holds %u",
                         pockets_name, work.count, capacity);
    return BVX_OK;
}

bvx_status bvx_find_pockets(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                            int32_t *seeds, uint64_t capacity, uint64_t *count)
{
    return BVXI_CALL(context, run_find_pockets(context, surface, mesh, seeds, capacity, count));
}
