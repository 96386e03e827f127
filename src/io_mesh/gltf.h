/* gltf.h - a glTF file while it is read: its description, the bytes of its buffers and images, its arrays of
 * numbers, its nodes. Not installed. */
#ifndef BVXI_GLTF_H
#define BVXI_GLTF_H

#include "io/json.h"
#include "io_mesh/mesh_formats.h"

/* What a file names by an index: buffers, accessors ... */
enum {
    BVXI_GLTF_BUFFER,
    BVXI_GLTF_VIEW,
    BVXI_GLTF_ACCESSOR,
    BVXI_GLTF_IMAGE,
    BVXI_GLTF_MATERIAL,
    BVXI_GLTF_MESH,
    BVXI_GLTF_NODE,
    BVXI_GLTF_SCENE,
    BVXI_GLTF_LISTS
};

/* The bytes of a buffer or an image, and whose they are. */
typedef struct bvxi_gltf_bytes {
    const uint8_t *bytes; /* NULL: not looked for yet, or not there */
    uint64_t size;
    void *decoded;       /* scratch of a data URI, or NULL */
    bvx_file_bytes file; /* by open_file */
    int32_t is_open;
} bvxi_gltf_bytes;

typedef struct bvxi_gltf {
    bvxi_source *source;
    const bvx_read_options *options;
    bvxi_json json;
    const uint8_t *chunk; /* of a GLB, or NULL */
    uint64_t chunk_size;
    uint64_t bytes;                  /* of the file, and of all that were opened */
    uint32_t *list[BVXI_GLTF_LISTS]; /* values of the JSON; scratch */
    uint32_t list_count[BVXI_GLTF_LISTS];
    bvxi_gltf_bytes *buffer, *image; /* scratch, one for each */
    uint32_t lost;                   /* BVX_LOST_... */
    bvxi_asset_part *part;           /* of a file that is kept; scratch, or NULL */
    uint32_t *part_of;               /* of each value of the JSON: its part, or BVXI_JSON_NONE; scratch */
    uint64_t parts;
} bvxi_gltf;

/* ---- gltf_file.c: the container, the description's lists, its numbers ---- */

/* Open GLB or text, and refuse what must be known to read it and is not. */
bvx_status bvxi_gltf_open(bvxi_gltf *f);
/* Item i of a list; the list is named in messages. */
bvx_status bvxi_gltf_item(const bvxi_gltf *f, int list, uint64_t i, const char *by, uint32_t *value);
/* A whole number below 2^53. Where the member is missing: fallback, or a failure with BVXI_GLTF_MUST. */
#define BVXI_GLTF_MUST UINT64_MAX
bvx_status bvxi_gltf_whole(const bvxi_gltf *f, int list, uint64_t i, uint32_t object, const char *name,
                           uint64_t fallback, uint64_t *whole);
/* An index into a list; BVXI_JSON_NONE where the member is missing. */
bvx_status bvxi_gltf_index(const bvxi_gltf *f, int list, uint64_t i, uint32_t object, const char *name,
                           int into, uint32_t *index);
/* "glTF: accessor 3: what" */
BVXI_COLD bvx_status bvxi_gltf_fail(const bvxi_gltf *f, int list, uint64_t i, const char *what);

/* ---- gltf_bytes.c: buffers and images ---- */

/* Bytes of a bufferView: its stride is 0 where it has none. */
bvx_status bvxi_gltf_view(bvxi_gltf *f, uint64_t view, const uint8_t **bytes, uint64_t *size,
                          uint64_t *stride, uint64_t *at);
/* What a uri stands for; bytes NULL where no file was found. */
bvx_status bvxi_gltf_uri(bvxi_gltf *f, uint32_t uri, bvxi_gltf_bytes *found);
/* Close what was opened. */
void bvxi_gltf_close(bvxi_gltf *f);

/* ---- gltf_array.c: accessors ---- */

enum {
    BVXI_GLTF_I8 = 5120,
    BVXI_GLTF_U8 = 5121,
    BVXI_GLTF_I16 = 5122,
    BVXI_GLTF_U16 = 5123,
    BVXI_GLTF_U32 = 5125,
    BVXI_GLTF_F32 = 5126
};

typedef struct bvxi_gltf_array {
    const uint8_t *at; /* of the first element; NULL: all are zero */
    uint64_t count, stride;
    int32_t type, components, normalized;
    const uint8_t *sparse_index, *sparse_value; /* elements that differ [Size: sparse_count] */
    uint64_t sparse_count;
    int32_t sparse_type;
} bvxi_gltf_array;

/* All of an accessor but its values is checked. */
bvx_status bvxi_gltf_array_of(bvxi_gltf *f, uint64_t accessor, bvxi_gltf_array *a);
/* Take elements in their order, and then those that differ: v[components] goes to put. A failure of put is
 * returned. */
typedef bvx_status bvxi_gltf_put(void *user, uint64_t element, const double *v);
bvx_status bvxi_gltf_each(bvxi_gltf *f, uint64_t accessor, const bvxi_gltf_array *a, bvxi_gltf_put *put,
                          void *user);

/* ---- gltf_nodes.c: the scene ---- */

/* From a node to the world: row by row three numbers and the translation. Axes are the file's own. */
typedef struct bvxi_gltf_world {
    double m[3][4];
} bvxi_gltf_world;

typedef struct bvxi_gltf_scene {
    bvxi_gltf_world *world; /* [Size: nodes]; scratch */
    uint8_t *drawn;         /* 1: of the scene [Size: nodes]; scratch */
} bvxi_gltf_scene;

bvx_status bvxi_gltf_scene_of(const bvxi_gltf *f, bvxi_gltf_scene *scene);

/* ---- gltf_assets.c: materials, textures, images ---- */

/* Nothing where the file has no materials. */
bvx_status bvxi_gltf_assets(bvxi_gltf *f, bvx_mesh *mesh);

#endif
