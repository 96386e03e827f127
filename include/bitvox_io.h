/* bitvox_io.h - files and pictures, from and to memory: the other part of libbitvox's interface. Licence: MIT.
 *
 *     bvx_mesh mesh = {0};
 *     bvx_buffer file = {0};
 *     if (bvx_read_mesh(context, bytes, size, BVX_FORMAT_STL, NULL, &mesh) == BVX_OK &&
 *         bvx_write_mesh(context, &mesh, 1, NULL, BVX_FORMAT_GLB, &file) == BVX_OK) ...
 *
 * Contents: the titles of the sections below, in their order.
 *     Formats, Pictures                                    bytes of files; shaded pictures, slices
 * What holds for every function stands at the top of bitvox.h. [Memory:] and [Cost:] say what a call takes beside its
 * inputs. */
#ifndef BITVOX_IO_H
#define BITVOX_IO_H

#include "bitvox.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Formats ------------------------------------------------------------------------------------------- */

/** Every format and the ending of its file names, which is also its own name. NRRD has .nhdr too. */
#define BVX_FORMAT_LIST(X) \
    X(BVX_FORMAT_STL, 1, "stl") \
    X(BVX_FORMAT_OBJ, 2, "obj") \
    X(BVX_FORMAT_PLY, 3, "ply") \
    X(BVX_FORMAT_NPY, 4, "npy") \
    X(BVX_FORMAT_PNG, 5, "png") \
    X(BVX_FORMAT_OFF, 6, "off") \
    X(BVX_FORMAT_GLB, 7, "glb") \
    X(BVX_FORMAT_BINVOX, 8, "binvox") \
    X(BVX_FORMAT_VOX, 9, "vox") \
    X(BVX_FORMAT_NRRD, 10, "nrrd") \
    X(BVX_FORMAT_VTI, 11, "vti") \
    X(BVX_FORMAT_BVX, 12, "bvx") \
    X(BVX_FORMAT_VTU, 13, "vtu") \
    X(BVX_FORMAT_RAW, 14, "raw") \
    X(BVX_FORMAT_XYZ, 15, "xyz") \
    X(BVX_FORMAT_CSL, 20, "csl") \
    X(BVX_FORMAT_CSV, 21, "csv") \
    X(BVX_FORMAT_GLTF, 23, "gltf") \
    X(BVX_FORMAT_3MF, 24, "3mf") \
    X(BVX_FORMAT_VDB, 25, "vdb") \
    X(BVX_FORMAT_NVDB, 26, "nvdb")
enum {
    BVX_FORMAT_UNKNOWN = 0,
    BVX_FORMAT_LIST(BVX_LIST_ENUM)
    /** What formats hold: bit 1 << format. */
    BVX_MESHES_READ = 1 << BVX_FORMAT_STL | 1 << BVX_FORMAT_OBJ | 1 << BVX_FORMAT_PLY | 1 << BVX_FORMAT_OFF |
                      1 << BVX_FORMAT_GLB | 1 << BVX_FORMAT_GLTF | 1 << BVX_FORMAT_3MF,
    BVX_MESHES_WRITTEN = 1 << BVX_FORMAT_STL | 1 << BVX_FORMAT_OBJ | 1 << BVX_FORMAT_PLY | 1 << BVX_FORMAT_OFF |
                         1 << BVX_FORMAT_GLB | 1 << BVX_FORMAT_3MF,
    BVX_GRIDS_READ = 1 << BVX_FORMAT_NPY | 1 << BVX_FORMAT_BINVOX | 1 << BVX_FORMAT_VOX | 1 << BVX_FORMAT_NRRD |
                     1 << BVX_FORMAT_VTI | 1 << BVX_FORMAT_BVX,
    BVX_GRIDS_WRITTEN = BVX_GRIDS_READ | 1 << BVX_FORMAT_VDB | 1 << BVX_FORMAT_NVDB,
    BVX_VOLUMES_READ = 1 << BVX_FORMAT_NRRD | 1 << BVX_FORMAT_NPY | 1 << BVX_FORMAT_VTI | 1 << BVX_FORMAT_RAW,
    BVX_POINTS_READ = 1 << BVX_FORMAT_XYZ | 1 << BVX_FORMAT_PLY,
    BVX_SECTIONS_READ = 1 << BVX_FORMAT_CSL | 1 << BVX_FORMAT_CSV,
    BVX_SECTIONS_WRITTEN = BVX_SECTIONS_READ
};

