/* all_slabs.c - the surface in all slabs, and the mesh of all of it.
 *
 * The exact way a slab needs its two planes only, so slabs are made side by side. Each has a stretch of
 * arrays with room for what it can make by the count of its crossings, and a view of the stack into which its
 * vertices go, numbered behind those of the rings. A slab that needs more, or in which anything fails, is
 * made once more afterwards, in order, with arrays that grow. The meshes are then put one after the other:
 * what comes of it does not show who made what. */
#include "layers/trace.h"

#include "mesh/mesh.h"

enum {
    SLAB_SPARE = 64,
    SLAB_GRAIN = 4096 /* triangles */
};

typedef struct slabs_worker {
    bvxi_stack view;
    bvxi_slab_work work;
} slabs_worker;

typedef struct slabs_job {
    bvxi_stack *s;
    bvxi_slab *slab;
    uint32_t count;
    int32_t pieces, workers;
    slabs_worker *worker;
    uint8_t *again; /* a slab each */
    bvx_mesh *mesh;
    uint64_t *vertex, *triangle; /* where each slab's begin */
} slabs_job;

/* Vertices of all loops in the slab's cells: a ring's points once, crossings twice, heights four times. */
static void count_slab(const bvxi_stack *s, bvxi_slab *slab)
{
    const uint64_t *const below = slab->plane[0]->inside, *const above = slab->plane[1]->inside;
    uint64_t const words = bvxi_stack_words(s);
    uint64_t rings = 0, heights;

    slab->lines = 0;
    for (uint64_t k = 0; k < words; k++) slab->lines += bvxi_popcount(below[k] ^ above[k]);
    heights = (uint64_t)slab->lines + slab->hanging_count;
    /* Of a nesting level about those of its loops. */
    for (int k = 0; k < 2; k++) {
        const bvxi_plane *const p = slab->plane[k];
        rings += p->whole == NULL ? (uint64_t)p->ring_count + p->cut_count
                                  : (uint64_t)p->segment_count + 2 * (uint64_t)p->arc_count;
    }
    slab->mesh.vertex_room = heights + rings / 16 + SLAB_SPARE;
    slab->mesh.triangle_room = rings + 4 * heights + SLAB_SPARE;
}

/* ---- side by side ---- */

static bvx_status fill_in_view(slabs_worker *w, bvxi_slab *slab)
{
    w->view.mesh = slab->mesh;
    bvx_status const status = bvxi_slab_fill(&w->work, slab);
    slab->mesh = w->view.mesh;
    return status;
}

static void fill_slab_piece(void *user, int32_t index, int32_t worker)
{
    slabs_job *const job = user;
    uint64_t begin, end;
    bvxi_piece(job->count, job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++)
        job->again[i] = fill_in_view(&job->worker[worker], &job->slab[i]) != BVX_OK;
}

static bvx_status open_workers(slabs_job *job)
{
    bvxi_stack *const s = job->s;
    uint32_t lines = 0, loop = 0;

    for (uint32_t i = 0; i < job->count; i++) {
        const bvxi_slab *const slab = &job->slab[i];
        uint32_t const rings = slab->plane[0]->ring_count + slab->plane[1]->ring_count;
        if (slab->lines > lines) lines = slab->lines;
        if (rings > loop) loop = rings;
    }
    for (int32_t i = 0; i < job->workers; i++) {
        slabs_worker *const w = &job->worker[i];
        w->view = *s;
        memset(&w->view.mesh, 0, sizeof w->view.mesh);
        /* Vertices of rings are read from the stack; new ones are numbered after them. */
        w->view.ring_position = s->mesh.position;
        w->view.ring_vertices = (uint32_t)s->mesh.vertex_count;
        BVXI_TRY(bvxi_slab_work_open(&w->work, &w->view, lines, loop));
        w->view.fixed = 1;
    }
    return BVX_OK;
}

