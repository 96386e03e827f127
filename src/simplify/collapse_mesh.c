/* collapse_mesh.c - a mesh made ready to be collapsed, run to a target, and given back. Source and method:
 * collapse.c.
 *
 * Vertices and triangles are put in an order of space first: neighbours lie near each other in memory, and
 * levels do not depend on the order in which the mesh comes. */
#include "simplify/room.h"
#include "bits/sort.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

#include <math.h>

enum {
    COLLAPSE_REPORT = 1024,  /* edges that are tried between two reports of progress */
    COLLAPSE_CURVE_BITS = 21 /* of the order in space along each axis */
};

/* Spans within which squares of normals of small triangles are numbers: beyond them every collapse would count
 * as one that turns or flattens something. */
#define COLLAPSE_NARROWEST 1e-30
#define COLLAPSE_WIDEST    1e31

/* The plane at a border edge weighs as much as that of a triangle whose doubled area is the edge's square. */
#define BORDER_WEIGHT 1.0

/* ---- The run to a target ---- */

/* Pack the mesh, and make boxes and queue anew. */
static void pack_collapse(bvxi_collapse *c)
{
    bvxi_corners *const m = &c->mesh;

    if (m->left != m->triangles) {
        uint64_t const vertices = m->vertices;

        bvxi_corners_pack(m, c->version);
        if (c->colour != NULL) bvxi_colours_pack(c->colour, vertices, c->version);
    }

    /* The old queue's entries go, so versions may begin anew. */
    memset(c->version, 0, (size_t)m->vertices * sizeof *c->version);
    bvxi_box_tree_set(&c->boxes, m);

    /* Each edge once: from the smaller of the two corners opposite to it. */
    bvxi_queue_clear(&c->queue);
    for (int32_t t = 0; t < (int32_t)m->triangles; t++)
        for (int32_t corner = 4 * t; corner < 4 * t + 3; corner++)
            if (corner < bvxi_corner_opposite(m, corner)) bvxi_collapse_put(c, corner);
    c->packed = m->left;
}

bvx_status bvxi_collapse_to(bvxi_collapse *c, uint64_t target, uint64_t level, double from, double to)
{
    uint64_t begun, collapsed = c->counts.collapsed;
    bvxi_queue_entry entry;

    /* Colours are kept beside the mesh, which cells do not copy. */
    if (c->colour == NULL && bvxi_collapse_is_far(c, target, level)) {
        BVXI_TRY(bvxi_collapse_cells(c, target, level, from, 0.5 * (from + to)));
        from = 0.5 * (from + to);
    }
    begun = c->mesh.left;

    for (uint64_t tried = 0; c->mesh.left > target; tried++) {
        if (tried % COLLAPSE_REPORT == 0)
            BVXI_TRY(bvxi_progress(c->ctx, "collapse",
                                   from + (to - from) * (double)(begun - c->mesh.left) /
                                              (double)(begun - target)));

        /* After each halving memory is in the order of space again, and refused edges come back. */
        if (c->mesh.left <= c->packed / 2 || bvxi_queue_room(&c->queue) < BVXI_STAR_MOST) pack_collapse(c);
        if (bvxi_queue_take(&c->queue, &entry)) {
            /* What comes next is fetched while this one is judged. */
            int32_t const soon = bvxi_queue_soon(&c->queue);

            if (soon >= 0) BVXI_PREFETCH(&c->mesh.triangle[soon >> 2]);
            bvxi_collapse_try(c, &entry);
            continue;
        }

        /* The queue is empty above the target. Edges that were refused may be safe now that others have gone:
         * all are queued again, unless the last pass has collapsed nothing. */
        if (collapsed == c->counts.collapsed) break;
        collapsed = c->counts.collapsed;
        pack_collapse(c);
    }
    return BVX_OK;
}

/* ---- The mesh in an order of space ---- */

typedef struct collapse_order {
    const bvx_mesh_view *view;
    uint64_t *key; /* of vertices, then of triangles */
    uint32_t *index;
    /* of each vertex of the view: UINT32_MAX where no triangle uses it, else 0 until take_mesh writes its
     * number in the new order */
    uint32_t *rank;
    double low[3], scale;
} collapse_order;