/** Bytes made by the library; freed by bvx_buffer_free. */
typedef struct bvx_buffer {
    uint8_t *bytes;
    uint64_t size;
    uint64_t capacity;
} bvx_buffer;

BVX_API void bvx_buffer_free(bvx_context *context, bvx_buffer *buffer);

/** The format of a file name's ending (also before ".gz"), in either case of letters. */
BVX_API int32_t bvx_format_of_name(const char *name);

/** The bytes of a file that another one names. */
typedef struct bvx_file_bytes {
    const void *bytes;
    uint64_t size;
    void *handle; /**< the callback's own */
} bvx_file_bytes;

/** Fills file with the bytes of the file called name, and returns 0; any other result: there is none. name is
 *  relative to the folder of the file that is read, in UTF-8 with / between folders, without "..", backslash
 *  and colon. The bytes must stay until bvx_close_fn has been called with the same struct. */
typedef int32_t bvx_open_fn(void *user, const char *name, bvx_file_bytes *file);
typedef void bvx_close_fn(void *user, bvx_file_bytes *file);

/** Unpack gzip or zlib data to exactly plain_size bytes. Returns 0 when that is what they hold; any other
 *  number when they are damaged, longer or shorter. Called on the calling thread. */
typedef int32_t bvx_inflate_fn(void *user, const void *packed, uint64_t packed_size, void *plain, uint64_t plain_size);

/** What a file holds that its mesh does not: skins with their joints and weights, morph targets, animations,
 *  points and lines, images whose file was not found, attributes beyond those of bvx_mesh,
 *  materials of OBJ. Bits. */
#define BVX_LOST_LIST(X) \
    X(BVX_LOST_SKINS, 1, "skins") \
    X(BVX_LOST_MORPHS, 2, "morphs") \
    X(BVX_LOST_ANIMATIONS, 4, "animations") \
    X(BVX_LOST_POINTS, 8, "points") \
    X(BVX_LOST_IMAGES, 16, "images") \
    X(BVX_LOST_ATTRIBUTES, 32, "attributes") \
    X(BVX_LOST_MATERIALS, 64, "materials")
enum { BVX_LOST_LIST(BVX_LIST_ENUM) };

typedef struct bvx_read_report {
    uint64_t dropped; /**< triangles left out by drop_nonfinite */
    uint32_t lost; /**< what the mesh does not hold: bits of BVX_LOST_... */
    uint32_t reserved;
} bvx_read_report;

typedef struct bvx_read_options {
    size_t struct_size;
    int32_t drop_nonfinite; /**< 1: triangles with a corner that is not finite are left out, not refused; of a polygon
                                 all are */
    int32_t keep_file; /**< 1: of glTF, for bvx_write_options.source */
    bvx_open_fn *open_file; /**< [Default: NULL, no other file is opened] */
    bvx_close_fn *close_file; /**< set together with open_file */
    void *user; /**< first argument of open_file and close_file */
    bvx_read_report *report; /**< filled when not NULL */
    bvx_inflate_fn *inflate; /**< for 3MF that is packed [Default: NULL, refused] */
    void *inflate_user; /**< first argument of inflate */
} bvx_read_options;

