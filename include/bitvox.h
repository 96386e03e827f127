/* bitvox.h - shapes to voxels and voxels to shapes: the whole public interface of libbitvox. Licence: MIT.
 *
 * Start here: two levels of detail of any mesh, closed and without crossing triangles.
 *
 *     bvx_mesh_view view = bvx_mesh_view_packed(positions, vertex_count, triangles, triangle_count);
 *     bvx_mesh levels[2] = {{0}};
 *     bvx_context *context;
 *     if (bvx_context_create(NULL, &context) != BVX_OK) return 1;
 *     if (bvx_build_levels(context, &view, NULL, 2, levels) != BVX_OK) puts(bvx_last_message(context));
 *     for (int i = 0; i < 2; i++) bvx_mesh_free(context, &levels[i]);
 *     bvx_context_destroy(context);
 *
 * Contents, in the order in which they are met: the titles of the sections below.
 *     Status, Context                                      results of calls; memory, threads, progress
 *     Meshes, Lattices, Grids                              what goes in and what comes out
 *     Solids, Surface voxels, Surfaces of grids            meshes to voxels, voxels to meshes
 *     Fewer triangles, Repair, Levels of detail, Booleans of meshes
 *     Levels by samples, Closest points, Distance fields   further ways from mesh to mesh, and measuring
 *     Set algebra, Morphology and distances, Components, Seeds and filling, Queries of grids
 *     Points, Volumes, Section contours, Refinement        other things that go in, voxels of several sizes
 *     Formats, Pictures                                    files, from and to memory
 * What holds for all stages: docs/exactness.md. How each decides, and its memory in detail: docs/rules.md.
 *
 * Conventions that hold for every function
 *   Result      Functions that can fail return bvx_status; results come through the last parameter.
 *   Errors      Every such call may return BVX_ERR_ARGUMENT, BVX_ERR_MEMORY, BVX_ERR_BUDGET and, where it
 *               reports progress, BVX_CANCELLED; those that fill arrays of the caller's, BVX_ERR_CAPACITY. A
 *               comment lists what else there is, or what one of these means there in particular.
 *   Failure     Inputs are unchanged, nothing leaks, results that the library would have made stay empty,
 *               arrays that the caller gave hold valid but unspecified values, and bvx_last_message(context)
 *               says what was wrong, where and why.
 *   Reuse       A result is zeroed before its first use, and may then be passed again without being freed:
 *               arrays that the library made are used again or, where they do not suffice, freed and made
 *               anew. Arrays of the caller's are filled where a function takes them, else refused, and too
 *               small ones are BVX_ERR_CAPACITY. After a failure what the library had made is as it was, of
 *               unspecified content, or empty; it may be passed again or freed in any case.
 *   Cases       A coordinate that is not finite is BVX_ERR_RANGE, no triangle or point at all BVX_ERR_EMPTY;
 *               nothing inside is an empty result and BVX_OK, unless a function says otherwise; a target
 *               that cannot be met is named in the report. Over the memory limit: BVX_ERR_BUDGET.
 *   Counting    Where an array of results may be NULL, only their count is computed.
 *   Memory      All of it comes from the context's allocator and counts against its limit.
 *   Threads     One context is used by one thread at a time; two contexts share nothing.
 *   Exactness   Same bits for any compiler, processor, thread count and window, unless a function says
 *               otherwise.
 *   Options     Structs carry their size first and are filled by their _init function; NULL means all
 *               defaults.
 *   Lists       The numbers of BVX_..._LIST are frozen; the texts are names in the program and the bindings.
 *   Reserved    Fields named reserved must be zero.
 *   Tags        [Size:] [Limit:] [Units:] [Default:] [Memory:] [Cost:] [Exact:] are fixed words, for people
 *               and for scripts. */
#ifndef BITVOX_H
#define BITVOX_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
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

/* ---- Status -------------------------------------------------------------------------------------------- */

typedef int32_t bvx_status;

/** Every status, its frozen value and its text. */
#define BVX_STATUS_LIST(X)                                                                \
    X(BVX_OK, 0, "done")                                                                  \
    X(BVX_ERR_ARGUMENT, 1, "an argument is NULL, out of range or contradicts another")    \
    X(BVX_ERR_VERSION, 2, "the header and the library are of different major versions")   \
    X(BVX_ERR_MEMORY, 3, "the allocator returned nothing")                                \
    X(BVX_ERR_BUDGET, 4, "the memory limit does not allow it")                            \
    X(BVX_ERR_RANGE, 5, "a coordinate, index or size is outside what can be represented") \
    X(BVX_ERR_EMPTY, 6, "the input holds nothing to work on")                             \
    X(BVX_ERR_FORMAT, 7, "the data is damaged or not of the stated format")               \
    X(BVX_ERR_UNSUPPORTED, 8, "a valid request that this build or format cannot serve")   \
    X(BVX_ERR_CAPACITY, 9, "an array given by the caller is too small")                   \
    X(BVX_ERR_LATTICE, 10, "the grids do not share one lattice or window")                \
    X(BVX_CANCELLED, 11, "the progress callback asked to stop")
enum { BVX_STATUS_LIST(BVX_LIST_ENUM) BVX_STATUS_COUNT = 12 };

/** The fixed text of a status; "unknown status" for any other number. Never NULL. */
BVX_API const char *bvx_status_text(bvx_status status);

/** Why a call failed, for programs: the reason, its frozen value and its text. */
#define BVX_REASON_LIST(X)                                                                                \
    X(BVX_REASON_NONE, 0, "no call has failed")                                                           \
    X(BVX_REASON_UNSPECIFIED, 1, "no failure has it any more")                                            \
    X(BVX_REASON_NULL, 2, "an argument is NULL")                                                          \
    X(BVX_REASON_RESERVED, 3, "a reserved field is not 0")                                                \
    X(BVX_REASON_OPTIONS, 4, "an option struct has no valid size or sets what the library does not know") \
    X(BVX_REASON_CHOICE, 5, "a number does not name one of the choices that there are")                   \
    X(BVX_REASON_MEMORY, 6, "the allocator returned nothing")                                             \
    X(BVX_REASON_BUDGET, 7, "the memory limit does not allow it")                                         \
    X(BVX_REASON_CAPACITY, 8, "an array given by the caller is too small")                                \
    X(BVX_REASON_LATTICE, 9, "the grids do not share one lattice or window")                              \
    X(BVX_REASON_CANCELLED, 10, "the progress callback asked to stop")                                    \
    X(BVX_REASON_NOT_FINITE, 11, "a number is NaN or infinite")                                           \
    X(BVX_REASON_INDEX, 12, "an index is beyond what it counts in")                                       \
    X(BVX_REASON_FLOATS_COARSE, 13,                                                                       \
      "f32 does not distinguish neighbouring positions; BVX_POSITION_AUTO takes f64")                     \
    X(BVX_REASON_DOUBLES_COARSE, 14,                                                                      \
      "doubles do not distinguish neighbouring positions; a local frame does")                            \
    X(BVX_REASON_SEVERAL_BODIES, 15, "the sections hold several bodies and no label chooses one")         \
    X(BVX_REASON_LOOPS_MEET, 16, "loops of a section cross or touch; mending splits them there")          \
    X(BVX_REASON_LOOP_FLAT, 17, "a loop encloses no area; mending leaves it out")                         \
    X(BVX_REASON_COMPRESSED, 18, "samples are compressed and nothing was given to unpack them")           \
    X(BVX_REASON_RANGE, 19, "an option is outside its range")                                             \
    X(BVX_REASON_CONTRADICTION, 20, "arguments or options exclude or need each other")                    \
    X(BVX_REASON_INVALID, 21, "an argument's sizes, counts or arrays do not describe what it should be")  \
    X(BVX_REASON_NOT_EMPTY, 22, "an output brings arrays of its own, which are not used")                 \
    X(BVX_REASON_OVERLAP, 23, "an output's memory is an input's")                                         \
    X(BVX_REASON_TOPOLOGY, 24, "the mesh is not closed, manifold or oriented as the call needs it")       \
    X(BVX_REASON_TOO_FAR, 25, "a coordinate or a length is beyond what numbers or a format represent")    \
    X(BVX_REASON_TOO_MANY, 26, "there are more elements than an index, a format or a machine counts")     \
    X(BVX_REASON_TARGET, 27, "a target of triangles or of error cannot be kept")                          \
    X(BVX_REASON_EMPTY, 28, "the input holds nothing to work on")                                         \
    X(BVX_REASON_DAMAGED, 29, "the data is damaged or not of the stated format")                          \
    X(BVX_REASON_UNSUPPORTED, 30, "the build or the format has no such thing")                            \
    X(BVX_REASON_VERSION, 31, "the header and the library are of different major versions")
enum { BVX_REASON_LIST(BVX_LIST_ENUM) BVX_REASON_COUNT = 32 };

/** The fixed text of a reason; "unknown reason" for any other number. Never NULL. */
BVX_API const char *bvx_reason_text(int32_t reason);

/** The library's version, made like BVX_VERSION. */
BVX_API int32_t bvx_version(void);

/* ---- Context ------------------------------------------------------------------------------------------- */

typedef struct bvx_context bvx_context;

/** Returns size bytes aligned to align (a power of two up to 64), or NULL. */
typedef void *bvx_alloc_fn(void *user, size_t size, size_t align);
/** Frees what bvx_alloc_fn returned, with the same size and align. */
typedef void bvx_free_fn(void *user, void *block, size_t size, size_t align);
/** Called on the calling thread between pieces of work. fraction is that of the whole call, from 0 to 1,
 *  whatever other functions it calls: it never falls, stays below 1 while there is work, and is roughly the
 *  share of the time. stage names what is done now, or the function where it reports nothing in between; it
 *  may change at any fraction. The last report of a call that succeeds is exactly 1; a call that fails makes
 *  none of 1. The next call begins anew. A result other than 0 cancels: the call returns BVX_CANCELLED. The
 *  result of the report of 1 is ignored, for the call has ended and its results stay.
 *  All functions that take a context and return a status report so, except bvx_lattice_make, bvx_grid_create,
 *  bvx_octree_lattice, bvx_octree_neighbours and bvx_volume_data_name, which are too small and report
 *  nothing. */
typedef int32_t bvx_progress_fn(void *user, const char *stage, double fraction);
/** One piece of parallel work; worker is below the context's thread count and never runs two pieces at
 *  once. */
typedef void bvx_task_fn(void *task_user, int32_t index, int32_t worker);
/** Runs task(task_user, index, worker) once for every index in [0, count),
 *  in any order, and returns when all ended. */
typedef void bvx_parallel_fn(void *user, int32_t count, bvx_task_fn *task, void *task_user);

enum { BVX_CPU_BEST = 0, BVX_CPU_PORTABLE = 1, BVX_CPU_AVX2 = 2 };

typedef struct bvx_context_options {
    size_t struct_size;    /**< set by bvx_context_options_init */
    bvx_alloc_fn *alloc;   /**< [Default: the C library's heap; required in freestanding builds without
                                arena] */
    bvx_free_fn *free;     /**< given together with alloc [Default: NULL] */
    void *alloc_user;      /**< first argument of alloc and free [Default: NULL] */
    void *arena;           /**< memory to live in: results grow from its low end, scratch from its high end
                                [Default: NULL] */
    uint64_t arena_size;   /**< [Units: bytes] [Limit: any] [Default: 0] */
    uint64_t memory_limit; /**< [Units: bytes] [Limit: any] [Default: 0, none] */
    bvx_parallel_fn *parallel; /**< the caller's own parallel-for [Default: the library's threads where
                                    built in] */
    void *parallel_user;       /**< first argument of parallel [Default: NULL] */
    bvx_progress_fn *progress; /**< [Default: NULL, never called] */
    void *progress_user;       /**< first argument of progress [Default: NULL] */
    int32_t threads;           /**< workers [Limit: 0..1024] [Default: 0, see below; 1 with the caller's
                                    own parallel] */
    int32_t cpu; /**< fastest code that may run, BVX_CPU_... [Limit: 0..2] [Default: BVX_CPU_BEST] */
} bvx_context_options;

/** Threads are the context's own helpers of the calling thread. By default there are as many workers as
 *  processors that the process may use, by its affinity and by the quota of its control group (of Linux,
 *  version 1 or 2); OMP_NUM_THREADS overrides that, OMP_THREAD_LIMIT limits it. A number in threads is taken
 *  as it is; a build without threads has one worker, whatever threads is. However many there are,
 *  they work only where that pays: no helper is started for less than a fifth of a millisecond of work,
 *  none works while other threads of the machine want all its processors (as Linux reports), and those that
 *  made the caller wait rest for a time. They sleep soon, take no signals, and end with the context.
 *  Results do not depend on any of this. */
BVX_API void bvx_context_options_init(bvx_context_options *options, size_t size);

/** Create a context; call it through bvx_context_create, which passes the header's version.
 *  Returns BVX_ERR_VERSION when the majors differ (before 1.0: the minors), BVX_ERR_UNSUPPORTED (this build
 *  or thread has arithmetic that would change results: bvx_arithmetic_fault says which).
 *  [Cost: O(1)] */
BVX_API bvx_status bvx_context_create_version(int32_t header_version, const bvx_context_options *options,
                                              bvx_context **context);

static inline bvx_status bvx_context_create(const bvx_context_options *options, bvx_context **context)
{
    return bvx_context_create_version(BVX_VERSION, options, context);
}

/** Why bvx_context_create returns BVX_ERR_UNSUPPORTED: products contracted by the compiler, results wider
 *  than their type, rounding that is not to nearest; NULL when all is well. */
BVX_API const char *bvx_arithmetic_fault(void);

/** Free a context. What it allocated for results stays valid until freed through another context with the
 *  same allocator. One in an arena, which ends with the arena, is released too before that memory is used
 *  otherwise: its threads end here. NULL is allowed. */
BVX_API void bvx_context_destroy(bvx_context *context);

/** What went wrong in the last call that failed, in one line, for people; "" when none did. Valid until the
 *  next call. */
BVX_API const char *bvx_last_message(const bvx_context *context);

/** The last failure in parts, for callers that decide by it: no caller needs to read messages. The library
 *  owns it and may append fields. */
typedef struct bvx_error {
    bvx_status status;    /**< BVX_OK: no call has failed */
    int32_t reason;       /**< BVX_REASON_...; after a failure neither BVX_REASON_NONE nor _UNSPECIFIED */
    const char *function; /**< the public function that was called; "" when none failed */
    const char *message;  /**< as bvx_last_message returns it */
    const char *text;     /**< the message without the function's name in front */
    int64_t index;        /**< of the vertex, triangle, level, loop ... that the message names first; -1:
                               it names none */
    int32_t value_count;  /**< [Limit: 0..8] */
    int32_t reserved;
    double value[8]; /**< the message's numbers in their order, the index too; rounded where doubles do not
                          hold them */
} bvx_error;

/** Why the last call that failed did so. Never NULL. Valid until the next call.
 *  [Cost: O(1)] */
BVX_API const bvx_error *bvx_last_error(const bvx_context *context);

/** Bytes now held, results included, and the most ever held since creation or the last reset. */
BVX_API uint64_t bvx_memory_used(const bvx_context *context);
BVX_API uint64_t bvx_memory_peak(const bvx_context *context);
BVX_API void bvx_memory_reset_peak(bvx_context *context);

/** Workers of this context, and the code path chosen (BVX_CPU_PORTABLE or BVX_CPU_AVX2). */
BVX_API int32_t bvx_context_threads(const bvx_context *context);
BVX_API int32_t bvx_context_cpu(const bvx_context *context);

/* ---- Meshes -------------------------------------------------------------------------------------------- */

/** Types of positions and values. BVX_POSITION_AUTO is for the position_type of options: BVX_F32 where it
 *  distinguishes neighbouring positions (its steps at the largest coordinate are at most 1/256 of a voxel),
 *  else BVX_F64; the mesh's own position_type says which. Simplifying, which has no voxels, keeps the
 *  mesh's type. Arrays of the caller's must be of the type that comes out. */
#define BVX_REAL_LIST(X) \
    X(BVX_F32, 1, "f32") \
    X(BVX_F64, 2, "f64")
enum { BVX_POSITION_AUTO = 0, BVX_REAL_LIST(BVX_LIST_ENUM) };
enum { BVX_U16 = 1, BVX_U32 = 2, BVX_U64 = 3 };

/** Borrowed input: pointers into the caller's arrays. */
typedef struct bvx_mesh_view {
    const void *positions;    /**< x, y, z of each vertex [Size: vertex_count] */
    const void *indices;      /**< three vertex indices a triangle; NULL: triangle t has vertices 3t, 3t+1,
                                   3t+2 */
    uint64_t vertex_count;    /**< [Limit: < 2^32] */
    uint64_t triangle_count;  /**< [Limit: < 2^31] */
    uint32_t position_type;   /**< BVX_F32 or BVX_F64 */
    uint32_t position_stride; /**< from vertex to vertex [Units: bytes] [Default: 0, packed] */
    uint32_t index_type;      /**< BVX_U16, BVX_U32 or BVX_U64; ignored without indices */
    uint32_t index_stride;    /**< from triangle to triangle [Units: bytes] [Default: 0, packed] */
    const uint8_t *colours;   /**< red, green, blue, alpha of each vertex, packed; used by pictures, and by
                                   levels with a colour_weight [Default: NULL] */
    uint64_t reserved;
} bvx_mesh_view;

/** The view of packed arrays: three floats a vertex, three vertex indices a triangle. Nothing is copied. */
static inline bvx_mesh_view bvx_mesh_view_packed(const float *positions, uint64_t vertex_count,
                                                 const uint32_t *triangles, uint64_t triangle_count)
{
    bvx_mesh_view view;

    view.positions = positions;
    view.indices = triangles;
    view.vertex_count = vertex_count;
    view.triangle_count = triangle_count;
    view.position_type = BVX_F32;
    view.position_stride = 0;
    view.index_type = BVX_U32;
    view.index_stride = 0;
    view.colours = NULL;
    view.reserved = 0;
    return view;
}

/** An indexed triangle mesh, counter-clockwise seen from outside. A zeroed struct is empty and ready to
 *  receive; one with arrays and capacities of the caller's is filled in place. */
typedef struct bvx_mesh {
    void *positions;         /**< float or double [Size: vertex_count * 3] [Units: world, less frame] */
    uint32_t *triangles;     /**< [Size: triangle_count * 3] */
    uint64_t *vertex_keys;   /**< canonical key of each vertex, where keys is set; else NULL */
    uint64_t *triangle_keys; /**< canonical key of each triangle's cell, where keys is set; else NULL */
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t vertex_capacity;   /**< vertices that the arrays hold */
    uint64_t triangle_capacity; /**< triangles that the arrays hold */
    double frame[3];            /**< add to positions to reach the world; zero without local_frame */
    int32_t position_type;      /**< BVX_F32 or BVX_F64 */
    int32_t owned;              /**< 1 when bvx_mesh_free frees the arrays */
    uint8_t *colours; /**< red, green, blue, alpha of each vertex, or NULL [Size: vertex_capacity * 4] */
    float *uvs;       /**< texture coordinates u, v, or NULL [Size: uv_count * 2] */
    uint32_t *uv_triangles; /**< three indices into uvs a triangle [Size: triangle_capacity * 3]; NULL
                                 beside uvs: each vertex has the uv of its own index, and uv_count is
                                 vertex_capacity */
    uint64_t uv_count;
    uint64_t reserved[4];
} bvx_mesh;

/** Free what the library allocated and zero the struct. */
BVX_API void bvx_mesh_free(bvx_context *context, bvx_mesh *mesh);

/** A view of a mesh; the frame is not part of it. */
BVX_API void bvx_mesh_view_of(const bvx_mesh *mesh, bvx_mesh_view *view);

/** Drop vertices with a coordinate that is not finite, and the triangles that use them: other calls refuse
 *  a mesh with such a triangle and name a vertex.
 *  mesh     its arrays, the library's or the caller's, are written: what remains moves up and keeps its
 *           order, its keys, colours and texture coordinates. The counts are set, the capacities stay. May
 *           be without triangles afterwards.
 *  dropped  out; triangles
 *  Returns BVX_ERR_RANGE (index, with its triangle). After a failure the mesh is unchanged.
 *  [Memory: 4 bytes a vertex, where there is something to drop] [Cost: O(vertices + triangles)] */
BVX_API bvx_status bvx_mesh_drop_nonfinite(bvx_context *context, bvx_mesh *mesh, uint64_t *dropped);

/** Hash of type, counts, frame, positions and triangles; the recipe is in docs/exactness.md. */
BVX_API bvx_status bvx_mesh_hash(bvx_context *context, const bvx_mesh *mesh, uint64_t *hash);

/** The hash behind all golden values: FNV-1a over 64-bit little-endian words, h ^= h >> 32 after each, then
 *  over the byte count; it starts with seed ^ 0xcbf29ce484222325. The recipe, and that of grids and meshes:
 *  docs/exactness.md. */
BVX_API uint64_t bvx_hash(const void *bytes, size_t size, uint64_t seed);

/** What a mesh is. Vertices at equal positions are one vertex with weld 1 (file formats without indices). */
typedef struct bvx_certificate {
    int32_t closed;          /**< 1: every edge has two or more triangle sides, none is a boundary */
    int32_t edge_manifold;   /**< 1: no edge has more than two triangles */
    int32_t vertex_manifold; /**< 1: the triangles around every vertex form one fan */
    int32_t oriented;        /**< 1: no two triangles run along an edge in the same direction */
    uint64_t vertices;       /**< vertices that triangles use, after welding */
    uint64_t edges;          /**< different edges of the triangles that count */
    uint64_t triangles;      /**< triangles that count: three different vertices */
    uint64_t unused_vertices;
    uint64_t collapsed;         /**< triangles with two equal vertices, left out of all that follows */
    uint64_t degenerate;        /**< triangles that count but have no area in the arithmetic of doubles */
    uint64_t duplicates;        /**< triangles whose three vertices an earlier one has, in any order */
    uint64_t boundary_edges;    /**< edges with one triangle */
    uint64_t nonmanifold_edges; /**< edges with three or more */
    uint64_t flipped_edges;     /**< edges with two triangles that run along it in the same direction */
    uint64_t nonmanifold_vertices;
    uint64_t components; /**< connected through edges */
    int64_t euler;       /**< vertices - edges + triangles */
    double volume;       /**< signed, by the divergence theorem about the bounds' centre [Units: world^3] */
    double area;         /**< [Units: world^2] */
    double low[3], high[3]; /**< bounds of the used vertices [Units: world] */
    uint64_t reserved[4];
} bvx_certificate;

/** Check a mesh. weld 1 identifies vertices with equal positions (-0 equals 0).
 *  Returns BVX_ERR_RANGE (index or coordinate). All vertices must be finite, used or not. A mesh without
 *  triangles is no error: its certificate says closed 0. [Limit: (2^32 - 1) / 3 triangles]
 *  [Memory: about 60 bytes a triangle] [Cost: O(triangles), radix sorts] [Exact: all but volume and area,
 *  which are sums of doubles in triangle order and the same everywhere] */
BVX_API bvx_status bvx_mesh_check(bvx_context *context, const bvx_mesh_view *mesh, int32_t weld,
                                  bvx_certificate *certificate);

/** Pairs of triangles that cross: that have a common point which is neither a common vertex nor on a common
 *  edge. Vertices at equal positions are one (-0 equals 0). Touching is crossing: a vertex on another
 *  triangle, an overlap in one plane, a fold flat on its neighbour, a triangle that is there twice.
 *  Triangles without area are left out; a mesh without triangles has no crossing. All vertices must be
 *  finite, used or not.
 *  count     out; pairs that cross, also when capacity is too small
 *  pairs     [Size: capacity * 2] two triangle indices a pair, the lower one first; pairs ascend
 *  capacity  pairs that the array holds [Limit: the list has fewer than 2^32]
 *  Returns BVX_ERR_RANGE (index or coordinate; too many pairs).
 *  [Memory: 85 bytes a triangle (f64: 121) and 4 a vertex, or 10 a vertex where that is more; 24 a pair
 *  that is listed] [Cost: O(triangles log triangles + pairs of triangles whose boxes meet)] [Exact: for all
 *  finite doubles, with no tolerance, for any order of vertices and triangles; on a thread that flushes
 *  subnormal numbers for coordinates that are 0 or at least 2^-960 in size] */