static void vertex_keys(collapse_order *o, uint64_t *used)
{
    uint64_t n = 0;

    for (uint64_t v = 0; v < o->view->vertex_count; v++) {
        double p[3];
        uint64_t key = 0;

        /* Vertices that no triangle uses are left out. */
        if (o->rank[v] == UINT32_MAX) continue;
        bvxi_view_position(o->view, v, p);

        /* Bits of the three coordinates by turns: neighbours in the order are neighbours in space. */
        for (int a = 0; a < 3; a++) key |= bvxi_curve_spread((uint64_t)((p[a] - o->low[a]) * o->scale)) << a;
        o->key[n] = key;
        o->index[n++] = (uint32_t)v;
    }
    *used = n;
}

static int position_before(const double p[3], const double q[3])
{
    return p[2] != q[2] ? p[2] < q[2] : p[1] != q[1] ? p[1] < q[1] : p[0] < q[0];
}

/* Vertices of one key by their positions: there are hardly any. */
static void order_equal_keys(collapse_order *o, uint64_t used)
{
    for (uint64_t i = 1; i < used; i++)
        for (uint64_t j = i; j > 0 && o->key[j] == o->key[j - 1]; j--) {
            double p[3], q[3];
            uint32_t const swap = o->index[j];

            bvxi_view_position(o->view, o->index[j], p);
            bvxi_view_position(o->view, o->index[j - 1], q);
            if (!position_before(p, q)) break;
            o->index[j] = o->index[j - 1];
            o->index[j - 1] = swap;
        }
}

/* Triangles by their least vertex, which comes first, and the one after it: no two begin alike in an oriented
 * manifold. */
static bvx_status order_triangles(bvxi_collapse *c, collapse_order *o)
{
    uint64_t const n = o->view->triangle_count;

    for (uint64_t t = 0; t < n; t++) {
        uint32_t v[3];

        bvxi_view_triangle(o->view, t, v);
        for (int k = 0; k < 3; k++) v[k] = o->rank[v[k]];
        {
            int const first = v[0] < v[1] ? v[0] < v[2] ? 0 : 2 : v[1] < v[2] ? 1 : 2;
            o->key[t] = (uint64_t)v[first] << 32 | v[(first + 1) % 3];
        }
        o->index[t] = (uint32_t)t;
    }

    /* Ties cannot be: the order depends on the mesh alone. */
    BVXI_TRY(bvxi_radix_sort(c->ctx, o->key, o->index, n));

    for (uint64_t t = 0; t < n; t++) {
        uint32_t v[3];
        uint32_t *const to = c->mesh.triangle[t].vertex;

        bvxi_view_triangle(o->view, o->index[t], v);
        for (int k = 0; k < 3; k++) v[k] = o->rank[v[k]];
        for (int k = 0; k < 3; k++)

            /* Turned so that the least vertex comes first, which keeps the orientation. */
            if (v[k] == o->key[t] >> 32)
                for (int j = 0; j < 3; j++) to[j] = v[(k + j) % 3];
    }
    return BVX_OK;
}

/* The mesh in an order of space, and its positions as the result will have them. */
static bvx_status take_mesh(bvxi_collapse *c, collapse_order *o)
{
    uint64_t used;

    vertex_keys(o, &used);
    BVXI_TRY(bvxi_radix_sort(c->ctx, o->key, o->index, used));
    order_equal_keys(o, used);

    c->mesh.vertices = used;
    for (uint64_t i = 0; i < used; i++) {
        double p[3];

        bvxi_view_position(o->view, o->index[i], p);

        /* Rounded to the type of the result from the start, so that what is judged is what is given. */
        for (int a = 0; a < 3; a++) c->mesh.at[i].p[a] = bvxi_collapse_rounded(c, p[a]);
        if (c->mesh.tint != NULL) memcpy(c->mesh.tint + 4 * i, o->view->colours + 4 * (size_t)o->index[i], 4);
        o->rank[o->index[i]] = (uint32_t)i;
    }
    return order_triangles(c, o);
}

