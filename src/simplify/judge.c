/* judge.c - a level without crossings that the mesh did not have: what makes them is undone by name.
 *
 * Collapses go without a look at what is near. Then the level is searched once for pairs of triangles that
 * cross. A pair has come with the mesh where triangles crossed whose vertices went into its own; of every
 * other one the last collapse that changed it is undone, with those after it that build on it, until none is
 * left. Vertices beside what was undone are held, so that other edges go in its place.
 *
 * Guarantee: no pair of triangles crosses but beside those that the mesh had. */
#include "core/vec3.h"
#include "mesh/cross.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

enum {
    JUDGE_GRAIN = 1024, /* vertices of a task */
    FAN_HELD = 16       /* triangles */
};

/* Sines and cosines that rounding does not bring to the other side of 0. */
#define FAN_SINE 1e-9

/* ---- Fans ---- */

/* A walk around a vertex, counter-clockwise, from its border on where it has one; so many triangles at a time. */
typedef struct fan_walk {
    const bvxi_corners *m;
    const double *p;
    int32_t start, at;
    int open;                    /* 1: it begins and ends at a border */
    int count, last;             /* triangles that are held; 1: no more follow */
    double way[3][FAN_HELD + 1]; /* to their neighbours: triangle i has those of i and i + 1 */
    double n[3][FAN_HELD];       /* their normals */
    double square[FAN_HELD + 1]; /* of the ways */
} fan_walk;

BVXI_VECTOR_INLINE void fan_neighbour(fan_walk *w, int32_t corner, int i)
{
    const double *const q = w->m->at[bvxi_corner_vertex_of(w->m, corner)].p;
    for (int k = 0; k < 3; k++) w->way[k][i] = q[k] - w->p[k];
}

/* Hold the next triangles; begin 1: the first ones. */
static void fan_hold(fan_walk *w, int begin)
{
    if (begin) {
        w->at = w->start;
        fan_neighbour(w, bvxi_corner_next(w->at), 0);
    }
    for (int k = 0; k < 3 && !begin; k++) w->way[k][0] = w->way[k][w->count];
    w->count = 0;
    do {
        fan_neighbour(w, bvxi_corner_previous(w->at), ++w->count);
        w->at = bvxi_corner_turn_left(w->m, w->at);
        w->last = w->at == w->start || bvxi_corner_is_ghost(w->m, w->at);
    } while (!w->last && w->count < FAN_HELD);

    for (int i = 0; i <= w->count; i++) {
        double const x = w->way[0][i], y = w->way[1][i], z = w->way[2][i];

        w->square[i] = x * x + y * y + z * z;
    }
    for (int i = 0; i < w->count; i++) {
        double const u[3] = {w->way[0][i], w->way[1][i], w->way[2][i]};
        double const v[3] = {w->way[0][i + 1], w->way[1][i + 1], w->way[2][i + 1]};

        for (int k = 0; k < 3; k++)
            w->n[k][i] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    }
}

static void fan_open(const bvxi_corners *m, uint32_t v, int32_t any, fan_walk *w)
{
    w->m = m;
    w->p = m->at[v].p;
    w->start = any;
    w->open = 0;
    if (m->ghosts == 0) return;
    for (int32_t at = any;;) {
        int const ghost = bvxi_corner_is_ghost(m, at);

        at = bvxi_corner_turn_left(m, at);
        if (ghost && !bvxi_corner_is_ghost(m, at)) {
            w->open = 1;
            w->start = at;
            return;
        }
        if (at == any) return;
    }
}

/* Seen along the sum of their normals all triangles face one way, and go around the vertex once, or less where
 * they begin and end at a border: then no two of them meet beside their common edges. */
