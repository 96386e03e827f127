/* write_vtu.c - the leaves of an octree to VTK's XML unstructured grid: voxels with their level and state.
 *
 * Source: VTK File Formats (docs.vtk.org), version 1.0 with 64-bit counts. A corner is known by its place
 * among those of the finest level: sorting the corners of all leaves by it brings equal ones together, so
 * that a reader finds the faces that two leaves share. The number of a corner is its rank among the places, z
 * first. */
#include "io/formats.h"
#include "io_grid/tree_file.h"
#include "mesh/mesh.h"

static const char vtu_name[] = "bvx_write_octree";

enum { VTU_VOXEL = 11, VTU_SIDE_BITS = 21, VTU_ARRAYS = 6 };

typedef struct vtu_leaves {
    bvx_context *ctx;
    const bvx_octree *tree;
    bvx_octree_leaf *leaf;
    uint64_t count;
    uint64_t *place;  /* of corners: sorted, then each different one once [Size: count * 8] */
    uint32_t *corner; /* 8 * leaf + corner of each place [Size: count * 8] */
    uint64_t points;
} vtu_leaves;

static const char *const vtu_array[VTU_ARRAYS] = {
    "      <Points>\n        <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"appended\" "
    "offset=\"",
    "      </Points>\n      <Cells>\n        <DataArray type=\"Int32\" Name=\"connectivity\" "
    "format=\"appended\" offset=\"",
    "        <DataArray type=\"Int32\" Name=\"offsets\" format=\"appended\" offset=\"",
    "        <DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"",
    "      </Cells>\n      <CellData Scalars=\"level\">\n        <DataArray type=\"UInt8\" Name=\"level\" "
    "format=\"appended\" offset=\"",
    "        <DataArray type=\"UInt8\" Name=\"state\" format=\"appended\" offset=\""};

static void vtu_sizes(const vtu_leaves *v, uint64_t size[VTU_ARRAYS])
{
    size[0] = 24 * v->points;
    size[1] = 32 * v->count;
    size[2] = 4 * v->count;
    size[3] = size[4] = size[5] = v->count;
}

static void put_vtu_head(const vtu_leaves *v, bvxi_output *out)
{
    uint64_t size[VTU_ARRAYS], offset = 0;

    vtu_sizes(v, size);
    bvxi_output_print(out,
                      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n"
                      "    <Piece NumberOfPoints=\"%u\" NumberOfCells=\"%u\">\n",
                      v->points, v->count);
    for (int i = 0; i < VTU_ARRAYS; i++) {
        bvxi_output_print(out, "%s%u\"/>\n", vtu_array[i], offset);
        offset += 8 + size[i];
    }
    bvxi_output_print(
        out,
        "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n    _");
}

static uint8_t *put_vtu_length(uint8_t *to, uint64_t length)
{
    bvxi_store_u64(to, length);
    return to + 8;
}

static uint8_t *put_vtu_corners(const vtu_leaves *v, const uint64_t size[VTU_ARRAYS], uint8_t *to)
{
    uint64_t const mask = ((uint64_t)1 << VTU_SIDE_BITS) - 1;
    uint8_t *point = put_vtu_length(to, size[0]), *const corners = put_vtu_length(point + size[0], size[1]);
    uint32_t number = UINT32_MAX;

    for (uint64_t i = 0; i < 8 * v->count; i++) {
        if (i == 0 || v->place[i] != v->place[i - 1]) {
            for (int a = 0; a < 3; a++) {
                double const at = (double)(v->place[i] >> VTU_SIDE_BITS * a & mask);
                bvxi_store_f64(point + 8 * a, v->tree->lattice.origin[a] + at * v->tree->lattice.spacing[a]);
            }
            point += 24;
            number++;
        }
        bvxi_store_u32(corners + 4 * (size_t)v->corner[i], number);
    }
    return corners + size[1];
}