/* Marks the vertices that triangles use by a rank of 0; returns how many. */
static uint64_t mark_used(collapse_order *o)
{
    uint64_t used = 0;

    for (uint64_t v = 0; v < o->view->vertex_count; v++) o->rank[v] = UINT32_MAX;
    for (uint64_t t = 0; t < o->view->triangle_count; t++) {
        uint32_t v[3];

        bvxi_view_triangle(o->view, t, v);
        for (int k = 0; k < 3; k++) {
            /* Counted once: after the first triangle the mark is 0. */
            used += o->rank[v[k]] != 0;
            o->rank[v[k]] = 0;
        }
    }
    return used;
}

static bvx_status order_mesh(bvxi_collapse *c, const bvx_mesh_view *mesh, const double low[3], double size)
{
    uint64_t const items = mesh->vertex_count > mesh->triangle_count ? mesh->vertex_count
                                                                     : mesh->triangle_count;
    uint64_t const bytes = items * 12 + mesh->vertex_count * 4;
    collapse_order o = {.view = mesh, .scale = size > 0 ? ((1 << COLLAPSE_CURVE_BITS) - 1) / size : 0};
    unsigned char *block;

    memcpy(o.low, low, sizeof o.low);
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, bytes, "the order of the triangles", &block));

    /* One block, the widest type first, so that each part is aligned. */
    o.key = (uint64_t *)(void *)block;
    o.index = (uint32_t *)(void *)(o.key + items);
    o.rank = o.index + items;

    c->mesh.vertex_room = mark_used(&o);
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->mesh.vertex_room * sizeof *c->mesh.at, "the vertices",
                        &c->mesh.at));
    if (c->options.colour_weight > 0 && mesh->colours != NULL)
        BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->mesh.vertex_room * 4, "the vertices' colours",
                            &c->mesh.tint));
    BVXI_TRY(take_mesh(c, &o));
    bvxi_drop(c->ctx, block);
    return BVX_OK;
}

/* ---- Quadrics ---- */

/* A plane through the vertex, n of unit length. Quadrics are stored about their own vertex (corners.h), so
 * only a grows: the plane's offset from there, and with it b and c, is 0. */
static void add_plane(bvxi_corner_vertex *at, const double n[3], double weight)
{
    int index = 0;

    /* The upper half of n n', row by row. */
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) at->a[index++] += weight * n[i] * n[j];
}

/* Each triangle's plane to its corners, by area; normal[v] sums the triangles' area normals. */
static void add_planes(bvxi_collapse *c, double (*normal)[3])
{
    const bvxi_corners *const m = &c->mesh;

    for (uint64_t t = 0; t < m->triangles; t++) {
        const uint32_t *const v = m->triangle[t].vertex;
        double n[3], length;

        bvxi_area_normal(m->at[v[0]].p, m->at[v[1]].p, m->at[v[2]].p, n);
        length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

        /* A triangle without an area has no plane. */
        if (!(length > 0)) continue;
        c->area += 0.5 * length * c->scale * c->scale;

        for (int k = 0; k < 3; k++) {
            for (int i = 0; i < 3; i++) normal[v[i]][k] += n[k];
            n[k] /= length;
        }

        /* Weighed by area, so that cutting a triangle in two changes nothing. */
        for (int i = 0; i < 3; i++) add_plane(&m->at[v[i]], n, length * c->scale * c->scale);
    }
}

/* The squared distance to the line through each vertex along its normal: to the vertex, less that along the
 * normal. */
static void add_lines(bvxi_collapse *c, double (*normal)[3])
{
    for (uint64_t v = 0; v < c->mesh.vertices; v++) {
        bvxi_corner_vertex *const at = &c->mesh.at[v];
        double *const n = normal[v];
        double const length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double const weight = c->options.even * (at->a[0] + at->a[3] + at->a[5]);
        int index = 0;

        /* Normals of a fold may cancel out: then there is no line. */
        if (!(length > 0)) continue;
        for (int k = 0; k < 3; k++) n[k] /= length;
        for (int i = 0; i < 3; i++)
            for (int j = i; j < 3; j++) at->a[index++] += weight * ((i == j) - n[i] * n[j]);
    }
}

