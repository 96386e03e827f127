/* cell_collapse.c - far from the target cells of space collapse on their own, with their borders locked.
 *
 * Source: Bentley. Multidimensional Binary Search Trees Used for Associative Searching. 1975.
 *
 * A round parts space into boxes of about as many vertices each, in whole steps of the box tree. Triangles
 * whose corners are all in one cell lie in it, since a cell is convex; a vertex is free when all of its
 * triangles do. Only edges between free vertices collapse, to positions in the cell: so all that changes lies
 * in one cell, and what may be crossed are the triangles that meet the cell, which are its own and those that
 * straddle borders, which stay. Cells share nothing that changes. Each is copied, collapses by rising cost as
 * the whole does, in the memory of a near cache, and is copied back: the order of the cells does not matter,
 * nor the number of threads.
 *
 * Ghost triangles, which close the borders of an open mesh, are in the cell of their two vertices, or
 * straddle: an edge to the ghost is of the cell that its other end is in.
 *
 * Only edges below a cost that half of all have go, and half of a cell's triangles at most: so cells keep
 * step with each other, and from three times the target on edges go by rising cost all over the mesh. Each
 * round has other borders. */
#include "simplify/collapse_state.h"

enum {
    CELL_VERTICES = 2048,               /* a cell with more is parted */
    CELL_TRIANGLES = 6 * CELL_VERTICES, /* a cell with more, of long triangles that straddle, stays */
    CELL_DEPTH = 40,
    CELL_SAMPLES = 64, /* positions among which a border is chosen */
    CELL_ROUNDS = 16,
    CELL_COST_STEP = 32 /* of so many triangles one shows what edges cost */
};

typedef struct collapse_cell {
    uint64_t begin, end;         /* of its vertices in the order */
    bvxi_box box;                /* steps, both ends within */
    uint64_t inside, straddling; /* triangles */
    uint64_t ghosts_inside, ghosts_straddling;
    /* of its list: those inside, then those that straddle, then ghosts in
     * the same way, each by rising index */
    uint64_t first;
    uint64_t listed_inside, listed_straddling, listed_ghosts_inside, listed_ghosts_straddling;
    int32_t stays;
    uint64_t removed; /* triangles, after its collapses */
    bvxi_collapse_counts counts;
} collapse_cell;

/* A cut across an axis, or a cell. */
typedef struct cell_node {
    int32_t axis;      /* -1: a cell */
    int32_t low, high; /* nodes below the cut and from it on; a cell: its index */
    int16_t cut;
} cell_node;

typedef struct cell_round {
    bvxi_collapse *whole;
    int16_t (*step)[3]; /* of each vertex */
    uint32_t *order;    /* vertices, cell by cell, each by rising index */
    uint32_t *other;    /* while they are ordered */
    uint32_t *rank;     /* of each vertex in the order */
    uint32_t *cell_of;  /* of each vertex */
    uint32_t *place;    /* of each triangle and ghost in its cell's list, UINT32_MAX: it straddles */
    uint32_t *list;
    cell_node *node;
    collapse_cell *cell;
    uint64_t nodes, cells, most_nodes;
    uint64_t listed, list_room; /* entries of the list */
    int32_t number;             /* of the round */
    int32_t dearest;

    /* A worker's memory. */
    unsigned char *memory;
    uint64_t worker_bytes, vertex_room, triangle_room, ghost_room;
} cell_round;

/* ---- Cells ---- */

/* Where to cut vertices begin .. end: a position that about half of them, or three eighths, lie below. */
static int16_t choose_cut(const cell_round *r, uint64_t begin, uint64_t end, int axis)
{
    int16_t sample[CELL_SAMPLES];

    /* Every other round cuts elsewhere, so that borders of one round lie within cells of the next. */
    int32_t const at = r->number % 2 == 0 ? CELL_SAMPLES / 2 : CELL_SAMPLES * 3 / 8;

    for (int32_t i = 0; i < CELL_SAMPLES; i++) {
        uint64_t const from = begin + (end - begin) * (uint64_t)i / CELL_SAMPLES;
        int16_t const value = r->step[r->order[from]][axis];
        int32_t j = i;

        /* Sorted as they come: 64 values are too few for more. */
        for (; j > 0 && sample[j - 1] > value; j--) sample[j] = sample[j - 1];
        sample[j] = value;
    }
    return sample[at];
}

