/* vox.c - MagicaVoxel's .vox, to grids and from them: one model, or several that a scene places.
 *
 * Source: https://github.com/ephtracy/voxel-model, file format and its extension. */
#include "bits/bits.h"
#include "io_grid/grid_formats.h"

/* ---- Read ---- */

/* Versions 150 and 200. Chunks lie one after the other in MAIN; those for models are PACK (how many there are), SIZE and
 * XYZI, those of a scene nTRN (a place and a turn), nGRP (several nodes) and nSHP (a model), the palette RGBA. All others
 * (materials) are passed. A model alone begins at the origin, wherever a scene has it. A node has one parent, so no
 * scene has more places than nodes. Everything is checked before there is a grid; a grid is at most 2 MiB, of a
 * scene 16 MiB for each place of a model. */

enum { VOX_HEAD = 12, VOX_BEGIN = 8, VOX_LONGEST_SIDE = 256, VOX_WORDS_EACH = 1 << 21 };
enum { VOX_NO_NODE, VOX_TRANSFORM, VOX_GROUP, VOX_SHAPE };
#define VOX_FARTHEST 1e9 /* of a node's place from its parent's */

typedef struct vox_model {
    const uint8_t *size, *voxels; /* of a SIZE chunk, and of the XYZI chunk after it, after its count */
    uint64_t count;
} vox_model;

/* Axis a of the parent is axis[a] of the child, reversed where sign[a] is -1, and moved. */
typedef struct vox_place {
    int32_t axis[3], sign[3];
    int64_t move[3];
} vox_place;

typedef struct vox_node {
    const uint8_t *content, *end; /* after the node's own number */
    int32_t kind, seen;
    vox_place place; /* of its parent, once that was seen; of a shape in the scene */
    uint64_t model;
} vox_node;

typedef struct vox_scene {
    const bvxi_grid_source *source;
    vox_model *model;       /* NULL: they are counted */
    vox_node *node;         /* by their numbers */
    uint64_t sizes, models; /* SIZE and XYZI chunks */
    uint64_t nodes;
    uint64_t said;          /* by PACK; 0: nothing was said */
    const uint8_t *palette; /* of labels 1 to 255; NULL: the one that holds without */
    uint8_t *labels;        /* of the box; NULL: a grid is read */
} vox_scene;

static bvx_status vox_take_node(vox_scene *scene, const uint8_t *chunk, uint32_t n)
{
    static const char *const names[] = {"nTRN", "nGRP", "nSHP"};
    const uint8_t *const content = chunk + VOX_HEAD;
    int32_t kind = VOX_NO_NODE;

    for (int32_t k = 0; k < 3; k++)
        if (memcmp(chunk, names[k], 4) == 0) kind = VOX_TRANSFORM + k;
    /* No node has less than four numbers, so the file is as long as a third of what is kept of all. */
    if (kind == VOX_NO_NODE || n < 16) return BVX_OK;
    if (scene->node == NULL) {
        scene->nodes++;
        return BVX_OK;
    }
    /* Nodes have the numbers from 0. One of another is none: a child of that number is missing. */
    uint64_t const number = bvxi_load_u32(content, 0);
    if (number >= scene->nodes || scene->node[number].kind != VOX_NO_NODE) return BVX_OK;
    scene->node[number].kind = kind;
    scene->node[number].content = content + 4;
    scene->node[number].end = content + n;
    return BVX_OK;
}