BVX_API bvx_status bvx_mesh_crossings(bvx_context *context, const bvx_mesh_view *mesh, uint64_t *count,
                                      uint32_t *pairs, uint64_t capacity);

/** Normals of length 1, three floats each, outwards where the mesh is oriented so; 0, 0, 1 where there is
 *  none (a vertex without facets, a facet without area). Either array may be NULL.
 *  vertex_normals  [Size: vertex_count * 3] the sum of the facets' normals, each weighted by its area
 *  facet_normals   [Size: triangle_count * 3] averaged 0: of each facet itself; 1: the mean of its three
 *                  vertices' normals
 *  Returns BVX_ERR_EMPTY (no triangle), BVX_ERR_RANGE (index or coordinate).
 *  [Memory: 24 bytes a vertex] [Cost: O(vertices + triangles)]
 *  Source: Gouraud. Continuous Shading of Curved Surfaces. 1971 */
BVX_API bvx_status bvx_mesh_normals(bvx_context *context, const bvx_mesh_view *mesh, int32_t averaged,
                                    float *vertex_normals, float *facet_normals);

/** Distances from random points on one mesh to the nearest points of another. */
typedef struct bvx_distance_report {
    uint64_t samples; /**< points taken on each side */
    uint64_t seed;
    double mean_a_to_b, max_a_to_b, mean_b_to_a, max_b_to_a; /**< [Units: world] */
    double mean, max;     /**< of both ways: the mean of the means, the greater maximum [Units: world] */
    double normal_a_to_b; /**< mean of 1 - cos of the angle between the facets' normals, from a */
    double normal_b_to_a;
} bvx_distance_report;

/** Sample each mesh uniformly by area (stratified, from a fixed generator and seed) and measure to the
 *  other. samples [Limit: 1..2^31-1]. Frames are ignored: give meshes in one frame.
 *  Returns BVX_ERR_EMPTY (no triangle of area), BVX_ERR_RANGE. Ties take the triangle that comes first
 *  along a curve through space; samples nearest to a triangle without area are left out of the normals'
 *  means. The order of triangles, of their corners (turned) and of vertices does not change a bit.
 *  [Memory: 72 bytes a triangle of both (f64: 108), and 8] [Cost: O((samples + triangles) log triangles)] */
BVX_API bvx_status bvx_mesh_distance(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b,
                                     uint64_t samples, uint64_t seed, bvx_distance_report *report);

/* ---- Lattices ------------------------------------------------------------------------------------------ */

/** Voxel (i,j,k) is the half-open box [origin + ijk*spacing, origin + (ijk+1)*spacing); samples sit at its
 *  centre. All four fields are the lattice's identity. */
typedef struct bvx_lattice {
    double origin[3];      /**< low corner of voxel (0,0,0) [Units: world] [Limit: finite] */
    double spacing[3];     /**< edges of a voxel [Units: world] [Limit: > 0, finite] */
    int32_t dims[3];       /**< [Units: voxels] [Limit: 1..2^25] */
    int32_t fraction_bits; /**< fixed-point bits below a voxel [Limit: 4..16] */
} bvx_lattice;

/** A box of a lattice: voxels low .. low + size - 1. All zero stands for the whole lattice. */
typedef struct bvx_window {
    int32_t low[3];
    int32_t size[3];
} bvx_window;

typedef struct bvx_lattice_options {
    size_t struct_size;
    int32_t resolution;         /**< voxels along the longest axis, cubic voxels [Limit: 0..2^25] [Default:
                                     0, unset] */
    int32_t axis_resolution[3]; /**< voxels along each axis, stretched voxels [Limit: 0..2^25] [Default: 0,
                                     unset] */
    double spacing[3];          /**< edges of a voxel [Units: world] [Limit: >= 0] [Default: 0, unset] */
    int32_t padding;            /**< empty voxels added on every side [Limit: 0..65536] [Default: 0] */
    int32_t reserved;
} bvx_lattice_options;

BVX_API void bvx_lattice_options_init(bvx_lattice_options *options, size_t size);

/** A lattice of cubic voxels around a mesh, resolution voxels along its longest axis, low-aligned: bounds
 *  of the vertices that triangles use (all must be finite, used or not), dims the smallest count that
 *  covers them.
 *  Returns BVX_ERR_EMPTY (no triangle), BVX_ERR_RANGE (a coordinate that is not finite, an index beyond the
 *  vertices, dims beyond 2^25).
 *  [Memory: none] [Cost: O(vertices + triangles)] */
BVX_API bvx_status bvx_lattice_fit(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                                   bvx_lattice *lattice);

/** The same with all choices; exactly one of resolution, axis_resolution and spacing is set. */
BVX_API bvx_status bvx_lattice_fit_with(bvx_context *context, const bvx_mesh_view *mesh,
                                        const bvx_lattice_options *options, bvx_lattice *lattice);

/** The same around a box, low corner and high corner, in place of a mesh's bounds: which contains every
 *  mesh in the box. Sides of 0 are allowed; a resolution needs one that is not.
 *  Returns BVX_ERR_ARGUMENT (also a corner above the other), BVX_ERR_EMPTY (a point and no spacing),
 *  BVX_ERR_RANGE (a coordinate that is not finite, dims beyond 2^25).
 *  [Memory: none] [Cost: O(1)] */
BVX_API bvx_status bvx_lattice_fit_box(bvx_context *context, const double low[3], const double high[3],
                                       const bvx_lattice_options *options, bvx_lattice *lattice);

/** A lattice from its parts; fraction_bits follows from dims.
 *  Returns BVX_ERR_RANGE. */
BVX_API bvx_status bvx_lattice_make(bvx_context *context, const double origin[3], const double spacing[3],
                                    const int32_t dims[3], bvx_lattice *lattice);

/* ---- Grids --------------------------------------------------------------------------------------------- */

/** A set of voxels, one bit each. Voxel (x,y,z) of the window is bit (x & 63) of words[(z * size[1] + y) *
 *  words_per_row + (x >> 6)]; bits at or past size[0] are always 0. Where a caller sets one, results are
 *  wrong or BVX_ERR_ARGUMENT (surfaces, faces and fields look), never unsafe for memory. Words of two grids
 *  are the same or apart: results that overlap their operands otherwise are refused. */
typedef struct bvx_grid {
    uint64_t *words;        /**< [Size: bvx_grid_bound] 64-byte aligned when the library made it */
    uint64_t word_capacity; /**< words that the array holds; set by a caller who provides the array */
    bvx_lattice lattice;
    int32_t low[3];        /**< window: lattice index of voxel (0,0,0) of this grid [Units: voxels] */
    int32_t size[3];       /**< window: voxels along each axis [Units: voxels] */
    int32_t words_per_row; /**< (size[0] + 63) / 64 */
    int32_t owned;         /**< 1 when bvx_grid_free frees words */
    int32_t reserved[4];
} bvx_grid;

/** Words that the grid of a window needs; 0 when the window is not inside the lattice. NULL window: all of
 *  it. */
BVX_API uint64_t bvx_grid_bound(const bvx_lattice *lattice, const bvx_window *window);

/** An empty grid. A grid that holds words of the caller's is filled in place when word_capacity suffices.
 *  Returns BVX_ERR_RANGE (window outside the lattice).
 *  [Cost: O(words)] */
BVX_API bvx_status bvx_grid_create(bvx_context *context, const bvx_lattice *lattice, const bvx_window *window,
                                   bvx_grid *grid);

/** Free what the library allocated and zero the struct. */
BVX_API void bvx_grid_free(bvx_context *context, bvx_grid *grid);

/** Count the set voxels.
 *  [Cost: O(words)] */
BVX_API bvx_status bvx_grid_count(bvx_context *context, const bvx_grid *grid, uint64_t *count);

/** Hash of size, low, lattice and bits, the same on every machine; the recipe is in docs/exactness.md. */
BVX_API bvx_status bvx_grid_hash(bvx_context *context, const bvx_grid *grid, uint64_t *hash);

/** 1 when voxel (x,y,z) of the window is set; no check of the range. */
static inline int bvx_grid_get(const bvx_grid *grid, int32_t x, int32_t y, int32_t z)
{
    size_t const row = (size_t)z * (size_t)grid->size[1] + (size_t)y;
    return (int)(grid->words[row * (size_t)grid->words_per_row + (size_t)(x >> 6)] >> (x & 63) & 1);
}

/** Set (value 1) or clear (value 0) voxel (x,y,z) of the window; no check of the range. */
static inline void bvx_grid_set(bvx_grid *grid, int32_t x, int32_t y, int32_t z, int value)
{
    size_t const row = (size_t)z * (size_t)grid->size[1] + (size_t)y;
    uint64_t *const word = &grid->words[row * (size_t)grid->words_per_row + (size_t)(x >> 6)];
    uint64_t const bit = UINT64_C(1) << (x & 63);
    *word = value ? *word | bit : *word & ~bit;
}

/* ---- Solids -------------------------------------------------------------------------------------------- */

/** What decides that a centre is inside.
 *  PARITY   an odd number of crossings before the centre along x: nested shells are cavities
 *  NONZERO  winding number along x other than zero: overlapping and inverted shells are one solid
 *  VOTE     the parities along x, y and z where they agree, else the majority of all directions: holes
 *           leave no stripes and close smoothly
 *  FLOOD    what a flood from outside, through faces of voxels, cannot reach past the conservative
 *           surface: fills cavities; the surface's own voxels vote, but around cavities
 *  REGIONS  each region that the conservative surface leaves (connected through faces) is inside or
 *           outside as a whole: keeps cavities; the surface's own voxels vote
 *  BELOW    all that lies under a terrain, or between two
 *  WINDING  generalized winding number above a half, either way: without open edges it is NONZERO, holes
 *           close smoothly; overlapping parts are one, flipped triangles are not for it
 *  AUTO     what suits the mesh: PARITY where closed shells do not cross, NONZERO where they do, WINDING
 *           where there are holes, VOTE where triangles cannot be oriented; flipped triangles are turned
 *           before */
#define BVX_FILL_LIST(X)              \
    X(BVX_FILL_PARITY, 0, "parity")   \
    X(BVX_FILL_NONZERO, 1, "nonzero") \
    X(BVX_FILL_VOTE, 2, "vote")       \
    X(BVX_FILL_FLOOD, 3, "flood")     \
    X(BVX_FILL_REGIONS, 4, "regions") \
    X(BVX_FILL_BELOW, 5, "below")     \
    X(BVX_FILL_WINDING, 6, "winding") \
    X(BVX_FILL_AUTO, 7, "auto")
enum {
    BVX_FILL_LIST(BVX_LIST_ENUM) BVX_FILL_COUNT = 8,
    /** Rules that bvx_boolean takes: bit 1 << rule. */
    BVX_FILLS_OF_BOOLEAN = 1 << BVX_FILL_PARITY | 1 << BVX_FILL_NONZERO | 1 << BVX_FILL_VOTE |
                           1 << BVX_FILL_WINDING | 1 << BVX_FILL_AUTO
};

/** Why a rule filled a mesh. The numbers are frozen. */
enum {
    BVX_FILL_REASON_ASKED = 0,       /**< it was chosen by name */
    BVX_FILL_REASON_SOUND = 1,       /**< PARITY: closed, and nothing lies twice inside: all rules agree */
    BVX_FILL_REASON_NESTED = 2,      /**< PARITY: closed shells lie in others that face the same way, and
                                          none cross: cavities */
    BVX_FILL_REASON_OVERLAP = 3,     /**< NONZERO: closed shells cross each other or themselves: they are
                                          one solid */
    BVX_FILL_REASON_OPEN = 4,        /**< WINDING: there are open edges */
    BVX_FILL_REASON_UNORIENTABLE = 5 /**< VOTE: the triangles of some patch cannot all be oriented the same
                                          way */
};

/** Counts of one call, for its window (edges: of the mesh); those of other rules are 0. */
typedef struct bvx_solid_report {
    uint64_t triangles_used;  /**< triangles whose box holds the centre of a row of the window (once for
                                   each 65535 rows a side); rules that look along three axes: the sum of
                                   the three, here and in the next three */
    uint64_t crossings;       /**< of rows with the surface, also outside the window along the row */
    uint64_t unbalanced_rows; /**< rows whose crossings do not balance: the mesh has a hole there */
    uint64_t dropped;         /**< parity, nonzero: unmatched crossings dropped in them */
    uint64_t boundary_edges;  /**< check_edges: edges with one triangle, vertices at equal positions taken
                                   as one */
    uint64_t flipped_edges;   /**< check_edges: edges with two triangles that run along it in the same
                                   direction */
    uint64_t surface_voxels;  /**< flood, regions, add_shell: voxels of the conservative surface */
    uint64_t closed_voxels;   /**< flood: voxels that closing gaps added to it */
    uint64_t leaks;   /**< flood: voxels off the surface (gaps closed) that the flood reached although they
                           are surely inside */
    uint64_t regions; /**< regions: how many there are */
    uint64_t mixed_regions;  /**< regions: those that hold sure centres of both sides, or none */
    uint64_t mixed_voxels;   /**< regions: voxels of these; each kept its own vote */
    uint64_t columns;        /**< below: columns under the surface; with a second: columns where both exist */
    uint64_t cut_voxels;     /**< below, with a second: voxels where mesh lies above second */
    uint64_t fill_voxels;    /**< below, with a second: voxels where second lies above mesh */
    int32_t fill;            /**< BVX_FILL_...: the rule that filled, AUTO's choice or the one in the
                                  options */
    int32_t fill_reason;     /**< BVX_FILL_REASON_... */
    uint64_t turned;         /**< auto: triangles that were turned before */
    uint64_t doubles;        /**< auto, where edges do not balance or nothing is inside: triangles that an
                                  earlier one equals, facing either way, or without area: left out */
    double volume;           /**< of the voxels set [Units: world] */
    double mesh_volume;      /**< that the mesh encloses; 0 where that is not to be compared: but for
                                  BVX_FILL_REASON_SOUND, and where it leaves the window or a shell was
                                  added, rounded to a float [Units: world] */
    int32_t thin_checked;    /**< 1: walls that the voxels lose were looked for (check_thin) */
    int32_t thin_resolution; /**< the resolution at which a wall of thin_wall is 1.5 voxels; 0: none, or
                                  none needed */
    uint64_t thin_voxels;    /**< voxels at walls thinner than 1.5 voxels that the voxels set do not show,
                                  or show with gaps */
    double thin_wall;        /**< nine tenths of these voxels have a wall this thick or thicker; 0: sheets
                                  [Units: world] */
    int32_t thin_low[3], thin_high[3]; /**< the box of these voxels, both ends in it [Units: voxels of the
                                            lattice] */
    double crossing_volume;    /**< where walls were looked for and no shell was added: volume, with the solid
                                 ending where lines of centres cross the mesh and not half way between
                                 centres; what the voxels lose or close is not in it. Rounded to a float
                                 [Units: world] */
    int32_t volume_resolution; /**< the resolution from which volume is within 1 % of mesh_volume, or of
                                    crossing_volume where that is 0: the volume is off by no more per
                                    resolution than now, and by half a voxel on faces along the lattice; 0:
                                    it is, or none does. Not in bvx_boolean_report */
    int32_t reserved;
} bvx_solid_report;

typedef struct bvx_voxelize_options {
    size_t struct_size;
    int32_t fill; /**< BVX_FILL_... [Default: BVX_FILL_AUTO] */
    int32_t reserved;
    bvx_window window; /**< flood, regions: the whole lattice only [Default: all zero, the whole lattice] */
    bvx_solid_report *report; /**< receives counts when not NULL [Default: NULL] */
    int32_t close_gaps;  /**< flood: gaps of up to this many voxels are walls: voxels that no empty cube of
                              close_gaps + 1 voxels a side holds. Past them the flood moves voxel by voxel,
                              and may find a way where walls slant [Units: voxels] [Limit: 0..65535]
                              [Default: 0] */
    int32_t add_shell;   /**< 1: voxels of the conservative surface are set too; not for below [Limit:
                              0..1] [Default: 0] */
    int32_t check_edges; /**< 1: count the report's boundary_edges and flipped_edges [Limit: 0..1]
                              [Default: 0] */
    int32_t axis;        /**< below: up is towards + along this axis [Limit: 0..2] [Default: 2] */
    double base;         /**< below: the height from which columns are filled [Units: world] [Limit: any]
                              [Default: -infinity, all of the lattice] */
    const bvx_mesh_view *second; /**< below: fill between mesh and this, where both exist [Default: NULL] */
    int32_t check_thin; /**< look for walls that the voxels lose, for the report's thin_...: 0 never, 1
                             always (not for below), -1 in a whole lattice with a report, as far as the
                             memory limit allows [Limit: -1..1] [Default: -1] */
    int32_t reserved2;
} bvx_voxelize_options;

BVX_API void bvx_voxelize_options_init(bvx_voxelize_options *options, size_t size);

/** Set the voxels whose centres lie inside a mesh.
 *
 *  Vertices are snapped to the lattice's fixed point; from there every decision is exact, with one rule for
 *  ties, so solids that share faces share no voxel and leave none between them. Near holes PARITY and
 *  NONZERO drop the crossings of a row that have no match, and count such rows; AUTO takes WINDING there, or
 *  VOTE where triangles cannot be turned alike (docs/rules.md). Vertices that no triangle uses may be
 *  anything (but must be finite for check_edges).
 *  solid  zeroed, or made by an earlier call, or with words of the caller's: too few are BVX_ERR_CAPACITY
 *  Returns BVX_ERR_ARGUMENT (also options that the rule does not take, and a window for flood or regions),
 *  BVX_ERR_EMPTY (no triangle; flood: it reached every centre off the surface although there is an inside),
 *  BVX_ERR_RANGE (index of a vertex or triangle: not finite, beyond the vertices, or too far from the
 *  lattice for its fixed point).
 *  [Memory: the grid, 16 bytes a vertex, 1 a row, up to 6.3 MiB for triangles, 160 KiB a worker; what each
 *  rule adds: docs/rules.md] [Cost: O(vertices + triangles + crossings + words); VOTE three times that;
 *  REGIONS and FLOOD add bvx_voxelize_surface] [Exact: all but the angles of VOTE and WINDING near holes,
 *  which are doubles to 1e-8, the same everywhere. Except for REGIONS and FLOOD a window has the bits of
 *  the whole]
 *  Source: scanline solid of "LOD by voxelization and downsampling" 2.3, with exact ties; Nooruddin, Turk.
 *  Simplification and Repair of Polygonal Models Using Volumetric Techniques. 2003 (votes); Jacobson,
 *  Kavan, Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized Winding Numbers. 2013;
 *  Barill, Dickson, Schmidt, Levin, Jacobson. Fast Winding Numbers for Soups and Clouds. 2018. */
BVX_API bvx_status bvx_voxelize_solid(bvx_context *context, const bvx_mesh_view *mesh,
                                      const bvx_lattice *lattice, const bvx_voxelize_options *options,
                                      bvx_grid *solid);

/** Where the rules for solids differ, and what a solid loses. */
typedef struct bvx_fill_comparison {
    uint64_t set[5];         /**< voxels that each rule sets, by BVX_FILL_PARITY .. BVX_FILL_REGIONS */
    uint64_t surface_voxels; /**< voxels of the conservative surface */
    uint64_t disagreeing;    /**< voxels off the surface that some of the rules set and others do not */
    uint64_t lost_voxels;    /**< voxels of the surface whose 3 x 3 x 3 neighbourhood holds no voxel of the
                                  vote's solid: a wall thinner than a voxel was lost there */
    uint64_t lost_places;    /**< pieces of these, connected through faces */
    int32_t flood_leaked;    /**< 1: the flood reached every centre off the surface although there is an
                                  inside: it is left out of disagreeing */
    int32_t reserved;
    uint64_t reserved2[4];
} bvx_fill_comparison;

typedef struct bvx_compare_fills_options {
    size_t struct_size;
    int32_t close_gaps; /**< as for bvx_voxelize_solid [Limit: 0..65535] [Default: 0] */
    int32_t reserved;
    bvx_grid *disagreeing; /**< receives the voxels counted there when not NULL; zeroed, or with words of
                                the caller's [Default: NULL] */
    bvx_grid *lost;        /**< receives the voxels counted in lost_voxels when not NULL [Default: NULL] */
} bvx_compare_fills_options;

BVX_API void bvx_compare_fills_options_init(bvx_compare_fills_options *options, size_t size);

/** Fill a mesh by the rules parity, nonzero, vote, flood and regions and say where they differ: where the
 *  mesh is closed and clean they differ only in cavities. Whole lattices only.
 *  Returns what bvx_voxelize_solid returns, but for a flood that finds nothing.
 *  [Memory: seven grids beside its own needs for flood] [Cost: that of vote, nonzero, regions and flood
 *  together] */
BVX_API bvx_status bvx_compare_fills(bvx_context *context, const bvx_mesh_view *mesh,
                                     const bvx_lattice *lattice, const bvx_compare_fills_options *options,
                                     bvx_fill_comparison *comparison);

/* ---- Surface voxels ------------------------------------------------------------------------------------ */

/** Which voxels are the surface.
 *  CONSERVATIVE  every voxel whose closed box meets a triangle: no 6-, 18- or 26-path leaks through
 *  THIN          every voxel whose axis cross (three unit segments through its centre) meets a triangle:
 *                no 6-path leaks through
 *  SAMPLED       every voxel that holds a point of the triangles' subdivision into parts shorter than a
 *                voxel: 26-connected; a flood may leak through */
#define BVX_SURFACE_LIST(X)                        \
    X(BVX_SURFACE_CONSERVATIVE, 0, "conservative") \
    X(BVX_SURFACE_THIN, 1, "thin")                 \
    X(BVX_SURFACE_SAMPLED, 2, "sampled")
enum { BVX_SURFACE_LIST(BVX_LIST_ENUM) };

/** The triangles that touch each set voxel, by rank: set voxel r, counted in the order of the grid's bits
 *  (z, y, x), has triangles[offsets[r]] .. triangles[offsets[r + 1] - 1], ascending. */
typedef struct bvx_attached {
    uint64_t *offsets;       /**< [Size: voxel_count + 1] */
    uint32_t *triangles;     /**< [Size: triangle_count] */
    uint64_t voxel_count;    /**< set voxels of the grid */
    uint64_t triangle_count; /**< offsets[voxel_count] */
    uint64_t reserved[2];
} bvx_attached;

/** Free what the library allocated and zero the struct. */
BVX_API void bvx_attached_free(bvx_context *context, bvx_attached *attached);

typedef struct bvx_surface_report {
    uint64_t triangles; /**< sampled: triangles whose first corner lies in the window; all counts are 0 for
                             the other modes */
    uint64_t samples;   /**< sampled: points of their subdivision */
    uint64_t parts;     /**< sampled: sum of the parts of the triangles' longest edges; by triangles, the
                             mean subdivision coefficient of the paper */
    uint64_t reserved[4];
} bvx_surface_report;

typedef struct bvx_surface_options {
    size_t struct_size;
    int32_t mode; /**< BVX_SURFACE_... [Default: BVX_SURFACE_CONSERVATIVE] */
    int32_t reserved;
    bvx_window window;          /**< [Default: all zero, the whole lattice] */
    bvx_attached *attached;     /**< zeroed; receives the triangles of each voxel when not NULL [Default:
                                     NULL] */
    bvx_surface_report *report; /**< receives counts when not NULL [Default: NULL] */
} bvx_surface_options;

BVX_API void bvx_surface_options_init(bvx_surface_options *options, size_t size);