/* The axis along which vertices lie furthest apart. */
static int widest_axis(const cell_round *r, uint64_t begin, uint64_t end)
{
    int16_t low[3] = {INT16_MAX, INT16_MAX, INT16_MAX}, high[3] = {0, 0, 0};
    int axis = 0;

    for (uint64_t i = begin; i < end; i++)
        for (int k = 0; k < 3; k++) {
            int16_t const step = r->step[r->order[i]][k];

            if (step < low[k]) low[k] = step;
            if (step > high[k]) high[k] = step;
        }
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    return axis;
}

/* Vertices below the cut first, others after them, each in their order; returns where those begin. */
static uint64_t part_vertices(cell_round *r, uint64_t begin, uint64_t end, int axis, int16_t cut)
{
    uint64_t low = begin, high = 0;

    for (uint64_t i = begin; i < end; i++) {
        uint32_t const v = r->order[i];
        int const below = r->step[v][axis] < cut;

        /* Both are written and one counter moves: no branch that half of the vertices would mispredict. */
        r->order[low] = v;
        r->other[high] = v;
        low += (uint64_t)below;
        high += (uint64_t)!below;
    }
    memcpy(r->order + low, r->other, (size_t)high * sizeof *r->order);
    return low;
}

static void close_cell(cell_round *r, cell_node *node, uint64_t begin, uint64_t end, const bvxi_box *box)
{
    collapse_cell *const cell = &r->cell[r->cells];

    memset(cell, 0, sizeof *cell);
    cell->begin = begin;
    cell->end = end;
    cell->box = *box;
    node->axis = -1;
    node->low = (int32_t)r->cells;

    /* A vertex finds its cell and its place in it without a search. */
    for (uint64_t i = begin; i < end; i++) {
        r->rank[r->order[i]] = (uint32_t)i;
        r->cell_of[r->order[i]] = (uint32_t)r->cells;
    }
    r->cells++;
}

/* A part of space that is not cut yet. */
typedef struct cell_part {
    uint64_t node, begin, end;
    bvxi_box box;
    int32_t depth;
} cell_part;

/* Cut a part in two; 0 when it is a cell. */
static int cut_part(cell_round *r, const cell_part *part, cell_part below[2])
{
    cell_node *const node = &r->node[part->node];
    uint64_t middle;

    if (part->end - part->begin <= CELL_VERTICES || part->depth == CELL_DEPTH || r->nodes + 2 > r->most_nodes)
        return 0;
    node->axis = widest_axis(r, part->begin, part->end);
    node->cut = choose_cut(r, part->begin, part->end, node->axis);
    middle = part_vertices(r, part->begin, part->end, node->axis, node->cut);

    /* All samples may be one position: then the part stays whole, however large. */
    if (middle == part->begin || middle == part->end) return 0;

    below[0] = below[1] = *part;
    below[0].end = below[1].begin = middle;

    /* Steps are whole numbers, both ends within: the halves share none. */
    below[0].box.high[node->axis] = (int16_t)(node->cut - 1);
    below[1].box.low[node->axis] = node->cut;
    for (int k = 0; k < 2; k++) {
        below[k].depth++;
        below[k].node = r->nodes++;
    }
    node->low = (int32_t)below[0].node;
    node->high = (int32_t)below[1].node;
    return 1;
}

/* Order the vertices by cells. */
static void make_cells(cell_round *r)
{
    const bvxi_corners *const m = &r->whole->mesh;
    cell_part stack[CELL_DEPTH + 2] = {
        {0, 0, m->vertices, {{0, 0, 0}, {BVXI_BOX_HIGHEST, BVXI_BOX_HIGHEST, BVXI_BOX_HIGHEST}}, 0}};
    int32_t depth = 1;

    /* In steps of the box tree, so that cells and boxes round alike. */
    for (uint64_t v = 0; v < m->vertices; v++) {
        bvxi_box const at = bvxi_box_at(&r->whole->boxes, m->at[v].p);

        memcpy(r->step[v], at.low, sizeof r->step[v]);
        r->order[v] = (uint32_t)v;
    }

    /* Depth first, with a stack as deep as cuts may be. */
    r->nodes = 1;
    r->cells = 0;
    while (depth > 0) {
        cell_part const part = stack[--depth];

        if (cut_part(r, &part, stack + depth)) depth += 2;
        else close_cell(r, &r->node[part.node], part.begin, part.end, &part.box);
    }
}