/* Planes upright on the triangles of border edges, each to both ends of its edge. */
static void add_borders(bvxi_collapse *c)
{
    const bvxi_corners *const m = &c->mesh;

    for (uint64_t t = m->triangles; t < m->triangles + m->ghosts; t++) {
        const bvxi_corner_triangle *const ghost = &m->triangle[t];
        const uint32_t *const v = m->triangle[ghost->opposite[0] >> 2].vertex;
        const double *const a = m->at[ghost->vertex[1]].p, *const b = m->at[ghost->vertex[2]].p;
        double const edge[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        double const square = edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2];
        double n[3], plane[3], length;

        bvxi_area_normal(m->at[v[0]].p, m->at[v[1]].p, m->at[v[2]].p, n);
        for (int k = 0; k < 3; k++)
            plane[k] = edge[(k + 1) % 3] * n[(k + 2) % 3] - edge[(k + 2) % 3] * n[(k + 1) % 3];
        length = sqrt(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);

        /* Nor has an edge without a length, or beside a triangle without an area. */
        if (!(length > 0)) continue;

        for (int k = 0; k < 3; k++) plane[k] /= length;
        for (int i = 1; i < 3; i++)
            add_plane(&c->mesh.at[ghost->vertex[i]], plane, BORDER_WEIGHT * square * c->scale * c->scale);
    }
}

static bvx_status start_quadrics(bvxi_collapse *c)
{
    uint64_t const bytes = c->mesh.vertices * 24;
    double(*normal)[3];

    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, bytes, "the vertices' normals", &normal));
    for (uint64_t v = 0; v < c->mesh.vertices; v++) {
        memset(c->mesh.at[v].a, 0, sizeof c->mesh.at[v].a);
        memset(c->mesh.at[v].b, 0, sizeof c->mesh.at[v].b);
        c->mesh.at[v].c = 0;
    }

    /* In this order: the weight of lines is a share of that of planes. */
    add_planes(c, normal);
    if (c->options.even > 0) add_lines(c, normal);
    add_borders(c);
    bvxi_drop(c->ctx, normal);
    return BVX_OK;
}

static bvx_status start_colours(bvxi_collapse *c)
{
    if (c->mesh.tint == NULL) return BVX_OK;

    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, c->mesh.vertex_room * sizeof *c->colour,
                             "the quadrics of colours", &c->colour));
    bvxi_colours_start(&c->mesh, c->mesh.tint, c->options.colour_weight, c->scale, c->colour);
    return BVX_OK;
}

/* ---- Opening, results ---- */

static bvx_status open_arrays(bvxi_collapse *c)
{
    uint64_t const entries = 3 * c->mesh.triangles + BVXI_STAR_MOST;
    uint64_t const spread = entries / (BVXI_QUEUE_CHUNK - 1) + BVXI_QUEUE_HEADS;

    /* Room for each edge, spread over the buckets as badly as can be. */
    c->queue.chunks = (int32_t)(entries < spread ? entries : spread) + 2 * BVXI_STAR_MOST;
    c->begun_vertices = c->mesh.vertices;
    c->node_bytes = bvxi_box_tree_bytes(c->mesh.triangles);
    c->chunk_bytes = (uint64_t)c->queue.chunks * sizeof *c->queue.chunk +
                     BVXI_QUEUE_HEADS * sizeof *c->queue.head;
    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, c->begun_vertices * sizeof *c->mesh.facing,
                             "what vertices face", &c->mesh.facing));
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->begun_vertices * sizeof *c->version,
                        "the vertices' versions", &c->version));
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->node_bytes, "the triangles' boxes", &c->nodes));
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->chunk_bytes, "the edges by their cost", &c->chunks));

    /* The proof by facing (one_sheet.c) needs a closed surface of one piece without crossings. */
    c->boxes.faces = c->options.simple && !c->options.lenient && c->mesh.ghosts == 0 &&
                     bvxi_corners_pieces(&c->mesh, c->version) == 1;

    /* Memory of the queue serves cells while they collapse, so it is one block that is laid out anew. */
    c->queue.chunk = (bvxi_queue_chunk *)(void *)c->chunks;
    c->queue.head = (int32_t *)(void *)(c->queue.chunk + c->queue.chunks);
    bvxi_box_tree_lay_out(&c->boxes, c->mesh.triangles, c->nodes);
    return BVX_OK;
}