/** Read a mesh from the bytes of a file. Planar simple polygons, convex or not, become triangles that neither
 *  overlap nor turn over. STL vertices are welded where their bits are equal. Colours and texture coordinates
 *  are read when all vertices or faces have them; they must be finite. What is read of each format:
 *  docs/formats.md.
 *
 *  glTF names files for buffers and images: a buffer that is not there is BVX_ERR_FORMAT, an image a loss.
 *  Materials, textures and images become mesh.assets; a triangle without a material has the index after the
 *  last one. With keep_file the mesh has the file beside it, where that can be, and nothing but images is lost.
 *  3MF is the items of its build, with their matrices, in millimeters; base materials and colours of triangles become
 *  materials. docs/formats.md says more.
 *  format   BVX_FORMAT_STL (ASCII and binary are recognised), _OBJ, _PLY, _OFF, _3MF, _GLB or _GLTF (both are
 *           recognised by content)
 *  options  NULL: all defaults
 *  mesh     brings no arrays of the caller's; positions are f32 where the file says float (STL, PLY, glTF), else
 *           f64
 *  Returns BVX_ERR_FORMAT (also a file that is cut off: byte, line or element, and why), BVX_ERR_RANGE (a
 *  coordinate that is not finite, an index beyond the vertices), BVX_ERR_EMPTY (no triangle, or none remains),
 *  BVX_ERR_UNSUPPORTED (glTF, 3MF: an extension that must be known and is not; 3MF: packed, without inflate or not
 *  by deflate).
 *  [Memory: with the mesh at most 8 (STL), 64 (OBJ, OFF), 128 (PLY), 4096 (glTF: nodes repeat meshes) or 8192 (3MF,
 *  which is packed and repeats objects) times size and 32 KiB, files that open_file hands out counted as size; 4 bytes
 *  a vertex more, where triangles are left out; the file's bytes once more by keep_file; counts that the size cannot hold are refused before
 *  allocation]
 *  Source: Khronos Group. glTF 2.0 Specification (ISO/IEC 12113:2022); KHR_mesh_quantization. */
BVX_API bvx_status bvx_read_mesh(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                 const bvx_read_options *options, bvx_mesh *mesh);

/** Read a cloud of points: the vertices of a mesh without triangles.
 *  BVX_FORMAT_XYZ  text, a point a line: x y z, further columns are ignored; between them spaces, tabs,
 *                  commas or semicolons. Lines that begin with #, // or % are comments; a first line of
 *                  names, or of one number (a count), is skipped. Positions are f64
 *  BVX_FORMAT_PLY  the element vertex, as bvx_read_mesh reads it; faces are ignored
 *  Returns BVX_ERR_FORMAT (line or byte, and why), BVX_ERR_RANGE (a point that is not finite, with its
 *  index: none is left out), BVX_ERR_EMPTY (no point).
 *  [Memory: the points, at most 16 times size and 32 KiB]
 *  [Cost: O(bytes)] */
BVX_API bvx_status bvx_read_points(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                   bvx_mesh *points);

/* STL and GLB hold 32-bit floats: STL of the position, GLB too where meshes have 32-bit floats and no frame,
 * else of what it is from the middle of the bounds; or whole steps where they are quantized. A mesh is spoilt
 * where that moves a coordinate by more than 1/16 of the mean length of edges, or leaves more than one triangle
 * in 20 without its area or turned over. */
enum { BVX_ROUNDING_REFUSE = 0, BVX_ROUNDING_ALLOW = 1 };

/** What readers will get of a mesh: its certificate has the positions as the file rounds them. */
typedef struct bvx_write_report {
    bvx_certificate file; /**< of the mesh with the file's positions; STL: equal positions are one vertex */
    uint64_t merged; /**< positions that differ in the mesh and equal another in the file */
    uint64_t spoilt; /**< triangles that lose their area by rounding, or are turned over */
    double largest_move; /**< of a coordinate, by the file's numbers; 0 without rounding [Units: world] */
    double mean_edge; /**< mean length of edges, where there is rounding [Units: world] */
    int32_t fits, reserved; /**< 1: written by default; 0: refused but for BVX_ROUNDING_ALLOW */
} bvx_write_report;

/* The axes of the file: Z_TO_Y: x, z, -y; Y_TO_Z: x, -z, y. Each is a turn of 90 degrees about x. */
enum { BVX_TURN_NONE = 0, BVX_TURN_Z_TO_Y = 1, BVX_TURN_Y_TO_Z = 2 };