static int is_graph(const bvxi_corners *m, uint32_t v, int32_t any)
{
    double sum[3] = {0, 0, 0}, first[3], left[3], sum_square, left_square;
    int changes = 0, side_before = 1, holds = 0;
    fan_walk w;

    fan_open(m, v, any, &w);
    do {
        fan_hold(&w, holds++ == 0);
        for (int i = 0; i < w.count; i++)
            for (int k = 0; k < 3; k++) sum[k] += w.n[k][i];
        for (int k = 0; k < 3 && holds == 1; k++) first[k] = w.way[k][0];
    } while (!w.last);
    sum_square = bvxi_vec_dot(sum, sum);

    /* Each triangle turns left by less than half a turn. A fan that goes around once is first to the left of its
     * first edge, then to the right: one change. One that ends at a border may end anywhere before it comes to its
     * first edge. What lies on that line within rounding tells nothing. */
    bvxi_vec_cross(sum, first, left);
    left_square = bvxi_vec_dot(left, left);
    for (int begin = 1; begin || !w.last; begin = 0) {
        if (holds > 1) fan_hold(&w, begin);
        for (int i = 0; i < w.count; i++) {
            double const n[3] = {w.n[0][i], w.n[1][i], w.n[2][i]};
            double const next[3] = {w.way[0][i + 1], w.way[1][i + 1], w.way[2][i + 1]};
            double const along = bvxi_vec_dot(n, sum), side = bvxi_vec_dot(next, left);
            double const least = FAN_SINE * FAN_SINE * sum_square * w.square[i] * w.square[i + 1];

            if (!((along > 0) & (along * along > least))) return 0;
            if (BVXI_UNLIKELY(side * side < FAN_SINE * FAN_SINE * w.square[i + 1] * left_square)) {
                if (w.open && bvxi_vec_dot(next, first) > 0) return 0;
                continue;
            }
            changes += (side > 0) != side_before;
            side_before = side > 0;
        }
    }
    return w.open ? changes <= 1 : changes == 1 && !side_before;
}

/* ---- The level's boxes ---- */

typedef struct judge_level {
    const bvxi_collapse *c;
    uint8_t *graph;
} judge_level;

static void fans_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const judge_level *const l = user;
    const bvxi_collapse *const c = l->c;
    (void)piece;
    for (uint64_t v = begin; v < end; v++)
        if (!bvxi_collapse_is_gone(c, (uint32_t)v))
            l->graph[v] = (uint8_t)is_graph(&c->mesh, (uint32_t)v, c->any[v]);
}

void bvxi_collapse_end_careful(bvxi_collapse *c)
{
    bvxi_drop(c->ctx, c->tree.node[0]);
    c->tree.node[0] = NULL;
}

/* Boxes over the mesh as it is, for collapses that are looked at one by one. */
static bvx_status open_tree(bvxi_collapse *c, const uint32_t *live, uint64_t triangles)
{
    c->tree.at = c->mesh.at[0].p;
    c->tree.vertex = c->mesh.triangle[0].vertex;
    c->tree.at_step = sizeof *c->mesh.at / sizeof *c->tree.at;
    c->tree.vertex_step = sizeof *c->mesh.triangle / sizeof *c->tree.vertex;
    c->tree.live = live;
    c->tree.triangles = triangles;
    /* While as many triangles are gone as there are, memory is to be had for it. */
    c->tree.slanted = live != NULL && 2 * triangles <= c->mesh.triangles;
    c->tree.scale = c->scale;
    memcpy(c->tree.low, c->low, sizeof c->low);
    return bvxi_crossing_tree_open(c->ctx, &c->tree);
}

/* Pairs of the level that cross, with a fresh vertex unless that is NULL. */
static bvx_status search_level(bvxi_collapse *c, const uint8_t *fresh, double from, double to)
{
    judge_level l = {.c = c};
    uint64_t count = 0;
    uint32_t *live;

    bvxi_drop(c->ctx, c->pairs);
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->mesh.vertices, "the level's fans", &l.graph));
    bvxi_ranges(c->ctx, bvxi_piece_count(c->mesh.vertices, JUDGE_GRAIN), c->mesh.vertices, fans_piece, &l);
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->mesh.left * 4, "the level's triangles", &live));
    for (uint64_t t = 0; t < c->mesh.triangles; t++)
        if (!bvxi_triangle_gone(&c->mesh.triangle[t])) live[count++] = (uint32_t)t;
    BVXI_TRY(open_tree(c, live, count));
    c->tree.graph = l.graph;
    c->tree.fresh = fresh;
    BVXI_TRY(bvxi_crossings_find(c->ctx, &c->tree, from, to, UINT64_MAX, &c->pairs, &c->crossings));
    bvxi_collapse_end_careful(c);
    c->tree.graph = c->tree.fresh = NULL;
    bvxi_drop(c->ctx, live);
    bvxi_drop(c->ctx, l.graph);
    return BVX_OK;
}

