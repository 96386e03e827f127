/* context.c - contexts made and destroyed: options checked, allocator or arena, threads and code path
 * chosen.
 *
 * A context lives in memory of its own allocator, or at the front of its arena, so the library needs no
 * memory of its own. A build or thread whose arithmetic would change results gets none. */
#include "context.h"

/* Why no context can be made, and the status that says so; BVX_OK and NULL where one can. */
typedef struct context_fault {
    bvx_status status;
    const char *text;
} context_fault;

static context_fault fault_of(bvx_status status, const char *text)
{
    context_fault const f = {status, text};
    return f;
}

/* The options of an older or newer caller as this library knows them. */
static context_fault take_context_options(int32_t header_version, const bvx_context_options *options,
                                          bvx_context_options *o)
{
    size_t given_size = 0;

    memset(o, 0, sizeof *o);

    /* Before 1.0 a minor version may change the interface. */
    int32_t const step = BVX_VERSION_MAJOR == 0 ? 100 : 10000;
    if (header_version / step != BVX_VERSION / step)
        return fault_of(BVX_ERR_VERSION,
                        "the header that was compiled and this library are of different versions");
    /* A build that would give other results is refused before anything is taken. */
    if (bvxi_arithmetic_fault() != NULL) return fault_of(BVX_ERR_UNSUPPORTED, bvxi_arithmetic_fault());
    if (options == NULL) return fault_of(BVX_OK, NULL);

    memcpy(&given_size, options, sizeof given_size);
    if (given_size < sizeof given_size || given_size > 65536)
        return fault_of(BVX_ERR_ARGUMENT, "struct_size is not the sizeof of the options");
    for (size_t i = sizeof *o; i < given_size; i++)
        if (((const unsigned char *)options)[i] != 0)
            return fault_of(BVX_ERR_VERSION, "a field is set that this library does not know");
    memcpy(o, options, given_size < sizeof *o ? given_size : sizeof *o);

    if ((o->allocator.alloc == NULL) != (o->allocator.free == NULL))
        return fault_of(BVX_ERR_ARGUMENT, "allocator.alloc and .free are given together");
    if (o->allocator.alloc != NULL && o->arena.memory != NULL)
        return fault_of(BVX_ERR_ARGUMENT, "allocator and arena exclude each other");
    if ((o->arena.memory == NULL) != (o->arena.size == 0))
        return fault_of(BVX_ERR_ARGUMENT, "arena.memory and .size are given together");
    if (o->threads < 0 || o->threads > BVXI_MAX_THREADS)
        return fault_of(BVX_ERR_ARGUMENT, "threads is 0 to 1024");
    if (o->cpu < BVX_CPU_BEST || o->cpu > BVX_CPU_AVX2)
        return fault_of(BVX_ERR_ARGUMENT, "cpu is BVX_CPU_BEST, BVX_CPU_PORTABLE or BVX_CPU_AVX2");
    return fault_of(BVX_OK, NULL);
}

/* Where no threads are built in and none are given all runs on the calling one. */
static int32_t choose_threads(const bvx_context_options *o)
{
    if (o->parallel.call != NULL) return o->threads == 0 ? 1 : o->threads;
    if (bvxi_pool_size(2) == 0) return 1;
    return o->threads == 0 ? bvxi_processors() : o->threads;
}

static size_t aligned_size(size_t size)
{
    return (size + BVXI_ALIGN - 1) / BVXI_ALIGN * BVXI_ALIGN;
}

static size_t arena_skip(const void *memory)
{
    return (BVXI_ALIGN - (uintptr_t)memory % BVXI_ALIGN) % BVXI_ALIGN;
}

/* The context, one line at the end for the word of the arena's chain, and one to give. */
static int fits_in_arena(const void *memory, uint64_t size, size_t own)
{
    return size <= SIZE_MAX && size >= arena_skip(memory) + own + 2 * (size_t)BVXI_ALIGN;
}