static bvx_status vox_take_chunk(const bvxi_grid_source *source, const uint8_t *chunk, uint32_t n,
                                 vox_scene *scene)
{
    const uint8_t *const content = chunk + VOX_HEAD;

    if (memcmp(chunk, "PACK", 4) == 0) {
        if (n != 4)
            return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "PACK has %u bytes, not 4", (uint64_t)n);
        scene->said = bvxi_load_u32(content, 0);
        if (scene->said == 0) return BVXI_BYTE_FAIL(source, content, BVX_ERR_FORMAT, "PACK says 0 models");
    } else if (memcmp(chunk, "SIZE", 4) == 0) {
        if (n != 12)
            return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "SIZE has %u bytes, not 12", (uint64_t)n);
        if (scene->model != NULL) scene->model[scene->sizes].size = content;
        scene->sizes++;
    } else if (memcmp(chunk, "XYZI", 4) == 0) {
        uint64_t const count = n < 4 ? 0 : bvxi_load_u32(content, 0);
        if (n < 4 || n - 4 != 4 * count)
            return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "XYZI has %u bytes; its %u voxels take %u",
                                  (uint64_t)n, count, 4 + 4 * count);
        if (scene->sizes <= scene->models)
            return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "XYZI before any SIZE");
        if (scene->model != NULL) {
            scene->model[scene->models].count = count;
            scene->model[scene->models].voxels = content + 4;
        }
        scene->models++;
    } else if (memcmp(chunk, "RGBA", 4) == 0 && n >= 1020) scene->palette = content;
    else return vox_take_node(scene, chunk, n);
    return BVX_OK;
}

static bvx_status vox_walk(const bvxi_grid_source *source, const uint8_t *p, vox_scene *scene)
{
    while (p != source->end) {
        uint64_t const left = (uint64_t)(source->end - p);
        if (left < VOX_HEAD)
            return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: the file ends in a chunk's head",
                                  bvxi_grid_byte(source, p) + left);
        uint32_t const content = bvxi_load_u32(p + 4, 0), children = bvxi_load_u32(p + 8, 0);
        /* Added in 64 bits, as two lengths of 32 bits can be more than 32 hold. */
        if ((uint64_t)content + children > left - VOX_HEAD)
            return BVXI_BYTE_FAIL(source, p, BVX_ERR_FORMAT, "a chunk of %u bytes, %u are left",
                                  (uint64_t)content + children, left - VOX_HEAD);
        BVXI_TRY(vox_take_chunk(source, p, content, scene));
        p += VOX_HEAD + (size_t)content + (size_t)children;
    }
    return BVX_OK;
}

static bvx_status vox_check_start(const bvxi_grid_source *source)
{
    const uint8_t *const p = source->begin;
    uint64_t const size = (uint64_t)(source->end - p);

    if (size < VOX_BEGIN || memcmp(p, "VOX ", 4) != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                              "byte 0: the file does not begin with \"VOX \" and a version");
    uint32_t const version = bvxi_load_u32(p + 4, 0);
    if (version != 150 && version != 200)
        return BVXI_FILE_FAIL(source, BVX_ERR_UNSUPPORTED, "byte 4: version %u; 150 and 200 can be read",
                              (uint64_t)version);
    if (size < VOX_BEGIN + VOX_HEAD)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: the file ends before its MAIN chunk", size);
    if (memcmp(p + VOX_BEGIN, "MAIN", 4) != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte 8: the first chunk is not MAIN");

    uint64_t const content = bvxi_load_u32(p + VOX_BEGIN + 4, 0);
    uint64_t const children = bvxi_load_u32(p + VOX_BEGIN + 8, 0);
    if (content + children != size - VOX_BEGIN - VOX_HEAD)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte 12: MAIN holds %u bytes, the file has %u",
                              content + children, size - VOX_BEGIN - VOX_HEAD);
    return BVX_OK;
}

static bvx_status vox_check_model(const bvxi_grid_source *source, const vox_model *model)
{
    uint64_t dims[3];

    /* Coordinates are single bytes, so no side is longer than 256. */
    for (int32_t a = 0; a < 3; a++) {
        dims[a] = bvxi_load_u32(model->size + 4 * a, 0);
        if (dims[a] < 1 || dims[a] > VOX_LONGEST_SIDE)
            return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                                  "byte %u: SIZE says %u voxels along %s; 1 to %u are possible",
                                  bvxi_grid_byte(source, model->size) + 4 * (uint64_t)a, dims[a],
                                  bvxi_axis_name[a], (uint64_t)VOX_LONGEST_SIDE);
    }
    /* Every voxel is checked before there is a grid, so setting them needs no check. */
    for (uint64_t i = 0; i < model->count; i++)
        for (int32_t a = 0; a < 3; a++) {
            const uint8_t *const at = model->voxels + 4 * i + (uint64_t)a;
            if (*at >= dims[a])
                return BVXI_BYTE_FAIL(source, at, BVX_ERR_FORMAT, "voxel %u has %s = %u, SIZE says %u", i,
                                      bvxi_axis_name[a], (uint64_t)*at, dims[a]);
        }
    return BVX_OK;
}