typedef struct bvx_write_options {
    size_t struct_size;
    int32_t normals; /**< 1: PLY and OBJ get normals of vertices too; GLB has them; STL, OFF, 3MF refuse */
    int32_t rounding; /**< of a mesh that the format's numbers would spoil, BVX_ROUNDING_... [Limit: 0..1] */
    int32_t turn; /**< coordinates and normals are turned, BVX_TURN_... [Limit: 0..2] */
    int32_t quantize; /**< 1: GLB by KHR_mesh_quantization: positions are whole steps, 65535 along the longest side of
                           all levels, normals have 8 bits, texture coordinates in 0..1 have 16; other formats are
                           refused */
    const bvx_mesh *source; /**< its materials, textures and images go into a GLB. Where it was read with keep_file and
                                 a single mesh has its vertices, as read (BVX_VERTICES_KEPT), the file is written again,
                                 with other indices [Default: NULL, those of the mesh, or of the first level that has
                                 some] */
    bvx_write_report *reports; /**< [Size: level_count] filled when not NULL */
    const char *const *names; /**< of a GLB whose meshes are no levels: each is a node of the scene, and mesh and node
                                   have its name, in UTF-8 [Size: level_count] [Default: NULL, levels] */
    const uint8_t *colours; /**< with names: red, green, blue, alpha of each mesh's material, in place of all others
                                 [Size: level_count * 4] */
} bvx_write_options;

/** Write a mesh, or levels of detail into one file; frames are added. PLY, OBJ (without alpha) and OFF keep
 *  colours, PLY and OBJ texture coordinates too. GLB has all that a mesh has. What each format holds:
 *  docs/formats.md. Coordinates stay as they are, whichever axis is up. A mesh that rounding to 32-bit floats
 *  would spoil, like one in metres of a map projection as STL, is refused (BVX_ROUNDING_REFUSE says from where
 *  on; below that a few vertices may become one): take another format, or subtract from mesh.frame an origin
 *  that the file's user knows.
 *
 *  Normals are those of the mesh, at length 1; without any they are smooth, as bvx_mesh_normals computes them
 *  at vertices, so sharp edges are averaged over too. PLY: float nx ny nz after the coordinates; OBJ: vn, with
 *  the vertex's index. Levels of a GLB are nodes "level_0", "level_1", ... with a mesh each, all about one
 *  centre, with materials, textures and images once. Only level_0 is in the scene; MSFT_lod, an extension that
 *  few readers know, attaches the others, and all other viewers show level_0. With names all meshes are in the scene.
 *  levels       [Size: level_count] the finest first, each with triangles
 *  level_count  [Limit: 1..65536] 1 but for GLB
 *  options      NULL: all defaults
 *  format       BVX_FORMAT_STL, _OBJ, _PLY, _OFF, _GLB or _3MF (not packed, in millimeters)
 *  file         NULL: nothing is written, and options.reports alone are filled; what rounding would spoil is
 *               BVX_OK with fits 0. Levels in other formats than GLB are files of their own then
 *  Returns BVX_ERR_EMPTY (a level without triangles), BVX_ERR_RANGE (beyond what the format holds, or spoilt by
 *  rounding), BVX_ERR_UNSUPPORTED (no mesh format; levels or quantize in another one than GLB; normals in STL,
 *  which has those of triangles, or OFF). Messages name the level.
 *  [Memory: the file (text: up to about 1.5 times); reports: what bvx_mesh_check takes, 24 bytes a vertex where
 *  positions are rounded or there is a frame, and 10 while equal ones are counted; normals: 24 bytes a vertex more
 *  where the mesh has none; GLB: 84 a triangle while texture coordinates are split, 4 a triangle where materials
 *  differ, about 700 a level; turn: positions and normals once more]
 *  [Cost: O(vertices + triangles)]
 *  Source: Khronos Group. KHR_mesh_quantization; Microsoft. MSFT_lod: extensions of glTF 2.0. */
BVX_API bvx_status bvx_write_mesh(bvx_context *context, const bvx_mesh *levels, uint64_t level_count,
                                  const bvx_write_options *options, int32_t format, bvx_buffer *file);

