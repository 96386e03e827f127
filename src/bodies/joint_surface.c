/* joint_surface.c - each body's faces, from tetrahedra that all have a kind.
 *
 * A body's faces are those between its tetrahedra and others: closed and oriented, and for two bodies that
 * touch the same but for the direction. What remains is where a body touches itself: an edge with more than
 * two of its faces gets a vertex, and a vertex becomes as many as there are fans of faces at it, all at one
 * place. Two faces follow each other at an edge where the body lies between them. */
#include "bodies/joint.h"

#include "mesh/mesh.h"
#include "mesh/view.h"

#define JOINT_ONE_PLACE 1e-12 /* of the contours' longest side */

/* Faces of a positive tetrahedron opposite each corner, seen counter-clockwise from outside. */
static const uint8_t tetra_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* The faces of all bodies, those of one body together and in the order of their tetrahedra. */
typedef struct joint_list {
    uint64_t first[BVXI_JOINT_BODIES + 2]; /* of each kind's; the outside has none */
    uint32_t *face;                        /* 4 times the tetrahedron and the corner opposite */
} joint_list;

/* Edges at which a body touches itself. */
typedef struct pinched_edges {
    uint32_t (*edge)[2];
    uint64_t count, room;
} pinched_edges;

/* The faces of the body at hand. Side 3 f + k of face f runs from its corner k to the next one. */
typedef struct joint_faces {
    bvxi_oblique *o;
    bvxi_joint_cut *cut;
    int kind;
    uint32_t (*corner)[3]; /* vertices of the tetrahedra */
    uint32_t *from;        /* 4 times the tetrahedron and the corner opposite; BVXI_NONE: a cell beyond it */
    uint32_t *next;        /* [3 a face] sides of one edge */
    uint32_t *joined;      /* [3 a face] corners that are one vertex */
    uint32_t *number; /* [3 a face] at roots: of the vertex; before that 0: it is its edge's first side */
    uint64_t count;
    uint32_t *point; /* [vertex] 1 more than the point given that it is; 0: none */
    uint8_t *used;   /* [vertex] the last body that has it */
} joint_faces;

/* ---- faces ---- */

/* All tetrahedra are looked at twice, however many bodies there are: to count, then to fill. */
static bvx_status list_all_faces(const bvxi_oblique *o, const bvxi_joint_cut *cut, joint_list *list)
{
    uint64_t *const next = list->first + 1; /* next[kind]: where its faces begin, and end once they are in */
    memset(list->first, 0, sizeof list->first);
    for (int fill = 0; fill < 2; fill++) {
        for (uint64_t t = 0; t < o->tetra_count; t++)
            for (int k = 0; k < 4; k++) {
                /* The bodies that a face is one of, as seen from one of its tetrahedra: that one's, and where
                 * nothing is beyond it but cells of one kind, that kind. Others are seen from both sides. */
                uint32_t const n = o->tetra[t].n[k];
                int const own = cut->kind[t];
                int const other = n != BVXI_NONE ? cut->kind[n] : bvxi_joint_border_kind(o, &o->tetra[t], k);
                int const kind[2] = {own != other ? own : 0, own != other && n == BVXI_NONE ? other : 0};
                for (int i = 0; i < 2; i++) {
                    if (kind[i] == 0) continue;
                    if (fill) list->face[next[kind[i] - 1]++] = (uint32_t)(4 * t) + (uint32_t)k;
                    else next[kind[i]]++;
                }
            }
        if (fill) break;
        for (uint32_t i = 0; i < o->body_count; i++) next[i + 1] += next[i];
        BVXI_TRY(BVXI_ARRAY(o->ctx, next[o->body_count] + 1, "the faces of bodies", list->face));
    }
    return BVX_OK;
}

/* The sides of each edge as a list, which begins with the first of them. */
static bvx_status list_sides(joint_faces *f)
{
    bvx_context *const ctx = f->o->ctx;
    bvxi_map edges = {0};

    /* A closed surface has three edges for two faces. */
    BVXI_TRY(bvxi_map_reserve(ctx, &edges, f->count + f->count / 2 + 1));
    for (uint32_t side = 0; side < 3 * f->count; side++) {
        const uint32_t *const v = f->corner[side / 3];
        uint32_t *first;
        BVXI_TRY(bvxi_edge_add(f->o, &edges, v[side % 3], v[(side + 1) % 3], &first));
        f->number[side] = *first != BVXI_NONE;
        f->next[side] = BVXI_NONE;
        if (*first == BVXI_NONE) {
            *first = side;
        } else {
            f->next[side] = f->next[*first];
            f->next[*first] = side;
        }
    }
    return BVX_OK;
}