/* ---- A scene ---- */

/* Content that is read number by number; p is NULL once it was too short. */
typedef struct vox_text {
    const uint8_t *p, *end;
} vox_text;

static const uint8_t *vox_skip(vox_text *t, uint64_t n)
{
    const uint8_t *const at = t->p;

    if (at == NULL || (uint64_t)(t->end - at) < n) t->p = NULL;
    else t->p = at + n;
    return t->p == NULL ? NULL : at;
}

static uint32_t vox_number(vox_text *t)
{
    const uint8_t *const at = vox_skip(t, 4);
    return at == NULL ? 0 : bvxi_load_u32(at, 0);
}

/* Pairs of names and values; those of a frame are its turn and its place. */
static void vox_take_pairs(vox_text *t, vox_place *place)
{
    for (uint32_t pairs = vox_number(t); pairs > 0 && t->p != NULL; pairs--) {
        uint32_t const name_size = vox_number(t);
        const uint8_t *const name = vox_skip(t, name_size);
        uint32_t const size = vox_number(t);
        const char *value = (const char *)vox_skip(t, size), *const end = value + size;
        double number[3] = {0, 0, 0};

        if (value == NULL || name_size != 2 || place == NULL || name[0] != '_') continue;
        for (int k = 0; k < (name[1] == 't' ? 3 : 1); k++) {
            while (value != end && *value == ' ') value++;
            size_t const used = bvxi_parse_double(value, end, &number[k]);
            if (used == 0 || !(bvxi_absolute(number[k]) <= VOX_FARTHEST)) t->p = NULL;
            value += used;
        }
        if (t->p == NULL) return;
        for (int a = 0; a < 3 && name[1] == 't'; a++) place->move[a] = (int64_t)number[a];
        if (name[1] != 'r') continue;
        /* Rows of a matrix: where two of them have their 1, in two bits each, and three signs. */
        uint32_t const bits = number[0] >= 0 ? (uint32_t)number[0] : 3, first = bits & 3,
                       second = bits >> 2 & 3;
        if (first == 3 || second == 3 || first == second) t->p = NULL;
        place->axis[0] = (int32_t)first;
        place->axis[1] = (int32_t)second;
        place->axis[2] = 3 - place->axis[0] - place->axis[1];
        for (int a = 0; a < 3; a++) place->sign[a] = (bits >> (4 + a) & 1) != 0 ? -1 : 1;
    }
}

/* The children of a node get their places, and are put to the end of the queue. */
static bvx_status vox_visit(vox_scene *scene, vox_node *node, uint32_t *queue, uint64_t *queued)
{
    static const vox_place here = {{0, 1, 2}, {1, 1, 1}, {0, 0, 0}};
    vox_text t = {node->content, node->end};
    vox_place place = node->place;
    uint32_t children = 1;

    vox_take_pairs(&t, NULL);
    if (node->kind == VOX_TRANSFORM) {
        vox_place own = here;
        vox_text frames = t;

        /* After the child something reserved, a layer, and frames, of which the first counts. */
        vox_skip(&frames, 12);
        if (vox_number(&frames) != 0) vox_take_pairs(&frames, &own);
        if (frames.p == NULL) t.p = NULL;
        /* Where something is that lies so in what lies as the node. */
        for (int a = 0; a < 3; a++) {
            int32_t const along = node->place.axis[a];
            place.axis[a] = own.axis[along];
            place.sign[a] = node->place.sign[a] * own.sign[along];
            place.move[a] = node->place.move[a] + node->place.sign[a] * own.move[along];
        }
    } else children = vox_number(&t);
    if (node->kind == VOX_SHAPE) {
        node->model = children != 0 ? vox_number(&t) : 0;
        if (t.p != NULL && children != 0 && node->model < scene->models) return BVX_OK;
        return BVXI_BYTE_FAIL(scene->source, node->content, BVX_ERR_FORMAT, "a shape without a model");
    }
    for (; children > 0 && t.p != NULL; children--) {
        uint32_t const child = vox_number(&t);

        if (t.p == NULL) break;
        if (child >= scene->nodes || scene->node[child].kind == VOX_NO_NODE || scene->node[child].seen)
            return BVXI_BYTE_FAIL(scene->source, node->content, BVX_ERR_FORMAT,
                                  "node %u is not there, or has a parent already", (uint64_t)child);
        scene->node[child].seen = 1;
        scene->node[child].place = place;
        queue[(*queued)++] = child;
    }
    return t.p != NULL ? BVX_OK
                       : BVXI_BYTE_FAIL(scene->source, node->content, BVX_ERR_FORMAT,
                                        "a node of the scene is cut short, or its place or turn is none");
}