/** Write a grid. The low corner of its window and the spacing go where the format keeps them:
 *  BVX_FORMAT_NPY     bool, axes [x,y,z] (Fortran order); no lattice: see bvx_write_lattice
 *  BVX_FORMAT_BINVOX  translate is the low corner, scale the longest side; cubic voxels only
 *  BVX_FORMAT_VOX     MagicaVoxel: more than 256 voxels a side are models of 256 in a scene; no lattice; white
 *  BVX_FORMAT_NRRD    uint8, raw, attached header; "space origin" is the centre of the first voxel
 *  BVX_FORMAT_VTI     VTK image, cell data uint8, raw appended; Origin is the low corner
 *  BVX_FORMAT_BVX     our own: lattice and window whole; slices packed by runs, each with a checksum
 *  BVX_FORMAT_VDB     OpenVDB: a tree of bool named "solid"; index 0,0,0 is the centre of the window's first voxel
 *  BVX_FORMAT_NVDB    NanoVDB: the same tree as one block, of masks; no checksum and no statistics
 *  Returns BVX_ERR_RANGE (larger than the format holds), BVX_ERR_UNSUPPORTED (no grid format, or a lattice
 *  that it cannot hold).
 *  [Memory: the file; BINVOX: and 64 layers of x twice; VDB, NVDB: and a byte for 512 voxels]
 *  [Cost: O(voxels) bytes written; BVX, BINVOX: O(words + runs)] */
BVX_API bvx_status bvx_write_grid(bvx_context *context, const bvx_grid *grid, int32_t format, bvx_buffer *file);

/** Write a grid whose voxels have labels, with the colours of those: VOX, or NRRD with the keys of 3D Slicer's segments.
 *  labels   0 where no voxel is set, and only there [Size: size[0] * size[1] * size[2]] x fastest
 *  palette  red, green, blue, alpha of each label [Size: 1024]
 *  Returns as bvx_write_grid, and BVX_ERR_ARGUMENT (a label that does not fit the grid). [Memory: the file] */
BVX_API bvx_status bvx_write_labels(bvx_context *context, const bvx_grid *grid, const uint8_t *labels,
                                    const uint8_t *palette, int32_t format, bvx_buffer *file);
/** The labels and colours of a VOX file, of the box that bvx_read_grid reads without a window. Its own palette, or the one
 *  that holds where a file has none; of voxels at one place the last one's label.
 *  labels   as for bvx_write_labels; made by the library
 *  Returns as bvx_read_grid. [Memory: the labels, and an eighth of them] */
BVX_API bvx_status bvx_read_labels(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                   bvx_buffer *labels, uint8_t *palette);

/** Write an octree.
 *  states          VTU: the leaves in a set of states (0: surface and inside); BVX: 0, all of the tree
 *  BVX_FORMAT_BVX  our own: all levels with their states, each with a checksum; bvx_read_octree reads it
 *  BVX_FORMAT_VTU  VTK unstructured grid: voxels (cells of type 11) with cell data uint8 "level" and "state",
 *                  in the order of bvx_octree_leaves; corners are shared, f64 [Units: world]; raw appended
 *  Returns BVX_ERR_EMPTY (no such leaf), BVX_ERR_RANGE (2^28 leaves or more, dims beyond 2^21 - 1),
 *  BVX_ERR_UNSUPPORTED (no octree format).
 *  [Memory: the file; VTU: and 16 bytes a leaf, and 192 while corners are merged] */
BVX_API bvx_status bvx_write_octree(bvx_context *context, const bvx_octree *tree, int32_t states, int32_t format,
                                    bvx_buffer *file);

/** Read an octree from the bytes of a .bvx file that bvx_write_octree made; *tree as for bvx_refine.
 *  Everything is checked before anything is allocated, and no file expands to more than its bytes.
 *  Returns BVX_ERR_FORMAT (byte, and why), BVX_ERR_UNSUPPORTED (a newer version).
 *  [Memory: the tree, at most twice size and 32 KiB]
 *  [Cost: O(bytes)] */
BVX_API bvx_status bvx_read_octree(bvx_context *context, const void *bytes, uint64_t size, bvx_octree **tree);

/** Write a field, dense, in its own type: signed distances (vectors 0) or vectors (1). Beyond the band stand
 *  half_width, negative inside, or 0 0 0. The sign bit is that of the field's inside everywhere.
 *  BVX_FORMAT_NPY   f4 or f8, axes [x,y,z] or [x,y,z,3], Fortran order: all x of vectors, then all y, then
 *                   all z; no lattice: see bvx_write_lattice
 *  BVX_FORMAT_NRRD  float or double, raw; vectors along a first axis of 3; "space origin" is the centre of
 *                   the first voxel
 *  BVX_FORMAT_VTI   point data "distance" or "vector" at the centres, raw appended; Origin is the first one
 *  BVX_FORMAT_VDB   OpenVDB: distances in the band as a level set, of floats or doubles; no vectors
 *  BVX_FORMAT_NVDB  NanoVDB: the same; a leaf of 8 x 8 x 8 has all of its values
 *  Returns BVX_ERR_ARGUMENT (also a field without vectors, or whose rows are not those of its band),
 *  BVX_ERR_LATTICE, BVX_ERR_UNSUPPORTED (no format for fields), BVX_ERR_RANGE.
 *  [Memory: the file]
 *  [Cost: O(voxels)] */