/* ---- Lists of triangles ---- */

/* Enter a triangle that straddles borders into each cell that its box meets; fill 0: count it only. */
static void list_straddling(cell_round *r, uint32_t t, int fill)
{
    const uint32_t *const v = r->whole->mesh.triangle[t].vertex;
    bvxi_box box = bvxi_box_none();
    int32_t stack[CELL_DEPTH + 2], depth = 0;

    for (int k = 0; k < 3; k++) {
        bvxi_box corner;

        memcpy(corner.low, r->step[v[k]], sizeof corner.low);
        memcpy(corner.high, r->step[v[k]], sizeof corner.high);
        bvxi_box_join(&box, &corner);
    }

    /* Down both sides of every cut that the box lies across. */
    stack[depth++] = 0;
    while (depth > 0) {
        const cell_node *const node = &r->node[stack[--depth]];

        if (node->axis < 0) {
            collapse_cell *const cell = &r->cell[node->low];

            if (!fill) cell->straddling++;
            else if (!cell->stays) r->list[cell->first + cell->inside + cell->listed_straddling++] = t;
            continue;
        }
        if (box.low[node->axis] < node->cut) stack[depth++] = node->low;
        if (box.high[node->axis] >= node->cut) stack[depth++] = node->high;
    }
}

static void list_by_cells(cell_round *r, int fill)
{
    const bvxi_corners *const m = &r->whole->mesh;

    for (uint64_t t = 0; t < m->triangles; t++) {
        const uint32_t *const v = m->triangle[t].vertex;
        uint32_t const one = r->cell_of[v[0]];
        collapse_cell *const cell = &r->cell[one];

        /* A cell is convex, so three corners in it hold all of the triangle. */
        if (one != r->cell_of[v[1]] || one != r->cell_of[v[2]]) {
            r->place[t] = UINT32_MAX;
            list_straddling(r, (uint32_t)t, fill);
        } else if (fill) {
            r->place[t] = (uint32_t)cell->listed_inside++;
            if (!cell->stays) r->list[cell->first + r->place[t]] = (uint32_t)t;
        } else {
            cell->inside++;
        }
    }
}

static void list_straddling_ghost(cell_round *r, collapse_cell *cell, uint32_t t, int fill)
{
    if (!fill) cell->ghosts_straddling++;
    else if (!cell->stays)
        r->list[cell->first + cell->inside + cell->straddling + cell->ghosts_inside +
                cell->listed_ghosts_straddling++] = t;
}

/* Ghosts are listed where one of their vertices is: nothing can cross them. */
static void list_ghosts(cell_round *r, int fill)
{
    const bvxi_corners *const m = &r->whole->mesh;

    for (uint64_t t = m->triangles; t < m->triangles + m->ghosts; t++) {
        const uint32_t *const v = m->triangle[t].vertex;
        uint32_t const one = r->cell_of[v[1]], other = r->cell_of[v[2]];
        collapse_cell *const cell = &r->cell[one];

        if (one != other) {
            r->place[t] = UINT32_MAX;
            list_straddling_ghost(r, cell, (uint32_t)t, fill);

            /* Both cells see it: each needs the border edge to close the fans of its own vertices. */
            list_straddling_ghost(r, &r->cell[other], (uint32_t)t, fill);
        } else if (fill) {
            r->place[t] = (uint32_t)(cell->inside + cell->straddling + cell->listed_ghosts_inside++);
            if (!cell->stays) r->list[cell->first + r->place[t]] = (uint32_t)t;
        } else {
            cell->ghosts_inside++;
        }
    }
}

/* Where each cell's list begins, and what a worker must have room for. */
static void size_lists(cell_round *r)
{
    r->listed = r->vertex_room = r->triangle_room = r->ghost_room = 0;
    for (uint64_t i = 0; i < r->cells; i++) {
        collapse_cell *const cell = &r->cell[i];
        uint64_t const triangles = cell->inside + cell->straddling;
        uint64_t const ghosts = cell->ghosts_inside + cell->ghosts_straddling;
        uint64_t const vertices = cell->end - cell->begin + 3 * cell->straddling + cell->ghosts_straddling;

        cell->first = r->listed;

        /* A cell of straddling triangles alone has nothing to collapse; one of very many would not fit a
         * near cache. */
        cell->stays = cell->inside == 0 || triangles > CELL_TRIANGLES;
        if (cell->stays) continue;
        r->listed += triangles + ghosts;

        /* The largest of each decides: a worker takes one cell after the other in the same memory. */
        if (ghosts > r->ghost_room) r->ghost_room = ghosts;
        if (triangles > r->triangle_room) r->triangle_room = triangles;
        if (vertices > r->vertex_room) r->vertex_room = vertices;
    }
}