/** Set the voxels that a mesh's surface touches, by one of three exact definitions. Vertices are snapped to
 *  the lattice's fixed point; closed sets touch when they share a point, and triangles without area count
 *  as the segments or points that they are (thin: they have no crossing).
 *  Returns BVX_ERR_EMPTY (no triangle), BVX_ERR_RANGE (vertex or index, as in bvx_voxelize_solid).
 *  [Memory: the grid, 16 bytes a vertex, and with more than one thread 4 for each triangle and tile of rows
 *  that it reaches; attached: 8 bytes a voxel and 4 a pair for the result, and 4 a voxel] [Cost: O(vertices
 *  + triangles + runs + words); sampled: O(points in the window); attached: twice more] [Exact: yes, for any
 *  order of triangles and corners; a window holds the bits of the whole]
 *  Source: Schwarz, Seidel. Fast Parallel Surface and Solid Voxelization on GPUs. 2010 (conservative);
 *  Laine. A Topological Approach to Voxelization. 2013 (thin); "Fast voxelization based on TIN" Algorithm 1
 *  (sampled). */
BVX_API bvx_status bvx_voxelize_surface(bvx_context *context, const bvx_mesh_view *mesh,
                                        const bvx_lattice *lattice, const bvx_surface_options *options,
                                        bvx_grid *surface);

/* ---- Surfaces of grids --------------------------------------------------------------------------------- */

/** What happens on a cell face whose two diagonals differ.
 *  SEPARATE  set corners are kept apart: the solid is 6-connected
 *  JOIN      set corners are joined: the solid is 18-connected on faces */
#define BVX_FACE_LIST(X)                \
    X(BVX_FACE_SEPARATE, 0, "separate") \
    X(BVX_FACE_JOIN, 1, "join")
enum { BVX_FACE_LIST(BVX_LIST_ENUM) };

/** Sides of the window that are left open (bits of open_sides). */
#define BVX_SIDE_LIST(X)            \
    X(BVX_OPEN_X_LOW, 1, "x-low")   \
    X(BVX_OPEN_X_HIGH, 2, "x-high") \
    X(BVX_OPEN_Y_LOW, 4, "y-low")   \
    X(BVX_OPEN_Y_HIGH, 8, "y-high") \
    X(BVX_OPEN_Z_LOW, 16, "z-low")  \
    X(BVX_OPEN_Z_HIGH, 32, "z-high")
enum { BVX_SIDE_LIST(BVX_LIST_ENUM) };

typedef struct bvx_extract_options {
    size_t struct_size;
    int32_t face_rule;     /**< BVX_FACE_... [Default: BVX_FACE_SEPARATE] */
    int32_t position_type; /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO [Limit: 0..2] [Default: BVX_F32] */
    int32_t open_sides;    /**< BVX_OPEN_... [Limit: 0..63] [Default: 0, beyond the window counts as empty] */
    int32_t keys; /**< 1: fill vertex_keys and triangle_keys [Limit: 0..1; dims below 2^20] [Default: 0] */
    int32_t local_frame; /**< 1: positions relative to the lattice's origin, which goes to frame [Limit:
                              0..1] [Default: 0] */
    int32_t reserved;
} bvx_extract_options;

BVX_API void bvx_extract_options_init(bvx_extract_options *options, size_t size);

/** The exact size of what bvx_extract_surface would make. [Memory: 16 bytes a row] [Cost: O(words +
 *  crossings)] */
BVX_API bvx_status bvx_extract_count(bvx_context *context, const bvx_grid *grid,
                                     const bvx_extract_options *options, uint64_t *vertex_count,
                                     uint64_t *triangle_count);

/** The surface between set and empty voxel centres by marching cubes, vertices at the middle of lattice
 *  edges.
 *
 *  Closed, outwards, edge- and vertex-manifold, no duplicate triangle and none without area; a side that is
 *  left open has a boundary there. Only cells whose eight centres lie in the window are visited on open
 *  sides, so windows that overlap by one layer of voxels tile the whole, and bvx_mesh_merge joins them to
 *  the whole's bytes. Vertices are in order of (z, y, axis, x) of their lattice edge, triangles of (z, y,
 *  x) of their cell.
 *  surface  zeroed, or made by an earlier call (Reuse, above), or with arrays of the caller's: too small
 *           ones are BVX_ERR_CAPACITY
 *  Returns BVX_ERR_RANGE (f32 does not distinguish neighbouring positions: take BVX_POSITION_AUTO, f64 or
 *  local_frame; 2^32 vertices or more). An empty grid gives an empty mesh.
 *  [Memory: the mesh and 16 bytes a row] [Cost: O(words + crossings)]
 *  Source: Lorensen, Cline. Marching Cubes. 1987; face rules and triangulations from src/surface/tables.py.
 */
BVX_API bvx_status bvx_extract_surface(bvx_context *context, const bvx_grid *grid,
                                       const bvx_extract_options *options, bvx_mesh *mesh);

typedef struct bvx_faces_options {
    size_t struct_size;
    int32_t position_type; /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO [Limit: 0..2] [Default: BVX_F32] */
    int32_t local_frame;   /**< 1: positions relative to the lattice's origin, which goes to frame [Limit:
                                0..1] [Default: 0] */
    int32_t merged;        /**< 1: faces of one plane and side are merged into rectangles [Limit: 0..1]
                                [Default: 0] */
    int32_t reserved;
} bvx_faces_options;

BVX_API void bvx_faces_options_init(bvx_faces_options *options, size_t size);

/** The exact size of what bvx_extract_faces would make. [Memory: 8 bytes a row; merged: as there] */
BVX_API bvx_status bvx_faces_count(bvx_context *context, const bvx_grid *grid,
                                   const bvx_faces_options *options, uint64_t *vertex_count,
                                   uint64_t *triangle_count);

/** The voxels themselves as a mesh: each face between a set and an empty voxel, outwards, as two triangles.
 *  Beyond the window counts as empty. The mesh is closed and its volume that of the set voxels; where
 *  voxels touch only along an edge or at a corner it is not manifold (bvx_extract_surface's is).
 *
 *  merged: the faces of one plane and side become rectangles. Corners of one may lie on a side of another
 *  (T-junctions): the mesh covers the same points without a crack, but its edges do not pair up, and
 *  bvx_mesh_check finds it open. Orders of vertices, faces and rectangles: docs/rules.md.
 *  Returns BVX_ERR_RANGE (f32 as in bvx_extract_surface; 2^32 - 1 vertices or triangles). An empty grid
 *  gives an empty mesh.
 *  [Memory: the mesh and 8 bytes a row; merged: one more grid, 28 bytes a rectangle, and 16 bytes a row and
 *  worker] [Cost: O(words + faces)]
 *  Source: "LOD by voxelization and downsampling" 2.3 (its picture of voxels). */
BVX_API bvx_status bvx_extract_faces(bvx_context *context, const bvx_grid *grid,
                                     const bvx_faces_options *options, bvx_mesh *mesh);

/** Join meshes with keys (windows of one lattice) into one: the bytes of the whole extracted at once, keys
 *  included.
 *  Returns BVX_ERR_ARGUMENT (no keys, types or frames that differ), BVX_ERR_RANGE.
 *  [Cost: O(n), radix sorts] [Memory: the result, and 24 bytes a vertex or triangle of the parts] */
BVX_API bvx_status bvx_mesh_merge(bvx_context *context, const bvx_mesh *parts, uint64_t part_count,
                                  bvx_mesh *whole);

/** Where the surface cuts a lattice edge whose ends A and B lie on either side. Always strictly inside the
 *  edge.
 *  VECTOR   where the line through the closest points of both ends passes nearest to the edge's line; where
 *           there is no such place, as SCALAR; where both have one closest point, its projection
 *  SCALAR   where the signed distance, taken as linear, is 0
 *  PAPER    VECTOR with the paper's clamps to the ends in place of SCALAR
 *  TANGENT  where the planes cut the edge that touch the surface at the closest points: the one nearer to
 *           the inside where they make a ridge, nearer to the outside where they make a groove; where they
 *           do neither, as VECTOR with the line kept between the closest points */
#define BVX_EDGE_LIST(X)            \
    X(BVX_EDGE_VECTOR, 0, "vector") \
    X(BVX_EDGE_SCALAR, 1, "scalar") \
    X(BVX_EDGE_MIDDLE, 2, "middle") \
    X(BVX_EDGE_PAPER, 3, "paper")   \
    X(BVX_EDGE_TANGENT, 4, "tangent")
enum { BVX_EDGE_LIST(BVX_LIST_ENUM) };

typedef struct bvx_field_surface_report {
    uint64_t edges;            /**< crossings placed */
    uint64_t scalar;           /**< of these: placed by the signed distance (PAPER: by a clamp) */
    uint64_t middle;           /**< placed in the middle: no values at one of the ends */
    uint64_t sharp_cells;      /**< sharp: pieces of the surface in a cell that got a vertex of their own */
    uint64_t sharp_taken_back; /**< sharp: pieces whose vertex would have turned a triangle over or might
                                    have crossed one */
    uint64_t flipped_edges;    /**< sharp: edges between such cells that were turned to join their vertices */
    uint64_t lids; /**< bvx_repair: placed by the winding number, since no surface is near: lids over holes */
    uint64_t sharp; /**< 1: edges and corners were kept sharp */
    uint64_t own;   /**< grid: crossings that are not the field's, placed by offset or in the middle */
    uint64_t reserved[1];
} bvx_field_surface_report;

/* ---- Fewer triangles ----------------------------------------------------------------------------------- */

/** What a level's error is.
 *  MEAN  mean distance, of both ways the mean
 *  MAX   largest distance, of both ways the greater */
#define BVX_ERROR_LIST(X)        \
    X(BVX_ERROR_MEAN, 0, "mean") \
    X(BVX_ERROR_MAX, 1, "max")
enum { BVX_ERROR_LIST(BVX_LIST_ENUM) };

/** What becomes of a mesh with borders when it is simplified.
 *  SHELL  bvx_build_levels: open sheets become thin closed shells; bvx_mesh_simplify: refused
 *  KEEP   borders stay borders; edges of three triangles and more, or between triangles that cannot agree
 *         on their sides, are refused
 *  CUT    as KEEP, but the sheet is cut along such edges: all their triangles get borders there */
#define BVX_OPEN_LIST(X)          \
    X(BVX_OPEN_SHELL, 0, "shell") \
    X(BVX_OPEN_KEEP, 1, "keep")   \
    X(BVX_OPEN_CUT, 2, "cut")
enum { BVX_OPEN_LIST(BVX_LIST_ENUM) };

typedef struct bvx_level_report {
    uint64_t vertices, triangles;
    uint64_t target;              /**< target of this level, or 0 */
    double target_error;          /**< error target of this level, or 0 [Units: world] */
    int32_t met;                  /**< 1: both are kept */
    int32_t measured;             /**< 1: distance is filled */
    bvx_distance_report distance; /**< a is the input, b the level */
    bvx_certificate certificate;  /**< of the level */
    uint64_t crossings; /**< pairs of triangles that cross: 0, but where the input of bvx_mesh_simplify has
                             some that stayed */
    double least_angle; /**< smallest angle of a triangle [Units: degrees] */
    uint64_t refused;   /**< edges that were tried and stayed, for their neighbours, turned triangles,
                             needles, crossings or crumples */
    uint64_t reserved[6];
} bvx_level_report;

typedef struct bvx_simplify_options {
    size_t struct_size;
    const uint64_t *target_triangles; /**< most triangles of each level [Size: level_count] [Default: NULL] */
    const double *target_errors;      /**< largest error of each level [Units: world] [Limit: > 0] [Size:
                                           level_count] [Default: NULL; with neither, each level has half
                                           of the triangles of the one before, the first half of the
                                           mesh's] */
    int32_t error_kind;               /**< of target_errors: BVX_ERROR_MEAN or BVX_ERROR_MAX [Limit: 0..1]
                                           [Default: BVX_ERROR_MEAN] */
    int32_t position_type;            /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO, the mesh's own [Limit:
                                           0..2] [Default: BVX_POSITION_AUTO] */
    double even;               /**< pull towards triangles of even size where the surface is flat [Limit:
                                    0..1] [Default: 1e-9] */
    uint64_t measure_samples;  /**< points a side for each report's distances [Limit: 0..2^31-1; 0: not
                                    measured] [Default: 0; target_errors measure with 20000 where none are
                                    given] */
    int32_t strict;            /**< 1: a target that cannot be kept is an error [Limit: 0..1] [Default: 0,
                                    the smallest mesh, met 0] */
    int32_t open;              /**< BVX_OPEN_...: may the mesh have borders? [Default: BVX_OPEN_KEEP] */
    bvx_level_report *reports; /**< [Size: level_count] filled when not NULL [Default: NULL] */
    double colour_weight;      /**< of the view's colours: a place whose colour is off by 255 in one
                                    channel costs as much as one that lies this part of the mesh's longest
                                    side off its planes, so borders of colours stay where they are. Alpha
                                    does not count. Without colours nothing changes [Limit: 0..1] [Default:
                                    0] */
    uint64_t reserved[3];
} bvx_simplify_options;

BVX_API void bvx_simplify_options_init(bvx_simplify_options *options, size_t size);

/** Fewer triangles for a manifold mesh, closed or with borders: a chain of levels, each made from the one
 *  before by collapsing the edge that costs least. Each level is closed where the mesh is, edge- and
 *  vertex-manifold and oriented, with the mesh's components, handles and borders, and without crossing
 *  triangles where the mesh has none. A collapse that would break one of these is refused, so a small
 *  target is not always met. Which edges are refused: docs/rules.md.
 *  mesh    edge-manifold and oriented, or it can be made so: triangles that are there twice count once,
 *          flipped ones are turned, a vertex in which parts touch becomes one for each. open
 *          BVX_OPEN_SHELL: closed, manifold and oriented as it is
 *  levels  [Size: level_count] each as for bvx_extract_surface; none of their arrays is the mesh's. After a
 *          failure no level remains
 *  Returns BVX_ERR_ARGUMENT (also: the mesh is not what is needed, with an edge), BVX_ERR_EMPTY (no
 *  triangle), BVX_ERR_RANGE (strict: a level that cannot be made; coordinates).
 *  [Memory: at most 160 bytes a triangle, 24 a border edge, 300 KB; of more than 20,000 triangles 1.3 MB a
 *  thread; with a colour weight 190 bytes a vertex] [Cost: O(triangles), some microseconds for each that
 *  goes] [Exact: the order of vertices and triangles of an oriented mesh does not change levels]
 *  Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997; Hoppe. New Quadric
 *  Metric for Simplifying Meshes with Appearance Attributes. 1999 (colours); Liu, Rahimzadeh, Zordan.
 *  Controlling Quadric Error Simplification with Line Quadrics. 2025; Dey, Edelsbrunner, Guha, Nekhayev.
 *  Topology Preserving Edge Contraction. 1999 (borders). */
BVX_API bvx_status bvx_mesh_simplify(bvx_context *context, const bvx_mesh_view *mesh,
                                     const bvx_simplify_options *options, uint64_t level_count,
                                     bvx_mesh *levels);

/* ---- Repair -------------------------------------------------------------------------------------------- */

/** What decides that a centre is inside.
 *  AUTO          fields: inside is what BVX_FILL_AUTO has inside: EXACT where closed shells do not cross,
 *                WINDING where they do or there are holes, VOTE where triangles cannot be oriented;
 *                repair: WINDING or VOTE
 *  EXACT         the solid's own rule (BVX_FILL_PARITY): field and solid never disagree
 *  NORMAL        the side of the closest triangle (the paper's): wrong near edges and corners
 *  PSEUDONORMAL  the side of the closest feature by angle-weighted normals: right for closed, oriented
 *                meshes that do not cross themselves
 *  WINDING       BVX_FILL_WINDING: holes and overlaps
 *  VOTE          BVX_FILL_VOTE: holes and flipped triangles
 *  NONE          no side at all: distances are not negative */
#define BVX_SIGN_LIST(X)                        \
    X(BVX_SIGN_AUTO, 0, "auto")                 \
    X(BVX_SIGN_EXACT, 1, "exact")               \
    X(BVX_SIGN_NORMAL, 2, "normal")             \
    X(BVX_SIGN_PSEUDONORMAL, 3, "pseudonormal") \
    X(BVX_SIGN_WINDING, 4, "winding")           \
    X(BVX_SIGN_VOTE, 5, "vote")                 \
    X(BVX_SIGN_NONE, 6, "none")
enum {
    BVX_SIGN_LIST(BVX_LIST_ENUM) BVX_SIGN_COUNT = 7,
    /** Rules that bvx_repair and bvx_build_levels take: bit 1 << rule. */
    BVX_SIGNS_OF_REPAIR = 1 << BVX_SIGN_AUTO | 1 << BVX_SIGN_EXACT | 1 << BVX_SIGN_WINDING |
                          1 << BVX_SIGN_VOTE
};

/** Why a mesh needs a repair: the first of these that holds. */
enum {
    BVX_NEEDS_NOTHING = 0,    /**< it is closed, manifold, oriented and outwards, and crosses itself
                                   nowhere */
    BVX_NEEDS_LIDS = 1,       /**< open edges */
    BVX_NEEDS_MANIFOLD = 2,   /**< edges of three triangles or more, vertices where parts touch */
    BVX_NEEDS_TURNS = 3,      /**< neighbours of opposite orientation */
    BVX_NEEDS_AREA = 4,       /**< triangles without area, or there twice */
    BVX_NEEDS_OUTSIDE_IN = 5, /**< its volume is not positive, or a part lies within another without being
                                   its cavity */
    BVX_NEEDS_UNCROSSING = 6  /**< triangles cross */
};

/** Walls of closed bodies thinner than 1.5 voxels, where no centre inside shows them.
 *  SHELL  pieces that the solid misses become shells, as sheets do; what else no centre lies in is lost,
 *         and reported
 *  KEEP   they are kept, closed and whole, about as thick as they are
 *  DROP   what no centre lies in is lost, and reported */
#define BVX_THIN_LIST(X)          \
    X(BVX_THIN_SHELL, 0, "shell") \
    X(BVX_THIN_KEEP, 1, "keep")   \
    X(BVX_THIN_DROP, 2, "drop")
enum { BVX_THIN_LIST(BVX_LIST_ENUM) };

typedef struct bvx_repair_report {
    bvx_certificate before;     /**< of the input, vertices at equal positions taken as one */
    bvx_certificate after;      /**< of the result */
    bvx_lattice lattice;        /**< that the result was made on */
    int32_t sign;               /**< BVX_SIGN_... that decided */
    int32_t shelled;            /**< 1: open sheets became shells */
    uint64_t holes;             /**< loops of open edges in the input */
    double hole_length;         /**< of all of them [Units: world] */
    double longest_hole;        /**< [Units: world] */
    uint64_t sheet_edges;       /**< crossings of the result far from the input's surface: the sheets over
                                     holes */
    uint64_t shelled_triangles; /**< of the input, that became shells */
    uint64_t overlaps; /**< voxels in more than one turn of the surface: overlapping parts; counted with
                            measure 1, and where volume or area of a closed, oriented mesh have changed by
                            more than a twentieth */
    uint64_t parts_kept, parts_dropped; /**< pieces of the solid */
    uint64_t cavities_kept, cavities_dropped;
    uint64_t searched;                  /**< target_triangles: resolutions that the search tried */
    bvx_distance_report distance;       /**< measure 1: a is the input, b the result */
    double mean_off_caps, max_off_caps; /**< measure 1: from the result to the input, without the sheets
                                             over holes [Units: world] */
    double sharp_share;       /**< sharp edges of the input: their part of the length of all; 0 for more
                                   than 500,000 triangles */
    int32_t sharp;            /**< 1: vertices were put on sharp edges and corners */
    int32_t needs;            /**< BVX_NEEDS_...: why the input needs a repair */
    int32_t copied;           /**< 1: it needed none and was copied (if_needed) */
    int32_t thin_kept;        /**< 1: thin walls are in the result, 0: there are none, or they are lost
                                   where no centre lies inside */
    uint64_t crossings;       /**< pairs of triangles of the input that cross; counted where nothing else
                                   is wrong with it */
    uint64_t crumbs;          /**< small parts and pockets that are not in the mesh: dropped and filled,
                                   also counted in parts_dropped and cavities_dropped */
    uint64_t turned;          /**< AUTO: triangles that faced the other way than their neighbours, or of
                                   bodies inside out beside others (of up to 4,096), and were turned */
    uint64_t thin_voxels;     /**< voxels at walls that the lattice loses: thinner than 1.5 voxels, with no
                                   centre inside to show them */
    uint64_t thin_components; /**< of the input, that have such walls */
    double thin_wall;         /**< nine tenths of these voxels have a wall this thick or thicker; 0: sheets
                                   [Units: world] */
    int32_t thin_low[3], thin_high[3]; /**< the box of these voxels, both ends in it [Units: voxels of
                                            lattice] */
    int32_t thin_resolution; /**< the resolution at which a wall of thin_wall is 1.5 voxels; 0: none, or
                                  none needed */
    int32_t reserved0;
    double parts_volume; /**< the volumes of the input's pieces, each by itself, added up: more than any solid
                              of them has, so that a larger result has walls or rods as thick as voxels; 0:
                              the input is open, or its sides are not known [Units: world] */
    uint64_t reserved[2];
} bvx_repair_report;

typedef struct bvx_repair_options {
    size_t struct_size;
    const bvx_lattice *lattice; /**< to work on [Default: NULL, fitted by resolution with padding of 2
                                     voxels and half a shell] */
    int32_t resolution;         /**< voxels along the longest axis [Limit: 1..2^24] [Default: 256] */
    int32_t sign;               /**< BVX_SIGN_AUTO, EXACT, WINDING or VOTE [Limit: BVX_SIGNS_OF_REPAIR]
                                     [Default: BVX_SIGN_AUTO: WINDING, flipped triangles turned before, or
                                     VOTE where they cannot be oriented] */
    int32_t interpolation;      /**< BVX_EDGE_... [Default: BVX_EDGE_TANGENT] */
    int32_t face_rule;          /**< BVX_FACE_... [Default: BVX_FACE_SEPARATE] */
    int32_t sharp; /**< vertices on sharp edges and corners, as for bvx_extract_field_surface: 0 never, 1
                        always, -1 where a tenth of the mesh's edges are sharp (by 40 degrees), or a
                        hundredth and at most half as many bent (by 15), by length, as in machine parts
                        [Limit: -1..1] [Default: -1] */
    int32_t position_type;     /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO [Limit: 0..2] [Default: BVX_F32] */
    int32_t local_frame;       /**< as for bvx_extract_field_surface [Limit: 0..1] [Default: 0] */
    int32_t measure;           /**< 1: fill the report's distances, from measure_samples points a side
                                    [Limit: 0..1] [Default: 0] */
    double shell;              /**< thickness that open sheets are given [Units: largest spacings] [Limit:
                                    0, or 1.5..10^6; 0: none are made] [Default: 2] */
    uint64_t least_part;       /**< pieces of fewer voxels are dropped [Limit: any] [Default: 0] */
    uint64_t least_cavity;     /**< cavities of fewer voxels are filled [Limit: any] [Default: 0] */
    uint64_t target_triangles; /**< the largest resolution, up to resolution, that a bisection finds not to
                                    exceed it [Limit: any] [Default: 0, none] */
    uint64_t measure_samples;  /**< [Limit: any; with measure 1..2^31-1] [Default: 100000] */
    bvx_repair_report *report; /**< receives what was found and done when not NULL [Default: NULL] */
    int32_t keep_crumbs;       /**< 1: small parts and pockets that are not in the mesh stay: those of at
                                    most 64 voxels or a thousandth of all, without a voxel that has its six
                                    neighbours, beside a larger part of the same piece of the mesh, as
                                    acute edges and narrow grooves leave them [Limit: 0..1] [Default: 0,
                                    they are dropped and filled] */
    int32_t if_needed;         /**< 1: a mesh that needs nothing (the report's needs) is copied: the same
                                    positions and triangles, vertices at one position once, in its own
                                    position_type and without a frame, whatever the other options are
                                    [Limit: 0..1] [Default: 0] */
    int32_t thin; /**< walls of bodies that the lattice loses: BVX_THIN_... [Default: BVX_THIN_KEEP] */
    int32_t reserved0;
    uint64_t reserved[1];
} bvx_repair_options;