BVX_API bvx_status bvx_write_field(bvx_context *context, const bvx_field *field, int32_t vectors, int32_t format,
                                   bvx_buffer *file);

/** Read a grid from the bytes of a file: values other than 0 are set. Its lattice is the file's box (BVX: the
 *  lattice that was written; the window's low is that of the file and of window, added). Without one in the
 *  file, origin is 0 and spacing 1; where the file has the centre of the first voxel, the origin is half a
 *  voxel below it. Types and encodings: docs/formats.md.
 *  format  as for bvx_write_grid
 *  window  NULL: all of the file; else only these voxels, counted from the file's first one
 *  Returns BVX_ERR_FORMAT (byte or line, and why), BVX_ERR_RANGE (window outside the file, dims beyond the
 *  limits), BVX_ERR_UNSUPPORTED (a newer version of the format, compressed data, more than one model, turned
 *  axes).
 *  [Memory: the grid, and at most size and 32 KiB (VTI in base64: the decoded samples; BVX: the offsets of
 *  slices); BINVOX: and 64 layers of x twice. Packed formats can expand to far more than their bytes: set
 *  a memory limit for files from strangers]
 *  [Cost: O(bytes + words)] */
BVX_API bvx_status bvx_read_grid(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                 const bvx_window *window, bvx_grid *grid);

/** A volume that was read. */
typedef struct bvx_volume {
    bvx_volume_view view;
    uint64_t bytes; /**< of view.samples where the library made them */
    int32_t owned; /**< 1 when bvx_volume_free frees view.samples; 0: they lie in the file's bytes */
    int32_t placed; /**< 0: the file has no lattice; origin 0 and spacing 1 are assumed */
    uint64_t reserved[2];
} bvx_volume;

BVX_API void bvx_volume_free(bvx_context *context, bvx_volume *volume);

typedef struct bvx_read_volume_options {
    size_t struct_size;
    const void *data; /**< NRRD with a detached header: its data files' bytes, joined */
    uint64_t data_size; /**< [Units: bytes] [Limit: any] */
    bvx_inflate_fn *inflate; /**< NRRD of encoding gzip, VTI with blocks of zlib [Default: NULL, refused] */
    void *inflate_user; /**< first argument of inflate */
    int32_t sample_type; /**< RAW: BVX_SAMPLE_... [Limit: any; RAW: 1..10] */
    int32_t big_endian; /**< RAW: 1: the highest byte comes first [Limit: 0..1] */
    int32_t size[3]; /**< RAW: samples along each axis [Units: voxels] [Limit: any] */
    int32_t reserved0;
    uint64_t offset; /**< RAW: bytes to skip first; those after the last sample are ignored [Limit: any] */
    double origin[3]; /**< RAW: low corner of the first voxel [Units: world] [Limit: any] */
    double spacing[3]; /**< RAW [Units: world] [Limit: any] [Default: 1] */
    uint64_t reserved[2];
} bvx_read_volume_options;

