/* oblique_surface.c - the surface between inside and outside, tetrahedron by tetrahedron.
 *
 * Source: Doi, Koide. An efficient method of triangulating equi-valued surfaces by using tetrahedral cells.
 * 1991 (marching tetrahedra), over split cells and over the six of each other cell alike.
 *
 * A contour's vertex counts as outside, and all crossings next to it are at its place, as one vertex: what is
 * left of a triangle then has three different ones or goes. Signs are such that this keeps a manifold
 * (oblique_signs.c). Bodies that no contour touches are left out. */
#include "section/oblique.h"

#include "mesh/mesh.h"

#define CROSSING_LEAST 0.02 /* of an edge: no crossing is nearer to its ends */

#define ONE_PLACE 1e-12 /* of the contours' longest side */

/* ---- vertices ---- */

static bvx_status add_position(bvxi_oblique *o, const double at[3], uint32_t *number)
{
    BVXI_TRY(bvxi_oblique_grow(o, &o->position, o->position_count, &o->position_room, 24,
                               "the vertices of the surface"));
    BVXI_TRY(
        bvxi_oblique_grow(o, &o->kept, o->position_count, &o->kept_room, 1, "the vertices of the surface"));
    for (int k = 0; k < 3; k++)
        o->position[3 * o->position_count + (uint64_t)k] = o->origin[k] + o->step * at[k];
    o->kept[o->position_count] = 0;
    *number = (uint32_t)o->position_count++;
    return BVX_OK;
}

static bvx_status contour_vertex(bvxi_oblique *o, uint32_t v, uint32_t *number)
{
    if (o->output[v] == BVXI_NONE) BVXI_TRY(add_position(o, o->vertex[v].at, &o->output[v]));
    *number = o->output[v];
    return BVX_OK;
}

/* Where an edge from inside to outside is crossed. */
static bvx_status edge_vertex(bvxi_oblique *o, uint32_t in, uint32_t out, uint32_t *number)
{
    uint32_t *found;

    if (o->vertex[out].sign == 0) return contour_vertex(o, out, number);
    BVXI_TRY(bvxi_edge_add(o, &o->crossing, in, out, &found));
    if (*found == BVXI_NONE) {
        const bvxi_tetra_vertex *const a = &o->vertex[in], *const b = &o->vertex[out];
        double const rise = bvxi_absolute(a->value), fall = bvxi_absolute(b->value);
        double share = rise + fall > 0.0 ? rise / (rise + fall) : 0.5, at[3];
        if (share < CROSSING_LEAST) share = CROSSING_LEAST;
        if (share > 1.0 - CROSSING_LEAST) share = 1.0 - CROSSING_LEAST;
        for (int k = 0; k < 3; k++) at[k] = a->at[k] + share * (b->at[k] - a->at[k]);
        BVXI_TRY(add_position(o, at, found));
    }
    *number = *found;
    return BVX_OK;
}

/* ---- triangles ---- */

static bvx_status add_surface_triangle(bvxi_oblique *o, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t;

    if (a == b || b == c || c == a) return BVX_OK;
    BVXI_TRY(bvxi_oblique_grow(o, &o->triangle, o->triangle_count, &o->triangle_room, 12,
                               "the triangles of the surface"));
    t = o->triangle + 3 * o->triangle_count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return BVX_OK;
}

/* Corners may be one vertex of a contour: a triangle is left then, or nothing. */
static bvx_status add_quadrangle(bvxi_oblique *o, const uint32_t q[4])
{
    BVXI_TRY(add_surface_triangle(o, q[0], q[1], q[2]));
    return add_surface_triangle(o, q[0], q[2], q[3]);
}