/* All nodes from the first one on: shapes get their places in the scene. */
static bvx_status vox_place_nodes(vox_scene *scene)
{
    bvx_context *const ctx = scene->source->ctx;
    uint64_t queued = 1;
    uint32_t *queue;

    BVXI_TRY(BVXI_ARRAY(ctx, scene->nodes, "the nodes of a scene", queue));
    queue[0] = 0;
    for (int a = 0; a < 3; a++) {
        scene->node[0].place.axis[a] = a;
        scene->node[0].place.sign[a] = 1;
    }
    scene->node[0].seen = 1;
    for (uint64_t i = 0; i < queued; i++) BVXI_TRY(vox_visit(scene, &scene->node[queue[i]], queue, &queued));
    return BVX_OK;
}

/* A voxel of a model in the scene: models turn around the voxel in their middle. */
static void vox_in_scene(const vox_place *p, const uint8_t *size, const int32_t v[3], int64_t at[3])
{
    for (int a = 0; a < 3; a++) {
        int32_t const k = p->axis[a], from_middle = v[k] - (int32_t)(bvxi_load_u32(size + 4 * k, 0) / 2);
        at[a] = p->move[a] + (p->sign[a] > 0 ? from_middle : -from_middle - 1);
    }
}

static int vox_is_placed(const vox_node *n)
{
    return n->kind == VOX_SHAPE && n->seen;
}