/* ---- One cell ---- */

/* A cell's mesh: its vertices in their order, then one for every corner outside of a triangle that
 * straddles. */
typedef struct cell_work {
    const cell_round *round;
    const collapse_cell *cell;
    const uint32_t *list;
    bvxi_collapse *c;
    unsigned char *locked;
    uint64_t own; /* vertices in the cell */
} cell_work;

static uint64_t whole_lines(uint64_t bytes)
{
    return (bytes + BVXI_ALIGN - 1) / BVXI_ALIGN * BVXI_ALIGN;
}

static uint64_t chunks_for(uint64_t triangles)
{
    uint64_t const entries = 3 * triangles + BVXI_STAR_MOST;
    uint64_t const spread = entries / (BVXI_QUEUE_CHUNK - 1) + BVXI_QUEUE_HEADS;

    return (entries < spread ? entries : spread) + 2 * BVXI_STAR_MOST;
}

static uint64_t worker_bytes_for(uint64_t vertices, uint64_t triangles, uint64_t ghosts)
{
    /* Each array begins on a line of its own, so that no two workers write one line. */
    return whole_lines(sizeof(bvxi_collapse)) + whole_lines(vertices * sizeof(bvxi_corner_vertex)) +
           whole_lines(vertices * sizeof(bvxi_facing)) + whole_lines(vertices * 4) + whole_lines(vertices) +
           whole_lines((triangles + ghosts) * sizeof(bvxi_corner_triangle)) +
           whole_lines(bvxi_box_tree_bytes(triangles)) +
           whole_lines(chunks_for(triangles) * sizeof(bvxi_queue_chunk)) + BVXI_QUEUE_HEADS * sizeof(int32_t);
}

static unsigned char *take_room(unsigned char **memory, uint64_t bytes)
{
    unsigned char *const block = *memory;

    *memory += whole_lines(bytes);
    return block;
}

/* Lay a cell's mesh, boxes and queue into a worker's memory. */
static void lay_out_cell(cell_work *w, unsigned char *memory)
{
    const cell_round *const r = w->round;
    bvxi_collapse *const c = (bvxi_collapse *)(void *)take_room(&memory, sizeof *c);
    bvxi_corners *const m = &c->mesh;

    /* What is the same for all cells comes from the whole. */
    c->options = r->whole->options;
    c->scale = r->whole->scale;
    c->bounds = w->cell->box;
    c->dearest = r->dearest;
    c->star.lenient = r->whole->star.lenient;
    memset(&c->counts, 0, sizeof c->counts);
    c->colour = NULL; /* meshes with a weight of colours have no cells */

    /* The order of worker_bytes_for. */
    m->at = (bvxi_corner_vertex *)(void *)take_room(&memory, r->vertex_room * sizeof *m->at);
    m->facing = (bvxi_facing *)(void *)take_room(&memory, r->vertex_room * sizeof *m->facing);
    c->version = (uint32_t *)(void *)take_room(&memory, r->vertex_room * sizeof *c->version);
    w->locked = take_room(&memory, r->vertex_room);
    m->triangle = (bvxi_corner_triangle *)(void *)take_room(&memory, (r->triangle_room + r->ghost_room) *
                                                                         sizeof *m->triangle);
    m->triangles = m->left = w->cell->inside + w->cell->straddling;
    m->ghosts = w->cell->ghosts_inside + w->cell->ghosts_straddling;

    c->boxes = r->whole->boxes;
    bvxi_box_tree_lay_out(&c->boxes, m->triangles, take_room(&memory, bvxi_box_tree_bytes(r->triangle_room)));
    c->queue.chunks = (int32_t)chunks_for(m->triangles);

    /* One batch: a cell is small enough to be walked in any order. */
    c->queue.batch = INT32_MAX;
    c->queue.chunk = (bvxi_queue_chunk *)(void *)take_room(&memory, chunks_for(r->triangle_room) *
                                                                        sizeof *c->queue.chunk);
    c->queue.head = (int32_t *)(void *)memory;
    c->locked = w->locked;
    w->c = c;
}