/* 1: one of both triangles has changed. */
static int is_fresh_pair(const bvxi_collapse *c, const uint32_t *pair)
{
    int fresh = 0;
    for (int k = 0; k < 6; k++) fresh |= c->fresh[c->mesh.triangle[pair[k > 2]].vertex[k % 3]];
    return fresh;
}

/* ---- What has come with the mesh ---- */

/* The mesh's triangles whose vertices went into those of crossing ones, as a mesh of its own. */
typedef struct judge_origin {
    const bvxi_collapse *c;
    uint8_t *beside;                  /* of each vertex: of a crossing triangle */
    uint8_t *near;                    /* of each vertex of the mesh: it went into one that is beside */
    uint32_t *small;                  /* of each vertex of the mesh: its number in the small one */
    uint64_t begin[BVXI_MOST_PIECES]; /* of each piece's triangles */
    uint32_t (*triangle)[3], *part;   /* of the small mesh, and the vertices that its own went into */
    double (*at)[3];
    uint8_t *open; /* of its vertices: beside crossings, and has not come */
    uint64_t vertices;
    crossing_tree tree;
} judge_origin;

static void near_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const judge_origin *const o = user;
    (void)piece;
    for (uint64_t v = begin; v < end; v++) {
        o->near[v] = o->beside[bvxi_collapse_now(o->c, (uint32_t)v)];
        o->small[v] = BVXI_VERTEX_NONE;
    }
}

/* Count the piece's triangles with a vertex that is near, or write them from where the piece begins. */
static void origin_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    judge_origin *const o = user;
    uint64_t n = o->begin[piece];

    for (uint64_t t = begin; t < end; t++) {
        const uint32_t *const v = o->c->origin + 3 * t;

        if ((o->near[v[0]] | o->near[v[1]] | o->near[v[2]]) == 0) continue;
        if (o->triangle != NULL) memcpy(o->triangle[n], v, sizeof *o->triangle);
        n++;
    }
    o->begin[piece] = n;
}

static bvx_status gather_origin(bvxi_collapse *c, judge_origin *o)
{
    uint32_t *from;

    /* The triangles, by the vertices of the mesh. */
    int32_t const pieces = bvxi_piece_count(c->first_triangles, JUDGE_GRAIN);
    bvxi_ranges(c->ctx, pieces, c->first_triangles, origin_piece, o);
    o->tree.triangles = bvxi_place_counts(o->begin, (uint64_t)pieces);
    BVXI_TRY(BVXI_ARRAY(c->ctx, o->tree.triangles, "triangles beside crossings", o->triangle));
    bvxi_ranges(c->ctx, pieces, c->first_triangles, origin_piece, o);
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, o->tree.triangles * 12, "vertices beside crossings", &from));
    for (uint64_t i = 0; i < 3 * o->tree.triangles; i++) {
        uint32_t *const v = &o->triangle[i / 3][i % 3], *const small = &o->small[*v];

        if (*small == BVXI_VERTEX_NONE) {
            from[o->vertices] = *v;
            *small = (uint32_t)o->vertices++;
        }
        *v = *small;
    }
    BVXI_TRY(BVXI_ARRAY(c->ctx, o->vertices, "positions beside crossings", o->at));
    BVXI_TRY(BVXI_ARRAY(c->ctx, o->vertices, "vertices beside crossings", o->open));
    for (uint64_t i = 0; i < o->vertices; i++) {
        double p[3];

        bvxi_view_position(c->view, c->first_source[from[i]], p);
        for (int k = 0; k < 3; k++) o->at[i][k] = bvxi_collapse_rounded(c, p[k]);
        from[i] = bvxi_collapse_now(c, from[i]);
        o->open[i] = o->beside[from[i]] > c->came[from[i]];
    }
    o->part = from;
    o->tree.at = o->at[0];
    o->tree.vertex = o->triangle[0];
    o->tree.at_step = o->tree.vertex_step = 3;
    o->tree.slanted = 1;
    o->tree.scale = c->scale;
    o->tree.fresh = o->open;
    memcpy(o->tree.low, c->low, sizeof c->low);
    return bvxi_crossing_tree_open(c->ctx, &o->tree);
}