/* The box of all models of the scene. */
static bvx_status vox_box(const vox_scene *scene, int64_t low[3], uint64_t dims[3])
{
    int64_t high[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
    uint64_t shapes = 0;
    int ok = 1;

    for (int a = 0; a < 3; a++) low[a] = INT64_MAX;
    for (uint64_t i = 0; i < scene->nodes; i++) {
        const vox_node *const n = &scene->node[i];
        const uint8_t *const size = vox_is_placed(n) ? scene->model[n->model].size : NULL;

        if (size == NULL) continue;
        shapes++;
        for (int end = 0; end < 2; end++) {
            int32_t corner[3] = {0, 0, 0};
            int64_t at[3];

            for (int a = 0; a < 3 && end == 1; a++) corner[a] = (int32_t)bvxi_load_u32(size + 4 * a, 0) - 1;
            vox_in_scene(&n->place, size, corner, at);
            for (int a = 0; a < 3; a++) {
                low[a] = at[a] < low[a] ? at[a] : low[a];
                high[a] = at[a] > high[a] ? at[a] : high[a];
            }
        }
    }
    if (shapes == 0)
        return BVXI_FILE_FAIL(
            scene->source, BVX_ERR_UNSUPPORTED,
            "the file has %u models and no scene that places them; save each in a file of its own",
            scene->models);
    for (int a = 0; a < 3; a++) dims[a] = (uint64_t)(high[a] - low[a]) + 1;
    if (bvxi_mul(bvxi_mul(dims[0] / 64 + 1, dims[1], &ok), dims[2], &ok) > shapes * VOX_WORDS_EACH || !ok)
        return BVXI_FILE_FAIL(scene->source, BVX_ERR_UNSUPPORTED,
                              "the scene's %u models lie far apart, in %u x %u x %u voxels", shapes, dims[0],
                              dims[1], dims[2]);
    return BVX_OK;
}

static void vox_set_model(const vox_scene *scene, bvx_grid *grid, const bvx_window *part, uint64_t number,
                          const vox_place *place, const int64_t low[3])
{
    const vox_model *const model = &scene->model[number];

    for (uint64_t i = 0; i < model->count; i++) {
        const uint8_t *const p = model->voxels + 4 * i;
        int32_t const v[3] = {p[0], p[1], p[2]};
        int64_t at[3] = {v[0], v[1], v[2]};

        if (place != NULL) vox_in_scene(place, model->size, v, at);
        for (int a = 0; a < 3; a++) at[a] -= low[a];
        bvxi_set_file_run(grid, part, at[0], at[0] + 1, at[1], at[2]);
        /* A voxel of no colour is set too. */
        if (scene->labels != NULL)
            scene->labels[(at[2] * grid->size[1] + at[1]) * grid->size[0] + at[0]] = p[3] != 0 ? p[3] : 1;
    }
}

/* Chunks are counted, then kept. */
static bvx_status vox_open(const bvxi_grid_source *source, vox_scene *scene)
{
    /* The children of MAIN begin after its own content, which is empty in all known files. */
    const uint8_t *const first = source->begin + VOX_BEGIN + VOX_HEAD +
                                 bvxi_load_u32(source->begin + VOX_BEGIN + 4, 0);

    BVXI_TRY(vox_walk(source, first, scene));
    if (scene->models == 0)
        return BVXI_BYTE_FAIL(source, source->end, BVX_ERR_FORMAT,
                              "the file ends without a model (SIZE and XYZI)");
    if (scene->sizes != scene->models)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "%u SIZE chunks and %u XYZI chunks", scene->sizes,
                              scene->models);
    if (scene->said > scene->models)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "PACK says %u models, the file has %u", scene->said,
                              scene->models);
    BVXI_TRY(BVXI_ZEROS(source->ctx, scene->models, "the models of the file", scene->model));
    BVXI_TRY(BVXI_ZEROS(source->ctx, scene->nodes, "the nodes of a scene", scene->node));
    scene->sizes = scene->models = 0;
    BVXI_TRY(vox_walk(source, first, scene));
    for (uint64_t i = 0; i < scene->models; i++) BVXI_TRY(vox_check_model(source, &scene->model[i]));
    return BVX_OK;
}

/* The palette of files without one: steps of 51 down from white, then of 17 in red, green, blue and grey. */
static void vox_palette(const uint8_t *own, uint8_t *palette)
{
    memset(palette, 0, 1024);
    if (own != NULL) memcpy(palette + 4, own, 1020);
    for (uint32_t i = 0; i < 255 && own == NULL; i++) {
        static const uint8_t shade[10] = {238, 221, 187, 170, 136, 119, 85, 68, 34, 17};
        uint8_t *const to = palette + 4 * (i + 1);
        uint32_t const step = i - 215;

        for (uint32_t a = 0, part = 36; a < 3; a++, part /= 6)
            to[a] = i < 215                            ? (uint8_t)(255 - 51 * (i / part % 6))
                    : step / 10 == a || step / 10 == 3 ? shade[step % 10]
                                                       : 0;
        to[3] = 255;
    }
}

bvx_status bvxi_read_vox(const bvxi_grid_source *source, bvx_grid *grid, bvx_buffer *labels, uint8_t *palette)
{
    static const double spacing[3] = {1, 1, 1};
    vox_scene scene = {.source = source};
    int64_t low[3] = {0, 0, 0};
    uint64_t dims[3];
    double origin[3];
    bvx_lattice box;
    bvx_window whole, part;

    BVXI_TRY(vox_check_start(source));
    BVXI_TRY(vox_open(source, &scene));
    int const alone = scene.models == 1;
    for (int a = 0; a < 3; a++) dims[a] = bvxi_load_u32(scene.model[0].size + 4 * a, 0);
    if (!alone && scene.nodes != 0) BVXI_TRY(vox_place_nodes(&scene));
    if (!alone) BVXI_TRY(vox_box(&scene, low, dims));
    BVXI_TRY(bvxi_progress(source->ctx, "read", 0.0));

    for (int a = 0; a < 3; a++) origin[a] = (double)low[a];
    BVXI_TRY(bvxi_file_box(source, origin, spacing, dims, &box));
    memset(whole.low, 0, sizeof whole.low);
    memcpy(whole.size, box.dims, sizeof whole.size);
    BVXI_TRY(bvxi_open_file_grid(source, &box, &whole, &part, grid));
    if (labels != NULL) {
        /* The box is of so many words that its voxels can be counted. */
        BVXI_TRY(bvxi_make_buffer(source->ctx, dims[0] * dims[1] * dims[2], "the labels", labels));
        scene.labels = labels->bytes;
        memset(scene.labels, 0, (size_t)labels->size);
        vox_palette(scene.palette, palette);
    }
    if (alone) vox_set_model(&scene, grid, &part, 0, NULL, low);
    for (uint64_t i = 0; i < scene.nodes && !alone; i++) {
        const vox_node *const n = &scene.node[i];
        if (vox_is_placed(n)) vox_set_model(&scene, grid, &part, n->model, &n->place, low);
    }
    return BVX_OK;
}