/* The side that its edge's list begins with. */
static int is_first_side(const joint_faces *f, uint64_t side)
{
    return f->number[side] == 0;
}

static bvx_status take_faces(joint_faces *f, const joint_list *list, int kind)
{
    const uint32_t *const face = list->face + list->first[kind - 1];
    bvx_context *const ctx = f->o->ctx;

    f->kind = kind;
    f->count = list->first[kind] - list->first[kind - 1];
    uint64_t const n = f->count + 1;
    if (f->count > UINT32_MAX / 3)
        return bvxi_fail_for(f->o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: a body has more than 2^30 triangles; take fewer cells", f->o->function);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, 13 * n * sizeof *f->from, "the faces of a body", &f->corner));
    f->from = f->corner[n];
    f->next = f->from + n;
    f->joined = f->next + 3 * n;
    f->number = f->joined + 3 * n;
    /* Where the tetrahedron is not the body's, the body lies beyond the face. */
    for (uint64_t i = 0; i < f->count; i++) {
        int const against = f->cut->kind[face[i] / 4] != kind;
        for (int k = 0; k < 3; k++)
            f->corner[i][k] = f->o->tetra[face[i] / 4].v[tetra_face[face[i] % 4][against ? 2 - k : k]];
        f->from[i] = against ? BVXI_NONE : face[i];
    }
    return BVXI_SCOPE(ctx, list_sides(f));
}

static int is_pinched(const joint_faces *f, uint32_t first)
{
    uint32_t n = 0;
    for (uint32_t i = first; i != BVXI_NONE; i = f->next[i]) n++;
    return n > 2;
}

/* Vertices of a pinched edge may be one fan at both ends: one in between is two. */
static bvx_status find_pinched(bvxi_oblique *o, bvxi_joint_cut *cut, const joint_list *list, int kind,
                               pinched_edges *pinched)
{
    joint_faces f = {.o = o, .cut = cut};
    BVXI_TRY(take_faces(&f, list, kind));
    for (uint64_t i = 0; i < 3 * f.count; i++) {
        const uint32_t *const v = f.corner[i / 3];
        if (!is_first_side(&f, i) || !is_pinched(&f, (uint32_t)i)) continue;
        BVXI_TRY(BVXI_GROW(o, pinched->edge, pinched->count, pinched->room, "the edges of a body"));
        pinched->edge[pinched->count][0] = v[i % 3];
        pinched->edge[pinched->count++][1] = v[(i + 1) % 3];
    }

    bvxi_drop(o->ctx, f.corner);
    return BVX_OK;
}

/* ---- vertices ---- */

/* Two faces of a body run along an edge in opposite directions. */
static void join_sides(const joint_faces *f, uint32_t one, uint32_t two)
{
    bvxi_join(f->joined, one, bvxi_corner_after(two));
    bvxi_join(f->joined, bvxi_corner_after(one), two);
}

static uint32_t third_vertex(const bvxi_tetra *t, uint32_t a, uint32_t b, uint32_t c)
{
    for (int k = 0; k < 4; k++)
        if (t->v[k] != a && t->v[k] != b && t->v[k] != c) return t->v[k];
    return BVXI_NONE;
}

/* The next face at a side, through the body: 4 * tetrahedron + corner opposite, or BVXI_NONE beyond all. */
static uint32_t face_through_body(const joint_faces *f, uint32_t side)
{
    const uint32_t *const v = f->corner[side / 3];
    uint32_t const x = v[side % 3], y = v[(side + 1) % 3];
    uint32_t leave = v[(side + 2) % 3], t = f->from[side / 3] / 4, other;

    if (f->from[side / 3] == BVXI_NONE) return BVXI_NONE;
    other = f->o->tetra[t].v[f->from[side / 3] % 4];
    for (;;) {
        const bvxi_tetra *const now = &f->o->tetra[t];
        /* Around the edge from tetrahedron to tetrahedron, leaving each by its other face. */
        int const k = bvxi_corner_of(now, leave);
        uint32_t const n = now->n[k];
        if (n == BVXI_NONE && bvxi_joint_border_kind(f->o, now, k) == f->kind) return BVXI_NONE;
        if (n == BVXI_NONE || f->cut->kind[n] != f->kind) return 4 * t + (uint32_t)k;
        leave = other;
        other = third_vertex(&f->o->tetra[n], x, y, other);
        t = n;
    }
}

/* The next face at its side outside of the body, where only bodies of higher numbers are; else BVXI_NONE. */
static uint32_t face_around_others(const joint_faces *f, uint32_t side)
{
    const uint32_t *const v = f->corner[side / 3];
    uint32_t const x = v[side % 3], y = v[(side + 1) % 3], from = f->from[side / 3];
    uint32_t leave = v[(side + 2) % 3], other, t;

    if (from == BVXI_NONE || f->o->tetra[from / 4].n[from % 4] == BVXI_NONE) return BVXI_NONE;
    t = f->o->tetra[from / 4].n[from % 4];
    other = third_vertex(&f->o->tetra[t], x, y, leave);
    for (;;) {
        const bvxi_tetra *const now = &f->o->tetra[t];
        uint32_t const n = now->n[bvxi_corner_of(now, leave)];

        /* A body of a lower number there passes through itself, and this one does not. */
        if (f->cut->kind[t] < f->kind || n == BVXI_NONE) return BVXI_NONE;
        leave = other;
        other = third_vertex(&f->o->tetra[n], x, y, other);
        if (f->cut->kind[n] == f->kind) return 4 * n + (uint32_t)bvxi_corner_of(&f->o->tetra[n], other);
        t = n;
    }
}

/* Of an edge with several pairs of faces those with the body between them belong together; where it passes
 * through, those with another one between them. */
static void join_pinched(const joint_faces *f, uint32_t first)
{
    int through = 1;
    /* Where two bodies touch themselves at one edge, the one with the lower number passes through. */
    for (uint32_t i = first; i != BVXI_NONE; i = f->next[i])
        through = through && face_around_others(f, i) != BVXI_NONE;
    for (uint32_t i = first; i != BVXI_NONE; i = f->next[i]) {
        uint32_t const face = through ? face_around_others(f, i) : face_through_body(f, i);
        if (face == BVXI_NONE) continue;
        for (uint32_t j = first; j != BVXI_NONE; j = f->next[j])
            if (f->from[j / 3] == face) join_sides(f, i, j);
    }
}

static void joint_place(const joint_faces *f, uint32_t v, double at[3])
{
    const bvxi_oblique *const o = f->o;
    if (f->point[v] != 0) {
        memcpy(at, o->given->points + 3 * (uint64_t)(f->point[v] - 1), 24);
        return;
    }
    for (int k = 0; k < 3; k++) at[k] = o->origin[k] + o->step * o->vertex[v].at[k];
}

/* The body's own points, which follow those of the bodies before it on each plane. */
static void count_unkept_points(const joint_faces *f)
{
    bvxi_oblique *const o = f->o;
    double const most = JOINT_ONE_PLACE * o->longest * o->step;

    for (uint32_t p = 0; p < o->plane_count; p++) {
        const bvxi_plane *const q = &o->plane[p].plane;
        uint32_t n = 0, end;
        for (int b = 0; b + 1 < f->kind; b++) n += o->body[b].plane[p].plane.point_count;
        end = n + o->body[f->kind - 1].plane[p].plane.point_count;
        for (; n < end; n++) {
            const double *const given = o->given->points + 3 * (uint64_t)q->given[n];
            uint32_t const v = o->plane[p].vertex[n];
            int kept = v != BVXI_NONE && f->used[v] == f->kind;
            double at[3];
            if (kept) joint_place(f, v, at);
            for (int k = 0; k < 3 && kept; k++) kept = bvxi_absolute(at[k] - given[k]) <= most;
            if (kept) continue;
            o->report.unkept_points++;
            bvxi_report_place(&o->report, given);
        }
    }
}

/* ---- meshes ---- */

static bvx_status write_joint_mesh(joint_faces *f, bvx_mesh *mesh)
{
    const bvxi_oblique *const o = f->o;
    uint64_t const corners = 3 * f->count;
    uint64_t vertices = 0;

    /* A fan is one vertex: its root is the corner of the lowest number. */
    for (uint64_t i = 0; i < corners; i++) vertices += f->joined[i] == i;
    if (f->count > INT32_MAX || vertices > INT32_MAX)
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the surface has more than 2^31 triangles", o->function);
    BVXI_TRY(bvxi_mesh_open(o->ctx, o->function, o->options.position_type, 0, vertices, f->count, mesh));
    /* Faces come in the order of tetrahedra, so vertices do not depend on threads either. */
    memset(f->number, 0xff, (size_t)(corners * 4));
    vertices = 0;
    for (uint64_t i = 0; i < corners; i++) {
        uint32_t const v = f->corner[i / 3][i % 3];
        uint32_t *const number = &f->number[bvxi_root(f->joined, (uint32_t)i)];
        double at[3];
        if (*number == BVXI_NONE) {
            *number = (uint32_t)vertices++;
            joint_place(f, v, at);
            bvxi_put_position(mesh, o->options.position_type, *number, at[0], at[1], at[2]);
            f->used[v] = (uint8_t)f->kind;
        }
        mesh->triangles[i] = *number;
    }
    return BVX_OK;
}

static bvx_status make_joint_mesh(joint_faces *f, const joint_list *list, int kind, bvx_mesh *mesh)
{
    bvxi_oblique *const o = f->o;
    int32_t const label = o->body[kind - 1].options.label;
    int sound;

    BVXI_TRY(take_faces(f, list, kind));
    if (f->count == 0)
        return bvxi_fail_for(o->ctx, BVX_ERR_EMPTY, BVX_REASON_EMPTY,
                             "%s: no point of the lattice lies inside label %d; take more cells", o->function,
                             (int64_t)label);

    for (uint64_t i = 0; i < 3 * f->count; i++) f->joined[i] = (uint32_t)i;
    for (uint64_t i = 0; i < 3 * f->count; i++) {
        uint32_t const first = (uint32_t)i;
        /* Two faces at an edge belong together; of more it has to be found out which. */
        if (!is_first_side(f, i)) continue;
        if (is_pinched(f, first)) join_pinched(f, first);
        else if (f->next[first] != BVXI_NONE) join_sides(f, first, f->next[first]);
    }

    BVXI_TRY(write_joint_mesh(f, mesh));
    count_unkept_points(f);
    /* Closed by construction, and a manifold once its fans have vertices of their own: looked at all the same. */
    BVXI_TRY(bvxi_section_check_mesh(o->ctx, mesh, 0, &sound));
    if (sound) return BVX_OK;
    return bvxi_fail_for(o->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOPS_MEET,
                         "%s: the contours of label %d contradict each other too much for a closed, manifold "
                         "mesh; move those apart that cross where their planes meet, or take a smaller agree",
                         o->function, (int64_t)label);
}

/* All cuts before all faces: a cut for one body changes faces that another shares. */
static bvx_status cut_pinched(bvxi_oblique *o, bvxi_joint_cut *cut, joint_list *list)
{
    int const count = (int)o->body_count;
    pinched_edges pinched = {0};
    for (int kind = 1; kind <= count; kind++)
        BVXI_TRY(BVXI_SHARE(o->ctx, 1.0 * (kind - 1) / count, 1.0 * kind / count,
                            find_pinched(o, cut, list, kind, &pinched)));
    for (uint64_t i = 0; i < pinched.count; i++) {
        const uint32_t *const e = pinched.edge[i];
        uint32_t t, m;
        double at[3];

        BVXI_TRY(bvxi_tetra_with_edge(o, e[0], e[1], &t));
        if (t == BVXI_NONE) continue;
        bvxi_oblique_middle(o, e, 2, at);
        BVXI_TRY(bvxi_tetra_split_edge(o, t, e[0], e[1], at, &m));
        o->vertex[m].sign = 0;
        BVXI_TRY(BVXI_RESERVE(o, cut->kind, o->tetra_room, cut->kind_room, "the kinds of tetrahedra"));
        for (uint64_t k = 0; k < o->ring_count; k++)
            cut->kind[o->tetra[o->ring[k]].twin] = cut->kind[o->ring[k]];
    }
    /* Numbers of faces are those of the tetrahedra before the cuts. */
    return pinched.count != 0 ? list_all_faces(o, cut, list) : BVX_OK;
}

bvx_status bvxi_joint_surfaces(bvxi_oblique *o, bvxi_joint_cut *cut, bvx_mesh *meshes)
{
    int const count = (int)o->body_count;
    joint_list list;
    joint_faces f = {0};

    BVXI_TRY(list_all_faces(o, cut, &list));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.4, cut_pinched(o, cut, &list)));
    f.o = o;
    f.cut = cut;
    BVXI_TRY(BVXI_ZEROS(o->ctx, o->vertex_count, "the points of contours", f.point));
    BVXI_TRY(BVXI_ZEROS(o->ctx, o->vertex_count, "the points of contours", f.used));
    for (uint32_t p = 0; p < o->plane_count; p++) {
        const bvxi_plane *const q = &o->plane[p].plane;
        for (uint32_t n = 0; n < q->point_count; n++) {
            uint32_t const v = o->plane[p].vertex[n];
            if (v != BVXI_NONE && f.point[v] == 0) f.point[v] = q->given[n] + 1;
        }
    }
    for (int kind = 1; kind <= count; kind++)
        BVXI_TRY(BVXI_SHARE(o->ctx, 0.4 + 0.6 * (kind - 1) / count, 0.4 + 0.6 * kind / count,
                            BVXI_SCOPE(o->ctx, make_joint_mesh(&f, &list, kind, &meshes[kind - 1]))));
    return BVX_OK;
}