/* 1 where triangles of the mesh crossed that are part of this one. */
static int has_come(const bvxi_collapse *c, uint32_t triangle)
{
    const uint32_t *const v = c->mesh.triangle[triangle].vertex;
    return c->came != NULL && (c->came[v[0]] | c->came[v[1]] | c->came[v[2]]) != 0;
}

/* Mark the vertices of triangles that crossed in the mesh, near the crossing pairs of the level. */
static bvx_status mark_origin(bvxi_collapse *c, double at)
{
    const bvxi_corners *const m = &c->mesh;
    judge_origin o = {.c = c};
    uint32_t *pairs;
    uint64_t count;

    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->first_vertices * 5, "vertices that went", &o.small));
    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, m->vertices, "vertices of crossings", &o.beside));
    o.near = (uint8_t *)(o.small + c->first_vertices);
    for (uint64_t i = 0; i < c->crossings; i++) {
        const uint32_t *const pair = c->pairs + 2 * i;

        /* Where both have come already nothing else is to be found. */
        if (!is_fresh_pair(c, pair) || (has_come(c, pair[0]) && has_come(c, pair[1]))) continue;
        for (int k = 0; k < 6; k++) o.beside[m->triangle[pair[k % 2]].vertex[k / 2]] = 1;
    }
    bvxi_ranges(c->ctx, bvxi_piece_count(c->first_vertices, JUDGE_GRAIN), c->first_vertices, near_piece, &o);
    BVXI_TRY(gather_origin(c, &o));
    BVXI_TRY(bvxi_crossings_find(c->ctx, &o.tree, at, at, UINT64_MAX, &pairs, &count));
    for (uint64_t i = 0; i < 6 * count; i++) c->came[o.part[o.triangle[pairs[i / 3]][i % 3]]] = 1;
    return BVX_OK;
}

/* ---- Collapses one by one ---- */

int bvxi_collapse_crosses(const bvxi_collapse *c, uint32_t u, uint32_t v, const uint32_t *link, int32_t count,
                          const double *p)
{
    const bvxi_corner_vertex *const at = c->mesh.at;
    int came = 0;

    for (int32_t i = 0; i < count && c->came != NULL; i++)
        came |= link[i] != BVXI_VERTEX_GHOST && c->came[link[i]] != 0;
    if (c->came != NULL) came |= (c->came[u] | c->came[v]) != 0;

    for (int32_t i = 0; i < count; i++) {
        const double *a[3] = {p, NULL, NULL};

        if (link[i] == BVXI_VERTEX_GHOST || link[i + 1] == BVXI_VERTEX_GHOST) continue;
        a[1] = at[link[i]].p;
        a[2] = at[link[i + 1]].p;
        /* Where triangles crossed in the mesh they may go on. */
        if (bvxi_crossing_tree_visit(&c->tree, a, u, v, came ? c->came : NULL, NULL, NULL, NULL)) return 1;

        for (int32_t j = 0; j < i && !came; j++) {
            const double *b[3] = {p, NULL, NULL};

            if (link[j] == BVXI_VERTEX_GHOST || link[j + 1] == BVXI_VERTEX_GHOST) continue;
            b[1] = at[link[j]].p;
            b[2] = at[link[j + 1]].p;
            if (bvxi_triangles_cross(a, b)) return 1;
        }
    }
    return bvxi_collapse_fan_leaves(c, link, count, p);
}

/* ---- Undoing ---- */

/* Pairs that are still to be looked at. */
typedef struct judge_found {
    bvxi_collapse *c;
    uint32_t *pair;
    uint64_t count, capacity;
    uint32_t triangle; /* whose partners are being listed */
    uint32_t hint;
    int settled; /* 1: vertices have moved that go back first */
    bvx_status status;
} judge_found;

