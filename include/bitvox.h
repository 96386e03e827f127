/* bitvox.h - shapes to voxels and voxels to shapes: the interface of libbitvox. Files and pictures: bitvox_io.h.
 * Licence: MIT.
 *
 * Start here: two levels of detail of any mesh.
 *
 *     bvx_mesh_view view = bvx_mesh_view_packed(positions, vertex_count, triangles, triangle_count);
 *     bvx_mesh levels[2] = {{0}};
 *     bvx_context *context;
 *     if (bvx_context_create(NULL, &context) != BVX_OK) return 1;
 *     if (bvx_build_levels(context, &view, NULL, 2, levels) != BVX_OK) puts(bvx_last_message(context));
 *     for (int i = 0; i < 2; i++) bvx_mesh_free(context, &levels[i]);
 *     bvx_context_destroy(context);
 *
 * Contents: the titles of the sections below, in their order.
 *     Status, Context                                      results of calls; memory, threads, progress
 *     Meshes, Lattices, Grids                              what goes in and what comes out
 *     Solids, Surface voxels, Surfaces of grids            meshes to voxels, voxels to meshes
 *     Fewer triangles, Smoothing, Repair, Levels of detail, Hulls, Booleans of meshes
 *     Levels by samples, Closest points, Distance fields   further ways from mesh to mesh, and measuring
 *     Set algebra, Morphology and distances, Components, Seeds and filling, Queries of grids
 *     Mass, Inspection
 *     Points, Volumes, Section contours, Refinement        other things that go in, voxels of several sizes
 *     Surfaces of labels                                   segmentations to bodies that share faces
 * What holds for all stages: docs/exactness.md. How each decides: docs/rules.md. What each call takes, and where its
 * method is from: docs/costs.md.
 *
 * What holds for every function, unless its comment says otherwise
 *   Status      Functions that can fail return bvx_status. Results come through the last parameters.
 *   Errors      Every such call may return BVX_ERR_ARGUMENT, BVX_ERR_MEMORY and BVX_ERR_BUDGET (the memory limit);
 *     BVX_CANCELLED where it reports progress; BVX_ERR_CAPACITY where it fills arrays of the caller's. Comments list
 *     the others, or a special meaning of these.
 *   Failure     Inputs are unchanged and nothing leaks. A zeroed result stays empty. The caller's arrays, and a result
 *     that was passed again, hold unspecified values: free it or pass it again. bvx_last_message says what was wrong.
 *   Outputs     Zero a result, = {0} or in C++ = {}, before its first use. Later calls may receive it again without
 *     a free: the library reuses its arrays or makes others, so pointers into them end there. A grid or mesh may also
 *     bring arrays of the caller's, with their capacities, to be filled in place. Other results refuse such arrays. A
 *     result overlaps no input, except where a comment says "in place". bvx_..._free frees what the library allocated
 *     and zeroes the struct; NULL is allowed.
 *   Counting    An array of results may be NULL: then only the count is computed. The count is also set when an array
 *     was too small.
 *   Input       A coordinate that is not finite, an index beyond its array, a window beyond its lattice and more than
 *     can be counted are BVX_ERR_RANGE, with the index where there is one. No triangle or point at all is
 *     BVX_ERR_EMPTY, as are triangles without area where surfaces are needed. Grids that share no lattice or window are
 *     BVX_ERR_LATTICE. Nothing inside is an empty result and BVX_OK. A target that cannot be met is BVX_OK with met 0
 *     in the report, unless strict is set.
 *   Options     bvx_repair_options o = {.struct_size = sizeof o}; has all defaults, as NULL has: each other field is 0,
 *     which stands for what [Default:] says, if anything. C++ takes fields in order, and .fit = {.resolution = 99}.
 *     BVX_NONE is the 0 itself, where [Limit:] has it. A comment that begins with "1:" is of a switch, 0 or 1. What the
 *     shorter struct of an older header lacks is 0; unknown bytes of a longer one are 0, or it is BVX_ERR_VERSION.
 *   Reports     report, reports and other pointers of options are filled when not NULL. Counts are of this call, within
 *     its window. Bit 1 << BVX_WARN_... of warnings is set for each warning that the call gives.
 *   Types       position_type of options is BVX_POSITION_AUTO, BVX_F32 or BVX_F64. AUTO is f32 where it distinguishes
 *     positions, else f64. With local_frame 1 positions are relative to frame, the low corner of the lattice.
 *   Arrays      Points are x y z each, rays six doubles: origin, direction of any length but 0 [Units: world]. Arrays
 *     over a window have x fastest, then y, then z. Order (z, y, x) is that of the bits of grids.
 *   Neighbours  connectivity is 6: across faces; 18: and edges; 26: and corners.
 *   Lists       The numbers of BVX_..._LIST are frozen; the texts are names in the program and the bindings.
 *   Memory      All memory comes from the context's allocator and counts against its limit. Reserved fields are zero.
 *   Threads     One context is used by one thread at a time. Contexts share nothing; inputs are only read.
 *   Exactness   Same bits for any compiler, processor, thread count and window.
 *   Tags        [Size:] [Limit:] [Units:] [Default:] are fixed words, for people and for scripts. */