/** Read a volume from the bytes of a file. Where the file holds the samples as they are needed, the view
 *  points into bytes (or options.data), which must then outlive it; else they are copied, packed with x
 *  fastest. The lattice is the file's box, as in bvx_read_grid. Encodings, and how numbers of a text become
 *  samples: docs/formats.md.
 *  BVX_FORMAT_NRRD  three axes, x fastest, any scalar type; raw, ascii, or gzip with options.inflate; samples
 *                   in other files come by bvx_volume_data_name and options.data
 *  BVX_FORMAT_NPY   any whole-number or float type, three axes [x,y,z]
 *  BVX_FORMAT_VTI   raw, base64 or ascii, cell or point data; blocks of zlib with options.inflate
 *  BVX_FORMAT_RAW   samples only, of the options' size, type and byte order
 *  Returns BVX_ERR_FORMAT (byte or line, and why), BVX_ERR_RANGE (dims beyond the limits),
 *  BVX_ERR_UNSUPPORTED (a format or encoding that is not read, turned axes, gzip without inflate),
 *  BVX_ERR_ARGUMENT (also a detached header without data).
 *  [Memory: none, or the samples: at most 4 times size and data_size and 32 KiB; gzip up to 1100 times its
 *  bytes, and three times that while halves or the other byte order are converted. Set a memory limit for
 *  files from strangers] */
BVX_API bvx_status bvx_read_volume(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                   const bvx_read_volume_options *options, bvx_volume *volume);

/** The name of data file index of an NRRD's detached header, zero-terminated, to be found beside the header.
 *  A header from a stranger may name any file: the program and the Python package refuse what is not in its
 *  folder or below. *count is the number of names, 0 when the samples follow the header. Each call reads the
 *  header: one whose data files times its bytes exceed 2^31 (a LIST of 60,000 names) is refused.
 *  Returns BVX_ERR_FORMAT, BVX_ERR_ARGUMENT (index not below the count), BVX_ERR_UNSUPPORTED. */
BVX_API bvx_status bvx_volume_data_name(bvx_context *context, const void *bytes, uint64_t size, uint64_t index,
                                        char *name, uint64_t capacity, uint64_t *count);

/** The side-car of a format without a lattice, as JSON: origin, spacing, dims, fraction_bits, window,
 *  center0.
 *  Returns BVX_ERR_RANGE. */
BVX_API bvx_status bvx_write_lattice(bvx_context *context, const bvx_grid *grid, bvx_buffer *file);

/** Put a grid on the lattice and window of a side-car.
 *  Returns BVX_ERR_FORMAT, BVX_ERR_LATTICE (its window has other sides than the grid), BVX_ERR_ARGUMENT.
 *  After a failure the grid is unchanged. */
BVX_API bvx_status bvx_read_lattice(bvx_context *context, const void *bytes, uint64_t size, bvx_grid *grid);

/** Write a .bvx file slice by slice: the head for a window of a lattice (NULL: all of it), then its slices in
 *  order, any number in each part. A part is a grid of the same lattice whose window covers x and y whole and
 *  continues in z where the last one ended. Head and parts one after the other are the bytes of
 *  bvx_write_grid. */
BVX_API bvx_status bvx_write_head(bvx_context *context, const bvx_lattice *lattice, const bvx_window *window,
                                  bvx_buffer *file);
BVX_API bvx_status bvx_write_slices(bvx_context *context, const bvx_grid *part, bvx_buffer *file);

typedef struct bvx_read_sections_options {
    size_t struct_size;
    double close_gap; /**< CSV: loops whose ends lie farther apart are refused as open polylines; 0 closes all by a
                           straight side [Units: world] [Limit: >= 0] */
    uint64_t reserved;
    uint64_t *flipped; /**< CSL: receives how many planes were read although their D has the other sign. All planes of
                            the file agree in that, else it is refused */
} bvx_read_sections_options;

/** Read section contours from the bytes of a file. How holes and labels of CSL are read: docs/formats.md.
 *  BVX_FORMAT_CSL  planes with their equation, points and loops with labels. Planes parallel within 1e-4 rad
 *                  have one normal, else normals are set; points lie within 1/1000 of the largest coordinate
 *                  of their plane
 *  BVX_FORMAT_CSV  a head line with section, position, loop, x, y and perhaps label (any order, other columns
 *                  are ignored); comma, semicolon or tab. Planes are z = position, or with the columns z, nx,
 *                  ny, nz of any direction (normals are set). A first point repeated at the end is left out.
 *                  A line without loop and point states a section, which may hold no loop
 *  Returns BVX_ERR_FORMAT (line and why), BVX_ERR_UNSUPPORTED (no contour format), BVX_ERR_EMPTY,
 *  BVX_ERR_RANGE.
 *  [Memory: with the stack at most 40 times size and 32 KiB]
 *  [Cost: O(bytes)] */