/* Of the same triangle twice: one that leaves what the level encloses. */
static int add_pair(void *user, uint32_t t)
{
    judge_found *const list = user;
    /* What failed once is not covered by what follows. */
    if (list->status != BVX_OK) return 1;
    list->status = BVXI_GROW_BY(list->c, list->pair, list->count, list->capacity, 8, "crossing pairs");
    if (list->status != BVX_OK) return 1;
    list->pair[2 * list->count] = list->triangle;
    list->pair[2 * list->count + 1] = t;
    list->count++;
    return 0;
}

enum { FRESH_LOOKED = 2 }; /* in place of 1: changed, and looked at since */

/* The triangles around a vertex that is back where it was: their boxes, or what they cross, once for all of these
 * vertices that they have. */
static void look_around(judge_found *list, uint32_t v, int boxes)
{
    bvxi_collapse *const c = list->c;
    const bvxi_corners *const m = &c->mesh;
    uint32_t const graph = !boxes && is_graph(m, v, c->any[v]) ? v : BVXI_VERTEX_NONE;
    int32_t at = c->any[v];

    do {
        uint32_t const t = (uint32_t)at >> 2, *const w = m->triangle[t].vertex;
        int first = t < m->triangles;

        at = bvxi_corner_turn_left(m, at);
        for (int k = 0; k < 3 && first; k++) first = w[k] >= v || c->fresh[w[k]] != 1;
        if (first && boxes) {
            bvxi_crossing_tree_move(&c->tree, t);
        } else if (first) {
            const double *const p[3] = {m->at[w[0]].p, m->at[w[1]].p, m->at[w[2]].p};
            /* Of two that no collapse has changed none can be undone. */
            int const still = !list->settled &&
                              (c->last[w[0]] & c->last[w[1]] & c->last[w[2]]) == BVXI_VERTEX_NONE;

            list->triangle = t;
            if (!still && bvxi_collapse_leaves(c, t, &list->hint)) add_pair(list, t);
            bvxi_crossing_tree_visit(&c->tree, p, graph, BVXI_VERTEX_NONE, has_come(c, t) ? c->came : NULL,
                                     still ? c->last : NULL, add_pair, list);
        }
    } while (at != c->any[v]);
}

/* What the vertices cross that are back since the last look. */
static bvx_status look_at_undone(judge_found *list)
{
    bvxi_collapse *const c = list->c;
    int boxes = c->tree.node[0] != NULL;
    if (!boxes) BVXI_TRY(open_tree(c, NULL, c->mesh.triangles));
    for (; boxes >= 0; boxes--)
        for (uint32_t v = 0; v < c->mesh.vertices; v++)
            if (c->fresh[v] == 1 && !bvxi_collapse_is_gone(c, v)) look_around(list, v, boxes);
    for (uint32_t v = 0; v < c->mesh.vertices; v++)
        c->fresh[v] = c->fresh[v] == 1 ? FRESH_LOOKED : c->fresh[v];
    return list->status;
}

/* The last collapse that changed one of both triangles: the vertex that went in it, or BVXI_VERTEX_NONE. */
static uint32_t latest_of(const bvxi_collapse *c, const uint32_t *a, const uint32_t *b)
{
    uint32_t latest = BVXI_VERTEX_NONE;
    for (int k = 0; k < 6; k++) {
        uint32_t const went = c->last[k < 3 ? a[k] : b[k - 3]];
        if (went != BVXI_VERTEX_NONE &&
            (latest == BVXI_VERTEX_NONE || c->undo[went].order > c->undo[latest].order))
            latest = went;
    }
    return latest;
}

/* The corners of a triangle that have settled go back; returns how many. */
static uint64_t unsettle(bvxi_collapse *c, const uint32_t *v)
{
    uint64_t count = 0;
    for (int k = 0; k < 3; k++) {
        if (!c->settled[v[k]]) continue;
        bvxi_collapse_unsettle(c, v[k]);
        c->fresh[v[k]] = 1;
        count++;
    }
    return count;
}