BVX_API void bvx_repair_options_init(bvx_repair_options *options, size_t size);

/** Make a closed, manifold, oriented mesh without crossing triangles from any mesh: the guarantee of
 *  marching cubes, whatever the input. Holes get smooth lids, overlapping parts become one, sheets become
 *  shells, walls too thin for the lattice are kept (thin). Details smaller than a voxel are lost, and rods
 *  thinner than one come out thicker. The steps, and what counts as a sheet: docs/rules.md.
 *  mesh      triangles without area are no harm; vertices must be finite, used or not
 *  repaired  as for bvx_extract_surface; its arrays are not the mesh's (BVX_ERR_ARGUMENT)
 *  Returns BVX_ERR_EMPTY (no triangle of area; nothing remains: no inside and no shells wanted, or all
 *  parts below least_part), BVX_ERR_RANGE.
 *  [Memory: the mesh, two grids and what the sign rule needs, then a grid, 32 bytes for each centre next to
 *  the surface and what bvx_measure_field needs a triangle; with a report that of bvx_mesh_check on both
 *  meshes. A scan of 69 thousand triangles: 24 MiB at 256, 112 at 512, with a report 36 and 155] [Cost: the
 *  solid, the closest points of the centres next to the surface, the surface; target_triangles: the solid
 *  for each resolution tried] [Exact: a closed mesh gives the same bytes for any order of triangles, vertices
 *  and corners, and turned inside out]
 *  Source: "Model repair by a vector distance field", with its formula corrected. */
BVX_API bvx_status bvx_repair(bvx_context *context, const bvx_mesh_view *mesh,
                              const bvx_repair_options *options, bvx_mesh *repaired);

/* ---- Levels of detail ---------------------------------------------------------------------------------- */

/** What levels are made from.
 *  AUTO      the mesh itself where it is closed, manifold, oriented and its levels do not cross
 *            themselves, else its measured surface; that too where the mesh itself would exceed the
 *            memory limit
 *  MESH      the mesh itself: closed, manifold and oriented
 *  MEASURED  the surface that bvx_repair makes of the mesh */
#define BVX_LEVELS_LIST(X)        \
    X(BVX_LEVELS_AUTO, 0, "auto") \
    X(BVX_LEVELS_MESH, 1, "mesh") \
    X(BVX_LEVELS_MEASURED, 2, "measured")
enum { BVX_LEVELS_LIST(BVX_LIST_ENUM) };

/** Why levels were made from the measured surface: the first of these that holds. */
enum {
    BVX_MEASURED_NOT = 0,   /**< they were made from the mesh itself */
    BVX_MEASURED_ASKED = 1, /**< chosen by source, or required by an option that only a measured surface
                                 can follow */
    BVX_MEASURED_OPEN = 2,
    BVX_MEASURED_MANIFOLD = 3, /**< the mesh is not manifold */
    BVX_MEASURED_FLIPPED = 4,  /**< neighbours of opposite orientation, or a piece inside out beside others */
    BVX_MEASURED_FLAT = 5,     /**< triangles without area */
    BVX_MEASURED_LARGE = 6,    /**< a scan of more than 500,000 triangles and 24 times those of the finest
                                     level */
    BVX_MEASURED_CROSSINGS = 7, /**< the mesh crosses itself, and so did its levels */
    BVX_MEASURED_MEMORY = 8     /**< as it is the mesh would have exceeded the memory limit */
};

typedef struct bvx_levels_report {
    int32_t source;            /**< BVX_LEVELS_MESH or MEASURED: what the levels were made from */
    int32_t reason;            /**< BVX_MEASURED_... */
    bvx_certificate before;    /**< of the input, vertices at equal positions taken as one */
    uint64_t triangles;        /**< of the surface before edges collapsed */
    uint64_t crossings;        /**< pairs of triangles of the input that cross, where that decided */
    uint64_t crumbs;           /**< pieces of the measured surface that the input has none for, each below
                                    a thousandth of the volume: dropped */
    bvx_repair_report repair;  /**< BVX_LEVELS_MEASURED: what was found and done; its lattice, parts and
                                    shells */
    uint64_t doubles, turned;  /**< open KEEP and CUT: triangles that were there twice, dropped; triangles
                                    turned to agree with their neighbours. Else, of a mesh that was inside
                                    out as a whole: all of them */
    uint64_t refused_edges;    /**< open KEEP: edges that made it impossible, of three triangles or between
                                    two that cannot agree. With CUT such edges became borders */
    double refused_edge[2][3]; /**< ends of the first of them [Units: world] */
    int32_t resolution; /**< BVX_LEVELS_MEASURED without a lattice: voxels along the longest axis, without
                             padding, else 0 */
    int32_t planned_resolution; /**< more than resolution where the memory limit did not allow it: what was
                                     planned */
    int32_t nested; /**< BVX_LEVELS_MESH: 1, closed bodies lie in others and face as they do: what lies in
                         both counts twice. A measured surface has it once */
    int32_t reserved0;
    uint64_t reserved[4];
} bvx_levels_report;

typedef struct bvx_levels_options {
    size_t struct_size;
    const uint64_t *target_triangles; /**< as in bvx_simplify_options; halving starts from the input's
                                           triangles [Default: NULL] */
    const double *target_errors;      /**< as in bvx_simplify_options [Default: NULL] */
    int32_t error_kind;       /**< as in bvx_simplify_options [Limit: 0..1] [Default: BVX_ERROR_MEAN] */
    int32_t position_type;    /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO: the type of a mesh that is
                                   simplified as it is; of a measured surface f32 where it holds, else f64
                                   [Limit: 0..2] [Default: BVX_POSITION_AUTO] */
    double even;              /**< as in bvx_simplify_options [Limit: 0..1] [Default: 1e-9] */
    uint64_t measure_samples; /**< as in bvx_simplify_options [Limit: 0..2^31-1] [Default: 0] */
    int32_t strict;           /**< as in bvx_simplify_options [Limit: 0..1] [Default: 0] */
    int32_t source; /**< BVX_LEVELS_... [Default: BVX_LEVELS_AUTO; MEASURED where a lattice, a resolution,
                         a sign, least_part, least_cavity or outer is given] */
    const bvx_lattice *lattice; /**< measured: to measure on [Default: NULL, fitted by resolution] */
    int32_t resolution;         /**< measured: voxels along the longest axis [Limit: 0..2^24] [Default: 0,
                                     as many as the finest level needs, bvx_plan_levels] */
    int32_t sign;               /**< measured: as in bvx_repair_options [Limit: BVX_SIGNS_OF_REPAIR]
                                     [Default: BVX_SIGN_AUTO] */
    int32_t sharp;              /**< measured: 0 never, 1 always, -1 where many of the mesh's edges are
                                     sharp [Limit: -1..1] [Default: -1] */
    int32_t outer;              /**< measured: 1: inner shells and cavities go [Limit: 0..1] [Default: 0] */
    double shell;          /**< measured: as in bvx_repair_options [Limit: 0, or 1.5..10^6] [Default: 2] */
    uint64_t least_part;   /**< measured: pieces of fewer voxels are dropped [Limit: any] [Default: 0] */
    uint64_t least_cavity; /**< measured: cavities of fewer voxels are filled [Limit: any] [Default: 0] */
    bvx_levels_report *report; /**< receives what was found and done when not NULL [Default: NULL] */
    bvx_level_report *reports; /**< [Size: level_count] filled when not NULL [Default: NULL] */
    int32_t open; /**< BVX_OPEN_...: KEEP and CUT make levels with borders from a mesh with borders, where
                       it can be taken as it is, also one that crosses itself, without options that only a
                       measured surface can follow [Default: BVX_OPEN_SHELL] */
    int32_t reserved0;
    double colour_weight; /**< as in bvx_simplify_options; of a measured surface by the colours of the
                               nearest points [Limit: 0..1] [Default: 0] */
    uint64_t reserved[2];
} bvx_levels_options;

BVX_API void bvx_levels_options_init(bvx_levels_options *options, size_t size);

/** The resolution that bvx_build_levels measures a mesh with where none is given: the one at which the
 *  measured surface has about 16 times the triangles of the finest level, from 256 to 320. mesh and options
 *  as there; options may be NULL.
 *  Returns BVX_ERR_EMPTY, BVX_ERR_RANGE.
 *  [Memory: none] [Cost: O(triangles)] */
BVX_API bvx_status bvx_plan_levels(bvx_context *context, const bvx_mesh_view *mesh,
                                   const bvx_levels_options *options, uint64_t level_count,
                                   int32_t *resolution);

/** Levels of detail from any mesh: the main job.
 *
 *  A mesh that is closed, manifold and oriented is simplified as it is, where its levels do not cross
 *  themselves; of any other mesh the surface is measured first as bvx_repair does. Then edges collapse as
 *  in bvx_mesh_simplify, whose guarantee holds for every level. With open BVX_OPEN_KEEP or CUT a mesh with
 *  borders is simplified as it is too, where bvx_mesh_simplify can take it. When thin walls are kept, and
 *  what is tried under a memory limit: docs/rules.md.
 *  mesh    any mesh with area; vertices must be finite
 *  levels  [Size: level_count] as for bvx_mesh_simplify. After a failure no level remains
 *  Returns BVX_ERR_EMPTY (no triangle of area; nothing remains), BVX_ERR_RANGE, BVX_ERR_BUDGET (names a
 *  limit that suffices). Only where a memory limit makes the lattice coarser can the number of threads show.
 *  [Memory: of n triangles as they are at most 175 bytes each; of a surface of s triangles measured on
 *  grids of g bytes at most the larger of 200 n + 30 s + 5 g and 12 n + 170 s; with either 24 bytes a
 *  border edge, 400 KB, and 1.3 MB a thread above 20,000 triangles] [Cost: that of bvx_repair and
 *  bvx_mesh_simplify]
 *  Source: "Model repair by a vector distance field" for the surface; as bvx_mesh_simplify for the levels. */
BVX_API bvx_status bvx_build_levels(bvx_context *context, const bvx_mesh_view *mesh,
                                    const bvx_levels_options *options, uint64_t level_count,
                                    bvx_mesh *levels);

/* ---- Booleans of meshes -------------------------------------------------------------------------------- */

/** What becomes of two bodies.
 *  UNION         what lies in a or in b
 *  INTERSECTION  what lies in both
 *  DIFFERENCE    what lies in a and not in b
 *  XOR           what lies in only one of them */
#define BVX_BOOLEAN_LIST(X)                        \
    X(BVX_BOOLEAN_UNION, 0, "union")               \
    X(BVX_BOOLEAN_INTERSECTION, 1, "intersection") \
    X(BVX_BOOLEAN_DIFFERENCE, 2, "difference")     \
    X(BVX_BOOLEAN_XOR, 3, "xor")
enum { BVX_BOOLEAN_LIST(BVX_LIST_ENUM) };

typedef struct bvx_boolean_report {
    bvx_lattice lattice;              /**< that the result was made on */
    uint64_t voxels_a, voxels_b;      /**< centres inside each */
    uint64_t voxels;                  /**< inside the result */
    bvx_field_surface_report surface; /**< how the vertices were placed, as of bvx_extract_field_surface */
    int32_t sharp;                    /**< 1: vertices were put on sharp edges and corners */
    int32_t few;                      /**< BVX_FEW_... that the lattice is too coarse for, or 0 */
    int32_t advised_resolution;       /**< where few is not 0: the resolution to take */
    int32_t thin_kept; /**< BVX_KEPT_... of the meshes whose thin walls were kept; those that a report
                            counts are lost else */
    uint64_t crumbs;   /**< small parts and pockets that neither mesh has a part for: dropped and filled */
    uint64_t parts_dropped;            /**< below least_part */
    bvx_solid_report solid_a, solid_b; /**< how each was filled; its volume and thin walls are those of the
                                            fill, before walls are kept */
} bvx_boolean_report;

/** Meshes of which thin walls were kept. */
enum { BVX_KEPT_A = 1, BVX_KEPT_B = 2 };

/** What of an operation has few voxels: fewer than 16 along its longest
 *  axis as far as it lies on the lattice, or none. */
enum { BVX_FEW_A = 1, BVX_FEW_B = 2, BVX_FEW_RESULT = 4 };

typedef struct bvx_boolean_options {
    size_t struct_size;
    const bvx_lattice *lattice; /**< to work on [Default: NULL, fitted by resolution with padding of 1
                                     voxel: of a difference to a, of an intersection to the box that both
                                     have in common (to a where there is none), else to both] */
    int32_t resolution;    /**< voxels along the longest axis of that box [Limit: 1..2^24] [Default: 256] */
    int32_t fill;          /**< what is inside a mesh: BVX_FILL_AUTO, PARITY, NONZERO, VOTE or WINDING
                                [Limit: BVX_FILLS_OF_BOOLEAN] [Default: BVX_FILL_AUTO] */
    int32_t interpolation; /**< BVX_EDGE_... [Default: BVX_EDGE_TANGENT] */
    int32_t face_rule;     /**< BVX_FACE_... [Default: BVX_FACE_SEPARATE] */
    int32_t sharp;         /**< 1: sharp edges of the meshes, and those where they meet, as in
                                bvx_extract_field_surface; 0: none; -1: where one of the meshes has them,
                                as in bvx_repair_options [Limit: -1..1] [Default: -1] */
    int32_t position_type; /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO [Limit: 0..2] [Default: BVX_F32] */
    int32_t local_frame;   /**< as for bvx_extract_field_surface [Limit: 0..1] [Default: 0] */
    int32_t keep_crumbs;   /**< 1: small parts and pockets that neither mesh has a part for stay, as in
                                bvx_repair_options [Limit: 0..1] [Default: 0] */
    bvx_boolean_report *report; /**< receives what was done when not NULL [Default: NULL] */
    uint64_t least_part;        /**< parts of fewer voxels are dropped [Limit: any] [Default: 0] */
    uint64_t reserved[1];
    int32_t thin; /**< walls of the meshes that the lattice loses: BVX_THIN_KEEP (of b in a difference:
                       slots) or BVX_THIN_DROP [Limit: 1..2] [Default: BVX_THIN_KEEP] */
    int32_t reserved1;
} bvx_boolean_options;

BVX_API void bvx_boolean_options_init(bvx_boolean_options *options, size_t size);

/** The union, intersection, difference or symmetric difference of two bodies as a mesh, as exact as the
 *  lattice is fine. Both are filled on one lattice, the bits are combined, and each vertex lies where the
 *  mesh whose side changes there cuts its edge. The guarantee is that of bvx_extract_field_surface,
 *  whatever the meshes are. Thin walls of the meshes are kept (thin); what the operation itself makes
 *  thinner than a voxel may be lost. The report says what has few voxels, and the resolution to take.
 *  operation  BVX_BOOLEAN_...
 *  result     as for bvx_extract_surface; its arrays are not those of a or b (BVX_ERR_ARGUMENT). Empty, and
 *             no error, where no centre lies inside, as in the intersection of bodies that are apart
 *  Returns BVX_ERR_EMPTY (a mesh without a triangle of area, or one on the lattice without any centre
 *  inside), BVX_ERR_RANGE (as bvx_voxelize_solid; f32 as in bvx_extract_surface).
 *  [Memory: the mesh, five grids (thin walls: two more, and 12 bytes a triangle near them), 16 bytes a row,
 *  32 (sharp: 36) for each centre next to a mesh's part of the surface; in turns what bvx_voxelize_solid
 *  needs and what bvx_measure_field needs a triangle] [Cost: two solids, O(triangles log triangles), the
 *  closest points of these centres, the surface] */
BVX_API bvx_status bvx_boolean(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b,
                               int32_t operation, const bvx_boolean_options *options, bvx_mesh *result);

/* ---- Levels by samples --------------------------------------------------------------------------------- */

/** How levels are sampled.
 *  EDGE_RATIO  the paper's: samples of the extended voxel function, first change along an edge
 *  COVERAGE    fraction of set voxels in the sample's box, linear positions */
#define BVX_LOD_LIST(X)                    \
    X(BVX_LOD_EDGE_RATIO, 1, "edge-ratio") \
    X(BVX_LOD_COVERAGE, 2, "coverage")
enum { BVX_LOD_LIST(BVX_LIST_ENUM) };

typedef struct bvx_lod_report {
    int32_t resolution[3]; /**< samples along each axis */
    int32_t reserved;
    double ratio[3]; /**< voxels a sample along each axis */
    uint64_t vertices, triangles;
    uint64_t searched;      /**< resolutions that the search for a triangle count tried */
    int32_t exceeds_source; /**< 1: more triangles than source_triangles: a simplification rate above 1 */
    int32_t reserved2;
} bvx_lod_report;

typedef struct bvx_lod_options {
    size_t struct_size;
    int32_t method; /**< BVX_LOD_... [Default: BVX_LOD_EDGE_RATIO, nearer to the original where measured] */
    int32_t edge_samples;       /**< steps along an edge, edge ratio only [Limit: 0..65536] [Default: 0,
                                     the ratio rounded up] */
    double threshold;           /**< inside means above it [Limit: > 0, < 1; kept to 2^-16] [Default: 0.5] */
    const int32_t *resolutions; /**< samples along the longest axis of each level [Size: level_count]
                                     [Default: NULL] */
    const int32_t *axis_resolutions;  /**< samples along x, y, z of each level [Size: level_count * 3]
                                           [Default: NULL] */
    const uint64_t *target_triangles; /**< most triangles of each level [Size: level_count] [Default: NULL] */
    uint64_t source_triangles; /**< triangles of the mesh that the grid was made from, for exceeds_source
                                    [Limit: any] [Default: 0, unknown] */
    int32_t face_rule;         /**< BVX_FACE_... [Default: BVX_FACE_SEPARATE] */
    int32_t position_type;     /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO [Limit: 0..2] [Default: BVX_F32] */
    int32_t local_frame;       /**< 1: positions relative to the grid's low corner, which goes to frame
                                    [Limit: 0..1] [Default: 0] */
    int32_t first_level;       /**< index of levels[0] in messages, where a chain is made one level a call
                                    [Limit: >= 0] [Default: 0] */
    double collapse;           /**< target_triangles only: make the level with up to this many times its
                                    target, then collapse the edges that cost least [Limit: 0, or 1..64]
                                    [Default: 0, no collapse] */
    bvx_lod_report *reports;   /**< [Size: level_count] filled when not NULL [Default: NULL] */
} bvx_lod_options;

BVX_API void bvx_lod_options_init(bvx_lod_options *options, size_t size);

/** The resolution of the solid that bvx_build_lods makes these levels of: eight times the samples of the
 *  finest level along the longest axis, at most 2^20; fewer where the solid would take more than 1 GiB or
 *  more than half of what the memory limit leaves, and never below the finest level. A level by triangles
 *  is as fine as the mesh's area says. padding: voxels added on every side of the solid. mesh: what is
 *  voxelized. options: resolutions, axis_resolutions or target_triangles, and collapse. limited, where not
 *  NULL, receives 1 when memory decided, else 0.
 *  Returns BVX_ERR_EMPTY (no triangles, or all in one point), BVX_ERR_RANGE.
 *  [Memory: none] [Cost: O(vertices + triangles)] */
BVX_API bvx_status bvx_plan_lods(bvx_context *context, const bvx_mesh_view *mesh,
                                 const bvx_lod_options *options, uint64_t level_count, int32_t padding,
                                 int32_t *resolution, int32_t *limited);

/** Closed meshes of several sizes from one solid. Each level lays a coarser lattice over the grid, n voxels
 *  to r samples along an axis (any ratio n/r >= 1, one for all axes unless set otherwise); sample i stands
 *  in the middle of its stretch [i n/r, (i+1) n/r) of voxels, so nothing shifts or shrinks. Each level is
 *  closed, outwards, edge- and vertex-manifold.
 *  Returns BVX_ERR_RANGE (a resolution above the grid's; f32 as in bvx_extract_surface), BVX_ERR_EMPTY (a
 *  level that keeps nothing, named). After a failure no level remains: meshes that the library made, also
 *  in an earlier call, are freed.
 *  Exactly one of resolutions, axis_resolutions and target_triangles is given. A target takes the
 *  largest resolution that a bisection finds not to exceed it; one below the coarsest level's triangles is
 *  an error. collapse 2 to 4 puts triangles where the surface bends: at equal count 1.6 to 2.4 times nearer
 *  to a scanned dragon, at the price of even triangles and of time (docs/rules.md). [Memory: the meshes,
 *  one coarse grid, 24 bytes a sample row and column (coverage: and 4 bytes a sample; collapse: and about
 *  300 bytes a vertex before it)] [Cost: O(words + samples) a level, collapse O(triangles log triangles)]
 *  Source: "LOD by voxelization and downsampling" 2.4, with the position inside the step and the phase
 *  defined. */
BVX_API bvx_status bvx_build_lods(bvx_context *context, const bvx_grid *solid, const bvx_lod_options *options,
                                  uint64_t level_count, bvx_mesh *levels);

/* ---- Closest points ------------------------------------------------------------------------------------ */

/** A mesh prepared for searches of nearest points. It keeps what it needs: the view may be freed. */
typedef struct bvx_closest bvx_closest;

/** Where on a mesh a point's nearest point lies. */
typedef struct bvx_closest_point {
    double position[3]; /**< the nearest point [Units: world] */
    double distance;    /**< [Units: world] */
    double weight[3];   /**< barycentric coordinates of position in the triangle: not negative, their sum
                             is 1 but for rounding */
    uint32_t triangle;  /**< the lowest index among the triangles at that distance */
    int32_t feature;    /**< 0: inside the triangle; 1, 2, 3: on the edge of corners 0-1, 1-2, 2-0; 4, 5,
                             6: corner 0, 1, 2 */
} bvx_closest_point;

/** Prepare a mesh.
 *  Returns BVX_ERR_EMPTY (no triangle), BVX_ERR_RANGE (index or coordinate).
 *  [Memory: 72 bytes a triangle (f64: 108)] [Cost: O(triangles log triangles)] */
BVX_API bvx_status bvx_closest_create(bvx_context *context, const bvx_mesh_view *mesh, bvx_closest **closest);

/** The nearest points of count points, x y z each [Units: world]. Distances are those of one stated
 *  evaluation in doubles, so results depend on nothing but mesh and point.
 *  Returns BVX_ERR_RANGE (a point that is not finite, with its index).
 *  [Memory: none up to 64 points, else 24 bytes a point, at most 1.5 MiB] [Cost: O(log triangles) a point
 *  near the surface, more far off (distance is infinity where it is beyond the largest double)] */
BVX_API bvx_status bvx_closest_find(bvx_context *context, const bvx_closest *closest, const double *points,
                                    uint64_t count, bvx_closest_point *found);

/** Free what bvx_closest_create allocated; NULL is allowed. */
BVX_API void bvx_closest_free(bvx_context *context, bvx_closest *closest);

/** Give the vertices of a mesh the colours and texture coordinates of the source's nearest points, by
 *  barycentric weights in the source's triangle; colours are rounded to the nearest. What the source does
 *  not have is left unchanged; what the target has is replaced. target's other arrays are not touched; it
 *  must be one that the library made (owned). A vertex has one texture coordinate, so a target's triangle
 *  over a seam of the texture stretches across it.
 *  Returns BVX_ERR_EMPTY, BVX_ERR_RANGE.
 *  [Memory: that of bvx_closest_create, and the new arrays] */
BVX_API bvx_status bvx_mesh_carry(bvx_context *context, const bvx_mesh *source, bvx_mesh *target);

/* ---- Distance fields ----------------------------------------------------------------------------------- */