/* The surface in a positive tetrahedron, seen from outside counter-clockwise. */
static bvx_status march_tetrahedron(bvxi_oblique *o, const uint32_t v[4])
{
    /* the other three corners, in the order in which they are seen from a corner outwards */
    static const uint8_t others[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    uint32_t n[4];
    int inside = 0, in[4], out[4], ins = 0, outs = 0;

    for (int k = 0; k < 4; k++) {
        int const is_in = o->vertex[v[k]].sign > 0;
        inside |= is_in << k;
        if (is_in) in[ins++] = k;
        else out[outs++] = k;
    }
    if (inside == 0 || inside == 15) return BVX_OK;
    if (ins == 1) {
        const uint8_t *const x = others[in[0]];
        for (int k = 0; k < 3; k++) BVXI_TRY(edge_vertex(o, v[in[0]], v[x[k]], &n[k]));
        return add_surface_triangle(o, n[0], n[1], n[2]);
    }
    if (outs == 1) {
        const uint8_t *const x = others[out[0]];
        for (int k = 0; k < 3; k++) BVXI_TRY(edge_vertex(o, v[x[k]], v[out[0]], &n[k]));
        return add_surface_triangle(o, n[0], n[2], n[1]);
    }

    /* two and two: round the four crossings; turned where (in, in, out, out) is a negative order */
    {
        static const uint8_t even[6] = {1, 0, 1, 1, 0, 1};
        static const uint8_t pair[4][4] = {{0, 0, 1, 2}, {0, 0, 3, 4}, {1, 3, 0, 5}, {2, 4, 5, 0}};
        int const positive = even[pair[in[0]][in[1]]];
        BVXI_TRY(edge_vertex(o, v[in[0]], v[out[0]], &n[0]));
        BVXI_TRY(edge_vertex(o, v[in[0]], v[out[1]], &n[positive ? 1 : 3]));
        BVXI_TRY(edge_vertex(o, v[in[1]], v[out[1]], &n[2]));
        BVXI_TRY(edge_vertex(o, v[in[1]], v[out[0]], &n[positive ? 3 : 1]));
        return add_quadrangle(o, n);
    }
}

static bvx_status march_split_cells(bvxi_oblique *o)
{
    for (uint64_t t = 0; t < o->tetra_count; t++) {
        uint32_t v[4];
        memcpy(v, o->tetra[t].v, sizeof v);
        BVXI_TRY(march_tetrahedron(o, v));
    }
    return BVX_OK;
}

static bvx_status march_cell(bvxi_oblique *o, const int32_t at[3])
{
    uint32_t corner[8];

    for (int k = 0; k < 8; k++) {
        int32_t const place[3] = {at[0] + (k & 1), at[1] + (k >> 1 & 1), at[2] + (k >> 2)};
        BVXI_TRY(bvxi_oblique_lattice_vertex(o, place, &corner[k]));
    }
    for (int k = 0; k < 6; k++) {
        uint32_t v[4];
        for (int x = 0; x < 4; x++) v[x] = corner[bvxi_kuhn[k][x]];
        BVXI_TRY(march_tetrahedron(o, v));
    }
    return BVX_OK;
}

static bvx_status march_cells(bvxi_oblique *o)
{
    for (uint32_t i = 0; i < o->known_count; i++) {
        int32_t first[3];
        if (o->active[i] == 0) continue;
        if (i % 1024 == 0) BVXI_TRY(bvxi_progress(o->ctx, "surface", (double)i / o->known_count));
        bvxi_oblique_block_place(o, o->known[i], first);
        for (int c = 0; c < BVXI_BLOCK_SIZE; c++) {
            int32_t const at[3] = {first[0] + (c & 3), first[1] + (c >> 2 & 3), first[2] + (c >> 4)};
            if (o->active[i] >> c & 1) BVXI_TRY(march_cell(o, at));
        }
    }
    return BVX_OK;
}

/* ---- what is kept ---- */

static uint32_t root_vertex(uint32_t *joined, uint32_t i)
{
    while (joined[i] != i) {
        joined[i] = joined[joined[i]];
        i = joined[i];
    }
    return i;
}

/* Contours' points have the coordinates given. */
static void give_contour_points(bvxi_oblique *o)
{
    uint32_t first = 0;

    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        for (uint32_t n = 0; n < p->point_count; n++) {
            uint32_t const v = o->point_vertex[first + n];
            if (v == BVXI_NONE || o->output[v] == BVXI_NONE || o->kept[o->output[v]]) continue;
            o->kept[o->output[v]] = 1; /* the first of two points at one vertex */
            memcpy(o->position + 3 * (uint64_t)o->output[v], o->given->points + 3 * (uint64_t)p->given[n],
                   24);
        }
        first += p->point_count;
    }
}

/* Points of two planes may be one place but for rounding: the first one's coordinates are those of both. */
static int is_there(const bvxi_oblique *o, const double a[3], const double b[3])
{
    double const most = ONE_PLACE * o->longest * o->step;

    for (int k = 0; k < 3; k++)
        if (!(bvxi_absolute(a[k] - b[k]) <= most)) return 0;
    return 1;
}

static void oblique_count_unkept(bvxi_oblique *o, const uint32_t *renumbered)
{
    uint32_t first = 0;

    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        for (uint32_t n = 0; n < p->point_count; n++) {
            uint32_t const v = o->point_vertex[first + n];
            const double *const given = o->given->points + 3 * (uint64_t)p->given[n];
            if (v != BVXI_NONE && o->output[v] != BVXI_NONE && renumbered[o->output[v]] != BVXI_NONE &&
                is_there(o, o->position + 3 * (uint64_t)o->output[v], given))
                continue;
            o->report.unkept_points++;
            if (o->report.located < BVX_SECTIONS_LOCATED)
                memcpy(o->report.unkept[o->report.located++], given, 24);
        }
        first += p->point_count;
    }
}