#ifndef BITVOX_H
#define BITVOX_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define BVX_NULL nullptr
extern "C" {
#else
#define BVX_NULL NULL
#endif

#if defined(BVX_STATIC_API)
#define BVX_API static
#elif defined(_WIN32) && defined(BVX_BUILD_SHARED)
#define BVX_API __declspec(dllexport)
#elif defined(_WIN32) && defined(BVX_USE_SHARED)
#define BVX_API __declspec(dllimport)
#elif defined(__GNUC__)
#define BVX_API __attribute__((visibility("default")))
#else
#define BVX_API
#endif

#define BVX_VERSION_MAJOR 0
#define BVX_VERSION_MINOR 1
#define BVX_VERSION_PATCH 0
#define BVX_VERSION       (BVX_VERSION_MAJOR * 10000 + BVX_VERSION_MINOR * 100 + BVX_VERSION_PATCH)

/* Rows X(name, value, text) of a list below as constants: enum { BVX_..._LIST(BVX_LIST_ENUM) }; */
#define BVX_LIST_ENUM(name, value, text) name = value,

/** 0 in an option where 0 stands for another number, its default. */
enum { BVX_NONE = -1 };

/* ---- Status -------------------------------------------------------------------------------------------- */
typedef int32_t bvx_status;

/** Every status, its frozen value and its text. */
#define BVX_STATUS_LIST(X) \
    X(BVX_OK, 0, "done") \
    X(BVX_ERR_ARGUMENT, 1, "an argument is NULL, out of range or contradicts another") \
    X(BVX_ERR_VERSION, 2, "the header and the library are of different major versions") \
    X(BVX_ERR_MEMORY, 3, "the allocator returned nothing") \
    X(BVX_ERR_BUDGET, 4, "the memory limit does not allow it") \
    X(BVX_ERR_RANGE, 5, "a coordinate, index or size is outside what can be represented") \
    X(BVX_ERR_EMPTY, 6, "the input holds nothing to work on") \
    X(BVX_ERR_FORMAT, 7, "the data is damaged or not of the stated format") \
    X(BVX_ERR_UNSUPPORTED, 8, "a valid request that this build or format cannot serve") \
    X(BVX_ERR_CAPACITY, 9, "an array given by the caller is too small") \
    X(BVX_ERR_LATTICE, 10, "the grids do not share one lattice or window") \
    X(BVX_CANCELLED, 11, "the progress callback asked to stop")
enum { BVX_STATUS_LIST(BVX_LIST_ENUM) BVX_STATUS_COUNT = 12 };

/** The fixed text of a status; "unknown status" for any other number. Never NULL. */
BVX_API const char *bvx_status_text(bvx_status status);

/** Why a call failed, for programs: the reason, its frozen value and its text. */
/* clang-format off */
#define BVX_REASON_LIST(X) \
    X(BVX_REASON_NONE, 0, "no call has failed") X(BVX_REASON_UNSPECIFIED, 1, "no failure has it any more") \
    X(BVX_REASON_NULL, 2, "an argument is NULL") X(BVX_REASON_RESERVED, 3, "a reserved field is not 0") \
    X(BVX_REASON_OPTIONS, 4, "an option struct has no valid size or sets what the library does not know") \
    X(BVX_REASON_CHOICE, 5, "a number does not name one of the choices that there are") \
    X(BVX_REASON_MEMORY, 6, "the allocator returned nothing") \
    X(BVX_REASON_BUDGET, 7, "the memory limit does not allow it") \
    X(BVX_REASON_CAPACITY, 8, "an array given by the caller is too small") \
    X(BVX_REASON_LATTICE, 9, "the grids do not share one lattice or window") \
    X(BVX_REASON_CANCELLED, 10, "the progress callback asked to stop") \
    X(BVX_REASON_NOT_FINITE, 11, "a number is NaN or infinite") \
    X(BVX_REASON_INDEX, 12, "an index is beyond what it counts in") \
    X(BVX_REASON_FLOATS_COARSE, 13, "f32 does not distinguish neighbouring positions; BVX_POSITION_AUTO takes f64") \
    X(BVX_REASON_DOUBLES_COARSE, 14, "doubles do not distinguish neighbouring positions; a local frame does") \
    X(BVX_REASON_SEVERAL_BODIES, 15, "the sections hold several bodies and no label chooses one") \
    X(BVX_REASON_LOOPS_MEET, 16, "loops of a section cross or touch; mending splits them there") \
    X(BVX_REASON_LOOP_FLAT, 17, "a loop encloses no area; mending leaves it out") \
    X(BVX_REASON_COMPRESSED, 18, "samples are compressed and nothing was given to unpack them") \
    X(BVX_REASON_RANGE, 19, "an option is outside its range") \
    X(BVX_REASON_CONTRADICTION, 20, "arguments or options exclude or need each other") \
    X(BVX_REASON_INVALID, 21, "an argument's sizes, counts or arrays do not describe what it should be") \
    X(BVX_REASON_NOT_EMPTY, 22, "an output brings arrays of its own, which are not used") \
    X(BVX_REASON_OVERLAP, 23, "an output's memory is an input's") \
    X(BVX_REASON_TOPOLOGY, 24, "the mesh is not closed, manifold or oriented as the call needs it") \
    X(BVX_REASON_TOO_FAR, 25, "a coordinate or a length is beyond what numbers or a format represent") \
    X(BVX_REASON_TOO_MANY, 26, "there are more elements than an index, a format or a machine counts") \
    X(BVX_REASON_TARGET, 27, "a target of triangles or of error cannot be kept") \
    X(BVX_REASON_EMPTY, 28, "the input holds nothing to work on") \
    X(BVX_REASON_DAMAGED, 29, "the data is damaged or not of the stated format") \
    X(BVX_REASON_UNSUPPORTED, 30, "the build or the format has no such thing") \
    X(BVX_REASON_VERSION, 31, "the header and the library are of different major versions")
/* clang-format on */
enum { BVX_REASON_LIST(BVX_LIST_ENUM) BVX_REASON_COUNT = 32 };

/** The library's version, made like BVX_VERSION. */
BVX_API int32_t bvx_version(void);

/* ---- Context ------------------------------------------------------------------------------------------- */
typedef struct bvx_context bvx_context;

/** Returns size bytes aligned to align (a power of two up to 64), or NULL. */
typedef void *bvx_alloc_fn(void *user, size_t size, size_t align);
/** Frees what bvx_alloc_fn returned, with the same size and align. */
typedef void bvx_free_fn(void *user, void *block, size_t size, size_t align);
/** Called on the calling thread between pieces of work. stage names what is being done. fraction is the share of the
 *  whole call that is done: it never falls, and 1 comes last, when the call has succeeded. A result other than 0
 *  cancels before that: the call returns BVX_CANCELLED. Small calls report nothing. */
typedef int32_t bvx_progress_fn(void *user, const char *stage, double fraction);
/** One piece of parallel work. worker is below the context's thread count and never runs two pieces at once. */
typedef void bvx_task_fn(void *task_user, int32_t index, int32_t worker);
/** Runs task(task_user, index, worker) once for every index in [0, count), in any order, and returns after the last. */
typedef void bvx_parallel_fn(void *user, int32_t count, bvx_task_fn *task, void *task_user);

enum { BVX_CPU_BEST = 0, BVX_CPU_PORTABLE = 1, BVX_CPU_AVX2 = 2 };

/** Where memory comes from; user is the first argument of both. */
typedef struct bvx_allocator {
    bvx_alloc_fn *alloc; /**< set together with free */
    bvx_free_fn *free;
    void *user;
} bvx_allocator;

/** Memory to live in: results at its low end, scratch at its high end. */
typedef struct bvx_arena {
    void *memory; /**< of any alignment: up to 63 bytes of it are skipped */
    uint64_t size; /**< [Units: bytes] [Limit: any] */
} bvx_arena;

/** Callbacks; user is their first argument. */
typedef struct bvx_parallel {
    bvx_parallel_fn *call;
    void *user;
} bvx_parallel;
typedef struct bvx_progress {
    bvx_progress_fn *call;
    void *user;
} bvx_progress;

typedef struct bvx_context_options {
    size_t struct_size;
    bvx_allocator allocator; /**< [Default: the C library's heap; BVX_FREESTANDING: this or arena] */
    bvx_arena arena; /**< in place of allocator */
    uint64_t memory_limit; /**< [Units: bytes] [Limit: any] [Default: 0, none] */
    bvx_parallel parallel; /**< the caller's own parallel-for [Default: the library's threads] */
    bvx_progress progress;
    int32_t threads; /**< workers [Limit: 0..1024] [Default: 0, see below; 1 with the caller's parallel] */
    int32_t cpu; /**< fastest code that may run, BVX_CPU_... [Limit: 0..2] */
} bvx_context_options;
/** Create a context. By default it has as many workers as the process may use processors: by affinity, the quota of its
 *  control group, OMP_NUM_THREADS and OMP_THREAD_LIMIT. A build without threads has one. When threads run and end:
 *  docs/limits.md.
 *  Returns BVX_ERR_VERSION (another major version, before 1.0 another minor one), BVX_ERR_UNSUPPORTED (arithmetic of
 *  this build or thread would change results), BVX_ERR_MEMORY (also an arena that is too small). */
BVX_API bvx_status bvx_context_create_version(int32_t header_version, const bvx_context_options *options,
                                              bvx_context **context);
static inline bvx_status bvx_context_create(const bvx_context_options *options, bvx_context **context)
{
    return bvx_context_create_version(BVX_VERSION, options, context);
}
/** Why bvx_context_create fails with these options and BVX_VERSION, in one line for people; NULL: it does not, where
 *  there is memory. Nothing is allocated or changed. */
BVX_API const char *bvx_context_fault(int32_t header_version, const bvx_context_options *options);
/** Free a context; NULL is allowed. Another context with the same allocator may free its results. */
BVX_API void bvx_context_destroy(bvx_context *context);
/** What went wrong in the last call that failed, in one line for people, or "". The next call may change it. */
BVX_API const char *bvx_last_message(const bvx_context *context);

/** The last failure in parts, for programs. The library owns it, as a warning, and may append fields. */
typedef struct bvx_error {
    bvx_status status; /**< BVX_OK: no call has failed */
    int32_t reason; /**< BVX_REASON_...; after a failure neither BVX_REASON_NONE nor _UNSPECIFIED */
    const char *function; /**< the public function that was called; "" when none failed */
    const char *message; /**< as bvx_last_message returns it */
    const char *text; /**< the message without the function's name in front */
    int64_t index; /**< of the vertex, triangle, level ... that the message names first, or -1 */
    int32_t value_count, reserved; /**< [Limit: 0..8] */
    double value[8]; /**< the message's numbers in order, the index included, as doubles */
} bvx_error;
/** Never NULL. The next call may change it. */
BVX_API const bvx_error *bvx_last_error(const bvx_context *context);

/** What a call that succeeded has cost, or could not do. The program alone gives those from BVX_WARN_UNJOINED on,
 *  and bvx_label_voxels BVX_WARN_LOST. */
/* clang-format off */
#define BVX_WARN_LIST(X) \
    X(BVX_WARN_NONE, 0) \
    X(BVX_WARN_THIN_LOST, 1) /* walls thinner than 1.5 voxels are lost where no voxel's centre lies in them */ \
    X(BVX_WARN_THICKER, 2) X(BVX_WARN_VOLUME, 3) X(BVX_WARN_AREA, 4) /* volume or area is not the input's */ \
    X(BVX_WARN_PARTS, 5) X(BVX_WARN_JOINED, 6) X(BVX_WARN_HANDLES, 7) /* parts broke or joined; handles changed */ \
    X(BVX_WARN_SHELLS, 8) X(BVX_WARN_SHELLED_BODIES, 9) /* sheets, and bodies thinner than voxels, are shells now */ \
    X(BVX_WARN_CRUMBS, 10) /* small parts that the input does not have were dropped */ \
    X(BVX_WARN_LEVEL_PARTS, 11) X(BVX_WARN_LEVEL_VOLUME, 12) /* not those before edges collapsed */ \
    X(BVX_WARN_TARGET, 13) X(BVX_WARN_ERROR, 14) /* a target of triangles, or of error, is missed */ \
    X(BVX_WARN_CUT, 15) /* edges of three triangles and more, or whose triangles cannot agree, were cut */ \
    X(BVX_WARN_LOWERED, 16) /* the memory limit lowered the resolution */ \
    X(BVX_WARN_DOUBLES, 17) X(BVX_WARN_TURNED, 18) /* triangles were left out, or turned; a room is filled */ \
    X(BVX_WARN_ROWS, 19) X(BVX_WARN_LEAKS, 21) X(BVX_WARN_MIXED, 22) /* holes: the solid may be wrong near them */ \
    X(BVX_WARN_NESTED, 20) /* what lies in two shells is hollow; the rule nonzero has it solid */ \
    X(BVX_WARN_VOXELS, 23) X(BVX_WARN_FEW, 24) X(BVX_WARN_FEW_RESULT, 25) /* the lattice is coarse for it */ \
    X(BVX_WARN_APART, 26) /* bodies do not meet: nothing was taken away */ \
    X(BVX_WARN_CONTOURS, 27) X(BVX_WARN_CELLS, 30) X(BVX_WARN_WINDOWS, 31) /* contours are not kept everywhere */ \
    X(BVX_WARN_SPECKS, 28) X(BVX_WARN_EXTRA_HANDLES, 29) X(BVX_WARN_OPEN_PARTS, 34) /* sections leave it open */ \
    X(BVX_WARN_REPEATED, 32) /* repeated points were left out */ \
    X(BVX_WARN_LIDS, 33) /* lids over holes are a large share of the surface */ \
    X(BVX_WARN_UNJOINED, 35) X(BVX_WARN_EMPTY, 36) X(BVX_WARN_UNMET, 37) X(BVX_WARN_ENDS, 38) X(BVX_WARN_LOST, 39) \
    X(BVX_WARN_READ, 40) X(BVX_WARN_ROUNDED, 41) X(BVX_WARN_FAR, 42) X(BVX_WARN_FILE, 43)
/* clang-format on */
#define BVX_WARN_ENUM(name, value) name = value,
enum { BVX_WARN_LIST(BVX_WARN_ENUM) BVX_WARN_COUNT = 44 };

typedef struct bvx_warning {
    int32_t code; /**< BVX_WARN_... */
    int32_t input; /**< 0 or 1: the mesh of several that it is about; -1: the result, or the only mesh */
    int32_t value_count; /**< [Limit: 0..6] */
    int32_t placed; /**< 1: low and high are filled */
    double value[6]; /**< what the text names, in order */
    double low[3], high[3]; /**< the box that it is about [Units: world] */
    const char *name; /**< "BVX_WARN_..." */
    const char *text; /**< one line for people; valid until the next call with this context */
} bvx_warning;
/** The next warning of the last call, which succeeded; NULL: no more. With a report calls measure more. */
BVX_API const bvx_warning *bvx_next_warning(bvx_context *context);
/** Bytes that are held now, results included; and the maximum since creation or the last reset. In an arena that is
 *  the size of one that is enough for the same calls: with the context, and what lies unused between blocks. */
BVX_API uint64_t bvx_memory_used(const bvx_context *context);
BVX_API uint64_t bvx_memory_peak(const bvx_context *context);
BVX_API void bvx_memory_reset_peak(bvx_context *context);
/** The number of workers. */
BVX_API int32_t bvx_context_threads(const bvx_context *context);

/* ---- Meshes -------------------------------------------------------------------------------------------- */
/** Types of positions and values. BVX_POSITION_AUTO, for options, is BVX_F32 where its steps at the largest coordinate
 *  are at most 1/256 of a voxel, else BVX_F64. Without voxels the mesh's type stays, and sections give f64. Arrays that
 *  the caller provides must be of the type that comes out. */
#define BVX_REAL_LIST(X) X(BVX_F32, 1, "f32") X(BVX_F64, 2, "f64")
enum { BVX_POSITION_AUTO = 0, BVX_REAL_LIST(BVX_LIST_ENUM) };
enum { BVX_U16 = 1, BVX_U32 = 2, BVX_U64 = 3 };

/** A mesh that goes in: pointers to arrays that the caller owns. What is optional is NULL or 0. */
typedef struct bvx_mesh_view {
    const void *positions; /**< x, y, z of each vertex [Size: vertex_count] */
    const void *indices; /**< three vertex indices a triangle; NULL: triangle t has vertices 3t, 3t+1, 3t+2 */
    uint64_t vertex_count; /**< [Limit: < 2^32] */
    uint64_t triangle_count; /**< [Limit: < 2^31] */
    uint32_t position_type; /**< BVX_F32 or BVX_F64 */
    uint32_t position_stride; /**< from vertex to vertex; 0: packed [Units: bytes] */
    uint32_t index_type; /**< BVX_U16, BVX_U32 or BVX_U64; ignored without indices */
    uint32_t index_stride; /**< from triangle to triangle; 0: packed [Units: bytes] */
    const uint8_t *colours; /**< optional: red, green, blue, alpha of each vertex, packed */
    const float *normals; /**< optional: x, y, z of each vertex, packed */
    const float *uvs; /**< optional: texture coordinates u, v of each vertex, or by uv_indices */
    const uint32_t *uv_indices; /**< three indices into uvs a triangle; NULL: each vertex has its own */
    uint64_t uv_count; /**< of uvs, with uv_indices */
    const float *uvs2; /**< optional: second texture coordinates of each vertex */
    const uint32_t *materials; /**< optional: index of each triangle's material */
    const double *transform; /**< optional: three rows of four, applied to positions in doubles as ((m0 x + m1 y) +
                                  m2 z) + m3. Normals stay, and a mirror turns triangles inside out [Size: 12] */
    uint64_t reserved;
} bvx_mesh_view;

/** The view of packed arrays: three floats a vertex, three vertex indices a triangle. Nothing is copied. */
static inline bvx_mesh_view bvx_mesh_view_packed(const float *positions, uint64_t vertex_count,
                                                 const uint32_t *triangles, uint64_t triangle_count)
{
    bvx_mesh_view const view = {positions, triangles, vertex_count, triangle_count, BVX_F32,  0,
                                BVX_U32,   0,         BVX_NULL,     BVX_NULL,       BVX_NULL, BVX_NULL,
                                0,         BVX_NULL,  BVX_NULL,     BVX_NULL,       0};
    return view;
}

/** Materials, textures and images as a file had them; a mesh that owns its arrays owns them too. */
typedef struct bvx_assets bvx_assets;

/** A mesh that comes out: indexed triangles, counter-clockwise seen from outside. What it does not have is NULL. Where
 *  attributes have a seam, vertices of equal positions have one side's each. */
typedef struct bvx_mesh {
    void *positions; /**< float or double [Size: vertex_count * 3] [Units: world, less frame] */
    uint32_t *triangles; /**< [Size: triangle_count * 3] */
    uint64_t *vertex_keys, *triangle_keys; /**< identify each vertex, and each triangle's cell, across windows */
    uint64_t vertex_count, triangle_count;
    uint64_t vertex_capacity, triangle_capacity; /**< what the arrays hold */
    double frame[3]; /**< add it to positions to get world coordinates; zero without the option local_frame */
    int32_t position_type; /**< BVX_F32 or BVX_F64 */
    int32_t owned; /**< 1 when bvx_mesh_free frees the arrays */
    uint8_t *colours; /**< red, green, blue, alpha of each vertex [Size: vertex_capacity * 4] */
    float *uvs; /**< texture coordinates u, v [Size: uv_count * 2] */
    uint32_t *uv_triangles; /**< three indices into uvs a triangle; NULL: one a vertex [Size: triangle_capacity * 3] */
    uint64_t uv_count;
    float *normals; /**< x, y, z of each vertex [Size: vertex_capacity * 3] */
    float *uvs2; /**< second texture coordinates of each vertex [Size: vertex_capacity * 2] */
    uint32_t *materials; /**< index of each triangle's material [Size: triangle_capacity] */
    bvx_assets *assets; /**< materials, textures and images of a glTF or 3MF file: passed on to a .glb */
    uint64_t reserved[2];
} bvx_mesh;

BVX_API void bvx_mesh_free(bvx_context *context, bvx_mesh *mesh);
/** A view of a mesh. The frame is not part of it. */
BVX_API void bvx_mesh_view_of(const bvx_mesh *mesh, bvx_mesh_view *view);
/** Remove vertices with a coordinate that is not finite, and the triangles that use them, in place. What remains keeps
 *  its order, keys and attributes. dropped, out, counts triangles. After a failure the mesh is unchanged. */
BVX_API bvx_status bvx_mesh_drop_nonfinite(bvx_context *context, bvx_mesh *mesh, uint64_t *dropped);
/** Hash of type, counts, frame, positions and triangles, the same on every machine. */
BVX_API bvx_status bvx_mesh_hash(bvx_context *context, const bvx_mesh *mesh, uint64_t *hash);
/** The hash behind all golden values; its recipe, and those of grids and meshes: docs/exactness.md. */
BVX_API uint64_t bvx_hash(const void *bytes, size_t size, uint64_t seed);

typedef struct bvx_box {
    double low[3], high[3];
} bvx_box;
/** What a mesh is. With weld 1 vertices at equal positions count as one. [Limit: (2^32 - 1) / 3 triangles] */
typedef struct bvx_certificate {
    int32_t closed; /**< 1: every edge has two or more triangles, none is a boundary */
    int32_t edge_manifold; /**< 1: no edge has more than two triangles */
    int32_t vertex_manifold; /**< 1: the triangles around every vertex form one fan */
    int32_t oriented; /**< 1: no two triangles run along an edge in the same direction */
    uint64_t vertices; /**< vertices that triangles use, after welding */
    uint64_t edges; /**< different edges of the triangles that count */
    uint64_t triangles; /**< triangles that count: three different vertices */
    uint64_t unused_vertices;
    uint64_t collapsed; /**< triangles with two equal vertices, not counted in anything that follows */
    uint64_t degenerate; /**< triangles that count but have no area, computed in doubles */
    uint64_t duplicates; /**< triangles with the three vertices of an earlier one, in any order */
    uint64_t boundary_edges, nonmanifold_edges; /**< edges with one triangle; with three or more */
    uint64_t flipped_edges; /**< edges with two triangles that run along it in the same direction */
    uint64_t nonmanifold_vertices;
    uint64_t components; /**< connected through edges */
    int64_t euler; /**< vertices - edges + triangles */
    double volume; /**< signed, by the divergence theorem about the bounds' centre [Units: world^3] */
    double area; /**< [Units: world^2] */
    bvx_box box; /**< bounds of the used vertices [Units: world] */
    uint64_t reserved[4];
} bvx_certificate;
BVX_API bvx_status bvx_mesh_check(bvx_context *context, const bvx_mesh_view *mesh, int32_t weld,
                                  bvx_certificate *certificate);
/** Find pairs of triangles that cross: that share a point which is neither a common vertex nor on a common edge. That
 *  includes touching, an overlap in one plane, a fold flat on its neighbour and a triangle that is there twice.
 *  Vertices at equal positions are one; triangles without area are left out.
 *  pairs  two indices a pair, the lower one first; pairs ascend [Size: capacity * 2] [Limit: < 2^32 pairs] */
BVX_API bvx_status bvx_mesh_crossings(bvx_context *context, const bvx_mesh_view *mesh, uint64_t *count, uint32_t *pairs,
                                      uint64_t capacity);
/** Compute normals of length 1, three floats each; 0, 0, 1 where there is none. Either array may be NULL.
 *  vertex_normals  [Size: vertex_count * 3] the sum of the facets' normals, weighted by area
 *  facet_normals   [Size: triangle_count * 3] averaged 0: of each facet; 1: the mean of its vertices' normals */
BVX_API bvx_status bvx_mesh_normals(bvx_context *context, const bvx_mesh_view *mesh, int32_t averaged,
                                    float *vertex_normals, float *facet_normals);

/** Distances from random points on one mesh to the nearest points of another. */
typedef struct bvx_distance_report {
    uint64_t samples; /**< points taken on each side */
    uint64_t seed;
    double mean_a_to_b, max_a_to_b, mean_b_to_a, max_b_to_a; /**< [Units: world] */
    double mean, max; /**< of both directions: the mean of the means, the greater maximum [Units: world] */
    double normal_a_to_b, normal_b_to_a; /**< mean of 1 - cos of the angle between the facets' normals */
} bvx_distance_report;
/** Sample each mesh uniformly by area, from seed, and measure the distance of each sample to the other mesh. Samples
 *  whose nearest triangle has no area are left out of the normals' means. The order of triangles, corners and vertices
 *  does not change a bit. samples  [Limit: 1..2^31-1] */
BVX_API bvx_status bvx_mesh_distance(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b,
                                     uint64_t samples, uint64_t seed, bvx_distance_report *report);

/* ---- Lattices ------------------------------------------------------------------------------------------ */
/** Voxel (i,j,k) is the half-open box [origin + ijk*spacing, origin + (ijk+1)*spacing). Samples lie at its centre. All
 *  four fields are the lattice's identity. */
typedef struct bvx_lattice {
    double origin[3]; /**< low corner of voxel (0,0,0) [Units: world] [Limit: finite] */
    double spacing[3]; /**< edges of a voxel [Units: world] [Limit: > 0, finite] */
    int32_t dims[3]; /**< [Units: voxels] [Limit: 1..2^25] */
    int32_t fraction_bits; /**< fixed-point bits below a voxel [Limit: 4..16] */
} bvx_lattice;

/** A box of voxels, low .. low + size - 1. All zero means the whole lattice. */
typedef struct bvx_window {
    int32_t low[3], size[3];
} bvx_window;

/** Exactly one of resolution, axis_resolution and spacing is set. */
typedef struct bvx_lattice_options {
    size_t struct_size;
    int32_t resolution; /**< voxels along the longest axis, cubic ones [Limit: 0..2^25] [Default: 0, unset] */
    int32_t axis_resolution[3]; /**< voxels along each axis, stretched ones [Limit: 0..2^25] [Default: 0, unset] */
    double spacing[3]; /**< edges of a voxel [Units: world] [Limit: >= 0] [Default: 0, unset] */
    int32_t padding, reserved; /**< empty voxels added on every side [Limit: 0..65536] */
} bvx_lattice_options;
/** A lattice of cubic voxels around a mesh, with resolution voxels along its longest axis. Its low corner is that of
 *  the bounds of the vertices that triangles use; dims is the smallest count that covers them. Without triangles all
 *  vertices count: those of a cloud of points, or two opposite corners of a box.
 *  resolution  [Limit: 1..2^25] below it is BVX_ERR_ARGUMENT, above BVX_ERR_RANGE
 *  Returns BVX_ERR_EMPTY (no vertex; only one position and no spacing), BVX_ERR_RANGE (dims beyond 2^25). */
BVX_API bvx_status bvx_lattice_fit(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                                   bvx_lattice *lattice);
BVX_API bvx_status bvx_lattice_fit_with(bvx_context *context, const bvx_mesh_view *mesh,
                                        const bvx_lattice_options *options, bvx_lattice *lattice);
/** A lattice from its parts; fraction_bits follows from dims. */
BVX_API bvx_status bvx_lattice_make(bvx_context *context, const double origin[3], const double spacing[3],
                                    const int32_t dims[3], bvx_lattice *lattice);

/* ---- Grids --------------------------------------------------------------------------------------------- */
/** A set of voxels, one bit each. Voxel (x,y,z) of the window is bit (x & 63) of words[(z * size[1] + y) *
 *  words_per_row + (x >> 6)]. Bits at or past size[0] are always 0: set by a caller, they spoil results, not memory. */
typedef struct bvx_grid {
    uint64_t *words; /**< [Size: bvx_grid_bound] 64-byte aligned when the library made it */
    uint64_t word_capacity; /**< words that the array holds; set by a caller who provides it */
    bvx_lattice lattice;
    int32_t low[3]; /**< window: lattice index of voxel (0,0,0) [Units: voxels] */
    int32_t size[3]; /**< window: voxels along each axis [Units: voxels] */
    int32_t words_per_row; /**< (size[0] + 63) / 64 */
    int32_t owned, reserved[4]; /**< 1 when bvx_grid_free frees words */
} bvx_grid;
/** Words that the grid of a window needs; 0 when the window is not inside the lattice. NULL: the whole lattice. */
BVX_API uint64_t bvx_grid_bound(const bvx_lattice *lattice, const bvx_window *window);
/** An empty grid of a window (NULL: the whole lattice). */
BVX_API bvx_status bvx_grid_create(bvx_context *context, const bvx_lattice *lattice, const bvx_window *window,
                                   bvx_grid *grid);
BVX_API void bvx_grid_free(bvx_context *context, bvx_grid *grid);
BVX_API bvx_status bvx_grid_count(bvx_context *context, const bvx_grid *grid, uint64_t *count);
/** Hash of size, low, lattice and bits, the same on every machine. */
BVX_API bvx_status bvx_grid_hash(bvx_context *context, const bvx_grid *grid, uint64_t *hash);

/** Whether voxel (x,y,z) of the window is set: 0 or 1; and set or clear it. The range is not checked. */
static inline int bvx_grid_get(const bvx_grid *grid, int32_t x, int32_t y, int32_t z)
{
    size_t const row = (size_t)z * (size_t)grid->size[1] + (size_t)y;
    return (int)(grid->words[row * (size_t)grid->words_per_row + (size_t)(x >> 6)] >> (x & 63) & 1);
}
static inline void bvx_grid_set(bvx_grid *grid, int32_t x, int32_t y, int32_t z, int value)
{
    size_t const row = (size_t)z * (size_t)grid->size[1] + (size_t)y;
    uint64_t *const word = &grid->words[row * (size_t)grid->words_per_row + (size_t)(x >> 6)];
    uint64_t const bit = UINT64_C(1) << (x & 63);
    *word = value ? *word | bit : *word & ~bit;
}

/* ---- Solids -------------------------------------------------------------------------------------------- */
/** What decides that a centre is inside, for solids, fields, repair and booleans: docs/rules.md, and docs/guide.md says
 *  which to take. AUTO takes what suits the mesh, flipped triangles turned first: PARITY where closed shells do not
 *  cross, NONZERO where they do, WINDING where there are holes, VOTE where triangles cannot be oriented. Repair takes
 *  WINDING in place of the first two. A rule that a call does not take is BVX_ERR_ARGUMENT. */
#define BVX_FILL_LIST(X) \
    X(BVX_FILL_AUTO, 0, "auto") \
    X(BVX_FILL_PARITY, 1, "parity") /* an odd number of crossings along x: nested shells are cavities */ \
    X(BVX_FILL_NONZERO, 2, "nonzero") /* a winding number along x: overlapping, inverted shells are one */ \
    X(BVX_FILL_VOTE, 3, "vote") /* the majority of directions: closes holes, flipped triangles do no harm */ \
    X(BVX_FILL_FLOOD, 4, "flood") /* what a flood from outside cannot reach: fills cavities */ \
    X(BVX_FILL_REGIONS, 5, "regions") /* each region of the surface as a whole: keeps cavities */ \
    X(BVX_FILL_BELOW, 6, "below") /* all that lies under a terrain, or between two */ \
    X(BVX_FILL_WINDING, 7, "winding") /* a generalized winding number above a half: closes holes smoothly */ \
    X(BVX_FILL_NORMAL, 8, "normal") /* the closest triangle's side (the paper's): wrong near edges */ \
    X(BVX_FILL_NONE, 9, "none") /* no side: distances are not negative */
enum {
    BVX_FILL_LIST(BVX_LIST_ENUM) BVX_FILL_COUNT = 10, /* and the rules that calls take, as bits 1 << rule */
    BVX_FILLS_OF_SOLID = 255,
    BVX_FILLS_OF_BOOLEAN = 1 << BVX_FILL_PARITY | 1 << BVX_FILL_NONZERO | 1 << BVX_FILL_VOTE | 1 << BVX_FILL_WINDING |
                           1 << BVX_FILL_AUTO,
    BVX_FILLS_OF_REPAIR = 1 << BVX_FILL_AUTO | 1 << BVX_FILL_PARITY | 1 << BVX_FILL_WINDING | 1 << BVX_FILL_VOTE,
    BVX_FILLS_OF_FIELD = 1 << BVX_FILL_AUTO | 1 << BVX_FILL_PARITY | 1 << BVX_FILL_NONZERO | 1 << BVX_FILL_VOTE |
                         1 << BVX_FILL_WINDING | 1 << BVX_FILL_NORMAL | 1 << BVX_FILL_NONE
};

/** Why a rule filled a mesh. */
enum {
    BVX_FILL_REASON_ASKED = 0, /**< it was chosen by name */
    BVX_FILL_REASON_SOUND = 1, /**< PARITY: closed, and nothing lies twice inside: all rules agree */
    BVX_FILL_REASON_NESTED = 2, /**< PARITY: closed shells lie in others that face the same way: cavities */
    BVX_FILL_REASON_OVERLAP = 3, /**< NONZERO: closed shells cross each other or themselves: one solid */
    BVX_FILL_REASON_OPEN = 4, /**< WINDING: there are open edges */
    BVX_FILL_REASON_UNORIENTABLE = 5 /**< VOTE: the triangles of some patch cannot be oriented alike */
};

/** What is up for BVX_FILL_BELOW: towards the high end of this axis. */
#define BVX_UP_LIST(X) X(BVX_UP_Z, 0, "z") X(BVX_UP_X, 1, "x") X(BVX_UP_Y, 2, "y")
enum { BVX_UP_LIST(BVX_LIST_ENUM) };
/** When walls that voxels lose are searched. AUTO: in a whole lattice with a report, as far as memory allows. */
#define BVX_CHECK_LIST(X) X(BVX_CHECK_AUTO, 0, "auto") X(BVX_CHECK_NEVER, 1, "never") X(BVX_CHECK_ALWAYS, 2, "always")
enum { BVX_CHECK_LIST(BVX_LIST_ENUM) };

/** Counts of other rules are 0. */
typedef struct bvx_solid_report {
    int32_t fill; /**< BVX_FILL_...: the rule that filled; AUTO reports its choice */
    int32_t fill_reason; /**< BVX_FILL_REASON_... */
    uint64_t crossings; /**< of rows with the surface, also outside the window along the row */
    uint64_t unbalanced_rows; /**< rows whose crossings do not balance: there is a hole (winding: docs/rules.md) */
    uint64_t leaks; /**< flood: voxels off the surface that it reached although they are surely inside */
    uint64_t regions; /**< regions: how many there are */
    uint64_t mixed_regions, mixed_voxels; /**< regions: with sure centres of both sides, or none; their voxels */
    uint64_t cut_voxels, fill_voxels; /**< below: voxels where mesh lies above second; second above mesh */
    uint64_t turned; /**< auto: triangles that were turned first */
    double volume; /**< of the voxels set [Units: world] */
    double mesh_volume; /**< that the mesh encloses, as a float; 0 where it is not comparable [Units: world] */
    double crossing_volume; /**< thin_checked: of the solid that ends at the mesh along rows; else 0 [Units: world] */
    int32_t volume_resolution; /**< at which volume is within 1 % of these; 0: it is, or none is */
    int32_t thin_checked; /**< 1: walls that the voxels lose were searched (check_thin) */
    uint64_t thin_voxels; /**< voxels at walls thinner than 1.5 voxels that are lost, or have gaps */
    int32_t thin_resolution; /**< at which nine tenths of them have a wall of 1.5 voxels; 0: none, or none needed */
    int32_t thin_box[2][3], reserved; /**< lowest and highest of these voxels, inclusive [Units: lattice's voxels] */
    uint64_t warnings; /**< not in bvx_boolean_report */
} bvx_solid_report;
typedef struct bvx_voxelize_options {
    size_t struct_size;
    int32_t fill; /**< BVX_FILL_... [Limit: 0..7] */
    int32_t has_base; /**< 1: below: columns begin at base, not at the lattice's end */
    bvx_window window; /**< flood, regions: the whole lattice only */
    bvx_solid_report *report;
    int32_t close_gaps; /**< flood: gaps of so many voxels stop it (docs/rules.md) [Units: voxels] [Limit: 0..65535] */
    int32_t add_shell; /**< 1: set the conservative surface's voxels too; not for below */
    int32_t check_thin; /**< for thin_... of the report, BVX_CHECK_...; not ALWAYS for below */
    int32_t up; /**< below: BVX_UP_... */
    double base; /**< below, with has_base: height where columns begin [Units: world] [Limit: any] */
    const bvx_mesh_view *second; /**< below: fill between the mesh and this, where both exist */
} bvx_voxelize_options;
/** Set the voxels whose centres lie inside a mesh. Vertices are snapped to the lattice's fixed point; from there every
 *  decision is exact, with one rule for ties: solids that share faces share no voxel and leave none between them.
 *  Vertices that no triangle uses may be anything.
 *  Returns BVX_ERR_ARGUMENT (also options that the rule does not take, and a window for flood or regions),
 *  BVX_ERR_EMPTY (flood: it reached every centre off the surface although there is an inside), BVX_ERR_RANGE (also a
 *  vertex too far from the lattice for its fixed point: docs/exactness.md). */
BVX_API bvx_status bvx_voxelize_solid(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                                      const bvx_voxelize_options *options, bvx_grid *solid);

/* ---- Surface voxels ------------------------------------------------------------------------------------ */
/** Which voxels are the surface.
 *  CONSERVATIVE  those whose closed box meets a triangle: no path leaks through, of whatever connectivity
 *  THIN          those whose axis cross (three unit segments through the centre) meets one: no 6-connected path leaks
 *  SAMPLED       those with a point of its subdivision into parts shorter than a voxel: a flood may leak through */
#define BVX_SURFACE_LIST(X) \
    X(BVX_SURFACE_CONSERVATIVE, 0, "conservative") \
    X(BVX_SURFACE_THIN, 1, "thin") \
    X(BVX_SURFACE_SAMPLED, 2, "sampled")
enum { BVX_SURFACE_LIST(BVX_LIST_ENUM) };

/** The triangles that touch each set voxel. Set voxel r, counted in the order of the grid's bits (z, y, x), has
 *  triangles[offsets[r]] .. triangles[offsets[r + 1] - 1], ascending. */
typedef struct bvx_attached {
    uint64_t *offsets; /**< [Size: voxel_count + 1] */
    uint32_t *triangles; /**< [Size: triangle_count] */
    uint64_t voxel_count; /**< set voxels of the grid */
    uint64_t triangle_count, reserved[2]; /**< offsets[voxel_count] */
} bvx_attached;
BVX_API void bvx_attached_free(bvx_context *context, bvx_attached *attached);

typedef struct bvx_surface_report {
    uint64_t triangles; /**< sampled (other modes count 0): those whose first corner is in the window */
    uint64_t samples, parts, reserved[4]; /**< points of their subdivision; parts of their longest edges */
} bvx_surface_report;
typedef struct bvx_surface_options {
    size_t struct_size;
    int32_t mode, reserved; /**< BVX_SURFACE_... */
    bvx_window window;
    bvx_attached *attached; /**< receives the triangles of each voxel */
    bvx_surface_report *report;
} bvx_surface_options;
/** Set the voxels that a mesh's surface touches, exactly, vertices snapped to the lattice's fixed point. Triangles
 *  without area count as segments or points (thin: not at all). Returns as bvx_voxelize_solid. */
BVX_API bvx_status bvx_voxelize_surface(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                                        const bvx_surface_options *options, bvx_grid *surface);

/* ---- Surfaces of grids --------------------------------------------------------------------------------- */
/** What happens on a cell face whose two diagonals differ: SEPARATE keeps set corners apart (the solid is 6-connected),
 *  JOIN joins them (18-connected on faces). */
#define BVX_FACE_LIST(X) X(BVX_FACE_SEPARATE, 0, "separate") X(BVX_FACE_JOIN, 1, "join")
enum { BVX_FACE_LIST(BVX_LIST_ENUM) };

/** The lattice that a call works on: given, or fitted to what the call takes. */
typedef struct bvx_fit {
    const bvx_lattice *lattice; /**< to work on; NULL: fitted by resolution */
    int32_t resolution, reserved; /**< along the longest axis [Limit: 1..2^24] [Default: 256; of levels by targets] */
} bvx_fit;

/** Where the vertices of a surface between voxels lie, and their type. */
typedef struct bvx_placing {
    int32_t position_type, local_frame; /**< see Types */
    int32_t face_rule; /**< BVX_FACE_... */
    int32_t interpolation; /**< BVX_EDGE_... */
    int32_t sharp, reserved; /**< sharp edges and corners get vertices: BVX_SHARP_... */
} bvx_placing;

/** Which parts of a solid are kept, in voxels that join through faces. */
typedef struct bvx_parts {
    uint64_t least_part; /**< parts of fewer voxels are dropped [Limit: any] */
    uint64_t keep_largest; /**< so many of the largest parts are kept; 0: all [Limit: any] */
    uint64_t least_cavity; /**< cavities of fewer voxels are filled; 0 in booleans [Limit: any] */
    int32_t keep_crumbs, reserved; /**< 1: keep small parts and pockets that are not in the mesh */
} bvx_parts;

/** What simplified levels have: triangles or an error each, and with neither half the triangles of the one before. */
typedef struct bvx_targets {
    const uint64_t *triangles; /**< at most so many in a level [Size: level_count] */
    const double *errors; /**< largest of each level [Units: world] [Limit: > 0] [Size: level_count] */
    int32_t error_kind; /**< of errors, BVX_ERROR_... [Limit: 0..1] */
    int32_t strict; /**< 1: a target that cannot be met is BVX_ERR_RANGE */
    uint64_t samples; /**< points a side for reports' distances; 0: not measured, by errors 20000 [Limit: 0..2^31-1] */
    double even; /**< pull towards triangles of even size on flat parts [Limit: BVX_NONE, or 0..1] [Default: 1e-9] */
} bvx_targets;

/** Sides of the window that are left open, as bits. */
/* clang-format off */
#define BVX_SIDE_LIST(X) \
    X(BVX_OPEN_X_LOW, 1, "x-low") X(BVX_OPEN_X_HIGH, 2, "x-high") X(BVX_OPEN_Y_LOW, 4, "y-low") \
    X(BVX_OPEN_Y_HIGH, 8, "y-high") X(BVX_OPEN_Z_LOW, 16, "z-low") X(BVX_OPEN_Z_HIGH, 32, "z-high")
/* clang-format on */
enum { BVX_SIDE_LIST(BVX_LIST_ENUM) };
typedef struct bvx_extract_options {
    size_t struct_size;
    int32_t face_rule; /**< BVX_FACE_... */
    int32_t position_type; /**< see Types */
    int32_t open_sides; /**< BVX_OPEN_...: beyond the window is empty, but at these sides [Limit: 0..63] */
    int32_t keys; /**< 1: fill vertex_keys and triangle_keys [Limit: 0..1; dims below 2^20] */
    int32_t local_frame, reserved; /**< see Types */
} bvx_extract_options;
/** The exact size of what bvx_extract_surface or bvx_extract_scalar makes: for arrays of one's own. */
BVX_API bvx_status bvx_extract_count(bvx_context *context, const bvx_grid *grid, const bvx_extract_options *options,
                                     uint64_t *vertex_count, uint64_t *triangle_count);
/** The surface between set and empty voxel centres by marching cubes, with vertices at the middle of lattice edges.
 *  Closed, outwards, edge- and vertex-manifold, without duplicate triangles and triangles without area; an open side
 *  has a boundary. Windows that overlap by one layer of voxels, with open sides there, tile the whole: bvx_mesh_merge.
 *  Their orders: docs/rules.md. Returns BVX_ERR_RANGE (also positions too coarse for their type; 2^32 vertices). */
BVX_API bvx_status bvx_extract_surface(bvx_context *context, const bvx_grid *grid, const bvx_extract_options *options,
                                       bvx_mesh *mesh);

typedef struct bvx_faces_options {
    size_t struct_size;
    int32_t position_type, local_frame; /**< see Types */
    const bvx_grid
        *of; /**< only faces of these voxels of the grid, such as those of one colour; same lattice and window
                             [Default: NULL, all] */
    int32_t merged; /**< 1: faces of one plane and side become rectangles */
    int32_t open_sides; /**< BVX_OPEN_...: the outermost voxels at these sides are a neighbour's, whose faces are left
                             to it: windows that overlap by two voxels have each face once [Limit: 0..63] */
} bvx_faces_options;
/** The voxels themselves as a mesh: two outward triangles for each face between a set and an empty voxel. Not manifold
 *  where voxels touch only along an edge or at a corner. merged: corners lie on edges of others, without a crack, so
 *  bvx_mesh_check finds the mesh open. Returns as bvx_extract_surface. */
BVX_API bvx_status bvx_extract_faces(bvx_context *context, const bvx_grid *grid, const bvx_faces_options *options,
                                     bvx_mesh *mesh);
/** Join meshes with keys, of windows of one lattice: the result has the bytes of the whole extracted at once, keys
 *  included. Windows may not overlap, unchecked. Returns BVX_ERR_ARGUMENT (no keys; types or frames that differ). */
BVX_API bvx_status bvx_mesh_merge(bvx_context *context, const bvx_mesh *parts, uint64_t part_count, bvx_mesh *whole);

/** Where the surface cuts a lattice edge between two sides: always strictly inside the edge (docs/rules.md). */
#define BVX_EDGE_LIST(X) \
    X(BVX_EDGE_TANGENT, 0, "tangent") /* where planes through the closest points cut it; else VECTOR */ \
    X(BVX_EDGE_VECTOR, 1, "vector") /* nearest to the line through the closest points; else SCALAR */ \
    X(BVX_EDGE_SCALAR, 2, "scalar") /* where the signed distance, taken as linear, is 0 */ \
    X(BVX_EDGE_MIDDLE, 3, "middle") /* in the middle */ \
    X(BVX_EDGE_PAPER, 4, "paper") /* VECTOR with the paper's clamps to the ends in place of SCALAR */
enum { BVX_EDGE_LIST(BVX_LIST_ENUM) };
typedef struct bvx_field_surface_report {
    uint64_t edges; /**< crossings placed */
    uint64_t scalar, middle; /**< of these: by the signed distance (PAPER: by a clamp); in the middle, without values */
    uint64_t sharp_cells, sharp_taken_back; /**< sharp: vertices on edges and corners; those removed, lest they cross */
    uint64_t flipped_edges; /**< sharp: edges between such cells, flipped to join their vertices */
    uint64_t lids; /**< bvx_repair: placed by the winding number, no surface is near: lids over holes */
    uint64_t sharp; /**< 1: edges and corners were kept sharp */
    uint64_t own, reserved[1]; /**< grid: crossings that are not the field's, placed by offset or in the middle */
} bvx_field_surface_report;

/* ---- Fewer triangles ----------------------------------------------------------------------------------- */
/** What a level's error is: the mean distance (of both directions the mean), or the largest (of both the greater). */
#define BVX_ERROR_LIST(X) X(BVX_ERROR_MEAN, 0, "mean") X(BVX_ERROR_MAX, 1, "max")
enum { BVX_ERROR_LIST(BVX_LIST_ENUM) };
/** Which vertices levels have: PLACED, new ones, nearest to the mesh (bvx_closest_find gives weights for values at its
 *  corners); KEPT, the mesh's own, all of them in their order, so that what is stored by vertex follows. Those of equal
 *  positions and attributes stay apart, unless the mesh has three for each triangle. */
#define BVX_VERTICES_LIST(X) X(BVX_VERTICES_PLACED, 0, "placed") X(BVX_VERTICES_KEPT, 1, "kept")
enum { BVX_VERTICES_LIST(BVX_LIST_ENUM) };
/** What becomes of handles and holes: KEEP, they stay; SIMPLIFY, those at most three mean edges of the level around are
 *  cut and filled, the smallest first. No part goes or becomes two; those at seams or locked vertices stay. */
#define BVX_TOPOLOGY_LIST(X) X(BVX_TOPOLOGY_KEEP, 0, "keep") X(BVX_TOPOLOGY_SIMPLIFY, 1, "simplify")
enum { BVX_TOPOLOGY_LIST(BVX_LIST_ENUM) };
typedef struct bvx_level_report {
    uint64_t vertices, triangles;
    uint64_t target; /**< triangles wanted of this level, halves too, or 0 */
    double target_error; /**< error target of this level, or 0 [Units: world] */
    int32_t met; /**< 1: both are kept */
    int32_t measured; /**< 1: distance is filled */
    bvx_distance_report distance; /**< from the input (a) to the level (b); NaN where measured is 0 */
    bvx_certificate certificate; /**< of the level */
    uint64_t crossings; /**< pairs of triangles that cross: 0, or some that the mesh had */
    double least_angle; /**< smallest angle of a triangle [Units: degrees] */
    uint64_t refused; /**< edges tried and kept, to keep what bvx_mesh_simplify promises */
    uint64_t handles_cut, holes_filled; /**< of the mesh, down to this level: BVX_TOPOLOGY_SIMPLIFY */
    double longest_closed; /**< way around the largest of them, or 0 [Units: world] */
    uint64_t reserved[3];
} bvx_level_report;

/** How edges collapse, and what stays. */
typedef struct bvx_collapse {
    double attribute_weight; /**< of attributes beside the shape (docs/rules.md); BVX_NONE: they follow it and cost
                                  nothing [Limit: BVX_NONE, or 0..1000] [Default: 1] */
    const uint8_t *locked; /**< vertices with a value other than 0 stay bit for bit [Size: vertex_count] */
    int32_t position_type; /**< see Types; AUTO: the mesh's, of a measured surface as everywhere */
    int32_t lock_border; /**< 1: vertices on borders stay, so that tiles join */
    int32_t vertices; /**< BVX_VERTICES_... [Limit: 0..1] */
    int32_t topology; /**< BVX_TOPOLOGY_... [Limit: 0..1] */
} bvx_collapse;
typedef struct bvx_simplify_options {
    size_t struct_size;
    bvx_targets targets;
    bvx_collapse collapse;
    bvx_level_report *reports; /**< [Size: level_count] */
} bvx_simplify_options;
/** Fewer triangles for a mesh as it is: a chain of levels, each made from the one before by collapsing the edges that
 *  cost least. Parts, handles (topology), borders, sides and own crossings stay. What is closed, manifold, oriented and
 *  free of crossings stays so; any other mesh gets no new fault. A small target is not always met: docs/rules.md.
 *  mesh    any mesh with area. Vertices at one position count as one; triangles without area and exact copies are
 *          dropped, flipped ones turned, edges of three triangles and more parted by sides, or cut
 *  levels  [Size: level_count] After a failure none is to be read. Those that the library allocates have the mesh's
 *          attributes; arrays of the caller's get positions and triangles alone
 *  Returns BVX_ERR_RANGE (also a mesh that spans less than 1e-30 or more than 1e31; strict). */
BVX_API bvx_status bvx_mesh_simplify(bvx_context *context, const bvx_mesh_view *mesh,
                                     const bvx_simplify_options *options, uint64_t level_count, bvx_mesh *levels);

/* ---- Smoothing ----------------------------------------------------------------------------------------- */
/** SINC: no wave is swollen, and the pass band ends sharply; TAUBIN: two steps an iteration. */
enum { BVX_SMOOTH_SINC = 0, BVX_SMOOTH_TAUBIN = 1 };
typedef struct bvx_smooth_report {
    double volume_before, volume_after; /**< of a closed mesh [Units: world^3] */
    double largest_move; /**< of a vertex [Units: world] */
    uint64_t held; /**< positions that do not move */
    uint64_t undone, reserved[3]; /**< positions that went back because of crossings */
} bvx_smooth_report;
typedef struct bvx_smooth_options {
    size_t struct_size;
    int32_t method; /**< BVX_SMOOTH_... [Limit: 0..1] */
    int32_t iterations; /**< the more, the sharper the pass band ends [Limit: 1..1000] [Default: 20] */
    double pass_band; /**< what varies more slowly is kept: eigenvalues of the Laplacian; 0.1 are waves of about 14
                           edges [Limit: 0.001..1] [Default: 0.1] */
    double sharp_angle; /**< vertices of edges that turn by more stay; 0: none [Limit: 0..180] [Units: degrees] */
    int32_t hold_border; /**< 1: vertices of borders stay, else they are smoothed along these */
    int32_t no_crossings; /**< 1: moves are undone where triangles would cross that did not */
    bvx_smooth_report *report;
    uint64_t reserved[2];
} bvx_smooth_options;
/** Smooth the positions of any mesh; its triangles and attributes stay. Vertices at one position move as one. On
 *  borders and on edges of three triangles and more, vertices have the neighbours along these alone; where other than
 *  two such edges meet they stay, bit for bit. What is slower than the pass band keeps its size, volumes to about 1 %
 *  (TAUBIN: 3 %). positions, out, are of the view's type, doubles where it has a transform [Size: vertex_count * 3].
 *  Returns BVX_ERR_EMPTY (no triangle), BVX_ERR_RANGE (also more than (2^32 - 1) / 3 triangles). */
BVX_API bvx_status bvx_mesh_smooth(bvx_context *context, const bvx_mesh_view *mesh, const bvx_smooth_options *options,
                                   void *positions);

/* ---- Repair -------------------------------------------------------------------------------------------- */
/** Why a mesh needs a repair: the first of these that holds. */
enum {
    BVX_NEEDS_NOTHING = 0, /**< it is closed, manifold, oriented and outwards, and crosses itself nowhere */
    BVX_NEEDS_LIDS = 1, /**< open edges */
    BVX_NEEDS_MANIFOLD = 2, /**< edges of three triangles or more, vertices where parts touch */
    BVX_NEEDS_TURNS = 3, /**< neighbours of opposite orientation */
    BVX_NEEDS_AREA = 4, /**< triangles without area, or there twice */
    BVX_NEEDS_OUTSIDE_IN = 5, /**< its volume is not positive, or a part lies within another, not as a cavity */
    BVX_NEEDS_UNCROSSING = 6 /**< triangles cross */
};

/** Sharp edges and corners: AUTO on meshes like machine parts of up to 500,000 triangles (docs/rules.md). */
#define BVX_SHARP_LIST(X) X(BVX_SHARP_AUTO, 0, "auto") X(BVX_SHARP_NEVER, 1, "never") X(BVX_SHARP_ALWAYS, 2, "always")
enum { BVX_SHARP_LIST(BVX_LIST_ENUM) };
/** Walls thinner than 1.5 voxels: KEEP, they are kept, closed and about as thick as they are; DROP, the lattice loses
 *  them; SHELL, parts that the solid misses become shells, as sheets do. What is lost is reported. */
#define BVX_THIN_LIST(X) X(BVX_THIN_KEEP, 0, "keep") X(BVX_THIN_DROP, 1, "drop") X(BVX_THIN_SHELL, 2, "shell")
enum { BVX_THIN_LIST(BVX_LIST_ENUM) };
typedef struct bvx_repair_report {
    bvx_certificate before; /**< of the input; vertices at equal positions count as one */
    bvx_certificate after; /**< of the result */
    bvx_lattice lattice; /**< that the result was made on */
    int32_t sign; /**< BVX_FILL_... that decided */
    int32_t needs; /**< BVX_NEEDS_...: why the input needs a repair, whatever if_needed is */
    int32_t copied; /**< 1: it needed none and was copied (if_needed) */
    int32_t sharp; /**< 1: vertices were put on sharp edges and corners */
    int32_t thin_kept; /**< 1: thin walls are in the result; 0: there are none, or they are lost */
    int32_t thin_resolution; /**< that keeps nine tenths of thin_voxels; 0: none, or none needed */
    uint64_t thin_voxels; /**< at walls thinner than 1.5 voxels with no centre inside: lost without KEEP */
    uint64_t holes; /**< loops of open edges in the input */
    uint64_t turned; /**< AUTO: triangles turned: flipped ones, and bodies inside out beside others */
    uint64_t crossings; /**< pairs of triangles of the input that cross, where they were counted */
    uint64_t shelled_triangles; /**< triangles of the input that became shells */
    uint64_t parts_dropped, cavities_dropped; /**< connected parts of the solid, and its cavities */
    uint64_t crumbs; /**< small parts and pockets that are not in the mesh, counted above too */
    bvx_distance_report distance; /**< with samples: a is the input, b the result */
    double crossing_volume; /**< the volume that it should have, as a float; 0: unknown, or copied [Units: world] */
    uint64_t warnings;
} bvx_repair_report;
typedef struct bvx_repair_options {
    size_t struct_size;
    bvx_fit fit; /**< [Default: 256 voxels, padded by 2 voxels and half a shell] */
    int32_t sign; /**< BVX_FILL_...: the rule for inside [Limit: BVX_FILLS_OF_REPAIR] */
    int32_t thin; /**< BVX_THIN_... */
    bvx_placing placing;
    double shell; /**< thickness that open sheets get, BVX_NONE: none [Units: largest spacings]
                       [Limit: BVX_NONE, or 0, or 1.5..10^6] [Default: 2] */
    bvx_parts parts;
    uint64_t reserved0, samples; /**< points a side for the report's distances; 0: not measured [Limit: 0..2^31-1] */
    bvx_repair_report *report;
    int32_t if_needed, reserved; /**< 1: copy a mesh that needs nothing, by its own position_type */
} bvx_repair_options;
/** Make a closed, manifold, oriented mesh without crossing triangles from any mesh. Holes get smooth lids, overlapping
 *  parts become one, sheets become shells, and walls too thin for the lattice are kept (thin). Details smaller than a
 *  voxel are lost. The steps, and what counts as a sheet: docs/rules.md.
 *  Returns BVX_ERR_EMPTY (also where nothing remains). */
BVX_API bvx_status bvx_repair(bvx_context *context, const bvx_mesh_view *mesh, const bvx_repair_options *options,
                              bvx_mesh *repaired);

/* ---- Levels of detail ---------------------------------------------------------------------------------- */
typedef struct bvx_levels_report {
    int32_t solid, reserved0; /**< 1: the levels were made from the measured surface */
    bvx_certificate before; /**< of the input; vertices at equal positions count as one */
    uint64_t triangles; /**< of the surface before edges collapsed */
    uint64_t collapsed, doubles; /**< dropped triangles: without area or with equal corners; copies of others */
    uint64_t turned; /**< triangles turned to agree with the others of their patch */
    uint64_t split, parted; /**< vertices, one for each fan now; edges of three triangles and more, by sides */
    uint64_t cut; /**< edges that became borders, since no pairing of their triangles does it */
    double cut_edge[2][3]; /**< ends of the first of them [Units: world] */
    uint64_t crumbs; /**< solid: those of repair, dropped */
    bvx_repair_report repair; /**< solid: what was found and done */
    int32_t resolution; /**< solid without a lattice: as in the options; else 0 */
    int32_t planned_resolution; /**< more than resolution where the memory limit did not allow it */
    uint64_t warnings, reserved[3];
} bvx_levels_report;
typedef struct bvx_levels_options {
    size_t struct_size;
    bvx_targets targets; /**< halving starts from the input */
    bvx_collapse collapse; /**< with solid: position_type and topology; the others are refused */
    int32_t solid; /**< 1: simplify the surface that bvx_repair measures: closed, manifold, oriented, without crossings
                        [Default: 0; 1 where an option marked "solid:" differs from its default] */
    bvx_fit fit; /**< solid: */
    int32_t sign; /**< solid: as in bvx_repair_options [Limit: BVX_FILLS_OF_REPAIR] */
    int32_t sharp; /**< solid: BVX_SHARP_... */
    double shell; /**< solid: as in bvx_repair_options [Limit: BVX_NONE, or 0, or 1.5..10^6] [Default: 2] */
    bvx_parts parts; /**< solid: least_cavity of UINT64_MAX: the outer hull */
    bvx_levels_report *report;
    bvx_level_report *reports; /**< [Size: level_count] */
} bvx_levels_options;
/** Levels of detail from any mesh: the main job. The mesh is simplified as it is, as by bvx_mesh_simplify. With solid
 *  its surface is measured first, as by bvx_repair; attributes are then for bvx_mesh_carry.
*  Returns as bvx_mesh_simplify; BVX_ERR_ARGUMENT (also what solid refuses), BVX_ERR_BUDGET (names what suffices). */
BVX_API bvx_status bvx_build_levels(bvx_context *context, const bvx_mesh_view *mesh, const bvx_levels_options *options,
                                    uint64_t level_count, bvx_mesh *levels);

/* ---- Hulls --------------------------------------------------------------------------------------------- */
typedef struct bvx_hull_report {
    bvx_lattice lattice; /**< that the hull was made on */
    uint64_t triangles; /**< of the hull before edges collapse */
    uint64_t outer_triangles, shelled_triangles; /**< of the input: on which the hull lies; that became shells */
    uint64_t lids; /**< crossings of lattice edges where an opening was closed */
    uint64_t parts_dropped; /**< connected parts of the body: least_part, keep_largest */
    uint64_t warnings, reserved[3];
} bvx_hull_report;
typedef struct bvx_hull_options {
    size_t struct_size;
    bvx_fit fit; /**< [Default: 256 voxels, padded by 2 voxels and half a shell] */
    bvx_placing placing;
    bvx_targets targets; /**< errors are measured from the hull [Default: the first level is the hull itself] */
    bvx_parts parts; /**< least_part and keep_largest; every cavity is filled */
    double shell; /**< thickness of walls with outside on both sides and no centre in them; BVX_NONE: they are lost
                       [Units: largest spacings] [Limit: BVX_NONE, or 0, or 1.5..10^6] [Default: 2] */
    int32_t close_gaps, reserved; /**< openings of up to this many voxels are closed; 0: those that no empty voxel leads
                                       through [Units: voxels] [Limit: 0..65535] */
    bvx_hull_report *report;
    bvx_level_report *reports; /**< [Size: level_count] */
    double
        enclose; /**< above 0: every level goes around all triangles, touches none and is nowhere further from them; no
                         fit, parts, close_gaps and shell then [Units: world] [Limit: >= 0] [Default: 0, unset] */
} bvx_hull_options;
/** What of a mesh can be reached from outside, as closed levels: inner walls, shells and parts are gone, and the
 *  surface lies on the outer of double walls. The mesh may be anything: walls doubled, welded through holes, crossing,
 *  flipped, loose parts inside. Levels are closed, manifold, oriented, free of crossings and without attributes, which
 *  bvx_mesh_carry gives. How openings are closed: docs/rules.md. levels as for bvx_mesh_simplify.
 *  Returns as bvx_build_levels; BVX_ERR_EMPTY also where the mesh encloses no centre and shell is BVX_NONE. */
BVX_API bvx_status bvx_hull(bvx_context *context, const bvx_mesh_view *mesh, const bvx_hull_options *options,
                            uint64_t level_count, bvx_mesh *levels);

/* ---- Booleans of meshes -------------------------------------------------------------------------------- */
/** What two bodies become: what lies in a or in b; in both; in a and not in b; in only one of them. */
#define BVX_BOOLEAN_LIST(X) \
    X(BVX_BOOLEAN_UNION, 0, "union") \
    X(BVX_BOOLEAN_INTERSECTION, 1, "intersection") \
    X(BVX_BOOLEAN_DIFFERENCE, 2, "difference") \
    X(BVX_BOOLEAN_XOR, 3, "xor")
enum { BVX_BOOLEAN_LIST(BVX_LIST_ENUM) };
/** Meshes of which thin walls were kept; and what has few voxels: fewer than 6 along its longest axis, or none. */
enum { BVX_KEPT_A = 1, BVX_KEPT_B = 2 };
enum { BVX_FEW_A = 1, BVX_FEW_B = 2, BVX_FEW_RESULT = 4 };
typedef struct bvx_boolean_report {
    bvx_lattice lattice; /**< that the result was made on */
    uint64_t voxels_a, voxels_b, voxels; /**< centres inside each, and inside the result */
    bvx_field_surface_report surface; /**< how the vertices were placed */
    int32_t sharp; /**< 1: vertices were put on sharp edges and corners */
    int32_t few; /**< BVX_FEW_... that the lattice is too coarse for, or 0 */
    int32_t advised_resolution; /**< where few is not 0: the resolution to take */
    int32_t thin_kept; /**< BVX_KEPT_... of the meshes whose thin walls were kept; others' are lost */
    uint64_t crumbs, parts_dropped; /**< small parts that neither mesh has; by least_part and keep_largest */
    bvx_solid_report solid_a, solid_b; /**< how each was filled, before walls are kept */
    uint64_t warnings;
} bvx_boolean_report;
typedef struct bvx_boolean_options {
    size_t struct_size;
    bvx_fit fit; /**< [Default: 256 voxels, padded by 1, around both; of a difference around a, of an intersection
                      around the box that both share] */
    int32_t fill; /**< BVX_FILL_...: the rule for inside [Limit: BVX_FILLS_OF_BOOLEAN] */
    int32_t thin; /**< BVX_THIN_KEEP (of b in a difference: slots) or BVX_THIN_DROP [Limit: 0..1] */
    bvx_placing placing; /**< sharp AUTO: where one of the meshes has sharp edges */
    bvx_parts parts; /**< crumbs are parts that neither mesh has */
    bvx_boolean_report *report;
} bvx_boolean_options;
/** Two bodies by a BVX_BOOLEAN_... as a mesh, as exact as the lattice is fine. Each vertex lies where the mesh whose
 *  side changes there cuts its edge. The guarantee is that of bvx_extract_field_surface, whatever the meshes are. What
 *  the operation itself makes thinner than a voxel may be lost. result is empty where no centre lies inside.
 *  Returns BVX_ERR_EMPTY (a mesh without a triangle of area, or with no centre inside although it lies on the lattice),
 *  BVX_ERR_RANGE (as bvx_voxelize_solid and bvx_extract_surface). */
BVX_API bvx_status bvx_boolean(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b, int32_t operation,
                               const bvx_boolean_options *options, bvx_mesh *result);

/* ---- Levels by samples --------------------------------------------------------------------------------- */
/** How levels are sampled: EDGE_RATIO, the paper's: samples of the extended voxel function, first change along an edge;
 *  COVERAGE, the share of set voxels in the sample's box, linear positions. */
#define BVX_LOD_LIST(X) X(BVX_LOD_EDGE_RATIO, 0, "edge-ratio") X(BVX_LOD_COVERAGE, 1, "coverage")
enum { BVX_LOD_LIST(BVX_LIST_ENUM) };
typedef struct bvx_lod_report {
    int32_t resolution[3], reserved; /**< samples along each axis */
    double ratio[3]; /**< voxels a sample along each axis */
    uint64_t vertices, triangles;
    uint64_t searched; /**< resolutions that the search for a triangle count tried */
} bvx_lod_report;

typedef struct bvx_sampling {
    int32_t method; /**< BVX_LOD_...; EDGE_RATIO is nearer to the original where measured */
    int32_t edge_samples; /**< edge ratio: steps along an edge; 0: by the ratio [Limit: 0..65536] */
    double threshold; /**< inside means above it [Limit: > 0, < 1; kept to 2^-16] [Default: 0.5] */
} bvx_sampling;
typedef struct bvx_lod_options {
    size_t struct_size;
    bvx_sampling sampling;
    const int32_t *resolutions; /**< samples along the longest axis [Size: level_count] */
    const int32_t *axis_resolutions; /**< samples along x, y, z [Size: level_count * 3] */
    const uint64_t *target_triangles; /**< at most so many in a level [Size: level_count] */
    int32_t face_rule; /**< BVX_FACE_... */
    int32_t position_type, local_frame; /**< see Types */
    int32_t first_level; /**< index of levels[0] in messages [Limit: >= 0] */
    double collapse; /**< target_triangles: make up to this many times the target, then collapse edges: 2 to 4 is nearer
                          to the original, but less even and slower [Limit: 0, or 1..64] */
    bvx_lod_report *reports; /**< [Size: level_count] */
} bvx_lod_options;
/** The resolution of the solid for bvx_build_lods: eight times the samples of the finest level, less where memory is
 *  short. padding is in voxels on every side. limited, out, may be NULL: 1 when memory decided. */
BVX_API bvx_status bvx_plan_lods(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lod_options *options,
                                 uint64_t level_count, int32_t padding, int32_t *resolution, int32_t *limited);
/** Closed, manifold meshes of several sizes from one solid. Each level lays a coarser lattice over the grid, n voxels
 *  to r samples along an axis (any ratio n/r >= 1), such that nothing shifts or shrinks: docs/rules.md. Exactly one of
 *  resolutions, axis_resolutions and target_triangles is given. After a failure no level is to be read.
 *  Returns BVX_ERR_RANGE (resolutions above the grid's; too small a target), BVX_ERR_EMPTY (a level without any). */
BVX_API bvx_status bvx_build_lods(bvx_context *context, const bvx_grid *solid, const bvx_lod_options *options,
                                  uint64_t level_count, bvx_mesh *levels);

/* ---- Closest points ------------------------------------------------------------------------------------ */
/** A mesh prepared for closest points, rays and winding numbers. It keeps what it needs: the view may be freed. */
typedef struct bvx_closest bvx_closest;

typedef struct bvx_closest_point {
    double position[3]; /**< [Units: world] */
    double distance; /**< [Units: world] */
    double weight[3]; /**< barycentric coordinates: not negative, with sum 1 but for rounding */
    uint32_t triangle; /**< the lowest index among the triangles at that distance; all else is of it */
    int32_t feature; /**< 0: inside the triangle; 1, 2, 3: on edge 0-1, 1-2, 2-0; 4, 5, 6: on corner 0, 1, 2 */
} bvx_closest_point;
/** Prepare a mesh. A handle that is passed again is overwritten: free it first. */
BVX_API bvx_status bvx_closest_create(bvx_context *context, const bvx_mesh_view *mesh, bvx_closest **closest);
BVX_API void bvx_closest_free(bvx_context *context, bvx_closest *closest);
/** The closest points to count points. A distance beyond the largest double is infinity. */
BVX_API bvx_status bvx_closest_find(bvx_context *context, const bvx_closest *closest, const double *points,
                                    uint64_t count, bvx_closest_point *found);
/** How often the mesh goes around each of count points; exact. Of a closed, oriented mesh 0 outside and 1 inside; of an
 *  open one the signed number of triangles ahead along x. On the surface the tie rule of voxel centres decides. */
BVX_API bvx_status bvx_closest_winding(bvx_context *context, const bvx_closest *closest, const double *points,
                                       uint64_t count, int64_t *turns);

typedef struct bvx_mesh_hit {
    double t; /**< position = origin + t * direction */
    double position[3]; /**< [Units: world] */
    double weight[3]; /**< barycentric coordinates: not negative, with sum 1 but for rounding */
    uint32_t triangle;
    int32_t side; /**< 1: that of the normal by the right hand; -1: the other; 0: none is met, all else is zero */
} bvx_mesh_hit;
/** The nearest hit of each of count rays, with 0 <= t <= t_max; of equal t the lowest index. A ray passes between no
 *  two triangles with a common edge, and through an edge or a corner it meets one of the triangles there. A triangle
 *  seen from its edge is not met.
 *  Returns BVX_ERR_ARGUMENT (a direction of 0, t_max below 0), BVX_ERR_RANGE (also a start 2^200 mesh sizes away). */
BVX_API bvx_status bvx_closest_cast(bvx_context *context, const bvx_closest *closest, const double *rays,
                                    uint64_t count, double t_max, bvx_mesh_hit *hits);
/** All hits of each ray, by t, then by index of the triangle. Those of ray r are hits[offsets[r]] .. hits[offsets[r +
 *  1] - 1]. hits NULL: only offsets [Size: count + 1] are written; after BVX_ERR_CAPACITY they are valid. */
BVX_API bvx_status bvx_closest_crossings(bvx_context *context, const bvx_closest *closest, const double *rays,
                                         uint64_t count, double t_max, uint64_t *offsets, bvx_mesh_hit *hits,
                                         uint64_t capacity);
/** Where links from the set voxels of a grid to their neighbours meet the mesh, as lattice Boltzmann methods use them.
 *  links    6 (faces), 18 (and edges) or 26 (and corners), in order (z, y, x) from -1 to 1
 *  values   part of the way from the centre to the neighbour's, 0 to 1, at the nearest hit of bvx_closest_cast; -1: none.
 *           Of set voxel n in order (z, y, x) they begin at n * links [Size: set voxels * links]
 *  Returns BVX_ERR_ARGUMENT (links is another number), BVX_ERR_RANGE (the grid is 2^200 mesh sizes away). */
BVX_API bvx_status bvx_closest_links(bvx_context *context, const bvx_closest *closest, const bvx_grid *grid,
                                     int32_t links, float *values);
/** Give the vertices of a mesh the colours and texture coordinates of the source's closest points. What the source does
 *  not have stays. The target's arrays are the library's. A triangle over a seam of the texture stretches across it. */
BVX_API bvx_status bvx_mesh_carry(bvx_context *context, const bvx_mesh *source, bvx_mesh *target);
/** Label the set voxels of a grid by the point of a mesh that is closest to their centres. Where the mesh has colours of
 *  vertices, or more than 254 materials, a label is a colour, base colour of the material times that of the vertices;
 *  beyond 255 colours close ones become their mean. Else it is 1 + the index of the material. Textures are not looked up
 *  (BVX_WARN_LOST).
 *  grid     in the mesh's coordinates, without its frame
 *  labels   0 where no voxel is set [Size: size[0] * size[1] * size[2]] x fastest
 *  palette  red, green, blue, alpha of each label [Size: 1024]
 *  Returns BVX_ERR_ARGUMENT (the mesh has neither), BVX_ERR_EMPTY (no triangle of area), BVX_ERR_RANGE (2^32 - 1 set
 *  voxels or more). */
BVX_API bvx_status bvx_label_voxels(bvx_context *context, const bvx_mesh *mesh, const bvx_grid *grid, uint8_t *labels,
                                    uint8_t *palette);

/* ---- Distance fields ----------------------------------------------------------------------------------- */
/** Values at centres of voxels: where the closest point of a mesh lies, and on which side. Value n is that of set voxel
 *  n of band, in order (z, y, x). Centres beyond the band have a side only. */
typedef struct bvx_field {
    bvx_grid band; /**< set: centres that have a value */
    bvx_grid inside; /**< set: centres inside, in all of the window (docs/rules.md); without words for BVX_FILL_NONE */
    uint64_t *row_values; /**< index of the first value of row z * size[1] + y [Size: rows + 1] */
    uint64_t value_count; /**< row_values[rows] */
    void *vectors; /**< to the closest point; float or double [Size: value_count * 3] [Units: world] */
    void *distances; /**< negative inside (-0: on it); float or double [Size: value_count] [Units: world] */
    uint32_t *triangles; /**< the closest one, or NULL [Size: value_count] */
    uint8_t *features; /**< as in bvx_closest_point, or NULL [Size: value_count] */
    int32_t value_type; /**< BVX_F32 or BVX_F64 */
    int32_t sign; /**< BVX_FILL_... that decided */
    double half_width; /**< of the band; infinity: every centre has a value [Units: world] */
    uint64_t reserved[4];
} bvx_field;
BVX_API void bvx_field_free(bvx_context *context, bvx_field *field);

typedef struct bvx_field_options {
    size_t struct_size;
    double half_width; /**< of the band [Units: largest spacings] [Limit: > 0; infinity: all] [Default: 3] */
    int32_t sign; /**< BVX_FILL_...: the rule for inside [Limit: BVX_FILLS_OF_FIELD] */
    int32_t value_type; /**< BVX_F32 (spacings 2^-100 to 2^100) or BVX_F64 [Limit: 1..2] [Default: BVX_F32] */
    bvx_window window;
    int32_t no_vectors; /**< 1: vectors stay NULL */
    int32_t features; /**< 1: fill triangles and features */
    uint64_t reserved[2];
} bvx_field_options;
/** Measure the distance from centres of voxels to a mesh. On closed meshes all signs but NORMAL agree, up to the
 *  lattice's fixed point: docs/rules.md. NORMAL takes meshes that are counter-clockwise seen from outside.
 *  [Limit: (2^32 - 1) / 3 triangles for AUTO]
 *  Returns BVX_ERR_RANGE (as bvx_voxelize_solid; voxels or distances that floats do not hold: take BVX_F64). */
BVX_API bvx_status bvx_measure_field(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                                     const bvx_field_options *options, bvx_field *field);
/** Index of the value at voxel (x,y,z) of the window; UINT64_MAX where it has none. */
BVX_API uint64_t bvx_field_value(const bvx_field *field, int32_t x, int32_t y, int32_t z);

/** A field as one value for every centre of the window: signed distances, or with vectors 1 vectors. Where the band
 *  has no value stands half_width, negative inside, or a vector of 0. Beyond the largest float values are infinite.
 *  values  [Size: size[0] * size[1] * size[2], times 3 for vectors] */
BVX_API bvx_status bvx_field_dense(bvx_context *context, const bvx_field *field, int32_t vectors, float *values);

typedef struct bvx_field_surface_options {
    size_t struct_size;
    bvx_placing placing; /**< sharp AUTO: never without vectors or the mesh */
    double sharp_angle; /**< sharp: facets that meet at less are smooth [Units: cosine of the angle between their
                             normals; not 0, but as near as wanted] [Limit: -1..1] [Default: 0.8] */
    bvx_field_surface_report *report;
    const bvx_grid *grid; /**< the surface of other voxels in the field's window, made from its inside. Where it is that
                               of inside, vertices are the field's; elsewhere those of offset, or in the middle */
    double offset; /**< grid: vertices lie at this distance to the mesh, negative inside: for bodies made thicker,
                        thinner or hollow; 0: no such surface [Units: world] [Limit: any] */
} bvx_field_surface_options;
/** The surface between inside and outside centres of a field, by marching cubes with vertices where the field has the
 *  surface. Closed, outwards, edge- and vertex-manifold, without crossing triangles, for every field. Beyond the window
 *  is outside. Order as in bvx_extract_surface; vertices of sharp cells follow, in order of their cells. mesh may be
 *  NULL: only sharp uses it, with field->triangles.
 *  Returns as bvx_extract_surface; BVX_ERR_ARGUMENT also for a field of BVX_FILL_NONE, or without vectors where they
 *  are needed; BVX_ERR_RANGE also for f64 whose steps exceed 1/512 of a voxel. */
BVX_API bvx_status bvx_extract_field_surface(bvx_context *context, const bvx_field *field, const bvx_mesh_view *mesh,
                                             const bvx_field_surface_options *options, bvx_mesh *surface);

/* ---- Set algebra --------------------------------------------------------------------------------------- */
/** Combine two grids of one lattice and window by a BVX_BOOLEAN_..., in place where the result is one of them. After
 *  BVX_CANCELLED its bits are then unspecified. */
BVX_API bvx_status bvx_grid_combine(bvx_context *context, const bvx_grid *a, const bvx_grid *b, int32_t operation,
                                    bvx_grid *result);
/** The voxels of the window that are not set. As bvx_grid_combine, also in place. */
BVX_API bvx_status bvx_grid_complement(bvx_context *context, const bvx_grid *grid, bvx_grid *result);
/** The same set on another lattice, or a window of it (NULL: all): a voxel is set when its centre lies in a set voxel
 *  of grid (a centre on a face belongs to the upper voxel). For integer factors take bvx_grid_downsample. */
BVX_API bvx_status bvx_grid_resample(bvx_context *context, const bvx_grid *grid, const bvx_lattice *lattice,
                                     const bvx_window *window, bvx_grid *result);

/** When a block of voxels becomes a set voxel: any of its voxels is set, all are, or more than half are. */
#define BVX_REDUCE_LIST(X) X(BVX_REDUCE_ANY, 0, "any") X(BVX_REDUCE_ALL, 1, "all") X(BVX_REDUCE_MAJORITY, 2, "majority")
enum { BVX_REDUCE_LIST(BVX_LIST_ENUM) };

/** Blocks of factor[0] x factor[1] x factor[2] voxels become voxels, by a BVX_REDUCE_.... Blocks are counted from the
 *  lattice's low corner; one that the window cuts is judged by its voxels in the window. The new lattice has the old
 *  origin, spacing * factor, and dims / factor rounded up; the window has every block that the old one reaches into.
 *  factor  [Limit: 1..2^25 each, and fewer than 2^32 voxels of the lattice in a block] */
BVX_API bvx_status bvx_grid_downsample(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                                       int32_t rule, bvx_grid *result);
/** The set voxels in each of these blocks. count, out, is that of bvx_grid_downsample's voxels. */
BVX_API bvx_status bvx_grid_coverage(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                                     uint32_t *counts, uint64_t capacity, uint64_t *count);
/** The same lattice through another window (NULL: all of it). Beyond the grid's own all is empty. */
BVX_API bvx_status bvx_grid_crop(bvx_context *context, const bvx_grid *grid, const bvx_window *window,
                                 bvx_grid *result);
/** Extend lattice and window by low empty voxels before the first ones along each axis, and high after the last ones.
 *  Nothing moves in the world. [Limit: 0 and more, dims up to 2^25] */
BVX_API bvx_status bvx_grid_pad(bvx_context *context, const bvx_grid *grid, const int32_t low[3], const int32_t high[3],
                                bvx_grid *result);
/** Axis a of the result is axis axes[a] of the grid (0, 1, 2 in any order), reversed where flips[a] is 1 (NULL: none).
 *  Origin, spacing, dims and window are permuted too; a flip mirrors the lattice's box in itself. */
BVX_API bvx_status bvx_grid_permute(bvx_context *context, const bvx_grid *grid, const int32_t axes[3],
                                    const int32_t flips[3], bvx_grid *result);

/* ---- Morphology and distances -------------------------------------------------------------------------- */
/** What a neighbourhood (steps times) or a ball does to a set of voxels. */
#define BVX_MORPH_LIST(X) \
    X(BVX_MORPH_DILATE, 0, "dilate") /* voxels with a set one within it */ \
    X(BVX_MORPH_ERODE, 1, "erode") /* voxels with no empty one there */ \
    X(BVX_MORPH_OPEN, 2, "open") /* eroded, then dilated: what cannot hold it goes */ \
    X(BVX_MORPH_CLOSE, 3, "close") /* dilated, then eroded: gaps that cannot hold it are filled */
enum { BVX_MORPH_LIST(BVX_LIST_ENUM) };

enum { BVX_BALL = 1 };
typedef struct bvx_morph_options {
    size_t struct_size;
    int32_t neighbourhood; /**< as connectivity, or BVX_BALL [Limit: BVX_BALL, or 6, or 18, or 26] [Default: 6] */
    int32_t steps; /**< times that it is applied; a ball takes 1 [Limit: 1..65536] [Default: 1] */
    double radius; /**< of BVX_BALL alone, with 2^-40 of it to spare [Units: world] [Limit: >= 0] */
    int32_t beyond, reserved; /**< beyond the window are 0 empty, 1 set voxels [Limit: 0..1] */
} bvx_morph_options;
/** Grow or shrink a set of voxels by its neighbours or by a ball, by a BVX_MORPH_..., as in unbounded space with beyond
 *  outside the window. Returns BVX_ERR_RANGE (a ball: spacings beyond 2^-400 .. 2^400). */
BVX_API bvx_status bvx_grid_morph(bvx_context *context, const bvx_grid *grid, int32_t operation,
                                  const bvx_morph_options *options, bvx_grid *result);

typedef struct bvx_hollow_report {
    uint64_t hollowed, drained; /**< voxels that became empty inside; that the drain hole took */
    double drain[3]; /**< centre of the voxel where the hole meets the hollow; 0 without one [Units: world] */
    uint64_t reserved[4];
} bvx_hollow_report;
typedef struct bvx_hollow_options {
    size_t struct_size;
    double thickness; /**< of the shell that stays, a voxel or more along every axis, with 2^-40 to spare
                           [Units: world] [Limit: any] [Default: 0, must be set] */
    double drain_radius; /**< of a round hole; 0: none [Units: world] [Limit: >= 0] */
    int32_t drain_side; /**< from BVX_OPEN_... [Limit: 1, or 2, or 4, or 8, or 16, or 32] [Default: BVX_OPEN_Z_LOW] */
    int32_t drain_placed; /**< 1: the hole's axis goes through drain_at, not through the middle of the hollow */
    double drain_at[2]; /**< the two other coordinates, in order [Units: world] [Limit: any] */
    int32_t beyond, reserved; /**< beyond the window are 0 empty, 1 set voxels [Limit: 0..1] */
    bvx_hollow_report *report;
} bvx_hollow_options;
/** Make a body hollow: voxels deeper than thickness become empty, if any. The drain hole takes set voxels whose centre
 *  lies within drain_radius of its axis, from its side to where the axis first meets the hollow.
*  Returns BVX_ERR_ARGUMENT (also an axis that misses the hollow), BVX_ERR_RANGE (a thickness below a voxel). */
BVX_API bvx_status bvx_grid_hollow(bvx_context *context, const bvx_grid *grid, const bvx_hollow_options *options,
                                   bvx_grid *result);

/** Distances of centres: OUTSIDE, to the nearest set one; INSIDE, to the nearest empty one; SIGNED, both. */
#define BVX_DISTANCE_LIST(X) \
    X(BVX_DISTANCE_OUTSIDE, 0, "outside") X(BVX_DISTANCE_INSIDE, 1, "inside") X(BVX_DISTANCE_SIGNED, 2, "signed")
enum { BVX_DISTANCE_LIST(BVX_LIST_ENUM) };
/** What lies beyond the window: no voxels at all, empty ones, or set ones. */
#define BVX_BEYOND_LIST(X) \
    X(BVX_BEYOND_NOTHING, 0, "nothing") X(BVX_BEYOND_EMPTY, 1, "empty") X(BVX_BEYOND_SET, 2, "set")
enum { BVX_BEYOND_LIST(BVX_LIST_ENUM) };

enum { BVX_SQUARES = 3 };
typedef struct bvx_distance_options {
    size_t struct_size;
    int32_t side; /**< BVX_DISTANCE_... */
    int32_t beyond; /**< BVX_BEYOND_... */
    uint64_t *nearest; /**< index in the window of the voxel that the distance is to, the lowest of equally near ones;
                            UINT64_MAX for none [Size: nx * ny * nz] */
    uint64_t reserved[2];
} bvx_distance_options;
/** The exact Euclidean distance between centres of voxels, for every voxel of the window; infinity where there is none.
 *  value_type  BVX_F32 or BVX_F64: the last rounding; BVX_SQUARES: whole squares as uint32_t, of cubic voxels, OUTSIDE
 *              or INSIDE [Units: voxels^2], UINT32_MAX where there is no such voxel
 *  values      [Size: nx * ny * nz] [Units: world]
 *  Returns BVX_ERR_RANGE (spacings beyond 2^-400 .. 2^400, for BVX_F32 beyond 2^-100 .. 2^100; squares of a window
 *  whose diagonal has one of 2^32 - 2^16 or more). */
BVX_API bvx_status bvx_grid_distance(bvx_context *context, const bvx_grid *grid, const bvx_distance_options *options,
                                     int32_t value_type, void *values, uint64_t capacity);

/* ---- Components ---------------------------------------------------------------------------------------- */
/** A connected component of a grid's set voxels, in voxels of the grid's window. */
typedef struct bvx_component {
    uint64_t first, voxels; /**< its first voxel: x + size[0] * (y + size[1] * z); how many it has */
    int32_t low[3], size[3]; /**< box of its voxels: the lowest index along each axis, and how many [Units: voxels] */
    uint64_t reserved;
} bvx_component;
/** The components of a grid, in order (z, y, x) of their first voxels. [Limit: < 2^32 - 1 runs of voxels along x] */
BVX_API bvx_status bvx_grid_components(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                       bvx_component *parts, uint64_t capacity, uint64_t *count);
/** Label the voxels of a window by their component: 0 for empty ones, 1 for the first of bvx_grid_components, and so
 *  on. capacity is size[0] * size[1] * size[2] at least; count may be NULL. */
BVX_API bvx_status bvx_grid_label(bvx_context *context, const bvx_grid *grid, int32_t connectivity, uint32_t *labels,
                                  uint64_t capacity, uint64_t *count);

typedef struct bvx_keep_report {
    uint64_t kept, dropped; /**< parts */
    uint64_t voxels_kept, voxels_dropped, reserved[4];
} bvx_keep_report;
typedef struct bvx_keep_options {
    size_t struct_size;
    int32_t connectivity, reserved; /**< see Neighbours [Limit: 6, or 18, or 26] [Default: 6] */
    uint64_t at_least; /**< components of fewer voxels are dropped [Limit: any] */
    const int32_t *seeds; /**< x y z each: components that hold none of them are dropped [Size: seed_count * 3] */
    uint64_t seed_count; /**< 0: seeds are ignored [Limit: any] */
    uint64_t largest; /**< of what remains so many of the largest are kept; 0: all [Limit: any] */
    bvx_keep_report *report;
} bvx_keep_options;
/** Keep some of a grid's components, also in place. A seed outside the window is BVX_ERR_ARGUMENT. */
BVX_API bvx_status bvx_grid_keep(bvx_context *context, const bvx_grid *grid, const bvx_keep_options *options,
                                 bvx_grid *result);
/** Fill cavities, also in place: components of empty voxels that do not touch a side of the window. Those of more than
 *  at_most voxels stay; 0: all are filled. filled, out, may be NULL: voxels that were set. */
BVX_API bvx_status bvx_grid_fill_cavities(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                          uint64_t at_most, bvx_grid *result, uint64_t *filled);

/** What kind of body a grid's set voxels are; beyond its window all is empty. */
typedef struct bvx_topology {
    uint64_t voxels;
    uint64_t components; /**< of the set voxels */
    uint64_t cavities; /**< components of the empty voxels that do not reach the window's sides */
    int64_t tunnels; /**< components + cavities - euler: 1 for a ring, 0 for a ball and for a hollow one */
    int64_t euler; /**< vertices - edges + faces - voxels: 1 for a ball, 2 for a hollow one, 0 for a ring */
    uint64_t reserved[4];
} bvx_topology;
/** Count components, cavities and tunnels. connectivity 26: set voxels are closed boxes, and empty ones connect only
 *  across faces; 6: set voxels connect only across faces, and empty ones across edges and corners too. */
BVX_API bvx_status bvx_grid_topology(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                     bvx_topology *topology);

/* ---- Seeds and filling --------------------------------------------------------------------------------- */
/** A voxel found inside a surface, and what the search took. */
typedef struct bvx_seed {
    int32_t voxel[3]; /**< of the surface's window; all zero when none was found */
    int32_t found; /**< 1: voxel is empty and hidden by surface voxels in all six directions */
    int32_t verified, reserved; /**< 1: a mesh was given, and the voxel's centre is inside it by the rule vote */
    uint64_t scans[3]; /**< lines scanned along x, y and z: the paper's counts i, j and k */
    uint64_t starts, refused, reserved2[2]; /**< rows that it began at; hidden voxels that the mesh has outside */
} bvx_seed;
/** Find one voxel inside a surface (of bvx_voxelize_surface) by scanning lines of voxels: one that is hidden in all six
 *  directions and, with a mesh, inside it by the rule vote. Hidden is not always inside: think of a bottle. limit is
 *  the maximum number of lines to scan; 0: all. found 0 is no error. */
BVX_API bvx_status bvx_find_seed(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                                 uint64_t limit, bvx_seed *seed);
/** The first voxel (z, y, x) of each 6-connected component of empty voxels inside a surface: with a mesh by the rule
 *  vote, else those that do not touch the window's sides. seeds are x y z each, of the window [Size: capacity * 3]. */
BVX_API bvx_status bvx_find_pockets(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                                    int32_t *seeds, uint64_t capacity, uint64_t *count);
/** Set all voxels that are connected with a seed through empty voxels of a grid, whose set voxels are walls. seeds are
 *  x y z each, of its window [Size: seed_count * 3]; one on a set voxel or outside is BVX_ERR_ARGUMENT. */
BVX_API bvx_status bvx_grid_fill(bvx_context *context, const bvx_grid *walls, const int32_t *seeds, uint64_t seed_count,
                                 int32_t connectivity, bvx_grid *filled);

/* ---- Queries of grids ---------------------------------------------------------------------------------- */
typedef struct bvx_ray_hit {
    double t; /**< position = origin + t * direction */
    double position[3]; /**< [Units: world] */
    int32_t voxel[3]; /**< counted from the low corner of the grid's window */
    int32_t axis; /**< of the face that is crossed: 0, 1, 2; -1 when the ray starts in the voxel */
    int32_t hit, reserved; /**< 1; or 0: the ray meets none, and the other fields are zero */
} bvx_ray_hit;
/** Cast count rays. Hits have 0 <= t <= t_max. Boxes are closed: the hit is the lowest (t, z, y, x) of all voxels that
 *  the ray touches. Returns BVX_ERR_ARGUMENT (a direction of 0, t_max below 0 or NaN). */
BVX_API bvx_status bvx_grid_cast(bvx_context *context, const bvx_grid *grid, const double *rays, uint64_t count,
                                 double t_max, bvx_ray_hit *hits);
/** A grid prepared for rays: which bricks of 8 x 8 x 8 voxels hold a set one. It borrows the grid's words, which stay
 *  where they are until it is freed. After changing them call bvx_rays_update. */
typedef struct bvx_rays bvx_rays;
/** Prepare a grid. A handle that is passed again is overwritten: free it first. */
BVX_API bvx_status bvx_rays_create(bvx_context *context, const bvx_grid *grid, bvx_rays **caster);
BVX_API void bvx_rays_free(bvx_context *context, bvx_rays *caster);
/** Look again at the voxels of a window (NULL: all) that have changed, those beyond the grid's own aside. grid is the
 *  same one, or another of the same lattice and window, whose words are borrowed from now on.
 *  Returns BVX_ERR_RANGE (the window is not in the lattice), BVX_ERR_LATTICE; after a failure nothing has changed. */
BVX_API bvx_status bvx_rays_update(bvx_context *context, bvx_rays *caster, const bvx_grid *grid,
                                   const bvx_window *changed);
/** As bvx_grid_cast, bit for bit; one ray costs what it does among many. */
BVX_API bvx_status bvx_rays_cast(bvx_context *context, const bvx_rays *caster, const double *rays, uint64_t count,
                                 double t_max, bvx_ray_hit *hits);
/** Trilinear samples at count points: 1 at centres of set voxels, 0 at those of others and beyond the window. gradients
 *  (three doubles a point, [Units: 1 / world]) may be NULL. */
BVX_API bvx_status bvx_grid_sample(bvx_context *context, const bvx_grid *grid, const double *points, uint64_t count,
                                   double *values, double *gradients);

/** What two grids share and where they differ. Components are 6-connected. */
typedef struct bvx_grid_difference {
    uint64_t set_a, set_b, both;
    uint64_t only_a, only_b;
    uint64_t components_only_a, components_only_b; /**< of what only one of them has */
    uint64_t largest_only_a, largest_only_b; /**< voxels of the largest component */
    int32_t low[3], size[3]; /**< box of all voxels that differ, in the window; all zero for none */
    uint64_t reserved[4];
} bvx_grid_difference;
BVX_API bvx_status bvx_grid_compare(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                                    bvx_grid_difference *difference);

/* ---- Mass ---------------------------------------------------------------------------------------------- */
typedef struct bvx_measure_options {
    size_t struct_size;
    double density; /**< mass of a unit of volume [Limit: > 0] [Default: 1] */
    int32_t resolution, reserved; /**< voxels along each axis that are counted [Limit: 1..2048] [Default: 128] */
} bvx_measure_options;
/** The body that a mesh encloses. Errors are bounds: the body's own values are at most this far off. */
typedef struct bvx_measure_report {
    double volume; /**< [Units: world^3] */
    double area; /**< of the triangles as they are [Units: world^2] */
    double mass; /**< density times volume */
    double center[3]; /**< of mass; that of the bounds where nothing is enclosed [Units: world] */
    double inertia[6]; /**< tensor about center: xx, yy, zz, xy, xz, yz [Units: mass * world^2] */
    double volume_error, center_error, inertia_error; /**< the last of each element [Units: as those] */
    int32_t resolution; /**< voxels along each axis that were counted; 0: triangles were summed up */
    int32_t fill; /**< BVX_FILL_...: the rule that says what is inside */
    int32_t fill_reason, reserved; /**< BVX_FILL_REASON_... */
    uint64_t turned; /**< triangles that were turned first */
} bvx_measure_report;
/** Volume, area, centre of mass and inertia of the body that a mesh encloses, with bounds of their errors. What is
 *  inside is what BVX_FILL_AUTO fills; over a hole the body ends where its winding number passes a half. Of one sound
 *  closed shell triangles are summed up, with errors of rounding. Of other meshes voxels of 1/resolution of the bounds
 *  along each axis are counted, with what all voxels at the surface can make. BVX_ERR_EMPTY also for one position. */
BVX_API bvx_status bvx_measure(bvx_context *context, const bvx_mesh_view *mesh, const bvx_measure_options *options,
                               bvx_measure_report *report);

/* ---- Inspection ---------------------------------------------------------------------------------------- */
/** What bvx_inspect finds at places. */
#define BVX_FINDING_LIST(X) \
    X(BVX_FINDING_WALL, 0, "wall") /* thinner than walls */ \
    X(BVX_FINDING_GAP, 1, "gap") /* narrower than gaps */ \
    X(BVX_FINDING_CAVITY, 2, "cavity") /* empty, and no way out: it traps resin or powder */ \
    X(BVX_FINDING_ISLAND, 3, "island") /* part of a layer with nothing below, nor beside that: it needs a support */
enum { BVX_FINDING_LIST(BVX_LIST_ENUM) BVX_FINDING_COUNT = 4 };
typedef struct bvx_finding {
    double size; /**< least thickness or width [Units: world], volume of a cavity, area of an island */
    double position[3]; /**< a voxel's centre: where it is least, of others one amid their longest row [Units: world] */
    double low[3], high[3]; /**< box of its voxels; of walls and gaps those of their middle [Units: world] */
    uint64_t voxels;
} bvx_finding;
typedef struct bvx_inspect_options {
    size_t struct_size;
    bvx_fit fit; /**< voxels; rays start as far apart, and layers are a voxel high [Default: 256 voxels, padded by 1] */
    double walls; /**< thinner walls are findings; 0: none [Units: world] [Limit: >= 0] */
    double gaps; /**< narrower gaps are findings; 0: none [Units: world] [Limit: >= 0] */
    double density; /**< mass of a unit of volume [Limit: > 0] [Default: 1] */
    int32_t up; /**< towards which layers are built, BVX_UP_... */
    int32_t most; /**< findings of a kind that are listed [Limit: 1..2^20] [Default: 8] */
    bvx_finding *findings; /**< of kind k from k * most, the worst first: thinnest, largest [Size: 4 * most] */
    double *thickness; /**< of each vertex, the least beside it; infinity where none is found [Size: vertex_count] */
} bvx_inspect_options;
typedef struct bvx_inspect_report {
    bvx_certificate certificate; /**< of the mesh; vertices at equal positions count as one */
    bvx_lattice lattice; /**< of the voxels */
    int32_t needs; /**< BVX_NEEDS_...: what makes it unsound, or nothing */
    int32_t fill; /**< BVX_FILL_...: the rule that filled */
    uint64_t crossings; /**< pairs of triangles that cross */
    double volume, volume_error, mass; /**< as bvx_measure_report */
    double least_thickness, thin_ends[2][3]; /**< and both ends; infinity: there is none [Units: world] */
    double thickness[4]; /**< that 1, 5, 50 and 95 % of the surface do not reach, to 1 % of it [Units: world] */
    double thin_area; /**< of the surface whose wall is thinner than walls [Units: world^2] */
    double least_gap, gap_ends[2][3]; /**< as least_thickness, through what is empty [Units: world] */
    double cavity_volume; /**< of all cavities [Units: world^3] */
    uint64_t found[4]; /**< findings of each kind */
} bvx_inspect_report;
/** Whether a mesh can be made: is it sound, how thick are its walls, how narrow its gaps, what is trapped in it, which
 *  parts of its layers hang in the air. Thickness is the way straight inwards to the other side, from points of each
 *  triangle; a gap is the way outwards. Both count where the other side faces the ray to 60 degrees. Why rays and not
 *  balls: docs/rules.md. Where a mesh is not sound they hold where triangles face outwards.
 *  Returns BVX_ERR_EMPTY (no triangle of area), BVX_ERR_RANGE (as bvx_voxelize_solid; 2^32 pairs that cross). */
BVX_API bvx_status bvx_inspect(bvx_context *context, const bvx_mesh_view *mesh, const bvx_inspect_options *options,
                               bvx_inspect_report *report);

/* ---- Points -------------------------------------------------------------------------------------------- */
typedef struct bvx_points_report {
    uint64_t inside, outside; /**< points in the window, and beyond it */
    uint64_t occupied, filled; /**< voxels that hold enough points; body: those that it has beside these */
    uint64_t pockets, reserved[3]; /**< body: places that the flood did not reach; 0: gaps let it in everywhere */
} bvx_points_report;
typedef struct bvx_points_options {
    size_t struct_size;
    int32_t minimum; /**< points that a voxel needs to be set [Limit: 1..2^31-1] [Default: 1] */
    int32_t body; /**< 1: what a flood from outside cannot reach is set too; no window */
    int32_t close_gaps, reserved; /**< body: gaps of so many voxels stop the flood [Units: voxels] [Limit: 0..65535] */
    bvx_window window;
    bvx_points_report *report;
} bvx_points_options;
/** Set the voxels that hold points of a cloud: the vertices of a view, whose triangles are ignored. Points are snapped
 *  to the lattice's fixed point and belong to one voxel each. */
BVX_API bvx_status bvx_voxelize_points(bvx_context *context, const bvx_mesh_view *points, const bvx_lattice *lattice,
                                       const bvx_points_options *options, bvx_grid *grid);

/* ---- Volumes ------------------------------------------------------------------------------------------- */
/** Types of samples, in this machine's byte order. */
/* clang-format off */
#define BVX_SAMPLE_LIST(X) \
    X(BVX_SAMPLE_U8, 1, "u8") X(BVX_SAMPLE_I8, 2, "i8") X(BVX_SAMPLE_U16, 3, "u16") X(BVX_SAMPLE_I16, 4, "i16") \
    X(BVX_SAMPLE_U32, 5, "u32") X(BVX_SAMPLE_I32, 6, "i32") X(BVX_SAMPLE_U64, 7, "u64") X(BVX_SAMPLE_I64, 8, "i64") \
    X(BVX_SAMPLE_F32, 9, "f32") X(BVX_SAMPLE_F64, 10, "f64")
/* clang-format on */
enum { BVX_SAMPLE_LIST(BVX_LIST_ENUM) };

/** Samples that the caller owns, one at the centre of each voxel of a window. Sample (i,j,k) is at (const char
 *  *)samples + i * strides[0] + j * strides[1] + k * strides[2]; no alignment is required. */
typedef struct bvx_volume_view {
    const void *samples;
    int32_t sample_type, reserved0; /**< BVX_SAMPLE_... */
    int32_t low[3]; /**< window: lattice index of sample (0,0,0) [Units: voxels] */
    int32_t size[3]; /**< window: samples along each axis [Units: voxels] */
    int64_t strides[3]; /**< of either sign [Units: bytes] [Default: all 0, packed with x fastest] */
    bvx_lattice lattice;
    uint64_t reserved[4];
} bvx_volume_view;
/** What a volume's window holds. */
typedef struct bvx_volume_report {
    uint64_t nan, infinite; /**< samples that are NaN; infinite, of either sign */
    uint64_t inside; /**< samples that became set voxels */
    double least; /**< of the finite samples; 64-bit integers as doubles; 0 for none */
    double greatest;
    uint64_t reserved[3];
} bvx_volume_report;
/** Set the voxels whose sample lies in a range: low <= sample <= high. NaN and infinite samples are never set.
 *  -infinity and infinity leave a side open. report may be NULL. */
BVX_API bvx_status bvx_threshold(bvx_context *context, const bvx_volume_view *volume, double low, double high,
                                 bvx_volume_report *report, bvx_grid *grid);
/** The same between integers (u64: their bits), for 64-bit samples beyond 2^53 too. Labels are such. Samples that are
 *  floats are BVX_ERR_UNSUPPORTED. */
BVX_API bvx_status bvx_threshold_whole(bvx_context *context, const bvx_volume_view *volume, int64_t low, int64_t high,
                                       bvx_volume_report *report, bvx_grid *grid);

typedef struct bvx_scalar_options {
    size_t struct_size;
    double level; /**< value of the surface [Limit: any; not NaN] */
    int32_t below; /**< 1: inside is where sample <= level, not sample >= level */
    int32_t face_rule; /**< BVX_FACE_... */
    int32_t position_type; /**< see Types */
    int32_t open_sides; /**< BVX_OPEN_...: beyond the window is outside, but at these sides [Limit: 0..63] */
    int32_t keys; /**< 1: fill vertex_keys and triangle_keys [Limit: 0..1; dims below 2^20] */
    int32_t local_frame; /**< see Types */
    bvx_volume_report *report;
    uint64_t reserved[2];
} bvx_scalar_options;
/** The surface of a level in a volume, by marching cubes with linear positions between samples. Samples that are not
 *  finite are outside. The mesh is what bvx_extract_surface promises; a body that the volume's sides cut ends on them.
 *  bvx_extract_count of bvx_threshold(level, infinity) computes its exact size. Returns as bvx_extract_surface. */
BVX_API bvx_status bvx_extract_scalar(bvx_context *context, const bvx_volume_view *volume,
                                      const bvx_scalar_options *options, bvx_mesh *mesh);

/** A value of a label map. */
typedef struct bvx_label {
    int64_t value; /**< u64: its bits */
    uint64_t voxels;
    int32_t low[3]; /**< box of its voxels, in the window [Units: voxels] */
    int32_t size[3];
} bvx_label;
/** The values other than 0 of a volume of integers, ascending. Floats are BVX_ERR_UNSUPPORTED. */
BVX_API bvx_status bvx_list_labels(bvx_context *context, const bvx_volume_view *volume, bvx_label *labels,
                                   uint64_t capacity, uint64_t *count);

/* ---- Section contours ---------------------------------------------------------------------------------- */
/** A closed loop of a section: a polygon whose last point is joined to its first, in either direction. */
typedef struct bvx_section_loop {
    uint64_t first_point; /**< index of its first point */
    uint32_t point_count; /**< [Limit: 3 or more different points] */
    uint32_t section; /**< index of its section */
    int32_t label, reserved; /**< the body that it belongs to */
} bvx_section_loop;
/** Contours on planes, read by the library or filled by a caller with arrays of its own (owned 0). Loops and sections
 *  may be in any order. Loops inside loops are holes, in these islands, and so on. */
typedef struct bvx_sections {
    double *points; /**< x, y, z [Size: point_count * 3] [Units: world] [Limit: 1e75; the widest loop at least 1e-70] */
    bvx_section_loop *loops; /**< [Size: loop_count] */
    double *positions; /**< of each plane: point . normal / |normal| [Size: section_count] */
    uint64_t point_count; /**< [Limit: < 2^31] */
    uint64_t loop_count;
    uint64_t section_count; /**< with those that hold no loop: there is no body there */
    uint64_t point_capacity, loop_capacity, section_capacity; /**< what the arrays hold */
    double normal[3]; /**< of all planes, any length but 0 */
    int32_t owned, reserved; /**< 1 when bvx_sections_free frees the arrays */
    double *normals; /**< of each plane, in place of normal; NULL: planes are parallel [Size: section_count * 3] */
    uint64_t reserved2[3];
} bvx_sections;
BVX_API void bvx_sections_free(bvx_context *context, bvx_sections *sections);

/** How a body ends at its first and last section: FLAT, on its plane; TAPER, each part narrows to a ridge half a
 *  spacing beyond, also those that share no area with the next section; OPEN, with boundary edges. */
#define BVX_CAPS_LIST(X) X(BVX_CAPS_FLAT, 0, "flat") X(BVX_CAPS_TAPER, 1, "taper") X(BVX_CAPS_OPEN, 2, "open")
enum { BVX_CAPS_LIST(BVX_LIST_ENUM) };
/** Where the surface meets the grid's edges on a section plane: EXACT, where the contour does, all of which is in the
 *  mesh; PAPER, by interpolated distances, with contour points on the lines that join them; CLASSIC, without these. */
#define BVX_CROSSINGS_LIST(X) \
    X(BVX_CROSSINGS_EXACT, 0, "exact") X(BVX_CROSSINGS_PAPER, 1, "paper") X(BVX_CROSSINGS_CLASSIC, 2, "classic")
enum { BVX_CROSSINGS_LIST(BVX_LIST_ENUM) };

/** The label 0 in options, where 0 stands for the default. No loop has this number. */
enum { BVX_LABEL_ZERO = -2147483647 - 1 };
enum { BVX_SECTIONS_LOCATED = 16 };

typedef struct bvx_sections_report {
    double cell[2]; /**< sides of a grid cell [Units: world] */
    int32_t grid[2]; /**< cells along the plane's two axes */
    uint64_t sections; /**< that hold the label; the body ends half way to those between them that do not */
    uint64_t loops, holes; /**< holes: loops with outside on their inner side */
    uint64_t points;
    uint64_t repeated_points, mended_loops; /**< left out; split, joined or left out */
    uint64_t unkept_edges, unkept_loops; /**< crossed twice and more, joined by guess; within a cell */
    uint64_t unkept_points; /**< contour points that are no vertices: of PAPER, CLASSIC, planes that contradict */
    uint64_t located; /**< places in unkept */
    double unkept[16][3]; /**< the first BVX_SECTIONS_LOCATED of them [Units: world] */
    double prismoid_volume; /**< sum of h / 3 (A + B + sqrt(A B)) over neighbouring sections of areas A and B; ends
                                 count as cones, A h / 3 [Units: world^3] */
    uint64_t joined_slabs; /**< pairs of neighbouring sections not blended level by level: very thin walls */
    uint64_t planes; /**< of all sections, if not parallel; else 0 */
    uint64_t gaps; /**< intervals of lines where planes cross that are inside for one of two sections only */
    double largest_gap; /**< how far contours were apart there at most [Units: world] */
    uint64_t warnings;
} bvx_sections_report;

/** What is between parallel planes. Planes of any direction take none of it. */
typedef struct bvx_slabs {
    int32_t grid[2]; /**< cells along the plane's axes, both or none [Limit: 0, or 2..8192] */
    int32_t crossings; /**< BVX_CROSSINGS_... */
    int32_t depth; /**< a cell is halved at most this often [Limit: BVX_NONE, or 0..8] [Default: 5] */
} bvx_slabs;
typedef struct bvx_sections_options {
    size_t struct_size;
    double spacing; /**< side of a cell [Units: world] [Limit: >= 0] [Default: 0, by slabs.grid or cells; else twice the
                         contours' mean segment, 16 to 512 cells along the longer side, of planes not parallel 64] */
    bvx_slabs slabs; /**< parallel planes */
    int32_t cells; /**< planes not parallel: cells along the longest side, in place of spacing [Limit: 0, or 8..1024] */
    int32_t mend; /**< 1: loops that touch or cross are split there, not refused; inside stays what an odd number of
                       loops enclose. Slits, spikes and borders that two loops share go */
    double agree; /**< planes not parallel: contours at most this far apart where planes cross are moved to agree
                       [Units: world] [Limit: >= 0] [Default: 0, 1/100 of the longest side] */
    double thickness; /**< of a body with one section only: slab, or tapered lens [Units: world] [Limit: >= 0] */
    int32_t caps; /**< BVX_CAPS_... */
    int32_t label; /**< the body; BVX_LABEL_ZERO: 0 [Limit: any] [Default: 0, the only one there is] */
    int32_t position_type, reserved; /**< see Types; AUTO is BVX_F64: contours stay as they are */
    bvx_sections_report *report;
} bvx_sections_options;
/** The closed surface of a body through all of its section contours. On a section plane the contour decides: its points
 *  are vertices with the coordinates given. Between planes the surface follows a blend of the sections' signed
 *  distances: from five sections on, with crossings EXACT, the monotone cubic over four of them, else straight. It is
 *  oriented, edge- and vertex-manifold, and closed but for open caps. Planes of any direction (normals) may cross. How
 *  each case is decided, and how far points may be off their plane: docs/rules.md.
 *  Returns BVX_ERR_EMPTY (no loop, only one section and no thickness, a loop of fewer than three points),
 *  BVX_ERR_FORMAT (loops that cross or touch; two sections at one position; points off their plane; planes that
 *  contradict each other), BVX_ERR_ARGUMENT (also several labels and none chosen). */
BVX_API bvx_status bvx_build_sections(bvx_context *context, const bvx_sections *sections,
                                      const bvx_sections_options *options, bvx_mesh *mesh);
/** The closed surfaces of several bodies at once: two that touch have the same vertices there, and the same triangles
 *  the other way round. Parallel planes are taken as planes of any direction (cells and agree count; slabs, mend,
 *  thickness and label do not). Where bodies touch, and how they end: docs/rules.md.
 *  labels  the bodies, each once; loops of others count for the lattice only [Size: count] [Limit: 1..63]
 *  meshes  in the order of the labels [Size: count] After a failure no mesh is made
 *  Returns as bvx_build_sections; BVX_ERR_EMPTY (also a label without loops, a body that no point of the lattice lies
 *  in, flat caps where one of parallel planes has all contours), BVX_ERR_FORMAT (also bodies that overlap by more than
 *  agree), BVX_ERR_ARGUMENT (also open caps, BVX_LABEL_ZERO, a label given twice). */
BVX_API bvx_status bvx_build_bodies(bvx_context *context, const bvx_sections *sections,
                                    const bvx_sections_options *options, const int32_t *labels, uint32_t count,
                                    bvx_mesh *meshes);

typedef struct bvx_slice_options {
    size_t struct_size;
    double normal[3]; /**< of the planes, of any length [Limit: any] [Default: 0, 0, 1] */
    double spacing; /**< from plane to plane, the first half a spacing up [Units: world] [Limit: >= 0] */
    const double *positions; /**< the planes instead: point . normal / |normal|, ascending [Size: position_count] */
    uint64_t position_count; /**< [Limit: any; with positions 1..2^20] */
    int32_t label, reserved; /**< of all loops; BVX_LABEL_ZERO: 0 [Limit: any] [Default: 1] */
} bvx_slice_options;
/** The contours of a mesh on parallel planes: a point where a plane meets an edge; vertices on a plane count as above
 *  it. The mesh must be closed and oriented where planes meet it. Loops run with the inside on their left, seen against
 *  the normal. Loops no wider than 2^-26 of the mesh's extent are left out.
 *  Returns BVX_ERR_EMPTY (no plane meets the mesh), BVX_ERR_FORMAT (a loop that does not close, with its position). */
BVX_API bvx_status bvx_slice_mesh(bvx_context *context, const bvx_mesh_view *mesh, const bvx_slice_options *options,
                                  bvx_sections *sections);

/* ---- Refinement ---------------------------------------------------------------------------------------- */
/** The state of an octree's voxel; as bits, so that they make sets.
 *  OUTSIDE  a flood from outside through faces of voxels reaches it (trees with a window: by rows)
 *  INSIDE   no triangle touches it, and it is not outside
 *  SURFACE  a triangle touches its closed box */
#define BVX_STATE_LIST(X) \
    X(BVX_STATE_OUTSIDE, 1, "outside") X(BVX_STATE_INSIDE, 2, "inside") X(BVX_STATE_SURFACE, 4, "surface")
enum { BVX_STATE_LIST(BVX_LIST_ENUM) };

/** Voxels of several sizes: level 0 is a base lattice, each further level halves the voxels that triangles touch. */
typedef struct bvx_octree bvx_octree;

typedef struct bvx_octree_leaf {
    int32_t ijk[3]; /**< index among the voxels of its level */
    uint8_t level;
    uint8_t state; /**< BVX_STATE_... */
    uint8_t reserved[2];
} bvx_octree_leaf;
/** Counts of one level. */
typedef struct bvx_octree_level {
    uint64_t voxels; /**< all of the level: split ones and leaves */
    uint64_t split; /**< touched by triangles and split in eight; 0 at the last level */
    uint64_t surface; /**< leaves that triangles touch */
    uint64_t inside, outside; /**< leaves that no triangle touches */
    uint64_t bytes, reserved[2]; /**< that the tree keeps for them */
} bvx_octree_level;
typedef struct bvx_refine_options {
    size_t struct_size;
    int32_t levels; /**< times voxels are halved [Limit: BVX_NONE, or 0..25; dims * 2^levels up to 2^25] [Default: 6] */
    int32_t start_level; /**< levels up to this are one grid: time alone; 0: by size [Limit: BVX_NONE, or 0..levels] */
    bvx_window window; /**< of the last level: beyond outer_levels only voxels that meet it are halved */
    int32_t outer_levels, reserved; /**< used with a window [Limit: 0..levels] */
    double tolerance; /**< voxels whose triangles lie this near to one plane are leaves [Units: world] [Limit: >= 0] */
} bvx_refine_options;
/** Voxelize a mesh with small voxels only at its surface. Each voxel whose closed box meets a triangle is split in
 *  eight down to the last level. There it is bvx_voxelize_surface (conservative) and a flood around it, bit for bit.
 *  What a window and a tolerance change: docs/rules.md.
 *  base  the lattice of level 0, as from bvx_lattice_fit(context, mesh, 8, &base); fraction_bits are ignored
 *  tree  out: *tree is NULL, or a tree that is freed when the new one is made; a failure leaves it as it was
 *  Returns BVX_ERR_RANGE (also a base of 2^31 voxels and more; dims * 2^levels beyond 2^25; 2^28 split voxels of a
 *  level), BVX_ERR_BUDGET (the last value of bvx_last_error is the number of levels that fits). */
BVX_API bvx_status bvx_refine(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *base,
                              const bvx_refine_options *options, bvx_octree **tree);
/** Choose base, out, and levels of options for at least resolution voxels of the last level along the mesh's longest
 *  axis: a base that is small beside it (docs/rules.md). levels is BVX_NONE for none. */
BVX_API bvx_status bvx_refine_choose(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                                     bvx_refine_options *options, bvx_lattice *base);
BVX_API void bvx_octree_free(bvx_context *context, bvx_octree *tree);
/** The index of a tree's last level; -1 for NULL. */
BVX_API int32_t bvx_octree_levels(const bvx_octree *tree);
/** The lattice of a level. Vertices were snapped to that of the last one. */
BVX_API bvx_status bvx_octree_lattice(bvx_context *context, const bvx_octree *tree, int32_t level,
                                      bvx_lattice *lattice);
/** Counts of the levels 0 .. bvx_octree_levels. */
BVX_API bvx_status bvx_octree_count(bvx_context *context, const bvx_octree *tree, bvx_octree_level *counts,
                                    int32_t capacity);
/** The leaves that hold voxels of the last level, or points. Beyond the lattice: state outside, level 255, ijk 0. */
BVX_API bvx_status bvx_octree_at(bvx_context *context, const bvx_octree *tree, const int32_t *voxels, uint64_t count,
                                 bvx_octree_leaf *leaves);
BVX_API bvx_status bvx_octree_find(bvx_context *context, const bvx_octree *tree, const double *points, uint64_t count,
                                   bvx_octree_leaf *leaves);
/** The leaves that share a face with a leaf, beyond it in a direction: 0 to 5 for -x, -y, -z, +x, +y, +z. One of the
 *  same size or larger, or all smaller ones; none beyond the lattice. */
BVX_API bvx_status bvx_octree_neighbours(bvx_context *context, const bvx_octree *tree, const bvx_octree_leaf *leaf,
                                         int32_t direction, bvx_octree_leaf *leaves, uint64_t capacity,
                                         uint64_t *count);

typedef struct bvx_octree_hit {
    double t; /**< position = origin + t * direction */
    double position[3]; /**< [Units: world] */
    bvx_octree_leaf leaf;
    int32_t axis; /**< of the face that is crossed: 0, 1, 2; -1 when the ray starts in the leaf */
    int32_t hit; /**< 0: the ray meets none, and the other fields are zero */
} bvx_octree_hit;
/** Cast rays as bvx_grid_cast. states of this and what follows: a set of BVX_STATE_..., or 0: surface and inside. */
BVX_API bvx_status bvx_octree_cast(bvx_context *context, const bvx_octree *tree, int32_t states, const double *rays,
                                   uint64_t count, double t_max, bvx_octree_hit *hits);
/** The leaves by base voxel (z, y, x), within it along the curve that takes x first, then y, then z at each level. */
BVX_API bvx_status bvx_octree_leaves(bvx_context *context, const bvx_octree *tree, int32_t states,
                                     bvx_octree_leaf *leaves, uint64_t capacity, uint64_t *count);
/** The voxels of one level as a grid, of its window. Above the last level a voxel that is split counts as surface. */
BVX_API bvx_status bvx_octree_expand(bvx_context *context, const bvx_octree *tree, int32_t level, int32_t states,
                                     const bvx_window *window, bvx_grid *grid);
/** The closed surface of the last level's voxels, block by block, with the bytes of bvx_extract_surface on all of it.
 *  mesh brings no arrays; dims are below 2^20. */
BVX_API bvx_status bvx_extract_octree(bvx_context *context, const bvx_octree *tree, int32_t states,
                                      const bvx_extract_options *options, bvx_mesh *mesh);

/* ---- Surfaces of labels -------------------------------------------------------------------------------- */
/** The surfaces between all labels of a volume: each face is there once and has a label on either side.
 *  Face f is the triangles 2f and 2f+1; seen from its front it turns counter-clockwise. */
typedef struct bvx_complex {
    bvx_mesh mesh; /**< its vertices and triangles; not manifold where three labels meet */
    uint32_t *sides; /**< of each face: back, front, as indices of labels, back < front [Size: face_count * 2] */
    bvx_label *labels; /**< all but the background, ascending; index label_count is the background */
    uint64_t *first; /**< where each label's faces begin in faces [Size: label_count + 1] */
    uint32_t *faces; /**< indices of each label's faces, ascending [Size: first[label_count]] */
    uint64_t *cells; /**< of each vertex: the cell (i,j,k) around the low corner of the window's voxel (i,j,k) that
                          holds it, as (k * (size[1] + 1) + j) * (size[0] + 1) + i [Size: vertices] */
    uint8_t *junctions; /**< of each vertex: sides of its cell (bits -x, +x, -y ...) through which an edge runs that has
                             more than two faces; BVX_AT_SEAM, BVX_ON_SEAM [Size: vertices] */
    uint64_t face_count, label_count;
    int32_t low[3], size[3]; /**< the volume's window */
    int32_t owned; /**< 1 when bvx_complex_free frees the arrays */
    int32_t single; /**< 1: simplified. Face f is triangle f alone, cells is NULL, junctions is 0 off them and seams; on
                         seams BVX_ON_SEAM + the vertex's index in its cell: equal vertices have it and the position */
    int32_t reserved[2];
} bvx_complex;
/** Bits of junctions in open windows: a vertex of a cell that windows share; one at which several may have faces. */
enum { BVX_AT_SEAM = 64, BVX_ON_SEAM = 128 };
typedef struct bvx_labels_options {
    size_t struct_size;
    int64_t background; /**< the label that is no body, and what lies beyond the volume; u64: its bits [Limit: any] */
    int32_t staircase; /**< 1: vertices stay at the corners of voxels, unsmoothed */
    int32_t position_type; /**< see Types */
    int32_t local_frame; /**< see Types */
    int32_t open; /**< 1: the window is a piece that others join, with one voxel more where the lattice goes on */
    uint64_t triangles; /**< at most so many in all, not on a staircase; 0: as they come [Limit: any] */
    double error; /**< instead: mean distance to the faces as they come, both ways [Units: world] [Limit: >= 0] */
} bvx_labels_options;
/** The surfaces of all labels at once, with shared faces. A face lies between two voxels that share a side and have
 *  different labels; its corners are vertices of the four cells around that side. Vertices are in order (z, y, x) of
 *  their cell, faces in order (z, y, x, axis) of their lower voxel. Labels keep the volume of their voxels to 0.1 %,
 *  but where most faces are at junctions; more: docs/rules.md. complex brings no arrays. Empty without labels.
 *  Open windows part a lattice by planes along voxels' sides, two voxels from its own sides and more, and each takes one
 *  voxel more beyond such planes. Each face is then in one of them, bodies of one end where the next one's begin, no
 *  triangles of two cross, and vertices ON_SEAM have the same bits in all; labels may be without faces. On the staircase
 *  bodies of one window may touch themselves in a seam's edges.
 *  Returns BVX_ERR_UNSUPPORTED (samples that are floats), BVX_ERR_ARGUMENT (also a background that samples cannot
 *  have), BVX_ERR_RANGE (2^32 - 1 vertices or 2^30 faces; positions too coarse). */
BVX_API bvx_status bvx_label_surfaces(bvx_context *context, const bvx_volume_view *volume,
                                      const bvx_labels_options *options, bvx_complex *complex);
/** The body of one label, an index of labels: the faces of a complex that it has, outwards. Closed, edge- and
 *  vertex-manifold and oriented, whatever the labels are: where a body touches itself along an edge or at a corner,
 *  vertices of equal positions have one side's each. Positions are the complex's, bit for bit. */
BVX_API bvx_status bvx_label_mesh(bvx_context *context, const bvx_complex *complex, uint64_t label, bvx_mesh *mesh);
BVX_API void bvx_complex_free(bvx_context *context, bvx_complex *complex);

#ifdef __cplusplus
}
#endif

#endif /* BITVOX_H */