/** Values at centres of voxels: where the closest point of a mesh lies, and on which side. Value n is that
 *  of set voxel n of band, counted in the order of its bits (z, y, x). */
typedef struct bvx_field {
    bvx_grid band;        /**< set: centres that have a value */
    bvx_grid inside;      /**< set: centres inside, in all of the window; all zero, without words, for
                               BVX_SIGN_NONE. NORMAL, PSEUDONORMAL: beyond the band as the first side that
                               comes from it, a voxel a step through faces, and outside where both come at
                               once */
    uint64_t *row_values; /**< index of each row's first value, row z * size[1] + y [Size: rows + 1] */
    uint64_t value_count; /**< row_values[rows] */
    void *vectors;   /**< from the centre to the closest point, x y z; float or double [Size: value_count *
                          3] [Units: world] */
    void *distances; /**< negative inside (-0 on the surface); float or double [Size: value_count] [Units:
                          world] */
    uint32_t *triangles; /**< the closest triangle, or NULL [Size: value_count] */
    uint8_t *features;   /**< where on it, as in bvx_closest_point, or NULL [Size: value_count] */
    int32_t value_type;  /**< BVX_F32 or BVX_F64 */
    int32_t sign;        /**< BVX_SIGN_... that decided */
    double half_width;   /**< of the band; infinity: every centre has a value [Units: world] */
    uint64_t reserved[4];
} bvx_field;

/** Free what the library allocated and zero the struct. */
BVX_API void bvx_field_free(bvx_context *context, bvx_field *field);

typedef struct bvx_field_options {
    size_t struct_size;
    double half_width;  /**< of the band, Euclidean [Units: largest spacings] [Limit: > 0; infinity: all
                             centres] [Default: 3] */
    int32_t sign;       /**< BVX_SIGN_... [Default: BVX_SIGN_AUTO] */
    int32_t value_type; /**< BVX_F32 (spacings of 2^-100 to 2^100) or BVX_F64 [Limit: 1..2] [Default:
                             BVX_F32] */
    bvx_window window;  /**< [Default: all zero, the whole lattice] */
    int32_t no_vectors; /**< 1: vectors stay NULL [Limit: 0..1] [Default: 0] */
    int32_t features;   /**< 1: fill triangles and features [Limit: 0..1] [Default: 0] */
    uint64_t reserved[2];
} bvx_field_options;

BVX_API void bvx_field_options_init(bvx_field_options *options, size_t size);

/** Measure the distance from the centres of voxels to a mesh. The closest point is the one with the lowest
 *  (distance squared, triangle index) by one stated evaluation in doubles. On closed meshes all signs but
 *  NORMAL agree, up to the lattice's fixed point; how each decides at edges, vertices and holes:
 *  docs/rules.md.
 *  mesh   triangles counter-clockwise seen from outside for NORMAL and PSEUDONORMAL [Limit: (2^32 - 1) / 3
 *         triangles for AUTO and PSEUDONORMAL]
 *  field  out, zeroed; freed by bvx_field_free
 *  Returns BVX_ERR_ARGUMENT (also a field that holds arrays), BVX_ERR_EMPTY (no triangle, or none of area),
 *  BVX_ERR_RANGE (index or coordinate; EXACT, WINDING and VOTE: also what bvx_voxelize_solid finds too far
 *  from the lattice; voxels or distances that floats do not hold: take BVX_F64).
 *  [Memory: two grids, 8 bytes a row, 16 a value (f64: 32; without vectors 4 or 8), 5 a value for features;
 *  about that of bvx_closest_create; that of the sign: docs/rules.md] [Cost: O(triangles log triangles +
 *  values log triangles) and that of the sign] [Exact: the bytes depend on nothing but mesh and lattice; a
 *  window holds the values of the whole. EXACT, WINDING, VOTE: inside is bvx_voxelize_solid's by that rule,
 *  bit for bit]
 *  Source: "Model repair by a vector distance field"; Baerentzen, Aanaes. Signed Distance Computation Using
 *  the Angle Weighted Pseudonormal. 2005. */
BVX_API bvx_status bvx_measure_field(bvx_context *context, const bvx_mesh_view *mesh,
                                     const bvx_lattice *lattice, const bvx_field_options *options,
                                     bvx_field *field);

/** Index of the value at voxel (x,y,z) of the window, or UINT64_MAX where it has none.
 *  [Cost: O(words of a row)] */
BVX_API uint64_t bvx_field_value(const bvx_field *field, int32_t x, int32_t y, int32_t z);

/** What a dense field holds where the band has no value. */
enum {
    BVX_FAR_CONSTANT = 0,  /**< half_width, negative inside; vectors 0 */
    BVX_FAR_PROPAGATED = 1 /**< from neighbours: the exact distance to one of the triangles that are
                                closest to centres of the band */
};

/** A field as one value for every centre of the window, x fastest, then y, then z.
 *  far_rule  BVX_FAR_...: PROPAGATED needs the mesh and features in the field; its distances are never
 *            below the true ones (0.01 to 0.07 % over on average with bands of three voxels: docs/rules.md)
 *  vectors   0: signed distances, 1: vectors, three floats each
 *  values    [Size: size[0] * size[1] * size[2], times 3 for vectors]; what is beyond the largest float is
 *            infinite
 *  Returns BVX_ERR_ARGUMENT (also a field whose numbers of rows are not those of its band), BVX_ERR_EMPTY
 *  (PROPAGATED: no value), BVX_ERR_LATTICE, BVX_ERR_RANGE.
 *  [Memory: none; PROPAGATED: 4 bytes a voxel, 12 a value] [Cost: O(voxels)] [Exact: CONSTANT, and a field
 *  whose half_width is infinity. PROPAGATED uses only the window's band, so a window may hold larger
 *  distances than the whole there]
 *  Source: Danielsson. Euclidean Distance Mapping. 1980, re-measured. */
BVX_API bvx_status bvx_field_dense(bvx_context *context, const bvx_field *field, const bvx_mesh_view *mesh,
                                   int32_t far_rule, int32_t vectors, float *values);

typedef struct bvx_field_surface_options {
    size_t struct_size;
    int32_t interpolation; /**< BVX_EDGE_... [Default: BVX_EDGE_TANGENT, nearest to the mesh where
                                measured] */
    int32_t face_rule;     /**< BVX_FACE_... [Default: BVX_FACE_SEPARATE] */
    int32_t position_type; /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO [Limit: 0..2] [Default: BVX_F32] */
    int32_t local_frame;   /**< 1: positions relative to the lattice's origin, which goes to frame [Limit:
                                0..1] [Default: 0] */
    int32_t sharp;         /**< 1: cells on sharp edges and corners get a vertex there, and cuts move to
                                the closest triangles' planes where the field has triangles and the mesh is
                                given; -1: where the mesh, which must be given, has sharp edges [Limit:
                                -1..1] [Default: 0] */
    int32_t reserved;
    double sharp_angle; /**< sharp: facets that meet at less than this are smooth [Units: cosine of the
                             angle between their normals] [Limit: -1..1] [Default: 0.8] */
    bvx_field_surface_report *report; /**< receives counts when not NULL [Default: NULL] */
    const bvx_grid *grid; /**< other voxels of the field's window, made from its inside by whatever changes
                               voxels, whose surface is computed: where it is that of inside, vertices are
                               the field's, elsewhere those of offset, or in the middle of their edges
                               [Default: NULL, inside] */
    double offset; /**< grid: where this distance to the mesh, negative inside, lies between the ends of an
                        edge, the vertex stands there: bodies made thicker, thinner or hollow; 0: no such
                        surface [Units: world] [Limit: any] [Default: 0] */
} bvx_field_surface_options;

BVX_API void bvx_field_surface_options_init(bvx_field_surface_options *options, size_t size);

/** The surface between inside and outside centres of a field, by marching cubes with vertices where the
 *  field has the surface. Closed, outwards, edge- and vertex-manifold, without crossing triangles, for
 *  every field; order as in bvx_extract_surface (sharp: vertices of cells come after those of edges, in
 *  order of their cells). Beyond the window counts as outside.
 *  mesh  the mesh that the field was measured from; used only for sharp, with field->triangles, which it
 *        needs to know facets; without either sharp uses the vectors, which is nearly as good
 *  Returns as bvx_extract_surface; BVX_ERR_ARGUMENT also for a field without inside, or without vectors
 *  where they are needed, or whose row_values are not those of its band; BVX_ERR_RANGE also for triangles
 *  that the mesh does not have, and for f64 whose steps exceed 1/512 of a voxel; BVX_ERR_LATTICE (band,
 *  inside or options.grid differ).
 *  [Memory: the mesh and 16 bytes a row; sharp: the mesh once more, 32 bytes a vertex, 40 a sharp cell]
 *  [Cost: O(words + crossings), one thread 20 ns a triangle; sharp 120 ns]
 *  Source: "Model repair by a vector distance field" 2.3, its formula corrected; for sharp Kobbelt, Botsch,
 *  Schwanecke, Seidel. Feature Sensitive Surface Extraction from Volume Data. 2001. */
BVX_API bvx_status bvx_extract_field_surface(bvx_context *context, const bvx_field *field,
                                             const bvx_mesh_view *mesh,
                                             const bvx_field_surface_options *options, bvx_mesh *surface);

/* ---- Set algebra --------------------------------------------------------------------------------------- */

/** Two grids of one lattice and window combined, 64 voxels at a time: a or b; a and b; a without b; one of
 *  both.
 *  result  zeroed, or with words of the caller's, or one of the operands itself (in place; after
 *          BVX_CANCELLED its bits are then valid but unspecified)
 *  Returns BVX_ERR_LATTICE (their lattices or windows differ, and in which field).
 *  [Memory: the result] [Cost: O(words)] */
BVX_API bvx_status bvx_grid_union(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                                  bvx_grid *result);
BVX_API bvx_status bvx_grid_intersection(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                                         bvx_grid *result);
BVX_API bvx_status bvx_grid_subtract(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                                     bvx_grid *result);
BVX_API bvx_status bvx_grid_xor(bvx_context *context, const bvx_grid *a, const bvx_grid *b, bvx_grid *result);

/** The voxels of the window that are not set in a grid. As bvx_grid_union, also in place. */
BVX_API bvx_status bvx_grid_complement(bvx_context *context, const bvx_grid *grid, bvx_grid *result);

/** The same set on another lattice: a voxel is set when its centre lies in a set voxel of grid (half-open
 *  boxes: a centre on a face belongs to the upper voxel). Beyond the grid's window all is empty. It
 *  samples, so what lies between centres is lost: for integer factors take bvx_grid_downsample.
 *  window  of lattice; NULL or all zero: all of it
 *  result  zeroed, or with words of the caller's, not those of grid
 *  Returns BVX_ERR_RANGE (an invalid lattice or window).
 *  [Memory: the result, 4 bytes for each voxel of a line along each axis] [Cost: O(words of the result +
 *  runs)] [Exact: along each axis the voxel is floor((centre - origin) / spacing) in doubles, centre = the
 *  other origin + (index + 1/2) * its spacing: the same bits everywhere, and a window holds those of the
 *  whole] */
BVX_API bvx_status bvx_grid_resample(bvx_context *context, const bvx_grid *grid, const bvx_lattice *lattice,
                                     const bvx_window *window, bvx_grid *result);

/** When a block of voxels becomes a set voxel.
 *  ANY       one of its voxels is set
 *  ALL       all are
 *  MAJORITY  more than half are */
#define BVX_REDUCE_LIST(X)      \
    X(BVX_REDUCE_ANY, 0, "any") \
    X(BVX_REDUCE_ALL, 1, "all") \
    X(BVX_REDUCE_MAJORITY, 2, "majority")
enum { BVX_REDUCE_LIST(BVX_LIST_ENUM) };

/** Blocks of factor[0] x factor[1] x factor[2] voxels become voxels. Blocks are counted from the lattice's
 *  low corner; one that the window or the lattice cuts is judged by the voxels that it has in the window.
 *  The new lattice has the old origin, spacing * factor, and dims / factor rounded up; the window has every
 *  block that the old one reaches into.
 *  factor  [Limit: 1..2^25 each, and fewer than 2^32 voxels of the lattice in a block]
 *  rule    BVX_REDUCE_...
 *  result  zeroed, or with words of the caller's, not those of grid
 *  Returns BVX_ERR_RANGE (too many voxels a block, spacing beyond doubles).
 *  [Memory: the result, 64 bytes for each word of a row, and 24 bytes times the binary digits of a block's
 *  voxels for each word of a row and worker] [Cost: O(words)] [Exact: yes; windows whose sides lie between
 *  blocks hold the bits of the whole] */
BVX_API bvx_status bvx_grid_downsample(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                                       int32_t rule, bvx_grid *result);

/** The number of set voxels in each of these blocks, x fastest, then y, then z.
 *  counts  [Size: capacity] NULL: count only
 *  count   out; the product of the result's sizes of bvx_grid_downsample
 *  Returns BVX_ERR_CAPACITY (count is then what there are), and as bvx_grid_downsample. */
BVX_API bvx_status bvx_grid_coverage(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                                     uint32_t *counts, uint64_t capacity, uint64_t *count);

/** The smallest window that holds all set voxels, counted from the lattice's corner as bvx_grid_crop takes
 *  it; all zero, which elsewhere stands for the whole lattice, when none is set.
 *  [Memory: 24 bytes for each of up to 256 parts] [Cost: O(words)] */
BVX_API bvx_status bvx_grid_content(bvx_context *context, const bvx_grid *grid, bvx_window *window);

/** The same lattice through another window, which may reach beyond the grid's own, where all is empty.
 *  window  NULL or all zero: the whole lattice
 *  result  zeroed, or with words of the caller's, not those of grid
 *  Returns BVX_ERR_RANGE (a window outside the lattice).
 *  [Memory: the result] [Cost: O(words of the result)] */
BVX_API bvx_status bvx_grid_crop(bvx_context *context, const bvx_grid *grid, const bvx_window *window,
                                 bvx_grid *result);

/** A lattice that has low more empty voxels before its first ones along each axis, and high more after its
 *  last ones. The window grows in the same way, and nothing moves in the world: the new origin is origin -
 *  low * spacing.
 *  low, high  [Limit: 0 and more, dims up to 2^25]
 *  Returns as bvx_grid_crop. */
BVX_API bvx_status bvx_grid_pad(bvx_context *context, const bvx_grid *grid, const int32_t low[3],
                                const int32_t high[3], bvx_grid *result);

/** Axes changed: axis a of the result is axis axes[a] of the grid, running backwards where flips[a] is 1.
 *  The lattice is permuted too: origin, spacing, dims and window; a flip mirrors the lattice's box in
 *  itself, so the origin stays.
 *  axes    0, 1, 2 in any order
 *  flips   0 or 1 each; NULL: none
 *  result  zeroed, or with words of the caller's, not those of grid
 *  [Memory: the result] [Cost: O(words), rows that turn in blocks of 64 x 64 bits] */
BVX_API bvx_status bvx_grid_permute(bvx_context *context, const bvx_grid *grid, const int32_t axes[3],
                                    const int32_t flips[3], bvx_grid *result);

/* ---- Morphology and distances -------------------------------------------------------------------------- */

typedef struct bvx_morph_options {
    size_t struct_size;
    int32_t neighbourhood; /**< 6: voxels across faces, 18: and edges, 26: and corners; 0: a ball [Limit:
                                0, or 6, or 18, or 26] [Default: 6] */
    int32_t steps;         /**< how many times the neighbourhood is applied; a ball takes 1 [Limit:
                                1..65536] [Default: 1] */
    double radius;         /**< of the ball: centres at most so far are in it, Euclidean, with 2^-40 of it
                                to spare, so that 0.3 reaches three voxels of 0.1 [Units: world] [Limit: >=
                                0] [Default: 0] */
    int32_t beyond; /**< what lies beyond the window: 0 empty, 1 set voxels [Limit: 0..1] [Default: 0] */
    int32_t reserved;
} bvx_morph_options;

BVX_API void bvx_morph_options_init(bvx_morph_options *options, size_t size);

/** Grow and shrink a set of voxels by its neighbours or by a ball, as in unbounded space with beyond
 *  outside the window.
 *  dilate  voxels that have a set one within the neighbourhood (steps times) or the ball
 *  erode   voxels that have no empty one there
 *  open    eroded, then dilated: what is too thin to hold the neighbourhood goes; a subset of the grid
 *  close   dilated, then eroded: gaps that cannot hold it are filled; a superset of the grid
 *  result  zeroed, or with words of the caller's, which are not the grid's; of the grid's lattice and
 *          window
 *  Options NULL: one voxel across faces.
 *  Returns BVX_ERR_RANGE (a ball: spacings beyond 2^-400 .. 2^400).
 *  [Memory: the result, and some slices for each worker; balls of more than 35 voxels up to 136 bytes a
 *  row; open and close with a ball one or two more grids (docs/rules.md)] [Cost: O(words * steps); a ball:
 *  O(words * radius^2), at most O(voxels)] [Exact: yes; a window with a halo of the reach (open, close:
 *  twice) holds the bits of the whole]
 *  Source: Serra. Image Analysis and Mathematical Morphology. 1982; for the ball as bvx_grid_distance. */
BVX_API bvx_status bvx_grid_dilate(bvx_context *context, const bvx_grid *grid,
                                   const bvx_morph_options *options, bvx_grid *result);
BVX_API bvx_status bvx_grid_erode(bvx_context *context, const bvx_grid *grid,
                                  const bvx_morph_options *options, bvx_grid *result);
BVX_API bvx_status bvx_grid_open(bvx_context *context, const bvx_grid *grid, const bvx_morph_options *options,
                                 bvx_grid *result);
BVX_API bvx_status bvx_grid_close(bvx_context *context, const bvx_grid *grid,
                                  const bvx_morph_options *options, bvx_grid *result);

typedef struct bvx_hollow_report {
    uint64_t hollowed; /**< voxels that became empty inside */
    uint64_t drained;  /**< voxels that the drain hole took */
    double drain[3];   /**< centre of the voxel where the hole meets the hollow; 0 without a hole [Units:
                            world] */
    uint64_t reserved[4];
} bvx_hollow_report;

typedef struct bvx_hollow_options {
    size_t struct_size;
    double thickness;     /**< of the shell that stays: set voxels whose nearest empty centre is at most so
                               far, with 2^-40 to spare [Units: world] [Limit: any; a voxel or more along
                               every axis] [Default: 0, must be set] */
    double drain_radius;  /**< of a round hole through the shell; 0: none [Units: world] [Limit: >= 0]
                               [Default: 0] */
    int32_t drain_side;   /**< the side that it comes from, BVX_OPEN_... [Limit: 1, or 2, or 4, or 8, or
                               16, or 32] [Default: BVX_OPEN_Z_LOW] */
    int32_t drain_placed; /**< 1: the hole's axis goes through drain_at; 0: through the middle of the
                               hollow's layer nearest to that side, or the voxel of the layer nearest to it
                               [Limit: 0..1] [Default: 0] */
    double drain_at[2];   /**< the other two coordinates, x before y before z [Units: world] [Limit: any]
                               [Default: 0] */
    int32_t beyond; /**< what lies beyond the window: 0 empty, 1 set voxels [Limit: 0..1] [Default: 0] */
    int32_t reserved;
    bvx_hollow_report *report; /**< receives counts when not NULL [Default: NULL] */
} bvx_hollow_options;

BVX_API void bvx_hollow_options_init(bvx_hollow_options *options, size_t size);

/** Leave a shell of a body: voxels deeper than thickness become empty, the outer surface stays but for the
 *  drain hole. The hole takes the set voxels whose centre lies within drain_radius of its axis, from its
 *  side to where the axis first meets the hollow; parts of the hollow that are not joined there stay
 *  closed. Where nothing is deep enough the result is the grid itself, without a hole.
 *  result  zeroed, or with words of the caller's, which are not the grid's
 *  Returns BVX_ERR_ARGUMENT (also a drain_at whose axis meets no hollow), BVX_ERR_RANGE (a thickness below
 *  a voxel, which would leave no shell), and as bvx_grid_erode with a ball. Memory and cost: of
 *  bvx_grid_erode with a ball.
 *  [Exact: yes] */
BVX_API bvx_status bvx_grid_hollow(bvx_context *context, const bvx_grid *grid,
                                   const bvx_hollow_options *options, bvx_grid *result);

/** Which distances are wanted.
 *  OUTSIDE  of every centre to the nearest set one: 0 on set voxels
 *  INSIDE   of every centre to the nearest empty one: 0 on empty voxels
 *  SIGNED   outside less inside: negative on set voxels, never 0 */
#define BVX_DISTANCE_LIST(X)              \
    X(BVX_DISTANCE_OUTSIDE, 0, "outside") \
    X(BVX_DISTANCE_INSIDE, 1, "inside")   \
    X(BVX_DISTANCE_SIGNED, 2, "signed")
enum { BVX_DISTANCE_LIST(BVX_LIST_ENUM) };

/** What lies beyond the window.
 *  NOTHING  no voxels at all
 *  EMPTY    empty voxels
 *  SET      set voxels */
#define BVX_BEYOND_LIST(X)              \
    X(BVX_BEYOND_NOTHING, 0, "nothing") \
    X(BVX_BEYOND_EMPTY, 1, "empty")     \
    X(BVX_BEYOND_SET, 2, "set")
enum { BVX_BEYOND_LIST(BVX_LIST_ENUM) };

typedef struct bvx_distance_options {
    size_t struct_size;
    int32_t side;      /**< BVX_DISTANCE_... [Default: BVX_DISTANCE_OUTSIDE] */
    int32_t beyond;    /**< BVX_BEYOND_... [Default: BVX_BEYOND_NOTHING] */
    uint64_t *nearest; /**< receives for each voxel the linear index x + nx * (y + ny * z) in the window of
                            the one that its distance is to, the lowest index of equally near ones,
                            UINT64_MAX where there is none in the window [Size: nx * ny * nz] [Default:
                            NULL] */
    uint64_t reserved[2];
} bvx_distance_options;

BVX_API void bvx_distance_options_init(bvx_distance_options *options, size_t size);

/** The exact Euclidean distance between centres of voxels, for every voxel of the window, x fastest, then
 *  y, then z. Infinite where there is no such voxel (SIGNED: negative on set voxels).
 *  value_type  BVX_F32 or BVX_F64; the last rounding
 *  values      [Size: nx * ny * nz] [Units: world]
 *  capacity    numbers that values holds
 *  Returns BVX_ERR_RANGE (spacings beyond 2^-400 .. 2^400, for BVX_F32 beyond 2^-100 .. 2^100).
 *  [Memory: 264 bytes a row (520 where voxels are not cubic; nearest: 512 more), and 350 to 1300 a voxel of
 *  the longer side along y or z for each worker] [Cost: O(voxels), SIGNED twice] [Exact: which voxel is
 *  nearest is decided without rounding; of cubic voxels the square is an integer. A window with a halo
 *  holds the values of the whole up to the distance to the halo's end]
 *  Source: Meijster, Roerdink, Hesselink. A General Algorithm for Computing Distance Transforms in Linear
 *  Time. 2000. */
BVX_API bvx_status bvx_grid_distance(bvx_context *context, const bvx_grid *grid,
                                     const bvx_distance_options *options, int32_t value_type, void *values,
                                     uint64_t capacity);

/** The squares as integers, for cubic voxels [Units: voxels^2]; UINT32_MAX where there is no such voxel.
 *  OUTSIDE and INSIDE.
 *  Returns as bvx_grid_distance; BVX_ERR_ARGUMENT also for SIGNED and for voxels that are not cubic,
 *  BVX_ERR_RANGE for windows whose squared diagonal is 2^32 - 2^16 or more (bvx_grid_distance has no such
 *  limit). */
BVX_API bvx_status bvx_grid_distance_squares(bvx_context *context, const bvx_grid *grid,
                                             const bvx_distance_options *options, uint32_t *squares,
                                             uint64_t capacity);

/* ---- Components ---------------------------------------------------------------------------------------- */