bvx_status bvxi_slabs_fill(bvxi_stack *s, bvxi_slab *slabs, uint32_t count)
{
    slabs_job job = {.s = s, .slab = slabs, .count = count};

    /* Slabs share the vertices of the planes between them, which the field makes as it comes to them. */
    if (s->options.slabs.crossings != BVX_CROSSINGS_EXACT) {
        bvxi_slab_work w;
        BVXI_TRY(
            bvxi_slab_work_open(&w, s, ((uint32_t)s->size[0] + 1) * ((uint32_t)s->size[1] + 1), SLAB_SPARE));
        for (uint32_t i = 0; i < count; i++) {
            BVXI_TRY(bvxi_progress(s->ctx, "surface", (double)i / count));
            BVXI_TRY(bvxi_slab_fill(&w, &slabs[i]));
        }
        return BVX_OK;
    }
    BVXI_TRY(BVXI_ZEROS(s->ctx, count, "the slabs' scratch", job.again));
    for (uint32_t i = 0; i < count; i++) count_slab(s, &slabs[i]);

    bvxi_section_mesh *const all = &s->slab_mesh;
    double *position;
    uint32_t *triangle;

    for (uint32_t i = 0; i < count; i++) {
        all->vertex_room += slabs[i].mesh.vertex_room;
        all->triangle_room += slabs[i].mesh.triangle_room;
    }
    BVXI_TRY(BVXI_ARRAY(s->ctx, 3 * all->vertex_room, "the vertices of a body", position));
    BVXI_TRY(BVXI_ARRAY(s->ctx, 3 * all->triangle_room, "the triangles of a body", triangle));
    for (uint32_t i = 0; i < count; i++) {
        bvxi_section_mesh *const m = &slabs[i].mesh;
        m->position = position;
        m->triangle = triangle;
        position += 3 * m->vertex_room;
        triangle += 3 * m->triangle_room;
    }

    job.pieces = bvxi_section_pieces(count, s->slab_mesh.triangle_room, SLAB_GRAIN);
    job.workers = bvxi_threads(s->ctx) < job.pieces ? bvxi_threads(s->ctx) : job.pieces;
    BVXI_TRY(BVXI_ZEROS(s->ctx, job.workers, "the slabs' scratch", job.worker));
    BVXI_TRY(open_workers(&job));
    BVXI_TRY(bvxi_parallel(s->ctx, "surface", 0.02, 0.8, job.pieces, fill_slab_piece, &job));
    job.worker[0].view.fixed = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!job.again[i]) continue;
        BVXI_TRY(bvxi_progress(s->ctx, "surface", 0.8 + 0.2 * (double)i / (double)count));
        memset(&slabs[i].mesh, 0, sizeof slabs[i].mesh);
        BVXI_TRY(fill_in_view(&job.worker[0], &slabs[i]));
    }
    return BVX_OK;
}

/* ---- joining ---- */

static void give_positions(const bvxi_stack *s, const double *from, uint64_t count, bvx_mesh *mesh,
                           uint64_t first)
{
    float *const narrow = (float *)mesh->positions + 3 * first;
    if (s->options.position_type == BVX_F64)
        memcpy((double *)mesh->positions + 3 * first, from, (size_t)count * 24);
    else
        for (uint64_t i = 0; i < 3 * count; i++) narrow[i] = (float)from[i];
}

static void join_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const slabs_job *const job = user;
    const bvxi_section_mesh *const rings = &job->s->mesh;

    if (begin < end) give_positions(job->s, rings->position + 3 * begin, end - begin, job->mesh, begin);
    bvxi_piece(job->count, job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        const bvxi_section_mesh *const m = &job->slab[i].mesh;
        uint32_t *const to = job->mesh->triangles + 3 * job->triangle[i];
        uint32_t const first = (uint32_t)rings->vertex_count;
        uint32_t const shift = (uint32_t)(job->vertex[i] - rings->vertex_count);
        if (m->vertex_count != 0)
            give_positions(job->s, m->position, m->vertex_count, job->mesh, job->vertex[i]);
        /* Vertices of rings keep their numbers; a slab's own are moved up by those of the slabs before it. */
        for (uint64_t n = 0; n < 3 * m->triangle_count; n++)
            to[n] = m->triangle[n] + (m->triangle[n] >= first ? shift : 0);
    }
}

bvx_status bvxi_slabs_join(bvxi_stack *s, const bvxi_slab *slabs, uint32_t count, bvx_mesh *mesh)
{
    slabs_job made = {.s = s, .slab = (bvxi_slab *)slabs, .count = count, .mesh = mesh}, *const job = &made;
    const bvxi_section_mesh *const own = &s->mesh;
    uint64_t vertices = own->vertex_count, triangles = 0;

    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the slabs' places", job->vertex));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the slabs' places", job->triangle));
    job->pieces = bvxi_section_pieces(count, s->mesh.vertex_count + s->slab_mesh.triangle_room, SLAB_GRAIN);
    for (uint32_t i = 0; i < job->count; i++) {
        job->vertex[i] = vertices;
        job->triangle[i] = triangles;
        vertices += job->slab[i].mesh.vertex_count;
        triangles += job->slab[i].mesh.triangle_count;
    }
    triangles += own->triangle_count;
    if (vertices > UINT32_MAX - 1)
        return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the surface has more than 2^32 vertices", s->function);
    if (triangles > INT32_MAX)
        return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the surface has more than 2^31 triangles", s->function);
    if (triangles == 0)
        return bvxi_fail(s->ctx, BVX_ERR_EMPTY,
                         "%s: no point of the grid of %d by %d cells lies inside; take a finer one",
                         s->function, (int64_t)s->size[0], (int64_t)s->size[1]);
    BVXI_TRY(
        bvxi_mesh_open(s->ctx, s->function, s->options.position_type, 0, vertices, triangles, job->mesh));
    if (own->triangle_count != 0)
        memcpy(job->mesh->triangles + 3 * (triangles - own->triangle_count), own->triangle,
               (size_t)own->triangle_count * 12);
    bvx_status const status = bvxi_for_pieces(s->ctx, "surface", 0.0, 1.0, job->pieces,
                                              job->s->mesh.vertex_count, join_piece, job);
    if (status != BVX_OK) bvx_mesh_free(s->ctx, job->mesh);
    return status;
}