/* The cell's own index of a vertex; a corner outside becomes a vertex of its own. */
static uint32_t take_corner(const cell_work *w, uint32_t v, int *outside)
{
    const cell_round *const r = w->round;
    bvxi_corners *const m = &w->c->mesh;

    if (v == BVXI_VERTEX_GHOST) return v;

    /* A corner outside is copied for each triangle that has it: it is only looked at, and never moves. */
    if (r->rank[v] < w->cell->begin || r->rank[v] >= w->cell->end) {
        *outside = 1;
        memcpy(m->at[m->vertices].p, r->whole->mesh.at[v].p, sizeof m->at[v].p);
        w->locked[m->vertices] = 1;
        return (uint32_t)m->vertices++;
    }
    return (uint32_t)(r->rank[v] - w->cell->begin);
}

static void take_vertices(cell_work *w)
{
    const bvxi_corners *const whole = &w->round->whole->mesh;
    bvxi_corners *const m = &w->c->mesh;

    w->own = m->vertices = w->cell->end - w->cell->begin;
    for (uint64_t i = 0; i < w->own; i++) {
        uint32_t const v = w->round->order[w->cell->begin + i];

        m->at[i] = whole->at[v];
        m->facing[i] = whole->facing[v];
    }
    memset(w->locked, 0, (size_t)w->own);
}

/* The cell's own index of a triangle that has a vertex in the cell. */
static uint32_t own_triangle(const cell_work *w, uint32_t t)
{
    uint64_t low = w->cell->inside, high = w->cell->inside + w->cell->straddling;

    if (w->round->place[t] != UINT32_MAX) return w->round->place[t];
    if (t >= w->round->whole->mesh.triangles) {
        low = high + w->cell->ghosts_inside;
        high = low + w->cell->ghosts_straddling;
    }

    /* Straddling triangles are in several cells and have no one place, but lists are sorted. */
    while (high - low > 1) {
        uint64_t const middle = (low + high) / 2;

        if (w->list[middle] <= t) low = middle;
        else high = middle;
    }
    return (uint32_t)low;
}

/* Corners of all triangles, then their opposites across edges that have an end in the cell: only those other
 * cells do not change, and only those are requested. */
static void take_triangles(cell_work *w)
{
    const bvxi_corners *const whole = &w->round->whole->mesh;
    bvxi_corners *const m = &w->c->mesh;

    for (uint64_t i = 0; i < m->triangles + m->ghosts; i++) {
        const bvxi_corner_triangle *const from = &whole->triangle[w->list[i]];
        bvxi_corner_triangle *const to = &m->triangle[i];
        int outside = 0;

        for (int k = 0; k < 3; k++) to->vertex[k] = take_corner(w, from->vertex[k], &outside);
        for (int k = 0; k < 3; k++) {
            /* A vertex with a triangle that leaves the cell is locked: another cell may change that
             * triangle. */
            if (outside && to->vertex[k] < w->own) w->locked[to->vertex[k]] = 1;
            to->opposite[k] = -1;
            if (to->vertex[(k + 1) % 3] < w->own || to->vertex[(k + 2) % 3] < w->own)
                to->opposite[k] = (int32_t)(own_triangle(w, (uint32_t)from->opposite[k] >> 2) << 2) +
                                  (from->opposite[k] & 3);
        }
    }
    memset(w->c->version, 0, (size_t)m->vertices * sizeof *w->c->version);
}

/* Collapse what is cheap, until half of the triangles are gone. */
static void collapse_edges(cell_work *w)
{
    bvxi_collapse *const c = w->c;
    uint64_t const least = c->mesh.triangles - w->cell->inside / 2;
    bvxi_queue_entry entry;

    bvxi_box_tree_set(&c->boxes, &c->mesh);
    bvxi_queue_clear(&c->queue);

    /* Edges of inner triangles alone: those of straddling ones have a locked end. */
    for (int32_t t = 0; t < (int32_t)w->cell->inside; t++)
        for (int32_t corner = 4 * t; corner < 4 * t + 3; corner++)
            if (corner < bvxi_corner_opposite(&c->mesh, corner)) bvxi_collapse_put(c, corner);

    /* An entry may put as many as a star has edges, so room for one star is kept. */
    while (c->mesh.left > least && bvxi_queue_room(&c->queue) >= BVXI_STAR_MOST &&
           bvxi_queue_take(&c->queue, &entry))
        bvxi_collapse_try(c, &entry);
}