/** A connected component of a grid's set voxels; its index is its position in the list. All in voxels of
 *  the grid's window. */
typedef struct bvx_component {
    uint64_t first;  /**< its first voxel: x + size[0] * (y + size[1] * z) */
    uint64_t voxels; /**< how many it has */
    int32_t low[3];  /**< box of its voxels: the lowest index along each axis [Units: voxels] */
    int32_t size[3]; /**< and how many voxels it spans [Units: voxels] */
    uint64_t reserved;
} bvx_component;

/** The connected components of a grid, in the order of their first voxels (z, y, x).
 *  connectivity  6: across faces; 18: and edges; 26: and corners
 *  parts         out, or NULL: only count them [Size: capacity]
 *  count         out: how many there are, also when capacity is too small
 *  Returns BVX_ERR_RANGE (2^32 - 1 runs of voxels along x or more).
 *  [Memory: 4 bytes a run and 24 for each word of a slice] [Cost: O(words + runs). Global: parts of a
 *  window are those of the voxels in it]
 *  Source: Rosenfeld, Pfaltz 1966, on runs, with pairs of touching runs found 64 voxels at a time. */
BVX_API bvx_status bvx_grid_components(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                       bvx_component *parts, uint64_t capacity, uint64_t *count);

/** Label the voxels of a window by their component, x fastest: 0 for empty ones, 1 for the component with
 *  the lowest voxel, and so on in the order of bvx_grid_components. labels [Size: capacity, size[0] *
 *  size[1] * size[2] at least]; count: how many components (may be NULL).
 *  Returns what bvx_grid_components returns.
 *  [Memory: its] [Cost: O(voxels)] */
BVX_API bvx_status bvx_grid_label(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                  uint32_t *labels, uint64_t capacity, uint64_t *count);

typedef struct bvx_keep_report {
    uint64_t kept, dropped; /**< parts */
    uint64_t voxels_kept, voxels_dropped;
    uint64_t reserved[4];
} bvx_keep_report;

typedef struct bvx_keep_options {
    size_t struct_size;
    int32_t connectivity; /**< 6, 18 or 26 [Limit: 6, or 18, or 26] [Default: 6] */
    int32_t reserved;
    uint64_t at_least;       /**< components of fewer voxels are dropped [Limit: any] [Default: 0, none is] */
    const int32_t *seeds;    /**< voxels of the window, x y z each; components that hold none of them are
                                  dropped (a seed on an empty voxel says nothing) [Size: seed_count * 3]
                                  [Default: NULL] */
    uint64_t seed_count;     /**< [Limit: any] [Default: 0, seeds are ignored] */
    uint64_t largest;        /**< of what remains, so many of the largest are kept, of equal ones those
                                  with the lower first voxel [Limit: any] [Default: 0, all] */
    bvx_keep_report *report; /**< receives counts when not NULL [Default: NULL] */
} bvx_keep_options;

BVX_API void bvx_keep_options_init(bvx_keep_options *options, size_t size);

/** Keep some of a grid's components. result: zeroed, or with words of the caller's, or the grid itself.
 *  Returns BVX_ERR_ARGUMENT (also a seed outside the window, with its index), BVX_ERR_RANGE.
 *  [Memory: the result, that of bvx_grid_components, and 9 bytes a part] [Cost: O(words + runs)] */
BVX_API bvx_status bvx_grid_keep(bvx_context *context, const bvx_grid *grid, const bvx_keep_options *options,
                                 bvx_grid *result);

/** Fill the cavities of a grid: parts of its empty voxels that do not touch a side of its window.
 *  connectivity  6, 18 or 26, of the empty voxels: with 6 a cavity ends where only edges or corners lead on
 *  at_most       larger cavities stay [Units: voxels] [Default: 0, all are filled]
 *  result        zeroed, or with words of the caller's, or the grid itself
 *  filled        voxels that were set; may be NULL
 *  Returns what bvx_grid_keep returns.
 *  [Memory: the result, 4 bytes a run of empty voxels, 24 for each word of a slice, and 10 a component of
 *  the empty voxels] [Cost: O(words + runs)] */
BVX_API bvx_status bvx_grid_fill_cavities(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                          uint64_t at_most, bvx_grid *result, uint64_t *filled);

/** What kind of body a grid's set voxels are, when all beyond its window is empty. */
typedef struct bvx_topology {
    uint64_t voxels;
    uint64_t components; /**< connected parts */
    uint64_t cavities;   /**< connected components of the empty voxels that do not reach the window's sides */
    int64_t tunnels;     /**< components + cavities - euler: 1 for a ring, 0 for a ball and for a hollow
                              one */
    int64_t euler; /**< vertices - edges + faces - voxels of the body; 1 for a ball, 2 for a hollow one, 0
                        for a ring */
    uint64_t reserved[4];
} bvx_topology;

/** Count components, cavities and tunnels.
 *  connectivity  of the set voxels: 26, bodies are closed boxes, and the empty voxels connect only across
 *                faces; or 6, set voxels connect only across faces, and the empty ones across edges and
 *                corners too
 *  Local Properties of Binary Images in Two Dimensions. 1971: the Euler number of cells, summed over rows
 *  (docs/rules.md).
 *  Returns BVX_ERR_RANGE.
 *  [Memory: that of bvx_grid_components, for set and for empty voxels, and a byte a component of the empty
 *  ones] [Cost: O(words + runs)]
 *  Source: Gray. */
BVX_API bvx_status bvx_grid_topology(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                     bvx_topology *topology);

/* ---- Seeds and filling --------------------------------------------------------------------------------- */

/** A voxel found inside a surface, and what it took. */
typedef struct bvx_seed {
    int32_t voxel[3]; /**< of the surface's window, as bvx_grid_get takes it; all zero when none was found */
    int32_t found;    /**< 1: voxel is empty and hidden by surface voxels in all six directions */
    int32_t verified; /**< 1: a mesh was given, and by the rule vote the voxel's centre is inside it */
    int32_t reserved;
    uint64_t scans[3]; /**< lines scanned along x, y and z: the paper's counts i, j and k */
    uint64_t starts;   /**< rows that the search began at */
    uint64_t refused;  /**< hidden voxels that the mesh has outside */
    uint64_t reserved2[2];
} bvx_seed;

/** Find one voxel inside a surface by scanning lines of voxels: a voxel that is hidden in all six
 *  directions and, with a mesh, inside it by the rule vote (hidden is not yet inside: a bottle with a
 *  narrow neck). In which order lines are scanned: docs/rules.md.
 *  surface  the voxels of a surface, by any rule of bvx_voxelize_surface
 *  mesh     NULL, or the mesh that it came from
 *  limit    maximum number of lines to scan [Default: 0, all that there are]
 *  seed     out; found 0 is no error
 *  Returns BVX_ERR_RANGE; with a mesh as bvx_voxelize_solid.
 *  [Memory: none; with a mesh that of the rule vote] [Cost: O(lines scanned); with a mesh and that of the
 *  rule vote]
 *  Source: "Fast voxelization based on TIN" Algorithm 2, bounded, and with its seed verified. */
BVX_API bvx_status bvx_find_seed(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                                 uint64_t limit, bvx_seed *seed);

/** One voxel of each pocket inside a surface: of each set of empty voxels, connected through faces, the
 *  first in the order z, y, x. With a mesh a pocket counts when the rule vote has that voxel inside;
 *  without one (NULL) when it does not touch the window's sides. seeds x y z each, of the surface's window
 *  [Size: capacity * 3]; NULL: count only.
 *  Returns BVX_ERR_CAPACITY (count is then what there are), and as bvx_find_seed.
 *  [Memory: 4 bytes a run of empty voxels and 24 for each word of a slice; with a mesh also the vote's, and
 *  a grid] */
BVX_API bvx_status bvx_find_pockets(bvx_context *context, const bvx_grid *surface, const bvx_mesh_view *mesh,
                                    int32_t *seeds, uint64_t capacity, uint64_t *count);

/** Set all voxels that are connected with one of the seeds through empty voxels of a grid, across faces
 *  (connectivity 6), faces and edges (18), or corners too (26). Set voxels of the grid are walls and stay
 *  out of the result. seeds x y z each, of the grid's window, none on a set voxel [Size: seed_count * 3].
 *  Returns BVX_ERR_ARGUMENT (a seed on a set voxel or outside the window, with its index), BVX_ERR_RANGE.
 *  [Memory: the result, 4 bytes a run of empty voxels and 24 for each word of a slice] [Cost: O(words +
 *  runs)] */
BVX_API bvx_status bvx_grid_fill(bvx_context *context, const bvx_grid *walls, const int32_t *seeds,
                                 uint64_t seed_count, int32_t connectivity, bvx_grid *filled);

/* ---- Queries of grids ---------------------------------------------------------------------------------- */

/** Where a ray first meets a set voxel. */
typedef struct bvx_ray_hit {
    double t;           /**< position = origin + t * direction */
    double position[3]; /**< [Units: world] */
    int32_t voxel[3];   /**< of the grid's window, as bvx_grid_get takes it */
    int32_t axis;       /**< of the face that is crossed: 0, 1, 2; -1 when the ray starts inside the voxel */
    int32_t hit;        /**< 0: the ray meets none, and the other fields are zero */
    int32_t reserved;
} bvx_ray_hit;

/** Cast count rays, six doubles each: origin, direction (any length but 0) [Units: world]. Hits have 0 <= t
 *  <= t_max. Boxes are closed: the hit is the lowest (t, z, y, x) among all voxels that the ray touches, by
 *  one stated evaluation in doubles; a ray that starts on a face has t 0 and axis -1.
 *  Returns BVX_ERR_ARGUMENT (a direction of 0, t_max below 0 or NaN), BVX_ERR_RANGE (a ray that is not
 *  finite, with its index).
 *  [Memory: for many rays 1/512 of the grid] [Cost: O(voxels crossed), empty words and bricks of 8 x 8 x 8
 *  passed at once] */
BVX_API bvx_status bvx_grid_cast(bvx_context *context, const bvx_grid *grid, const double *rays,
                                 uint64_t count, double t_max, bvx_ray_hit *hits);

/** Trilinear samples at count points, x y z each [Units: world]: 1 at the centres of set voxels, 0 at those
 *  of others and beyond the window. gradients (three doubles a point, [Units: 1 / world]) may be NULL; on
 *  planes through centres they are those of the upper side.
 *  Returns BVX_ERR_RANGE (a point that is not finite).
 *  [Memory: none] */
BVX_API bvx_status bvx_grid_sample(bvx_context *context, const bvx_grid *grid, const double *points,
                                   uint64_t count, double *values, double *gradients);

/** What two grids share and where they differ. Components are 6-connected. */
typedef struct bvx_grid_difference {
    uint64_t set_a, set_b, both;
    uint64_t only_a, only_b;
    uint64_t components_only_a, components_only_b; /**< pieces of what only one has */
    uint64_t largest_only_a, largest_only_b;       /**< voxels of the largest piece */
    int32_t low[3], size[3]; /**< box of all voxels that differ, in the window; all zero when none does */
    uint64_t reserved[4];
} bvx_grid_difference;

/** Compare two grids.
 *  Returns BVX_ERR_LATTICE (their lattices or windows differ, and in which field).
 *  [Memory: 12 bytes a run of differing voxels and 24 for each word of a slice] [Cost: O(words + runs)] */
BVX_API bvx_status bvx_grid_compare(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                                    bvx_grid_difference *difference);

/* ---- Points -------------------------------------------------------------------------------------------- */

/** A lattice around a cloud of points, as bvx_lattice_fit_with makes it around a mesh: all vertices of the
 *  view count, triangles are ignored.
 *  Returns BVX_ERR_EMPTY (no point; only one position and no spacing), BVX_ERR_RANGE.
 *  [Memory: none] [Cost: O(points)] */
BVX_API bvx_status bvx_lattice_fit_points(bvx_context *context, const bvx_mesh_view *points,
                                          const bvx_lattice_options *options, bvx_lattice *lattice);

/** Counts of one call, for its window. */
typedef struct bvx_points_report {
    uint64_t inside, outside; /**< points in the window, and beyond it */
    uint64_t occupied;        /**< voxels that hold enough points */
    uint64_t filled;          /**< body: voxels that it has beside them */
    uint64_t pockets;         /**< body: places that the flood could not get into: 0 when gaps let it in
                                   everywhere */
    uint64_t reserved[3];
} bvx_points_report;

typedef struct bvx_points_options {
    size_t struct_size;
    int32_t minimum;    /**< points that a voxel needs to be set [Limit: 1..2^31-1] [Default: 1] */
    int32_t body;       /**< 1: what a flood from outside cannot reach through faces of voxels is set too;
                             the whole lattice only [Limit: 0..1] [Default: 0] */
    int32_t close_gaps; /**< body: gaps of up to this many voxels hold the flood, which is to say: it moves
                             as a cube of close_gaps + 1 voxels a side, and all that this cube reaches is
                             outside [Units: voxels] [Limit: 0..65535] [Default: 0] */
    int32_t reserved;
    bvx_window window;         /**< [Default: all zero, the whole lattice] */
    bvx_points_report *report; /**< receives counts when not NULL [Default: NULL] */
} bvx_points_options;

BVX_API void bvx_points_options_init(bvx_points_options *options, size_t size);

/** Set the voxels that hold points of a cloud: the vertices of a view, whose triangles are ignored.
 *
 *  Points are snapped to the lattice's fixed point as the vertices of meshes are, and belong to one voxel
 *  each: boxes are half-open, but at the lattice's high sides, where they are closed, so that a lattice
 *  around a cloud holds all of it.
 *
 *  Local but for body: a window holds the bits of the whole there.
 *  Returns BVX_ERR_ARGUMENT (also a window with body), BVX_ERR_EMPTY (no points), BVX_ERR_RANGE (a point
 *  that is not finite, with its index).
 *  [Memory: the grid; one more for each binary digit of minimum - 1; body: a grid of close_gaps more voxels
 *  a side, and what bvx_grid_fill_cavities needs for that] [Cost: O(points + words); body: as
 *  bvx_grid_fill_cavities, and O(words * log gap)] */
BVX_API bvx_status bvx_voxelize_points(bvx_context *context, const bvx_mesh_view *points,
                                       const bvx_lattice *lattice, const bvx_points_options *options,
                                       bvx_grid *grid);

/* ---- Volumes ------------------------------------------------------------------------------------------- */

/** Types of samples, in this machine's byte order. */
#define BVX_SAMPLE_LIST(X)      \
    X(BVX_SAMPLE_U8, 1, "u8")   \
    X(BVX_SAMPLE_I8, 2, "i8")   \
    X(BVX_SAMPLE_U16, 3, "u16") \
    X(BVX_SAMPLE_I16, 4, "i16") \
    X(BVX_SAMPLE_U32, 5, "u32") \
    X(BVX_SAMPLE_I32, 6, "i32") \
    X(BVX_SAMPLE_U64, 7, "u64") \
    X(BVX_SAMPLE_I64, 8, "i64") \
    X(BVX_SAMPLE_F32, 9, "f32") \
    X(BVX_SAMPLE_F64, 10, "f64")
enum { BVX_SAMPLE_LIST(BVX_LIST_ENUM) };

/** Borrowed samples: one number at the centre of each voxel of a window. Sample (i,j,k) of the window
 *  stands at (const char *)samples + i * strides[0] + j * strides[1] + k * strides[2], at any address (no
 *  alignment is required). */
typedef struct bvx_volume_view {
    const void *samples;
    int32_t sample_type; /**< BVX_SAMPLE_... */
    int32_t reserved0;
    int32_t low[3];     /**< window: lattice index of sample (0,0,0) [Units: voxels] */
    int32_t size[3];    /**< window: samples along each axis [Units: voxels] */
    int64_t strides[3]; /**< of either sign [Units: bytes] [Default: all 0, packed with x fastest] */
    bvx_lattice lattice;
    uint64_t reserved[4];
} bvx_volume_view;

/** What a volume's window holds. */
typedef struct bvx_volume_report {
    uint64_t nan;      /**< samples that are NaN */
    uint64_t infinite; /**< samples that are infinite, of either sign */
    uint64_t inside;   /**< samples that became set voxels */
    double least;      /**< of the finite samples; 64-bit integers are rounded to double; 0 when there is
                            none */
    double greatest;
    uint64_t reserved[3];
} bvx_volume_report;

/** Set the voxels whose sample lies in a range: low <= sample <= high.
 *  low, high  not NaN; -infinity and infinity leave a side open. low above high sets nothing; NaN and
 *             infinite samples are never set
 *  report     receives counts and the least and greatest sample when not NULL
 *  grid       zeroed, or with words of the caller's; its window is the volume's
 *  Returns BVX_ERR_ARGUMENT (also a view with an invalid type, stride or reserved field), BVX_ERR_RANGE
 *  (window outside the lattice).
 *  [Memory: the grid, and 12 KiB with a report] [Cost: O(samples), read once in the order of the fastest
 *  axis, 64 at a time] [Exact: for all types, no sample is rounded; a window holds the bits of the whole] */
BVX_API bvx_status bvx_threshold(bvx_context *context, const bvx_volume_view *volume, double low, double high,
                                 bvx_volume_report *report, bvx_grid *grid);

typedef struct bvx_scalar_options {
    size_t struct_size;
    double level;          /**< value of the surface [Limit: any; not NaN] [Default: 0] */
    int32_t below;         /**< inside is where 0: sample >= level, 1: sample <= level [Limit: 0..1]
                                [Default: 0] */
    int32_t face_rule;     /**< BVX_FACE_... [Default: BVX_FACE_SEPARATE] */
    int32_t position_type; /**< BVX_F32, BVX_F64 or BVX_POSITION_AUTO [Limit: 0..2] [Default: BVX_F32] */
    int32_t open_sides;    /**< BVX_OPEN_... [Limit: 0..63] [Default: 0, beyond the window is outside] */
    int32_t keys; /**< 1: fill vertex_keys and triangle_keys [Limit: 0..1; dims below 2^20] [Default: 0] */
    int32_t local_frame;       /**< 1: positions relative to the lattice's origin, which goes to frame
                                    [Limit: 0..1] [Default: 0] */
    bvx_volume_report *report; /**< receives counts when not NULL [Default: NULL] */
    uint64_t reserved[2];
} bvx_scalar_options;

BVX_API void bvx_scalar_options_init(bvx_scalar_options *options, size_t size);

/** The surface of a level in a volume, by marching cubes with linear positions on the edges between
 *  samples. A sample is inside when it is finite and level <= sample (below: sample <= level). The mesh is
 *  what bvx_extract_surface promises, for any samples; a body that is cut by the volume's sides ends on
 *  them. Windows that overlap by one layer of samples, open where they meet, tile the whole, and
 *  bvx_mesh_merge joins them to the whole's bytes. Where exactly vertices lie: docs/rules.md.
 *  mesh  as for bvx_extract_surface; bvx_extract_count of bvx_threshold(level, infinity) computes its exact
 *        size. Empty where the volume has no crossing
 *  Returns BVX_ERR_RANGE (positions too coarse: take BVX_POSITION_AUTO, f64 or local_frame; 2^32 vertices
 *  or more).
 *  [Memory: the mesh, one bit a sample and 16 bytes a row] [Cost: O(samples), read once, and the samples
 *  next to the surface again]
 *  Source: Lorensen, Cline. Marching Cubes. 1987; triangulations from src/surface/tables.py. */
BVX_API bvx_status bvx_extract_scalar(bvx_context *context, const bvx_volume_view *volume,
                                      const bvx_scalar_options *options, bvx_mesh *mesh);

/** A value of a label map. */
typedef struct bvx_label {
    int64_t value; /**< u64: its bits */
    uint64_t voxels;
    int32_t low[3]; /**< box of its voxels, in the window [Units: voxels] */
    int32_t size[3];
} bvx_label;

/** The values other than 0 of a volume of integers, ascending, each with its voxels and their box. labels
 *  NULL: *count becomes how many there are. bvx_threshold from a value to itself gives a label's voxels.
 *  Returns BVX_ERR_UNSUPPORTED (samples that are floats), BVX_ERR_CAPACITY (*count becomes how many there
 *  are).
 *  [Memory: up to 200 bytes a label] [Cost: O(samples)] */
BVX_API bvx_status bvx_list_labels(bvx_context *context, const bvx_volume_view *volume, bvx_label *labels,
                                   uint64_t capacity, uint64_t *count);

/** A volume that was read. */
typedef struct bvx_volume {
    bvx_volume_view view;
    uint64_t bytes; /**< of view.samples where the library made them */
    int32_t owned;  /**< 1 when bvx_volume_free frees view.samples; 0: they lie in the file's bytes */
    int32_t placed; /**< 0: the file has no lattice; origin 0 and spacing 1 are taken */
    uint64_t reserved[2];
} bvx_volume;

/** Free what the library allocated and zero the struct. */
BVX_API void bvx_volume_free(bvx_context *context, bvx_volume *volume);

/** Unpack gzip or zlib data to exactly plain_size bytes. Returns 0 when that is what they hold; any other
 *  number when they are damaged, longer or shorter. Called on the calling thread. */
typedef int32_t bvx_inflate_fn(void *user, const void *packed, uint64_t packed_size, void *plain,
                               uint64_t plain_size);

typedef struct bvx_read_volume_options {
    size_t struct_size;
    const void *data;        /**< NRRD with a detached head: the bytes of its data files, one after the
                                  other [Default: NULL] */
    uint64_t data_size;      /**< [Units: bytes] [Limit: any] [Default: 0] */
    bvx_inflate_fn *inflate; /**< NRRD of encoding gzip [Default: NULL, refused] */
    void *inflate_user;      /**< first argument of inflate [Default: NULL] */
    int32_t sample_type;     /**< RAW: BVX_SAMPLE_... [Limit: any; RAW: 1..10] [Default: 0] */
    int32_t big_endian;      /**< RAW: 1: the highest byte first [Limit: 0..1] [Default: 0] */
    int32_t size[3]; /**< RAW: samples along each axis, x fastest [Units: voxels] [Limit: any] [Default: 0] */
    int32_t reserved0;
    uint64_t offset;   /**< RAW: bytes before the first sample; what follows the last is ignored [Limit:
                            any] [Default: 0] */
    double origin[3];  /**< RAW: low corner of the first voxel [Units: world] [Limit: any] [Default: 0, 0,
                            0] */
    double spacing[3]; /**< RAW: [Units: world] [Limit: any] [Default: 1, 1, 1] */
    uint64_t reserved[2];
} bvx_read_volume_options;

BVX_API void bvx_read_volume_options_init(bvx_read_volume_options *options, size_t size);

/** Read a volume from the bytes of a file. Where the samples stand in the file as they are needed, the view
 *  points into bytes (or options.data), which must stay as long as it is used; else they are copied, packed
 *  with x fastest. The lattice is the file's box, as in bvx_read_grid. Which encodings are read, and how
 *  numbers of a text become samples: docs/formats.md.
 *  BVX_FORMAT_NRRD  three axes, x fastest, any scalar type; raw, ascii, or gzip with options.inflate;
 *                   samples in other files come by bvx_volume_data_name and options.data
 *  BVX_FORMAT_NPY   any whole-number or float type, three axes [x,y,z]
 *  BVX_FORMAT_VTI   raw, base64 or ascii without compression, cell or point data
 *  BVX_FORMAT_RAW   samples alone, of the options' size, type and byte order
 *  Returns BVX_ERR_FORMAT (byte or line, and why), BVX_ERR_RANGE (dims beyond the limits),
 *  BVX_ERR_UNSUPPORTED (a format or encoding that is not read, turned axes, gzip without inflate),
 *  BVX_ERR_ARGUMENT (also a detached head without data).
 *  [Memory: none, or the samples, at most 4 times size and data_size and 32 KiB; gzip up to 1100 times its
 *  bytes, and three times that while halves or the other byte order are converted: set a memory limit for
 *  strangers' files] */
BVX_API bvx_status bvx_read_volume(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                   const bvx_read_volume_options *options, bvx_volume *volume);