static bvx_status open_steps(bvxi_collapse *c, const bvx_mesh_view *mesh)
{
    double low[3], high[3], size = 0;

    BVXI_TRY(bvxi_view_bounds(c->ctx, c->function, mesh, low, high));
    for (int a = 0; a < 3; a++) {
        c->boxes.low[a] = low[a];
        if (high[a] - low[a] > size) size = high[a] - low[a];
    }

    if (size > 0 && !(size >= COLLAPSE_NARROWEST && size <= COLLAPSE_WIDEST))
        return bvxi_fail_for(c->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                             "%s: the mesh spans %g; edges collapse between spans of %g and %g: scale it",
                             c->function, size, COLLAPSE_NARROWEST, COLLAPSE_WIDEST);

    /* The longest side decides: steps are the same along all axes. */
    c->boxes.scale = size > 0 ? BVXI_BOX_HIGHEST / size : 0;
    c->scale = size > 0 ? 1 / size : 1;

    c->mesh.triangle_room = c->mesh.triangles = mesh->triangle_count;
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->mesh.triangle_room * sizeof *c->mesh.triangle,
                        "the triangles", &c->mesh.triangle));

    /* Ordered before it is connected, so that neighbours are written close to each other. */
    BVXI_TRY(order_mesh(c, mesh, low, size));
    BVXI_TRY(bvxi_progress(c->ctx, "collapse", 0.03));
    BVXI_TRY(bvxi_corners_connect(c->ctx, c->function, &c->mesh, c->options.borders));
    BVXI_TRY(bvxi_progress(c->ctx, "collapse", 0.07));
    BVXI_TRY(start_quadrics(c));
    BVXI_TRY(start_colours(c));

    c->packed = UINT64_MAX; /* boxes and queue are not set yet */
    return open_arrays(c);
}

bvx_status bvxi_collapse_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              const bvxi_collapse_options *options, bvxi_collapse **collapse)
{
    bvxi_collapse *c;

    if (mesh->triangle_count > INT32_MAX / 4)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u triangles are too many; %u are possible", function, mesh->triangle_count,
                             (uint64_t)INT32_MAX / 4);
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, sizeof *c, "the collapse", &c));
    c->ctx = ctx;
    c->function = function;
    c->options = *options;
    c->star.lenient = options->lenient;

    /* All costs are allowed; cells have a limit of their own. */
    c->dearest = BVXI_QUEUE_FINE - 1;
    c->queue.batch = INT32_MAX;
    BVXI_TRY(open_steps(c, mesh));
    *collapse = c;
    return BVX_OK;
}

void bvxi_collapse_close(bvxi_collapse *c)
{
    if (c == NULL) return;
    bvxi_drop(c->ctx, c->chunks);
    bvxi_drop(c->ctx, c->nodes);
    bvxi_drop(c->ctx, c->version);
    bvxi_drop(c->ctx, c->mesh.facing);
    bvxi_drop(c->ctx, c->mesh.triangle);
    bvxi_drop(c->ctx, c->colour);
    bvxi_drop(c->ctx, c->mesh.tint);
    bvxi_drop(c->ctx, c->mesh.at);
    bvxi_drop(c->ctx, c);
}

bvx_status bvxi_collapse_give(bvxi_collapse *c, bvx_mesh *level)
{
    const bvxi_corners *const m = &c->mesh;

    /* Packed, triangles and vertices stand as the result has them, and the run can go on to the next
     * level. */
    pack_collapse(c);
    BVXI_TRY(
        bvxi_mesh_open(c->ctx, c->function, c->options.position_type, 0, m->vertices, m->triangles, level));
    for (uint64_t t = 0; t < m->triangles; t++) memcpy(level->triangles + 3 * t, m->triangle[t].vertex, 12);
    for (uint64_t v = 0; v < m->vertices; v++)
        for (uint64_t k = 0; k < 3; k++) {
            if (c->options.position_type == BVX_F64) ((double *)level->positions)[3 * v + k] = m->at[v].p[k];
            else ((float *)level->positions)[3 * v + k] = (float)m->at[v].p[k];
        }
    return BVX_OK;
}

uint64_t bvxi_collapse_triangles(const bvxi_collapse *c)
{
    return c->mesh.left;
}

const bvxi_collapse_counts *bvxi_collapse_tried(const bvxi_collapse *c)
{
    return &c->counts;
}