/* 1 when no other cell has the end of an edge. */
static int is_no_others(const cell_work *w, uint32_t v)
{
    return v < w->own || v == BVXI_VERTEX_GHOST;
}

/* A triangle's opposites across edges with both ends in the cell. */
static void give_opposites(const cell_work *w, const bvxi_corner_triangle *from, bvxi_corner_triangle *to)
{
    for (int k = 0; k < 3; k++)
        if (is_no_others(w, from->vertex[(k + 1) % 3]) && is_no_others(w, from->vertex[(k + 2) % 3]))
            to->opposite[k] = (int32_t)(w->list[from->opposite[k] >> 2] << 2) + (from->opposite[k] & 3);
}

static void give_back(const cell_work *w)
{
    bvxi_corners *const whole = &w->round->whole->mesh;
    const bvxi_corners *const m = &w->c->mesh;
    const uint32_t *const vertex = w->round->order + w->cell->begin;

    for (uint64_t i = 0; i < w->own; i++) {
        /* Locked vertices did not move, and a neighbour cell may read them now. */
        if (!w->locked[i]) whole->at[vertex[i]] = m->at[i];
        whole->facing[vertex[i]] = m->facing[i];
    }
    for (uint64_t i = 0; i < m->triangles + m->ghosts; i++) {
        const bvxi_corner_triangle *const from = &m->triangle[i];
        bvxi_corner_triangle *const to = &whole->triangle[w->list[i]];

        /* A triangle that went: marked in the whole mesh, where packing takes it out. */
        if (from->vertex[0] == BVXI_VERTEX_NONE) {
            to->vertex[0] = BVXI_VERTEX_NONE;
            continue;
        }
        for (int k = 0; k < 3 && w->round->place[w->list[i]] != UINT32_MAX; k++)
            if (from->vertex[k] != BVXI_VERTEX_GHOST) to->vertex[k] = vertex[from->vertex[k]];
        give_opposites(w, from, to);
    }
}

static void collapse_one_cell(void *user, int32_t index, int32_t worker)
{
    cell_round *const r = user;
    collapse_cell *const cell = &r->cell[index];
    cell_work w = {.round = r, .cell = cell, .list = r->list + cell->first};

    if (cell->stays) return;
    lay_out_cell(&w, r->memory + r->worker_bytes * (uint64_t)worker);
    take_vertices(&w);
    take_triangles(&w);
    collapse_edges(&w);
    give_back(&w);

    /* Counts are added up afterwards, in the order of the cells. */
    cell->removed = w.c->mesh.triangles - w.c->mesh.left;
    cell->counts = w.c->counts;
}

/* ---- Rounds ---- */

/* A cost that half of the edges stay below, by a sample of them. count [Size: BVXI_QUEUE_FINE], 0. */
static int32_t middle_cost(const bvxi_collapse *c, uint32_t *count)
{
    uint64_t sampled = 0, below = 0;
    int32_t bucket = 0;

    for (uint64_t t = 0; t < c->mesh.triangles; t += CELL_COST_STEP)
        for (int32_t k = 0; k < 3; k++, sampled++) count[bvxi_collapse_bucket(c, (int32_t)(4 * t) + k)]++;

    /* The bucket in which the median lies. */
    while ((below += count[bucket]) * 2 < sampled) bucket++;
    return bucket;
}

static void sum_cells(cell_round *r)
{
    bvxi_collapse *const c = r->whole;

    for (uint64_t i = 0; i < r->cells; i++) {
        const collapse_cell *const cell = &r->cell[i];

        c->mesh.left -= cell->removed;
        c->counts.collapsed += cell->counts.collapsed;
        c->counts.link += cell->counts.link;
        c->counts.turned += cell->counts.turned;
        c->counts.needle += cell->counts.needle;
        c->counts.crossed += cell->counts.crossed;
    }
}