/* Bodies that hold most of some contour are marked at their roots. */
static void mark_bodies(bvxi_oblique *o, const uint32_t *joined)
{
    uint32_t first = 0;

    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        for (uint32_t c = 0; c < p->contour_count; c++) {
            const bvxi_contour *const loop = &p->contour[c];
            uint32_t most = BVXI_NONE, lead = 0;
            /* the one with more than half of the points, if any (Boyer, Moore 1981), is the last to lead */
            for (uint32_t n = 0; n < loop->count; n++) {
                uint32_t const v = o->point_vertex[first + loop->first + n];
                uint32_t const root = v == BVXI_NONE || o->output[v] == BVXI_NONE ? BVXI_NONE
                                                                                  : joined[o->output[v]];
                if (lead == 0) most = root;
                lead = root == most ? lead + 1 : lead - 1;
            }
            if (most != BVXI_NONE && lead > 0) o->kept[most] = 1;
        }
        first += p->point_count;
    }
}

/* Bodies with contours on them, their vertices numbered anew; joined becomes the new numbers. */
static void keep_bodies(bvxi_oblique *o, uint32_t *joined, uint64_t *vertices)
{
    uint64_t kept = 0;

    for (uint64_t i = 0; i < o->position_count; i++) joined[i] = (uint32_t)i;
    for (uint64_t t = 0; t < o->triangle_count; t++)
        for (int k = 1; k < 3; k++) {
            uint32_t const a = root_vertex(joined, o->triangle[3 * t]);
            uint32_t const b = root_vertex(joined, o->triangle[3 * t + (uint64_t)k]);
            joined[a > b ? a : b] = a > b ? b : a;
        }
    for (uint64_t i = 0; i < o->position_count; i++) joined[i] = root_vertex(joined, (uint32_t)i);
    memset(o->kept, 0, (size_t)o->position_count);
    mark_bodies(o, joined);
    for (uint64_t t = 0; t < o->triangle_count; t++) {
        if (!o->kept[joined[o->triangle[3 * t]]]) continue;
        if (kept != t) memcpy(o->triangle + 3 * kept, o->triangle + 3 * t, 12);
        kept++;
    }
    o->triangle_count = kept;

    memset(joined, 0xff, (size_t)o->position_count * 4);
    *vertices = 0;
    for (uint64_t t = 0; t < 3 * o->triangle_count; t++) {
        uint32_t *const number = &joined[o->triangle[t]];
        if (*number == BVXI_NONE) *number = (uint32_t)(*vertices)++;
        o->triangle[t] = *number;
    }
}

static bvx_status write_surface(bvxi_oblique *o, uint32_t *joined, bvx_mesh *mesh)
{
    uint64_t vertices;

    give_contour_points(o);
    keep_bodies(o, joined, &vertices);
    oblique_count_unkept(o, joined);
    if (o->triangle_count == 0)
        return bvxi_fail_for(o->ctx, BVX_ERR_EMPTY, BVX_REASON_EMPTY,
                             "%s: no point of the lattice lies inside; take more cells", o->function);
    if (o->triangle_count > INT32_MAX)
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the surface has more than 2^31 triangles", o->function);
    BVXI_TRY(
        bvxi_mesh_open(o->ctx, o->function, o->options.position_type, 0, vertices, o->triangle_count, mesh));
    memcpy(mesh->triangles, o->triangle, (size_t)o->triangle_count * 12);
    for (uint64_t i = 0; i < o->position_count; i++) {
        if (joined[i] == BVXI_NONE) continue;
        for (uint64_t k = 0; k < 3; k++) {
            double const x = o->position[3 * i + k];
            if (o->options.position_type == BVX_F64)
                ((double *)mesh->positions)[3 * (uint64_t)joined[i] + k] = x;
            else ((float *)mesh->positions)[3 * (uint64_t)joined[i] + k] = (float)x;
        }
    }
    return BVX_OK;
}

bvx_status bvxi_oblique_surface(bvxi_oblique *o, bvx_mesh *mesh)
{
    uint32_t *joined = NULL;
    uint64_t bytes;
    bvx_status status;

    o->output_room = o->vertex_count;
    BVXI_TRY(bvxi_alloc(o->ctx, BVXI_SCRATCH, o->output_room * 4, "the vertices on contours", &o->output));
    memset(o->output, 0xff, (size_t)o->output_room * 4);
    o->crossing.near = 1;
    BVXI_TRY(march_split_cells(o));
    BVXI_TRY(bvxi_progress(o->ctx, "surface", 0.5));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.5, 0.9, march_cells(o)));
    bytes = o->position_count * 4;
    BVXI_TRY(bvxi_alloc(o->ctx, BVXI_SCRATCH, bytes, "the parts of the surface", &joined));
    status = write_surface(o, joined, mesh);
    bvxi_drop(o->ctx, joined);
    return status;
}