static bvx_status write_vtu_file(vtu_leaves *v, bvx_buffer *file)
{
    static const char tail[] = "\n  </AppendedData>\n</VTKFile>\n";
    bvxi_output head = {0};
    uint64_t size[VTU_ARRAYS], bytes = sizeof tail - 1;

    for (uint64_t n = 0; n < 8 * v->count; n++) {
        /* Doubling the place for each level up brings corners of all levels to one lattice. */
        const bvx_octree_leaf *const leaf = &v->leaf[n / 8];
        int32_t const up = v->tree->levels - leaf->level;
        uint64_t at[3];
        for (int a = 0; a < 3; a++) at[a] = (uint64_t)(leaf->ijk[a] + (int32_t)(n >> a & 1)) << up;
        /* 21 bits each: the sides are checked to be below 2^21, so the last corner fits too. */
        v->place[n] = at[2] << 2 * VTU_SIDE_BITS | at[1] << VTU_SIDE_BITS | at[0];
        v->corner[n] = (uint32_t)n;
    }

    BVXI_TRY(bvxi_radix_sort(v->ctx, v->place, v->corner, 8 * v->count));
    BVXI_TRY(bvxi_progress(v->ctx, "octree", 0.7));
    v->points = 0;
    for (uint64_t i = 0; i < 8 * v->count; i++) v->points += i == 0 || v->place[i] != v->place[i - 1];
    put_vtu_head(v, &head);
    vtu_sizes(v, size);
    bytes += head.size;
    for (int i = 0; i < VTU_ARRAYS; i++) bytes += 8 + size[i];
    BVXI_TRY(bvxi_make_buffer(v->ctx, bytes, "the VTU file", file));
    head.bytes = file->bytes;
    head.size = 0;
    put_vtu_head(v, &head);
    uint8_t *to = file->bytes + head.size;
    to = put_vtu_length(put_vtu_corners(v, size, to), size[2]);
    for (uint64_t n = 0; n < v->count; n++, to += 4) bvxi_store_u32(to, (uint32_t)(8 * n + 8));
    to = put_vtu_length(to, size[3]);
    memset(to, VTU_VOXEL, (size_t)size[3]);
    to = put_vtu_length(to + size[3], size[4]);
    for (uint64_t n = 0; n < v->count; n++) *to++ = v->leaf[n].level;
    to = put_vtu_length(to, size[5]);
    for (uint64_t n = 0; n < v->count; n++) *to++ = v->leaf[n].state;
    memcpy(file->bytes + bytes - (sizeof tail - 1), tail, sizeof tail - 1);
    return BVX_OK;
}

static bvx_status write_vtu(bvx_context *ctx, const bvx_octree *tree, int32_t states, bvx_buffer *file)
{
    vtu_leaves v = {.ctx = ctx, .tree = tree};

    /* Places must fit the bits of a key, and the last corner must be a finite number. */
    for (int a = 0; a < 3; a++) {
        double const far = tree->lattice.origin[a] + (double)tree->lattice.dims[a] * tree->lattice.spacing[a];
        if (tree->lattice.dims[a] >= (int32_t)1 << VTU_SIDE_BITS)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the lattice has %d voxels along %s; VTU is written up to 2^21 - 1",
                                 vtu_name, (int64_t)tree->lattice.dims[a], bvxi_axis_name[a]);
        if (!(far - far == 0.0))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: the lattice ends beyond the largest number along %s", vtu_name,
                                 bvxi_axis_name[a]);
    }

    BVXI_TRY(
        bvxi_octree_leaves(bvxi_call_of(ctx, vtu_name, "octree", 0.0, 0.1), tree, states, NULL, 0, &v.count));
    if (v.count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the tree has no leaf in states %d", vtu_name,
                         (int64_t)states);
    /* Eight corners a leaf: their numbers must fit 31 bits, as VTK's Int32 has them. */
    if (v.count >= (uint64_t)1 << 28)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u leaves; VTU is written up to 2^28 - 1", vtu_name, v.count);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, v.count * sizeof *v.leaf, "the octree's leaves", &v.leaf));
    BVXI_TRY(bvxi_octree_leaves(bvxi_call_of(ctx, vtu_name, "octree", 0.1, 0.3), tree, states, v.leaf,
                                v.count, &v.count));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, v.count * 64, "the leaves' corners", &v.place));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, v.count * 32, "the leaves' corners", &v.corner));
    return write_vtu_file(&v, file);
}

static bvx_status run_write_octree(bvx_context *context, const bvx_octree *tree, int32_t states,
                                   int32_t format, bvx_buffer *file)
{
    bvx_buffer made = {0};

    BVXI_TRY(bvxi_renew_buffer(context, vtu_name, file));
    BVXI_TRY(bvxi_octree_check(context, vtu_name, tree));
    if (format != BVX_FORMAT_VTU && format != BVX_FORMAT_BVX)
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: format %d holds no octree; take BVX or VTU",
                         vtu_name, (int64_t)format);

    /* The whole tree is read back by bvx_read_octree; leaves of some states would be no tree. */
    if (format == BVX_FORMAT_BVX && states != 0)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: states is %d; BVX holds the whole tree, and takes 0", vtu_name,
                             (int64_t)states);
    BVXI_TRY(format == BVX_FORMAT_VTU ? write_vtu(context, tree, states, &made)
                                      : bvxi_write_tree(context, tree, &made));
    *file = made;
    return BVX_OK;
}

bvx_status bvx_write_octree(bvx_context *context, const bvx_octree *tree, int32_t states, int32_t format,
                            bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_octree(context, tree, states, format, file));
}