/* The context and a word for the arena's chain come off the arena's front; the rest becomes the arena. */
static bvx_context *place_in_arena(void *memory, uint64_t size, size_t own, bvxi_arena *arena)
{
    unsigned char *const base = memory;
    size_t const skip = arena_skip(memory);
    if (!fits_in_arena(memory, size, own)) return NULL;
    arena->memory = base + skip + own;
    arena->size = ((size_t)size - skip - own - BVXI_ALIGN) / BVXI_ALIGN * BVXI_ALIGN;
    arena->low = 0;
    arena->high = arena->least = arena->size;
    memset(arena->memory + arena->size, 0, sizeof(size_t));
    return (bvx_context *)(void *)(base + skip);
}

/* The context and its helpers' state, where they are the library's own. */
static size_t context_size(const bvx_context_options *o, int32_t threads)
{
    return aligned_size(sizeof(bvx_context)) +
           (o->parallel.call == NULL ? aligned_size(bvxi_pool_size(threads)) : 0);
}

const char *bvx_context_fault(int32_t header_version, const bvx_context_options *options)
{
    bvx_context_options o;
    context_fault const f = take_context_options(header_version, options, &o);
    /* Nothing is written to the arena, which may be another context's. */
    if (f.status != BVX_OK || o.arena.memory == NULL ||
        fits_in_arena(o.arena.memory, o.arena.size, context_size(&o, choose_threads(&o))))
        return f.text;
    return "the arena is too small for the context and its threads";
}

bvx_status bvx_context_create_version(int32_t header_version, const bvx_context_options *options,
                                      bvx_context **context)
{
    bvx_context_options o;
    bvxi_arena arena = {0};
    bvx_context *c;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    *context = NULL;
    context_fault fault = take_context_options(header_version, options, &o);
    if (fault.status != BVX_OK) return fault.status;
    if (o.allocator.alloc == NULL) {
        o.allocator.alloc = bvxi_heap_alloc;
        o.allocator.free = bvxi_heap_free;
    }

    /* The helpers' state and the table of scratch lie behind the context, in the one block that creating a
     * context takes. */
    int32_t threads = choose_threads(&o); /* once: to count processors takes longer than all that follows */
    size_t const size = context_size(&o, threads);
    size_t const table = o.arena.memory == NULL ? BVXI_SCRATCH_ROOM * sizeof *c->scratch : 0;
    c = o.arena.memory != NULL ? place_in_arena(o.arena.memory, o.arena.size, size, &arena)
                               : o.allocator.alloc(o.allocator.user, size + table, BVXI_ALIGN);
    if (c == NULL) return BVX_ERR_MEMORY;

    memset(c, 0, sizeof *c);
    c->size = size + table;
    if (table != 0) {
        c->scratch = c->scratch_first = (bvxi_scratch *)(void *)((unsigned char *)c + size);
        c->scratch_room = BVXI_SCRATCH_ROOM;
    }
    c->alloc = o.allocator.alloc;
    c->free = o.allocator.free;
    c->alloc_user = o.allocator.user;
    c->arena = arena;
    c->memory_limit = o.memory_limit;
    c->parallel = o.parallel.call;
    c->parallel_user = o.parallel.user;
    c->progress = o.progress.call;
    c->progress_user = o.progress.user;
    c->share[0].high = 1.0;
    c->error.function = "";
    c->error.message = c->error.text = c->message;
    c->error.index = -1;
    c->threads = threads;
    if (size > aligned_size(sizeof *c)) {
        bvxi_pool *const pool = (bvxi_pool *)(void *)((unsigned char *)c + aligned_size(sizeof *c));
        if (bvxi_pool_begin(pool, c->threads)) c->pool = pool;
        else c->threads = 1;
    }
    int32_t const best = bvxi_cpu_detect();
    c->cpu = o.cpu == BVX_CPU_BEST || o.cpu > best ? best : o.cpu;
    *context = c;
    return BVX_OK;
}

void bvx_context_destroy(bvx_context *context)
{
    if (context == NULL) return;
    if (context->pool != NULL) bvxi_pool_end(context->pool);
    if (context->arena.memory == NULL) context->free(context->alloc_user, context, context->size, BVXI_ALIGN);
}

int32_t bvx_context_threads(const bvx_context *context)
{
    return context == NULL ? 0 : context->threads;
}