static bvx_status run_round(cell_round *r, double from, double to)
{
    bvxi_collapse *const c = r->whole;
    uint64_t memory_bytes;
    bvx_status status;

    memset(r->place, 0, BVXI_QUEUE_FINE * sizeof *r->place);
    r->dearest = middle_cost(c, r->place);

    /* Counted, then listed: all lists lie in one array, one after the other. */
    make_cells(r);
    list_by_cells(r, 0);
    list_ghosts(r, 0);
    size_lists(r);
    if (r->listed > r->list_room) return BVX_OK;
    list_by_cells(r, 1);
    list_ghosts(r, 1);

    /* As many as threads, each as large as the largest cell needs. */
    r->worker_bytes = whole_lines(worker_bytes_for(r->vertex_room, r->triangle_room, r->ghost_room));
    memory_bytes = r->worker_bytes * (uint64_t)bvxi_threads(c->ctx);
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, memory_bytes, "the cells that collapse", &r->memory));
    status = bvxi_parallel(c->ctx, "collapse", from, to, (int32_t)r->cells, collapse_one_cell, r);
    bvxi_drop(c->ctx, r->memory);
    if (status != BVX_OK) return status;

    sum_cells(r);
    bvxi_corners_pack(&c->mesh, c->version);
    return BVX_OK;
}

/* Lay all arrays into the memory of the queue, which is not set while cells collapse; 0: it is too small. */
static int lay_out_round(cell_round *r)
{
    bvxi_collapse *const c = r->whole;
    uint64_t const vertices = c->mesh.vertices, cells = vertices / (CELL_VERTICES / 8) + 1;
    uint64_t const vertex_bytes = whole_lines(vertices * 4);
    uint64_t const bytes = whole_lines(vertices * sizeof *r->step) + 4 * vertex_bytes +
                           whole_lines((c->mesh.triangles + c->mesh.ghosts) * 4) +
                           whole_lines(2 * cells * sizeof *r->node) + whole_lines(cells * sizeof *r->cell);
    unsigned char *memory = c->chunks;

    /* A mesh that is small collapses as a whole about as fast. */
    if (bytes > c->chunk_bytes || c->mesh.triangles < BVXI_QUEUE_FINE) return 0;
    r->most_nodes = 2 * cells - 1;
    r->step = (int16_t(*)[3])(void *)take_room(&memory, vertices * sizeof *r->step);
    r->order = (uint32_t *)(void *)take_room(&memory, vertex_bytes);
    r->other = (uint32_t *)(void *)take_room(&memory, vertex_bytes);
    r->rank = (uint32_t *)(void *)take_room(&memory, vertex_bytes);
    r->cell_of = (uint32_t *)(void *)take_room(&memory, vertex_bytes);
    r->place = (uint32_t *)(void *)take_room(&memory, (c->mesh.triangles + c->mesh.ghosts) * 4);
    r->node = (cell_node *)(void *)take_room(&memory, 2 * cells * sizeof *r->node);
    r->cell = (collapse_cell *)(void *)take_room(&memory, cells * sizeof *r->cell);
    r->list = (uint32_t *)(void *)memory;
    r->list_room = (c->chunk_bytes - bytes) / 4;
    return 1;
}

int bvxi_collapse_is_far(const bvxi_collapse *c, uint64_t target, uint64_t level)
{
    return (c->mesh.left + COLLAPSE_FAR - 1) / COLLAPSE_FAR > level && c->mesh.left > COLLAPSE_NEAR &&
           c->mesh.left - c->mesh.left / 5 > target;
}

bvx_status bvxi_collapse_cells(bvxi_collapse *c, uint64_t target, uint64_t level, double from, double to)
{
    cell_round r = {.whole = c};

    /* Cells index triangles from 0 on without gaps. */
    if (c->mesh.left != c->mesh.triangles) bvxi_corners_pack(&c->mesh, c->version);
    c->packed = UINT64_MAX;
    for (r.number = 0; r.number < CELL_ROUNDS; r.number++) {
        uint64_t const before = c->mesh.left;
        double const middle = 0.5 * (from + to);

        if (!bvxi_collapse_is_far(c, target, level) || !lay_out_round(&r)) break;
        BVXI_TRY(run_round(&r, from, middle));
        from = middle;

        /* Rounds that hardly remove anything leave the rest to the queue. */
        if (before - c->mesh.left < before / 16) break;
    }
    return BVX_OK;
}