/* Undo until none of the pairs crosses that has not come with the mesh. */
static bvx_status undo_pairs(judge_found *list, uint64_t *undone)
{
    bvxi_collapse *const c = list->c;

    while (list->count != 0 && list->status == BVX_OK) {
        uint32_t const s = list->pair[2 * --list->count], t = list->pair[2 * list->count + 1];
        uint32_t latest, went;

        if (bvxi_corner_gone(&c->mesh, (int32_t)(4 * s)) || bvxi_corner_gone(&c->mesh, (int32_t)(4 * t)))
            continue;
        if (has_come(c, s) && has_come(c, t)) continue;
        if (s == t ? !bvxi_collapse_leaves(c, t, &list->hint) : !bvxi_crossing_pair(&c->tree, s, t)) continue;
        if (list->settled) {
            /* Where none has settled both were that way before. */
            uint64_t const back = unsettle(c, c->mesh.triangle[s].vertex) +
                                  unsettle(c, c->mesh.triangle[t].vertex);

            list->triangle = s;
            if (back != 0) add_pair(list, t);
            *undone += back;
            continue;
        }
        latest = latest_of(c, c->mesh.triangle[s].vertex, c->mesh.triangle[t].vertex);
        if (latest == BVXI_VERTEX_NONE) continue;

        /* One at a time, until the one that was meant is undone; then both are looked at again. */
        do {
            went = bvxi_collapse_undo(c, latest);
            ++*undone;
        } while (went != latest);
        list->triangle = s;
        add_pair(list, t);
    }
    return list->status;
}

bvx_status bvxi_collapse_judge(bvxi_collapse *c, double from, double to, uint64_t *undone)
{
    judge_found list = {.c = c, .settled = bvxi_any_marked(c->settled, c->mesh.vertices)};
    int fresh = 0;

    *undone = 0;
    BVXI_TRY(search_level(c, c->options.counted ? NULL : c->fresh, from, to));
    for (uint64_t i = 0; i < c->crossings; i++) fresh |= is_fresh_pair(c, c->pairs + 2 * i);
    if (fresh && c->came == NULL)
        BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, c->mesh.vertices, "marks of crossings", &c->came));
    if (fresh) BVXI_TRY(BVXI_SCOPE(c->ctx, mark_origin(c, to)));
    for (uint64_t i = 0; i < c->crossings; i++) {
        list.triangle = c->pairs[2 * i];
        if (is_fresh_pair(c, c->pairs + 2 * i)) add_pair(&list, c->pairs[2 * i + 1]);
    }
    if (c->options.enclosed != NULL) {
        uint8_t *leaves;

        BVXI_TRY(bvxi_collapse_mark_leaving(c, to, &leaves));
        for (uint64_t t = 0; t < c->mesh.triangles; t++) {
            list.triangle = (uint32_t)t;
            if (leaves[t]) add_pair(&list, (uint32_t)t);
        }
        bvxi_drop(c->ctx, leaves);
    }
    memset(c->fresh, 0, (size_t)c->mesh.vertices);
    BVXI_TRY(list.status);
    while (list.count != 0) {
        BVXI_TRY(undo_pairs(&list, undone));
        if (*undone != 0) BVXI_TRY(look_at_undone(&list));
    }
    for (uint64_t v = 0; v < c->mesh.vertices; v++) c->fresh[v] = c->fresh[v] != 0;
    memset(c->settled, 0, (size_t)c->mesh.vertices);
    c->counts.refused += *undone;
    c->judged = 1;
    bvxi_drop(c->ctx, list.pair);
    return c->tree.node[0] != NULL || c->options.given.topology == BVX_TOPOLOGY_KEEP
               ? BVX_OK
               : open_tree(c, NULL, c->mesh.triangles);
}

bvx_status bvxi_collapse_crossings(bvxi_collapse *c, uint64_t *count)
{
    /* Found when the level was judged, unless it has changed since. */
    if (!c->judged || !c->options.counted || bvxi_any_marked(c->fresh, c->mesh.vertices))
        BVXI_TRY(search_level(c, NULL, 0.0, 1.0));
    *count = c->crossings;
    return BVX_OK;
}