/* ---- Written ---- */

/* Version 150. Chunks of a name, the bytes of their content and of their children: MAIN around SIZE (three sides) and
 * XYZI (a count, then x, y, z and a colour number for each voxel). z is up there too. More than 256 voxels a side are
 * models of 256, which a scene puts side by side. There is no place for a lattice. Without labels all voxels have
 * colour 1, white in the palette that holds when none is written. The file is laid out twice, to count and to fill. */

enum { VOX_MAX_SIDE = 256, VOX_VERSION = 150, VOX_COLOUR = 1, VOX_MOST_MODELS = 1 << 20 };

static void vox_put_head(bvxi_output *o, const char *name, uint64_t content, uint64_t children)
{
    bvxi_output_add(o, name, 4);
    bvxi_output_u32(o, content);
    bvxi_output_u32(o, children);
}

/* A box of voxels, whose first word of a row is whole, as a model. */
static void vox_put_model(bvxi_output *o, const bvx_grid *grid, const uint8_t *labels, const int32_t low[3],
                          const int32_t size[3])
{
    int32_t const first = low[0] / BVXI_WORD_BITS, last = (low[0] + size[0] - 1) / BVXI_WORD_BITS;
    uint64_t count = 0;

    for (int32_t pass = 0; pass < 2; pass++) {
        if (pass == 1) {
            vox_put_head(o, "SIZE", 12, 0);
            for (int32_t a = 0; a < 3; a++) bvxi_output_u32(o, (uint64_t)size[a]);
            vox_put_head(o, "XYZI", 4 + 4 * count, 0);
            bvxi_output_u32(o, count);
        }
        for (int32_t z = 0; z < size[2]; z++)
            for (int32_t y = 0; y < size[1]; y++)
                for (int32_t k = first; k <= last; k++)
                    for (uint64_t w = bvxi_grid_row(grid, low[1] + y, low[2] + z)[k]; w != 0; w &= w - 1) {
                        int32_t const x = k * BVXI_WORD_BITS + bvxi_lowest(w);
                        uint64_t const at = ((uint64_t)(low[2] + z) * (uint64_t)grid->size[1] +
                                             (uint64_t)(low[1] + y)) *
                                                (uint64_t)grid->size[0] +
                                            (uint64_t)x;
                        uint8_t const voxel[4] = {(uint8_t)(x - low[0]), (uint8_t)y, (uint8_t)z,
                                                  labels != NULL ? labels[at] : VOX_COLOUR};
                        if (pass == 1) bvxi_output_add(o, voxel, 4);
                        else count++;
                    }
    }
}

/* A node that places another one, at the middle of what it is. */
static void vox_put_place(bvxi_output *o, uint64_t number, const int32_t middle[3])
{
    bvxi_output text = {NULL, 0};

    /* Once to know how long the text is. */
    for (int pass = 0; pass < 2; pass++) {
        bvxi_output *const to = pass == 0 ? &text : o;

        if (pass == 1) {
            vox_put_head(o, "nTRN", 38 + text.size, 0);
            bvxi_output_u32(o, number);
            bvxi_output_u32(o, 0);
            bvxi_output_u32(o, number + 1);
            bvxi_output_u32(o, UINT32_MAX);
            bvxi_output_u32(o, UINT32_MAX);
            bvxi_output_u32(o, 1);
            bvxi_output_u32(o, 1);
            bvxi_output_u32(o, 2);
            bvxi_output_add(o, "_t", 2);
            bvxi_output_u32(o, text.size);
        }
        bvxi_output_print(to, "%d %d %d", (int64_t)middle[0], (int64_t)middle[1], (int64_t)middle[2]);
    }
}