/** The name of data file index of an NRRD's detached head, as it stands there (to be looked for beside the
 *  head), with a zero byte after it. A head from a stranger may name any file: the program and the Python
 *  package refuse what is not in its folder or below. *count becomes how many there are, 0 when the samples
 *  follow the head; name may be NULL for the count. Each call reads the head: one whose data files times
 *  its bytes are more than 2^31 (a LIST of 60,000 names) is refused.
 *  Returns BVX_ERR_FORMAT, BVX_ERR_ARGUMENT (index not below the count), BVX_ERR_UNSUPPORTED. */
BVX_API bvx_status bvx_volume_data_name(bvx_context *context, const void *bytes, uint64_t size,
                                        uint64_t index, char *name, uint64_t capacity, uint64_t *count);

/* ---- Section contours ---------------------------------------------------------------------------------- */

/** One closed loop of a section: a polygon whose last point is joined to its first, in either direction. */
typedef struct bvx_section_loop {
    uint64_t first_point; /**< index of its first point */
    uint32_t point_count; /**< [Limit: 3 or more different points] */
    uint32_t section;     /**< index of its section */
    int32_t label;        /**< which body it belongs to */
    int32_t reserved;
} bvx_section_loop;

/** Contours on planes. A zeroed struct is empty and ready to receive;
 *  callers may also fill one with arrays of their own (owned 0). Loops and sections
 *  may stand in any order; loops inside loops are holes, in these islands, and so on. */
typedef struct bvx_sections {
    double *points;          /**< x, y, z [Size: point_count * 3] [Units: world] */
    bvx_section_loop *loops; /**< [Size: loop_count] */
    double *positions;       /**< where each section's plane lies along its normal: point . normal / |normal|
                                  [Size: section_count] */
    uint64_t point_count;    /**< [Limit: < 2^31] */
    uint64_t loop_count;
    uint64_t section_count; /**< also of those that hold no loop: there is no body there */
    uint64_t point_capacity, loop_capacity, section_capacity; /**< what the arrays hold */
    double normal[3];                                         /**< of all planes, any length but 0 */
    int32_t owned; /**< 1 when bvx_sections_free frees the arrays */
    int32_t reserved;
    double *normals; /**< of each plane, in place of normal, any length but 0; NULL: the planes are parallel
                          [Size: section_count * 3] */
    uint64_t reserved2[3];
} bvx_sections;

/** Free what the library allocated and zero the struct. */
BVX_API void bvx_sections_free(bvx_context *context, bvx_sections *sections);

/** How a body ends at its first and last section.
 *  FLAT   on the section's plane
 *  TAPER  each part (a loop with the holes in it) runs to a ridge half a spacing beyond: at a height of t
 *         half spacings it is the part less all that lies within t times its half width of its contour;
 *         also the parts of other sections that have nothing in common with the next one
 *  OPEN   not at all: the mesh has boundary edges there */
#define BVX_CAPS_LIST(X)          \
    X(BVX_CAPS_FLAT, 0, "flat")   \
    X(BVX_CAPS_TAPER, 1, "taper") \
    X(BVX_CAPS_OPEN, 2, "open")
enum { BVX_CAPS_LIST(BVX_LIST_ENUM) };

/** Where the surface meets the grid's edges on a section plane.
 *  EXACT    where the contour does; all of the contour is in the mesh
 *  PAPER    by interpolated distances; contour points are put into the lines that join them
 *  CLASSIC  only by interpolated distances: marching cubes */
#define BVX_CROSSINGS_LIST(X)          \
    X(BVX_CROSSINGS_EXACT, 0, "exact") \
    X(BVX_CROSSINGS_PAPER, 1, "paper") \
    X(BVX_CROSSINGS_CLASSIC, 2, "classic")
enum { BVX_CROSSINGS_LIST(BVX_LIST_ENUM) };

/** What is blended between two sections whose loops lie in each other.
 *  LEVELS  each level apart, and cut out of the one around it: outer loops, the holes in them, the
 *          islands in these. A wall stays a wall however far it is shifted. Holes that overlap no hole of
 *          the other section are blended with what is around them
 *  WHOLE   the sections as they are: a wall that shares no area with the next section's gets windows */
#define BVX_NESTING_LIST(X)            \
    X(BVX_NESTING_LEVELS, 0, "levels") \
    X(BVX_NESTING_WHOLE, 1, "whole")
enum { BVX_NESTING_LIST(BVX_LIST_ENUM) };

/** How distances go from section to section.
 *  LINEAR  straight between neighbours: the surface has a kink at every section
 *  CUBIC   the monotone cubic over four sections: as exact on the sections, smooth across them. It has
 *          one zero where the linear one has one, and none elsewhere. Linear all the same: two sections,
 *          slabs in which parts end (taper, a section without loops), nesting levels that would cross
 *          otherwise */
#define BVX_BLEND_LIST(X)            \
    X(BVX_BLEND_LINEAR, 0, "linear") \
    X(BVX_BLEND_CUBIC, 1, "cubic")
enum { BVX_BLEND_LIST(BVX_LIST_ENUM) };

enum { BVX_SECTIONS_LOCATED = 16, BVX_LABEL_ONLY = -2147483647 - 1 };

/** What was found and done. */
typedef struct bvx_sections_report {
    double cell[2];          /**< sides of a grid cell [Units: world] */
    int32_t grid[2];         /**< cells along the plane's two axes */
    uint64_t sections;       /**< that hold the label */
    uint64_t empty_sections; /**< between these, without it: the body ends half way to them */
    uint64_t loops, holes;   /**< holes: loops with outside on their inner side */
    uint64_t points;
    uint64_t repeated_points; /**< that equal the one before them: left out */
    uint64_t crossings;       /**< of contours with the grid's edges */
    uint64_t multiple_edges;  /**< grid edges crossed more than once */
    uint64_t inner_loops;     /**< loops inside one grid cell */
    uint64_t split_cells;     /**< grid cells that were subdivided */
    uint64_t leaf_cells;      /**< cells that these became */
    uint64_t unkept_edges;    /**< edges crossed more than once all the same: the contour is kept, what
                                   joins it to the other section there is a guess */
    uint64_t unkept_loops;    /**< loops inside one cell all the same: closed by a cone of their own */
    uint64_t unkept_points;   /**< contour points that are no vertices: none but for the paper's crossings
                                   and the classic ones */
    uint64_t samples;         /**< grid points of all sections */
    uint64_t distances;       /**< distances to contours that were computed */
    uint64_t skipped;         /**< samples whose distance nothing needed */
    uint64_t ambiguous_faces; /**< faces with four crossings, between sections or on a plane without
                                   contours, decided by the field */
    uint64_t inner_vertices;  /**< vertices put inside cells for loops that need one */
    double prismoid_volume;   /**< sum of h / 3 (A + B + sqrt(A B)) over neighbouring sections of areas A
                                   and B; taper and ends at empty sections count as cones, A h / 3 [Units:
                                   world^3] */
    uint64_t located;         /**< places in unkept */
    double unkept[16][3];     /**< the first BVX_SECTIONS_LOCATED of them [Units: world] */
    uint64_t crossed_cells;   /**< cells whose triangles cross each other, looked for in those of up to 64:
                                   some where edges are unkept, hardly any else. In the paper's way
                                   triangles of neighbouring cells cross too, uncounted */
    uint64_t nested_slabs;    /**< pairs of neighbouring sections that were blended level by level */
    uint64_t joined_slabs;    /**< pairs that were not, since their levels would cross there: walls much
                                   thinner than a cell */
    uint64_t mended_loops;    /**< loops given that were split, joined or left out */
    uint64_t planes;          /**< of all sections, where they are not parallel; else 0 */
    uint64_t settled;         /**< places on lines where planes cross at which contours were moved to agree */
    uint64_t gaps;      /**< stretches of such lines on which still only one of two sections is inside */
    double largest_gap; /**< how far contours were apart there at most [Units: world] */
} bvx_sections_report;

typedef struct bvx_sections_options {
    size_t struct_size;
    int32_t grid[2];       /**< cells along the plane's two axes, both or none [Limit: 0, or 2..8192]
                                [Default: 0, 0] */
    double spacing;        /**< side of a square cell [Units: world] [Limit: >= 0] [Default: 0; with no
                                grid either: twice the mean length of the contours' segments, 16 to 512
                                cells along the longer side] */
    int32_t layers;        /**< cells from section to section [Limit: 1..64] [Default: 1] */
    int32_t caps;          /**< BVX_CAPS_... [Default: BVX_CAPS_FLAT] */
    int32_t crossings;     /**< BVX_CROSSINGS_... [Default: BVX_CROSSINGS_EXACT] */
    int32_t depth;         /**< a cell is halved at most this often [Limit: 0..8] [Default: 5] */
    int32_t label;         /**< the body [Limit: any] [Default: BVX_LABEL_ONLY, the only one there is] */
    int32_t position_type; /**< BVX_F32 (rounded, whatever that joins) or BVX_F64, which BVX_POSITION_AUTO
                                is too: contours' points are doubles and are kept [Limit: 0..2] [Default:
                                BVX_F64] */
    bvx_sections_report *report; /**< filled when not NULL [Default: NULL] */
    int32_t nesting;             /**< BVX_NESTING_... [Default: BVX_NESTING_LEVELS] */
    int32_t mend;  /**< 1: loops that touch or cross themselves or each other are split there; inside stays
                        what an odd number of loops enclose. Slits (a hole joined to its outline), spikes
                        and borders that two loops have in common go, with points that lie on nothing else
                        [Limit: 0..1] [Default: 0, they are refused] */
    int32_t blend; /**< BVX_BLEND_... [Default: BVX_BLEND_LINEAR] */
    int32_t cells; /**< planes that are not parallel: lattice cells along the longest side of the contours'
                        box; spacing gives the side of one instead [Limit: 0, or 8..1024] [Default: 0; with no
                        spacing either: 64] */
    double agree;  /**< planes that are not parallel: contours that are at most so far apart where two planes
                        cross are moved to agree there [Units: world] [Limit: >= 0] [Default: 0: a hundredth
                        of that longest side] */
    double thickness; /**< of a body with one section alone, which is refused without: half to either side of
                           it, a slab with flat caps, with tapered ones a lens. Bodies with several sections
                           take no notice of it [Units: world] [Limit: >= 0] [Default: 0] */
} bvx_sections_options;

BVX_API void bvx_sections_options_init(bvx_sections_options *options, size_t size);

/** The closed surface of a body through all of its section contours. On a section plane the contour
 *  decides: its points are vertices with the coordinates given. Between planes the surface follows a blend
 *  of the sections' signed distances, by marching cubes over a grid of cells. The surface is oriented,
 *  edge- and vertex-manifold, and closed but for open caps. Planes of any direction (normals) may cross;
 *  between them the surface is a thin plate through their distances. How loops in loops, cells that a
 *  contour crosses more than once, ends of parts, and planes that cross are treated: docs/rules.md.
 *
 *  Points off their plane keep their coordinates; the surface takes them as lying on it. [Limit: 1/1000 of
 *  the contours' extent and a quarter of the way to the next plane]
 *  mesh  as for bvx_extract_surface
 *  Returns BVX_ERR_EMPTY (no loop, only one section and no thickness, a loop with fewer than three different points),
 *  BVX_ERR_FORMAT (a loop that crosses or touches itself or another; two sections at one position; points
 *  off their plane; crossing planes that contradict each other by more than agree: sections, loop, point or
 *  place are named), BVX_ERR_RANGE (not finite, an index beyond its array or the limits), BVX_ERR_ARGUMENT
 *  (also several labels and none chosen).
 *  [Memory: about 150 bytes a contour point or crossing, those of nested levels twice more; 20 bytes a cell
 *  of one section; the mesh twice. n planes that are not parallel: 10 MB + 3,500 cells^2 + 15,000 n cells
 *  + 38,000 n^2, for a ball] [Cost: O(crossings log points + cells / 64 a section); layers multiply
 *  what is between sections; the cubic blend computes up to twice the distances] [Exact: inside tests, in
 *  fixed point of 2^-29 of the extent]
 *  Source: "surface modelling in section data fields", with crossings and connectivity on section planes by
 *  the contour; Herman, Zheng, Bucholtz. Shape-based Interpolation. 1992 (layers, nesting); Fritsch,
 *  Butland. A Method for Constructing Local Monotone Piecewise Cubic Interpolants. 1984 (cubic); Duchon.
 *  Splines Minimizing Rotation-invariant Semi-norms in Sobolev Spaces. 1977 (planes that cross). */
BVX_API bvx_status bvx_build_sections(bvx_context *context, const bvx_sections *sections,
                                      const bvx_sections_options *options, bvx_mesh *mesh);

typedef struct bvx_slice_options {
    size_t struct_size;
    double normal[3];        /**< of the planes, any length but 0 [Limit: any] [Default: 0, 0, 1] */
    double spacing;          /**< from plane to plane; the first lies half a spacing above the lowest point
                                  [Units: world] [Limit: >= 0] [Default: 0] */
    const double *positions; /**< the planes instead: point . normal / |normal|, ascending [Size:
                                  position_count] [Default: NULL] */
    uint64_t position_count; /**< [Limit: any; with positions 1..2^20] [Default: 0] */
    int32_t label;           /**< of all loops [Limit: -2147483647..2147483647] [Default: 1] */
    int32_t reserved;
} bvx_slice_options;

BVX_API void bvx_slice_options_init(bvx_slice_options *options, size_t size);

/** The contours of a mesh on parallel planes: where a plane meets an edge there is a point; vertices on a
 *  plane count as above it. The mesh must be closed and oriented where planes meet it (vertices at equal
 *  positions are one). Loops run with the inside on their left, seen against the normal. Left out are loops
 *  of fewer than three different points, and those that enclose no area: no wider than 2^-26 of the mesh's
 *  extent across the normal, twice the area divided by the perimeter.
 *  Returns BVX_ERR_EMPTY (no plane meets the mesh), BVX_ERR_FORMAT (a loop that does not close, with its
 *  place), BVX_ERR_RANGE.
 *  [Memory: the points, 60 bytes each while a plane is cut, and 100 bytes a triangle] [Cost: O(triangles
 *  log triangles + points log points)] */
BVX_API bvx_status bvx_slice_mesh(bvx_context *context, const bvx_mesh_view *mesh,
                                  const bvx_slice_options *options, bvx_sections *sections);

/* ---- Refinement ---------------------------------------------------------------------------------------- */

/** What an octree says of a voxel; as bits, so that they make sets.
 *  OUTSIDE  a flood from outside through faces of voxels reaches it (trees with a window: by rows)
 *  INSIDE   no triangle touches it, and it is not outside
 *  SURFACE  a triangle touches its closed box */
#define BVX_STATE_LIST(X)              \
    X(BVX_STATE_OUTSIDE, 1, "outside") \
    X(BVX_STATE_INSIDE, 2, "inside")   \
    X(BVX_STATE_SURFACE, 4, "surface")
enum { BVX_STATE_LIST(BVX_LIST_ENUM) };

/** Voxels of several sizes: level 0 is a base lattice, each further level
 *  halves the voxels that triangles touch. */
typedef struct bvx_octree bvx_octree;

/** One voxel of an octree. */
typedef struct bvx_octree_leaf {
    int32_t ijk[3]; /**< index among the voxels of its level */
    uint8_t level;
    uint8_t state; /**< BVX_STATE_... */
    uint8_t reserved[2];
} bvx_octree_leaf;

/** Counts of one level. */
typedef struct bvx_octree_level {
    uint64_t voxels;  /**< all of the level: split ones and leaves */
    uint64_t split;   /**< touched by triangles and split in eight; 0 at the last level */
    uint64_t surface; /**< leaves that triangles touch; 0 above the last level without window and tolerance */
    uint64_t inside, outside; /**< leaves that no triangle touches */
    uint64_t bytes;           /**< that the tree keeps for them */
    uint64_t reserved[2];
} bvx_octree_level;

typedef struct bvx_refine_options {
    size_t struct_size;
    int32_t levels;       /**< how many times voxels are halved [Limit: 0..25; dims * 2^levels up to 2^25]
                               [Default: 6] */
    int32_t start_level;  /**< levels up to this one come from one grid of it, later ones from their
                               parents' triangles; shows in time and memory only [Limit: -1..levels]
                               [Default: -1, chosen by size] */
    bvx_window window;    /**< voxels of the last level: from outer_levels on only voxels that meet it are
                               halved [Default: all zero, the whole lattice] */
    int32_t outer_levels; /**< used with a window [Limit: 0..levels] [Default: 0] */
    int32_t reserved;
    double tolerance; /**< a voxel whose triangles lie in whole within this distance of one plane is a leaf
                           of the surface [Units: world] [Limit: >= 0] [Default: 0, none is] */
} bvx_refine_options;

BVX_API void bvx_refine_options_init(bvx_refine_options *options, size_t size);

/** Voxelize a mesh with small voxels only at its surface. Each voxel whose closed box meets a triangle is
 *  split in eight down to the last level; then a voxel without triangles that shares a face with an outside
 *  one, or with the lattice's side, is outside, and what remains is inside. At the last level the surface
 *  is that of bvx_voxelize_surface (conservative), and inside is what the flood around it cannot reach, bit
 *  for bit. What a window and a tolerance change: docs/rules.md.
 *  base  the lattice of level 0; its fraction_bits are ignored. bvx_lattice_fit(context, mesh, 8, &base)
 *        makes one
 *  tree  out: *tree is NULL, or a tree that is freed when the new one is made; freed by bvx_octree_free
 *  Returns BVX_ERR_EMPTY (no triangle), BVX_ERR_RANGE (as bvx_voxelize_surface; a base or levels beyond the
 *  lattice, with the largest number of levels that fits; 2^28 split voxels of a level), BVX_ERR_BUDGET
 *  (names the number of levels that fits).
 *  [Memory: the tree (2 to 3.5 bytes a split voxel, and the base's bits twice), 16 bytes a vertex, 13 a
 *  split voxel; for the two finest split levels 20 a voxel and 5 for each triangle that touches it; a grid
 *  of up to 128 MiB] [Cost: O(triangles of each split voxel + voxels)]
 *  Source: "Refinement of surface voxels by boundary states" 2.1 and 2.2, with a worklist in place of one
 *  traversal. */
BVX_API bvx_status bvx_refine(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *base,
                              const bvx_refine_options *options, bvx_octree **tree);

/** Choose the base and the levels with which bvx_refine takes least time for a finest resolution, by a
 *  model of its time: from the triangles, their area and the voxels of every pair.
 *  resolution  voxels of the last level along the mesh's longest axis, at least: rounded up to whole voxels
 *              of the base
 *  options     in and out: its levels are set. The size of its window counts (a window wants a coarse
 *              base), and so does tolerance (flat voxels stay as large as the base allows: 8 to 15 voxels)
 *  base        out: bvx_lattice_fit with fewer voxels
 *  Returns what bvx_lattice_fit returns.
 *  [Memory: none] [Cost: O(triangles). The same choice on every machine] */
BVX_API bvx_status bvx_refine_choose(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                                     bvx_refine_options *options, bvx_lattice *base);

/** Free what bvx_refine allocated; NULL is allowed. */
BVX_API void bvx_octree_free(bvx_context *context, bvx_octree *tree);

/** Times that the tree's voxels are halved: the index of its last level; -1 for NULL. */
BVX_API int32_t bvx_octree_levels(const bvx_octree *tree);

/** The lattice of a level; that of the last one is the one that vertices were snapped to. */
BVX_API bvx_status bvx_octree_lattice(bvx_context *context, const bvx_octree *tree, int32_t level,
                                      bvx_lattice *lattice);

/** Counts of the levels 0 .. bvx_octree_levels.
 *  [Cost: O(bytes of the tree)] */
BVX_API bvx_status bvx_octree_count(bvx_context *context, const bvx_octree *tree, bvx_octree_level *counts,
                                    int32_t capacity);

/** The leaves that hold voxels of the last level, three indices each.
 *  Returns BVX_ERR_RANGE (a voxel beyond the lattice, with its index).
 *  [Memory: none] [Cost: O(levels) a voxel] */
BVX_API bvx_status bvx_octree_at(bvx_context *context, const bvx_octree *tree, const int32_t *voxels,
                                 uint64_t count, bvx_octree_leaf *leaves);

/** The leaves that hold points, x y z each [Units: world]; beyond the lattice: state outside, level 255,
 *  ijk 0.
 *  Returns BVX_ERR_RANGE (a point that is not finite, with its index). */
BVX_API bvx_status bvx_octree_find(bvx_context *context, const bvx_octree *tree, const double *points,
                                   uint64_t count, bvx_octree_leaf *leaves);

/** The leaves that share a face with a leaf, beyond it towards a direction: 0 to 5 for -x, -y, -z, +x, +y,
 *  +z. One of the same size or larger, or all smaller ones on that face; none beyond the lattice. leaves
 *  NULL: only count them.
 *  Returns BVX_ERR_RANGE (no voxel of the tree), BVX_ERR_CAPACITY (*count is what it takes).
 *  [Memory: none] */
BVX_API bvx_status bvx_octree_neighbours(bvx_context *context, const bvx_octree *tree,
                                         const bvx_octree_leaf *leaf, int32_t direction,
                                         bvx_octree_leaf *leaves, uint64_t capacity, uint64_t *count);

/** Where a ray first meets a leaf. */
typedef struct bvx_octree_hit {
    double t;           /**< position = origin + t * direction */
    double position[3]; /**< [Units: world] */
    bvx_octree_leaf leaf;
    int32_t axis; /**< of the face that is crossed: 0, 1, 2; -1 when the ray starts in the leaf */
    int32_t hit;  /**< 0: the ray meets none, and the other fields are zero */
} bvx_octree_hit;

/** Cast count rays, six doubles each: origin, direction (any length but 0) [Units: world], at the leaves in
 *  a set of states (0: surface and inside). Hits have 0 <= t <= t_max. Boxes are closed: the hit is the
 *  lowest (t, z, y, x) of the leaves' low corners among all that the ray touches, by one stated evaluation
 *  in doubles.
 *  Returns BVX_ERR_ARGUMENT (a direction of 0, t_max below 0 or NaN), BVX_ERR_RANGE (a ray that is not
 *  finite, with its index).
 *  [Memory: none] [Cost: O(rows of the base + octets crossed) a ray] */
BVX_API bvx_status bvx_octree_cast(bvx_context *context, const bvx_octree *tree, int32_t states,
                                   const double *rays, uint64_t count, double t_max, bvx_octree_hit *hits);

/** The leaves in a set of states (0: surface and inside), by base voxel (z, y, x), within it along the
 *  curve that takes x first, then y, then z at each level. leaves NULL: only count them.
 *  [Memory: none] [Cost: O(voxels)] */
BVX_API bvx_status bvx_octree_leaves(bvx_context *context, const bvx_octree *tree, int32_t states,
                                     bvx_octree_leaf *leaves, uint64_t capacity, uint64_t *count);

/** The voxels of one level, in a set of states, as a grid.
 *  level   0 .. bvx_octree_levels. Above the last level a voxel that is split counts as surface, and others
 *          keep what the last level made of them
 *  states  BVX_STATE_... added; 0: surface and inside
 *  window  of the level's lattice; NULL or all zero: all of it
 *  grid    out; zeroed, or with words of the caller's
 *  Returns BVX_ERR_RANGE.
 *  [Memory: the grid] [Cost: O(words + voxels in the window)] */
BVX_API bvx_status bvx_octree_expand(bvx_context *context, const bvx_octree *tree, int32_t level,
                                     int32_t states, const bvx_window *window, bvx_grid *grid);

/** The closed surface of the last level's voxels in a set of states (0: surface and inside), block by
 *  block: all of the level is never expanded. The bytes are those of bvx_extract_surface on all of it;
 *  options are its own, all sides closed.
 *  Returns what bvx_octree_expand, bvx_extract_surface and bvx_mesh_merge return; dims are below 2^20, as
 *  for keys. mesh must be empty.
 *  [Memory: the surface twice, with keys, and what merging takes] [Cost: O(surface + blocks of 256 x 256 x
 *  256 voxels)] */