BVX_API bvx_status bvx_read_sections(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                     const bvx_read_sections_options *options, bvx_sections *sections);

/** Write section contours: BVX_FORMAT_CSL or BVX_FORMAT_CSV (planes z = position, or normals). Numbers read
 *  back to the same ones.
 *  Returns BVX_ERR_EMPTY, BVX_ERR_RANGE, BVX_ERR_UNSUPPORTED.
 *  [Memory: the file] */
BVX_API bvx_status bvx_write_sections(bvx_context *context, const bvx_sections *sections, int32_t format,
                                      bvx_buffer *file);

/* ---- Pictures ------------------------------------------------------------------------------------------ */

/** Pixels, top row first, red green blue. */
typedef struct bvx_image {
    uint8_t *pixels; /**< [Size: width * height * 3] */
    int32_t width, height;
} bvx_image;

BVX_API void bvx_image_free(bvx_context *context, bvx_image *image);

/** Where a picture is seen from. */
typedef struct bvx_camera {
    double direction[3]; /**< from the model towards the eye [Limit: any] [Default: 3, -4, 2] */
    double up[3]; /**< what is up in the picture [Limit: any] [Default: 0, 0, 1] */
    double show[2]; /**< the frame shows at least this much on either side of the model's middle, along width and
                         height: several pictures get one scale [Units: world] [Limit: >= 0; finite] [Default: 0, 0: the
                         model fills it] */
} bvx_camera;

/** What is cut away. */
typedef struct bvx_cut {
    int32_t sides, reserved; /**< on which, BVX_OPEN_... [Limit: 0..63] [Default: 0, none] */
    double low[3]; /**< what lies below, on low sides [Units: world] [Limit: any] */
    double high[3]; /**< what lies above, on high sides; grids by whole voxels [Units: world] [Limit: any] */
} bvx_cut;

typedef struct bvx_render_options {
    size_t struct_size;
    int32_t width, height; /**< [Units: pixels] [Limit: 1..16384] [Default: 1024, 768] */
    bvx_camera camera;
    uint8_t colour[4]; /**< of the surface: red, green, blue, and any number that makes black not all zero [Limit: any]
                            [Default: 200, 196, 188] */
    uint8_t background[4]; /**< the same [Limit: any] [Default: 255, 255, 255] */
    int32_t smooth; /**< 1: normals averaged at vertices, 0: of each facet */
    int32_t samples; /**< rays a pixel along each side [Limit: 1..4] [Default: 2] */
    int32_t wireframe, reserved; /**< 1: draw edges of triangles (grids: of voxels) too */
    bvx_cut cut; /**< [Default: all zero, nothing] */
} bvx_render_options;

/** A shaded picture of a mesh that fills the frame: orthographic, one light near the eye, ambient light from
 *  the depths around. Colours of the view's vertices replace options.colour. Back faces are reddish; a cut
 *  opens the mesh and shows them. The same bytes everywhere.
 *  Returns BVX_ERR_EMPTY, BVX_ERR_RANGE.
 *  [Cost: O(pixels * samples^2 + triangles)] */
BVX_API bvx_status bvx_render_mesh(bvx_context *context, const bvx_mesh_view *mesh, const bvx_render_options *options,
                                   bvx_image *image);

/** The same for a grid: its exposed voxel faces. A cut shows the voxels inside, flat and a little darker. */
BVX_API bvx_status bvx_render_grid(bvx_context *context, const bvx_grid *grid, const bvx_render_options *options,
                                   bvx_image *image);

/** Two grids of one lattice and window in one picture: voxels of both in options.colour, only of before
 *  (removed) red, only of after (added) green.
 *  Returns BVX_ERR_LATTICE too.
 *  [Memory: as bvx_render_grid] */
BVX_API bvx_status bvx_render_difference(bvx_context *context, const bvx_grid *before, const bvx_grid *after,
                                         const bvx_render_options *options, bvx_image *image);

/** Write a PNG with stored blocks: its bytes depend only on the pixels. */
BVX_API bvx_status bvx_write_png(bvx_context *context, const bvx_image *image, bvx_buffer *file);

#ifdef __cplusplus
}
#endif

#endif /* BITVOX_IO_H */