static void vox_put_file(bvxi_output *o, const bvx_grid *grid, const uint8_t *labels, const uint8_t *palette,
                         const int32_t n[3], uint64_t children)
{
    int32_t const all = n[0] * n[1] * n[2];
    static const int32_t here[3] = {0, 0, 0};
    int32_t size[3], low[3], middle[3];

    o->size = 0;
    bvxi_output_add(o, "VOX ", 4);
    bvxi_output_u32(o, VOX_VERSION);
    vox_put_head(o, "MAIN", 0, children);
    for (int32_t scene = 0; scene < (all > 1 ? 2 : 1); scene++) {
        /* Nodes: 0 and 1 hold all, then two for each model. */
        if (scene == 1) {
            vox_put_place(o, 0, here);
            vox_put_head(o, "nGRP", 12 + 4 * (uint64_t)all, 0);
            bvxi_output_u32(o, 1);
            bvxi_output_u32(o, 0);
            bvxi_output_u32(o, (uint64_t)all);
            for (int32_t i = 0; i < all; i++) bvxi_output_u32(o, 2 + 2 * (uint64_t)i);
        }
        for (int32_t i = 0; i < all; i++) {
            int32_t const at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};

            for (int a = 0; a < 3; a++) {
                low[a] = at[a] * VOX_MAX_SIDE;
                size[a] = grid->size[a] - low[a] < VOX_MAX_SIDE ? grid->size[a] - low[a] : VOX_MAX_SIDE;
                middle[a] = low[a] + size[a] / 2;
            }
            if (scene == 0) {
                vox_put_model(o, grid, labels, low, size);
                continue;
            }
            vox_put_place(o, 2 + 2 * (uint64_t)i, middle);
            vox_put_head(o, "nSHP", 20, 0);
            bvxi_output_u32(o, 3 + 2 * (uint64_t)i);
            bvxi_output_u32(o, 0);
            bvxi_output_u32(o, 1);
            bvxi_output_u32(o, (uint64_t)i);
            bvxi_output_u32(o, 0);
        }
    }
    if (labels == NULL) return;
    vox_put_head(o, "RGBA", 1024, 0);
    bvxi_output_add(o, palette + 4, 1020);
    bvxi_output_u32(o, 0);
}

bvx_status bvxi_write_vox(bvx_context *ctx, const bvx_grid *grid, const uint8_t *labels,
                          const uint8_t *palette, bvx_buffer *file)
{
    enum { VOX_START = 20 };
    bvxi_output o = {NULL, 0};
    bvx_buffer made = {0};
    int32_t n[3];

    for (int a = 0; a < 3; a++) n[a] = (grid->size[a] - 1) / VOX_MAX_SIDE + 1;
    /* Sides are below 2^26. */
    if ((int64_t)n[0] * n[1] > VOX_MOST_MODELS || (int64_t)n[0] * n[1] * n[2] > VOX_MOST_MODELS)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "VOX: %d x %d x %d voxels are more than 2^20 models of 256 a side; write windows of the grid",
            (int64_t)grid->size[0], (int64_t)grid->size[1], (int64_t)grid->size[2]);
    BVXI_TRY(bvxi_progress(ctx, "write", 0.0));
    vox_put_file(&o, grid, labels, palette, n, 0);
    if (o.size > UINT32_MAX)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "VOX: the file would have %u bytes, more than its lengths of 32 bits hold; write windows of the grid",
            o.size);
    BVXI_TRY(bvxi_make_buffer(ctx, o.size, "the VOX file", &made));
    o.bytes = made.bytes;
    vox_put_file(&o, grid, labels, palette, n, o.size - VOX_START);
    *file = made;
    return BVX_OK;
}