BVX_API bvx_status bvx_extract_octree(bvx_context *context, const bvx_octree *tree, int32_t states,
                                      const bvx_extract_options *options, bvx_mesh *mesh);

/* ---- Formats ------------------------------------------------------------------------------------------- */

/** Every format, its frozen value and the ending of its file names, which is its own name too. NRRD has
 *  .nhdr besides. */
#define BVX_FORMAT_LIST(X)            \
    X(BVX_FORMAT_STL, 1, "stl")       \
    X(BVX_FORMAT_OBJ, 2, "obj")       \
    X(BVX_FORMAT_PLY, 3, "ply")       \
    X(BVX_FORMAT_NPY, 4, "npy")       \
    X(BVX_FORMAT_PNG, 5, "png")       \
    X(BVX_FORMAT_OFF, 6, "off")       \
    X(BVX_FORMAT_GLB, 7, "glb")       \
    X(BVX_FORMAT_BINVOX, 8, "binvox") \
    X(BVX_FORMAT_VOX, 9, "vox")       \
    X(BVX_FORMAT_NRRD, 10, "nrrd")    \
    X(BVX_FORMAT_VTI, 11, "vti")      \
    X(BVX_FORMAT_BVX, 12, "bvx")      \
    X(BVX_FORMAT_VTU, 13, "vtu")      \
    X(BVX_FORMAT_RAW, 14, "raw")      \
    X(BVX_FORMAT_XYZ, 15, "xyz")      \
    X(BVX_FORMAT_CSL, 20, "csl")      \
    X(BVX_FORMAT_CSV, 21, "csv")      \
    X(BVX_FORMAT_SVG, 22, "svg")
enum {
    BVX_FORMAT_UNKNOWN = 0,
    BVX_FORMAT_LIST(BVX_LIST_ENUM)
    /** What formats hold: bit 1 << format. */
    BVX_MESHES_READ = 1 << BVX_FORMAT_STL | 1 << BVX_FORMAT_OBJ | 1 << BVX_FORMAT_PLY | 1 << BVX_FORMAT_OFF,
    BVX_MESHES_WRITTEN = BVX_MESHES_READ | 1 << BVX_FORMAT_GLB,
    BVX_GRIDS_READ = 1 << BVX_FORMAT_NPY | 1 << BVX_FORMAT_BINVOX | 1 << BVX_FORMAT_VOX |
                     1 << BVX_FORMAT_NRRD | 1 << BVX_FORMAT_VTI | 1 << BVX_FORMAT_BVX,
    BVX_GRIDS_WRITTEN = BVX_GRIDS_READ,
    BVX_VOLUMES_READ = 1 << BVX_FORMAT_NRRD | 1 << BVX_FORMAT_NPY | 1 << BVX_FORMAT_VTI | 1 << BVX_FORMAT_RAW,
    BVX_POINTS_READ = 1 << BVX_FORMAT_XYZ | 1 << BVX_FORMAT_PLY,
    BVX_SECTIONS_READ = 1 << BVX_FORMAT_CSL | 1 << BVX_FORMAT_CSV,
    BVX_SECTIONS_WRITTEN = BVX_SECTIONS_READ | 1 << BVX_FORMAT_SVG
};

/** Bytes made by the library; freed by bvx_buffer_free. */
typedef struct bvx_buffer {
    uint8_t *bytes;
    uint64_t size;
    uint64_t capacity;
} bvx_buffer;

BVX_API void bvx_buffer_free(bvx_context *context, bvx_buffer *buffer);

/** The format that a file name's ending stands for (".gz" is looked through), in either case of letters. */
BVX_API int32_t bvx_format_of_name(const char *name);

/** Read a mesh from the bytes of a file. Polygons that are planar and simple, convex or not, are cut into
 *  triangles that neither overlap nor turn over. What is read of each format: docs/formats.md.
 *  format  BVX_FORMAT_STL (ASCII and binary are recognised), _OBJ, _PLY or _OFF
 *  mesh    out, zeroed (arrays of the caller's are not used); positions f32 where the file says float (STL,
 *          PLY float), else f64; STL vertices are welded where their bits are equal. Colours and texture
 *          coordinates are read when all vertices or faces have them
 *  Returns BVX_ERR_FORMAT (byte, line or element, and why), BVX_ERR_RANGE (a coordinate that is not finite,
 *  an index beyond the vertices), BVX_ERR_EMPTY (no triangle).
 *  [Memory, the mesh included: at most 8 (STL), 64 (OBJ, OFF) or 128 (PLY) times size and 32 KiB; counts
 *  that the size cannot hold are refused before allocation] */
BVX_API bvx_status bvx_read_mesh(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                 bvx_mesh *mesh);

/** The same, but triangles with a corner that is not finite are left out (bvx_mesh_drop_nonfinite), not
 *  refused; of a polygon with such a corner all triangles are.
 *  dropped  out; the triangles that were left out
 *  Returns what bvx_read_mesh returns; BVX_ERR_EMPTY also when no triangle remains. Colours and texture
 *  coordinates must be finite.
 *  [Memory: 4 bytes a vertex more, where triangles are left out] */
BVX_API bvx_status bvx_read_mesh_finite(bvx_context *context, const void *bytes, uint64_t size,
                                        int32_t format, uint64_t *dropped, bvx_mesh *mesh);

/** Read a cloud of points: the vertices of points, which has no triangles.
 *  BVX_FORMAT_XYZ  text, a point a line: x y z and further columns, which are left out; spaces, tabs,
 *                  commas or semicolons between them; lines that begin with #, // or % are comments; a
 *                  first line of names, or of one number (a count), is passed over; positions f64
 *  BVX_FORMAT_PLY  the element vertex, as bvx_read_mesh reads it; faces are left out
 *  Returns BVX_ERR_FORMAT (line or byte, and why), BVX_ERR_RANGE (a point that is not finite),
 *  BVX_ERR_EMPTY (no point).
 *  [Memory: the points, and room for the head; at most 16 times size and 32 KiB] [Cost: O(bytes)] */
BVX_API bvx_status bvx_read_points(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                   bvx_mesh *points);

/** Write a mesh. The frame is added. file is zeroed. STL and PLY: binary, little-endian; OBJ and OFF: text
 *  that reads back to the same numbers. PLY, OBJ (without alpha) and OFF keep colours, PLY and OBJ texture
 *  coordinates too; STL keeps neither, and has normals of triangles. GLB (glTF 2.0, binary): f32 positions
 *  about the bounds' centre, smooth normals weighted by area, colours as linear light, texture coordinates;
 *  world axes are kept, and the nodes carry the centre and the turn from z up to glTF's y up; vertices are
 *  repeated where texture coordinates need it. A mesh that rounding to 32-bit floats would spoil, like one
 *  in metres of a map projection as STL, is refused with BVX_ERR_RANGE (see BVX_ROUNDING_REFUSE). Another
 *  format keeps it, or mesh.frame set to less than it is, by an origin that the file's user knows.
 *  bvx_check_written reports what a file would hold.
 *  Returns BVX_ERR_EMPTY, BVX_ERR_RANGE (beyond what the format holds), BVX_ERR_UNSUPPORTED.
 *  [Memory: the file (text: up to about 1.5 times); GLB: and 24 bytes a vertex, and 84 a triangle while
 *  texture coordinates are split] */
BVX_API bvx_status bvx_write_mesh(bvx_context *context, const bvx_mesh *mesh, int32_t format,
                                  bvx_buffer *file);

/* STL and GLB hold 32-bit floats: STL of the position, GLB of what it is from the middle of the bounds. A
 * mesh is spoilt where that moves a coordinate by more than 1/16 of the mean length of edges, or leaves more
 * than one triangle in 20 without its area or turned over. */
enum { BVX_ROUNDING_REFUSE = 0, BVX_ROUNDING_ALLOW = 1 };

typedef struct bvx_write_options {
    size_t struct_size;
    int32_t normals;  /**< 1: PLY and OBJ get normals of vertices too; GLB always has them, STL and OFF are
                           refused [Limit: 0..1] [Default: 0] */
    int32_t rounding; /**< what becomes of a mesh that the format's 32-bit floats would spoil,
                           BVX_ROUNDING_... [Limit: 0..1] [Default: BVX_ROUNDING_REFUSE] */
} bvx_write_options;

BVX_API void bvx_write_options_init(bvx_write_options *options, size_t size);

/** The same with all choices; NULL options write what bvx_write_mesh writes. Normals are smooth: at each
 *  vertex the sum of its triangles' normals, each counted by its area, at length 1; (0, 0, 1) where the sum
 *  is zero. There is one for each vertex, so sharp edges are averaged over too, as in GLB. PLY: float nx ny
 *  nz after the coordinates; OBJ: vn, with the vertex's number. The readers here skip them.
 *  Returns what bvx_write_mesh returns; BVX_ERR_UNSUPPORTED for normals in STL (which has those of
 *  triangles) or OFF.
 *  [Memory: normals: 24 bytes a vertex more] [Cost: O(vertices + triangles)] */
BVX_API bvx_status bvx_write_mesh_with(bvx_context *context, const bvx_mesh *mesh,
                                       const bvx_write_options *options, int32_t format, bvx_buffer *file);

typedef struct bvx_write_report {
    bvx_certificate file; /**< of the mesh with the positions that the file holds; STL: equal positions are
                               one vertex */
    uint64_t merged;      /**< positions that differ in the mesh and are equal to another in the file */
    uint64_t spoilt;      /**< triangles that lose their area by rounding, or are turned over */
    double largest_move;  /**< of a coordinate, by rounding to 32-bit floats; 0 without rounding [Units:
                               world] */
    double mean_edge;     /**< mean length of edges, where there is rounding [Units: world] */
    int32_t fits;         /**< 1: written by default; 0: refused but for BVX_ROUNDING_ALLOW */
    int32_t reserved;
} bvx_write_report;

/** What readers get of meshes in a format, without writing them: certificates with the positions as the
 *  file rounds them.
 *  levels   [Size: level_count] what one file is to hold, as bvx_write_levels takes them; 1: one mesh
 *  format   STL, OBJ, PLY, OFF or GLB; levels of GLB share one middle, those of other formats are files of
 *           their own
 *  reports  [Size: level_count] out; unspecified after a failure
 *  Returns what the writers return for these meshes, but BVX_OK where they refuse rounding: report.fits is
 *  0 then.
 *  [Memory: what bvx_mesh_check takes; 24 bytes a vertex where positions are rounded or there is a frame,
 *  and 10 a vertex while equal ones are counted] [Cost: O(vertices + triangles)] */
BVX_API bvx_status bvx_check_written(bvx_context *context, const bvx_mesh *levels, uint64_t level_count,
                                     int32_t format, bvx_write_report *reports);

/** Write levels of detail as one file: each is a node "level_0", "level_1", ... with a mesh of its own,
 *  written as bvx_write_mesh writes one, all about one centre. Only level_0 is in the scene; MSFT_lod, a
 *  vendor extension that few readers know, attaches the others to it, and all other viewers show level_0.
 *  When a level gives way to the next: docs/formats.md.
 *  levels       [Size: level_count] the finest first; each has triangles; colours and texture coordinates
 *               are kept where a level has them
 *  level_count  [Limit: 1..65536] 1: the bytes of bvx_write_mesh
 *  format       BVX_FORMAT_GLB; the others hold one mesh a file
 *  file         out, zeroed
 *  Returns BVX_ERR_EMPTY (a level without triangles), BVX_ERR_RANGE (beyond what the format holds: 2^32 - 1
 *  bytes, f32 positions about the common centre), BVX_ERR_UNSUPPORTED (another format: write one file a
 *  level); a message about one level names it.
 *  [Memory: the file; 24 bytes a vertex of all levels; with uv_triangles 12 bytes a triangle and 8 a vertex
 *  as written, and 72 a triangle of one level at a time; about 450 bytes a level] [Cost: O(vertices +
 *  triangles)]
 *  Source: Microsoft. MSFT_lod, a vendor extension of glTF 2.0. */
BVX_API bvx_status bvx_write_levels(bvx_context *context, const bvx_mesh *levels, uint64_t level_count,
                                    int32_t format, bvx_buffer *file);

/** Write a grid. The lattice's low corner (of the window) and spacing go where the format keeps them, by
 *  its own convention:
 *  BVX_FORMAT_NPY     bool, axes [x,y,z] (Fortran order: x runs fastest in the file too); no lattice: see
 *                     bvx_write_lattice
 *  BVX_FORMAT_BINVOX  translate is the low corner, scale the longest side; cubic voxels only
 *  BVX_FORMAT_VOX     MagicaVoxel: at most 256 voxels a side; no lattice
 *  BVX_FORMAT_NRRD    uint8, raw, attached header; "space origin" is the centre of the first voxel
 *  BVX_FORMAT_VTI     VTK image, cell data uint8, raw appended; Origin is the low corner
 *  BVX_FORMAT_BVX     our own: lattice and window whole; each slice by itself, packed by runs, with a
 *                     checksum
 *  Returns BVX_ERR_RANGE (larger than the format holds), BVX_ERR_UNSUPPORTED (no grid format, or a lattice
 *  that it cannot hold).
 *  [Memory: the file; BINVOX: and 64 layers of x a worker] [Cost: O(voxels) bytes written; BVX, BINVOX:
 *  O(words + runs)] */
BVX_API bvx_status bvx_write_grid(bvx_context *context, const bvx_grid *grid, int32_t format,
                                  bvx_buffer *file);

/** Write an octree.
 *  states          VTU: the leaves in a set of states (0: surface and inside); BVX: 0, all of the tree is
 *                  written
 *  BVX_FORMAT_BVX  our own: all levels with their states, each with a checksum; bvx_read_octree reads it
 *  BVX_FORMAT_VTU  VTK unstructured grid: voxels (cells of type 11) with cell data uint8 "level" and
 *                  "state", in the order of bvx_octree_leaves; corners are shared, f64 [Units: world]; raw
 *                  appended
 *  Returns BVX_ERR_EMPTY (no such leaf), BVX_ERR_RANGE (2^28 leaves or more, dims beyond 2^21 - 1),
 *  BVX_ERR_UNSUPPORTED (no octree format).
 *  [Memory: the file; VTU: and 16 bytes a leaf, and 192 while corners are merged] */
BVX_API bvx_status bvx_write_octree(bvx_context *context, const bvx_octree *tree, int32_t states,
                                    int32_t format, bvx_buffer *file);

/** Read an octree from the bytes of a .bvx file that bvx_write_octree made. *tree as for bvx_refine.
 *  Everything is checked before anything is allocated, and no file stands for more than its bytes.
 *  Returns BVX_ERR_FORMAT (byte, and why), BVX_ERR_UNSUPPORTED (a newer version).
 *  [Memory: the tree, at most twice size and 32 KiB] [Cost: O(bytes)] */
BVX_API bvx_status bvx_read_octree(bvx_context *context, const void *bytes, uint64_t size, bvx_octree **tree);

/** Write a field, dense: signed distances (vectors 0) or vectors (1) in its own type of numbers; beyond the
 *  band half_width, negative inside, or 0 0 0. The sign bit is that of the field's inside everywhere.
 *  BVX_FORMAT_NPY   f4 or f8, axes [x,y,z] or [x,y,z,3], Fortran order: all x of vectors, then all y, then
 *                   all z; no lattice: see bvx_write_lattice
 *  BVX_FORMAT_NRRD  float or double, raw; vectors along a first axis of 3; "space origin" is the centre of
 *                   the first voxel
 *  BVX_FORMAT_VTI   point data "distance" or "vector" at the centres, raw appended; Origin is the first one
 *  Returns BVX_ERR_ARGUMENT (also a field without vectors, or whose rows are not those of its band),
 *  BVX_ERR_LATTICE, BVX_ERR_UNSUPPORTED (no format for fields), BVX_ERR_RANGE.
 *  [Memory: the file] [Cost: O(voxels)] */
BVX_API bvx_status bvx_write_field(bvx_context *context, const bvx_field *field, int32_t vectors,
                                   int32_t format, bvx_buffer *file);

/** Read a grid from the bytes of a file.
 *  format  as for bvx_write_grid; values other than 0 are set. Formats that keep no lattice give origin 0
 *          and spacing 1; where a format keeps the centre of the first voxel, the lattice's origin is half
 *          a voxel below it. Types and encodings: docs/formats.md
 *  window  NULL: all of the file; else only these voxels, counted from the file's first one
 *  grid    out; its lattice is the file's box (BVX: the lattice and window that were written). Zeroed, or
 *          with words of the caller's
 *  Returns BVX_ERR_FORMAT (byte or line, and why), BVX_ERR_RANGE (window outside the file, dims beyond the
 *  limits), BVX_ERR_UNSUPPORTED (compressed data, more than one model, turned axes).
 *  [Memory: the grid, and at most size and 32 KiB (VTI in base64: the decoded samples; BVX: the offsets of
 *  slices); BINVOX: and 64 layers of x a worker. Packed formats can stand for far more than their bytes:
 *  set a memory limit for strangers' files] [Cost: O(bytes + words)] */
BVX_API bvx_status bvx_read_grid(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                 const bvx_window *window, bvx_grid *grid);

/** The side-car of a format without a lattice: origin, spacing, dims, fraction_bits, window and center0 as
 *  JSON.
 *  Returns BVX_ERR_RANGE. */
BVX_API bvx_status bvx_write_lattice(bvx_context *context, const bvx_grid *grid, bvx_buffer *file);

/** Put a grid on the lattice and window of a side-car.
 *  Returns BVX_ERR_FORMAT, BVX_ERR_LATTICE (its window has other sides than the grid), BVX_ERR_ARGUMENT;
 *  the grid is then as before. */
BVX_API bvx_status bvx_read_lattice(bvx_context *context, const void *bytes, uint64_t size, bvx_grid *grid);

/** Write a .bvx file slice by slice: the head for a window of a lattice (NULL: all of it), then all its
 *  slices in order, any number in each part (a grid of the same lattice whose window covers x and y whole
 *  and continues in z where the last one ended). Head and parts one after the other are the bytes that
 *  bvx_write_grid makes. */
BVX_API bvx_status bvx_write_head(bvx_context *context, const bvx_lattice *lattice, const bvx_window *window,
                                  bvx_buffer *file);
BVX_API bvx_status bvx_write_slices(bvx_context *context, const bvx_grid *part, bvx_buffer *file);

typedef struct bvx_read_sections_options {
    size_t struct_size;
    double close_gap; /**< CSV: loops whose first and last points lie further apart than this are refused
                           as open polylines; 0 closes all of them by a straight side [Units: world]
                           [Limit: >= 0] [Default: 0] */
    uint64_t reserved;
} bvx_read_sections_options;

BVX_API void bvx_read_sections_options_init(bvx_read_sections_options *options, size_t size);

/** Read section contours from the bytes of a file. How holes and labels of CSL are read: docs/formats.md.
 *  BVX_FORMAT_CSL  planes with their equation, points and loops with labels; normals are set unless all
 *                  planes are parallel within 1e-4 rad, points lie within 1/1000 of the largest coordinate
 *  BVX_FORMAT_CSV  a head line and lines of section, position, loop, x, y (any order, others are ignored;
 *                  also label); comma, semicolon or tab. Planes are z = position, or with the columns z,
 *                  nx, ny, nz of any direction (normals are set, position as in bvx_sections); a first
 *                  point that is repeated at the end is left out
 *  Returns BVX_ERR_FORMAT (line and why), BVX_ERR_UNSUPPORTED (no contour
 *  format), BVX_ERR_EMPTY, BVX_ERR_RANGE.
 *  [Memory, the stack included: at most 40 times size and 32 KiB] [Cost: O(bytes)] */
BVX_API bvx_status bvx_read_sections(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                     const bvx_read_sections_options *options, bvx_sections *sections);

/** Write section contours: BVX_FORMAT_CSL, BVX_FORMAT_CSV (planes z = position, or normals) or BVX_FORMAT_SVG (a
 *  drawing: sections side by side, filled by even-odd, y up). Numbers of CSL and CSV read back to the same
 *  ones.
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

typedef struct bvx_render_options {
    size_t struct_size;
    int32_t width, height; /**< [Units: pixels] [Limit: 1..16384] [Default: 1024, 768] */
    double direction[3];   /**< from the model towards the eye [Limit: any] [Default: 3, -4, 2] */
    double up[3];          /**< what is up in the picture [Limit: any] [Default: 0, 0, 1] */
    uint8_t colour[4];     /**< of the surface: red, green, blue, 0 [Limit: any] [Default: 200, 196, 188] */
    uint8_t background[4]; /**< [Limit: any] [Default: 255, 255, 255] */
    int32_t smooth;    /**< 1: normals averaged at vertices, 0: of each facet [Limit: 0..1] [Default: 0] */
    int32_t samples;   /**< rays a pixel along each side [Limit: 1..4] [Default: 2] */
    int32_t wireframe; /**< 1: the edges of triangles (grids: of voxels) drawn over the surface [Limit:
                            0..1] [Default: 0] */
    int32_t reserved;
    double cut_low[3];  /**< what lies below along an axis is taken away [Units: world] [Limit: any]
                             [Default: -infinity] */
    double cut_high[3]; /**< what lies above is taken away; grids are cut to whole voxels [Limit: any]
                             [Default: infinity] */
    double show[2];     /**< the frame shows at least so much on either side of the middle of the model's
                             bounds, along its width and its height, so that pictures from several sides
                             have one scale [Units: world] [Limit: >= 0; finite] [Default: 0, 0: the model
                             fills the frame] */
} bvx_render_options;

BVX_API void bvx_render_options_init(bvx_render_options *options, size_t size);

/** A shaded picture of a mesh that fills the frame: orthographic, one light near the eye, ambient light
 *  from the depths around. Colours of the view's vertices replace options.colour. Back faces are reddish. A
 *  cut opens the mesh: its back faces show. The frame fits what is left. Deterministic bytes.
 *  Returns BVX_ERR_EMPTY, BVX_ERR_RANGE.
 *  [Cost: O(pixels * samples^2 + triangles)] */
BVX_API bvx_status bvx_render_mesh(bvx_context *context, const bvx_mesh_view *mesh,
                                   const bvx_render_options *options, bvx_image *image);

/** The same for a grid: its exposed voxel faces. A cut shows the voxels inside, flat and a little darker. */
BVX_API bvx_status bvx_render_grid(bvx_context *context, const bvx_grid *grid,
                                   const bvx_render_options *options, bvx_image *image);

/** Two grids of one lattice and window in one picture: voxels of both in options.colour, only of before
 *  (removed) red, only of after (added) green.
 *  Returns BVX_ERR_LATTICE too.
 *  [Memory: as bvx_render_grid] */
BVX_API bvx_status bvx_render_difference(bvx_context *context, const bvx_grid *before, const bvx_grid *after,
                                         const bvx_render_options *options, bvx_image *image);

/** A sheet of count slices across an axis (0, 1, 2), evenly spread from the lowest voxel to the highest, in
 *  reading order: set voxels in options.colour, on background, thin lines between; up the sheet is y (axis
 *  2) or z, and the voxels' shape is that of the spacing. A pixel shows its voxel, or where it covers
 *  several the share that is set, never less than a quarter of the colour when one is. options.cut_low and
 *  cut_high apply; direction, up, smooth, wireframe are ignored. [Limit: count 1..1024]
 *  Returns BVX_ERR_EMPTY (nothing is set). */
BVX_API bvx_status bvx_render_slices(bvx_context *context, const bvx_grid *grid, int32_t axis, int32_t count,
                                     const bvx_render_options *options, bvx_image *image);

/** Write a PNG with stored blocks: its bytes depend only on the pixels. */
BVX_API bvx_status bvx_write_png(bvx_context *context, const bvx_image *image, bvx_buffer *file);

#ifdef __cplusplus
}
#endif

#endif /* BITVOX_H */
