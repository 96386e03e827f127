/* fuzz_contours.c - the contour readers on damaged files, and bodies from whatever was read: no crash, no leak, an error in words or a
 * stack that is written and read to itself; a body that is closed and manifold.
 *
 * A libFuzzer target: the first byte of the input chooses format and options, the rest is the file. With BVX_FUZZ_MAIN it is a
 * program of its own that damages built-in files by a fixed generator: fuzz_contours [inputs [seed]]. */
#include "bitvox.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void fuzz_require(int good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz_contours: %s\n", what);
    abort();
}

static bvx_context *fuzz_context(void)
{
    bvx_context_options o;
    bvx_context *ctx = NULL;
    bvx_context_options_init(&o, sizeof o);
    o.threads = 1;
    o.memory_limit = 32 << 20;
    fuzz_require(bvx_context_create(&o, &ctx) == BVX_OK, "no context");
    return ctx;
}

static void fuzz_check_writing(bvx_context *ctx, const bvx_sections *s)
{
    bvx_buffer file = {0};
    bvx_sections back;
    memset(&back, 0, sizeof back);
    if (bvx_write_sections(ctx, s, BVX_FORMAT_CSL, &file) == BVX_OK) { /* negative labels and numbers that are too large are refused */
        fuzz_require(bvx_read_sections(ctx, file.bytes, file.size, BVX_FORMAT_CSL, NULL, &back) == BVX_OK, bvx_last_message(ctx));
        fuzz_require(back.point_count == s->point_count && back.loop_count == s->loop_count, "another stack"); /* loops come back section by section */
    }
    bvx_sections_free(ctx, &back);
    bvx_buffer_free(ctx, &file);
}

static int fuzz_check_body(bvx_context *ctx, const bvx_sections *s, int choice)
{
    bvx_sections_options o;
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_status status;
    bvx_sections_options_init(&o, sizeof o);
    o.grid[0] = 2 + choice % 7;
    o.grid[1] = 2 + choice % 11;
    o.depth = choice % 5;
    o.caps = choice % 2;
    o.layers = 1 + choice % 3;
    o.label = s->loops[0].label;
    status = bvx_build_sections(ctx, s, &o, &mesh);
    if (status == BVX_OK) {
        bvx_mesh_view_of(&mesh, &view);
        fuzz_require(bvx_mesh_check(ctx, &view, 0, &c) == BVX_OK, bvx_last_message(ctx));
        fuzz_require(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented, "a body that is not closed or not manifold");
    } else {
        fuzz_require(mesh.positions == NULL && bvx_last_message(ctx)[0] != 0, "a failure with a result, or without words");
        fuzz_require(status != BVX_ERR_ARGUMENT || strstr(bvx_last_message(ctx), "stands for none") != NULL, bvx_last_message(ctx));
        fuzz_require(strstr(bvx_last_message(ctx), "does not close") == NULL, bvx_last_message(ctx));
    }
    bvx_mesh_free(ctx, &mesh);
    return status == BVX_OK;
}

static int fuzz_read(bvx_context *ctx, const uint8_t *data, size_t size, int choice)
{
    bvx_sections s;
    int built = 0;
    memset(&s, 0, sizeof s);
    if (bvx_read_sections(ctx, data, size, choice & 1 ? BVX_FORMAT_CSL : BVX_FORMAT_CSV, NULL, &s) == BVX_OK) {
        fuzz_require(s.loop_count > 0 && s.owned == 1, "a stack without loops");
        fuzz_check_writing(ctx, &s);
        built = fuzz_check_body(ctx, &s, choice >> 1);
    } else {
        fuzz_require(s.points == NULL && bvx_last_message(ctx)[0] != 0, "a failure with a result, or without words");
    }
    bvx_sections_free(ctx, &s);
    fuzz_require(bvx_memory_used(ctx) == 0, "memory that is not given back");
    return built;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bvx_context *const ctx = fuzz_context();
    if (size > 0) fuzz_read(ctx, data + 1, size - 1, data[0]);
    bvx_context_destroy(ctx);
    return 0;
}

#if defined(BVX_FUZZ_MAIN)

static uint64_t fuzz_state = 1;

static uint32_t fuzz_below(uint32_t n)
{
    fuzz_state ^= fuzz_state << 13;
    fuzz_state ^= fuzz_state >> 7;
    fuzz_state ^= fuzz_state << 17;
    return (uint32_t)(fuzz_state >> 33) % n;
}

static const char fuzz_csv[] = "section,position,loop,x,y\n1,0,1,0,0\n1,0,1,9,0\n1,0,1,9,7\n1,0,1,0,7\n1,0,2,2,2\n1,0,2,5,2\n1,0,2,5,4\n2,4,1,1,1\n2,4,1,8,1\n"
                               "2,4,1,8,8\n2,4,1,3,6\n3,6,1,1,1\n3,6,1,4,1\n3,6,1,4,4\n3,6,2,6,5\n3,6,2,7,7\n3,6,2,5,7\n";
static const char fuzz_csl[] = "CSLC\n2 2\n\n1 7 2 0 0 1 -0.5\n\n0 0 0.5\n4 0 0.5\n4 4 0.5\n0 4 0.5\n1 1 .5\n2 1 .5\n1 2 .5\n\n4 1 0 1 2 3\n3h0 1 4 5 6\n"
                               "2 3 1 0 0 -1 1.5\n0 0 1.5 4 0 1.5 4 4 1.5\n3 1 2 1 0\n";

/* Another digit, another byte, a piece left out or repeated. */
static size_t fuzz_damage(char *work, size_t size, size_t room)
{
    size_t const at = fuzz_below((uint32_t)size), n = 1 + fuzz_below(12);
    switch (fuzz_below(6)) {
    case 0: work[at] = (char)fuzz_below(256); return size;
    case 1: return at;
    case 2:
        if (at + n >= size) return size;
        memmove(work + at, work + at + n, size - at - n);
        return size - n;
    case 3:
        if (at + n >= size || size + n > room) return size;
        memmove(work + at + n, work + at, size - at);
        return size + n;
    default:
        for (size_t i = at; i < size; i++)
            if (work[i] >= '0' && work[i] <= '9') {
                work[i] = (char)('0' + fuzz_below(10));
                break;
            }
        return size;
    }
}

int main(int argc, char **argv)
{
    unsigned long const inputs = argc > 1 ? strtoul(argv[1], NULL, 10) : 20000;
    unsigned long built = 0;
    bvx_context *const ctx = fuzz_context();
    fuzz_state = (argc > 2 ? strtoul(argv[2], NULL, 10) : 1) * 2 + 1;
    for (unsigned long i = 0; i < inputs; i++) {
        static char work[4096];
        int const choice = (int)(fuzz_below(1u << 20) << 1 | (i & 1));
        const char *const text = i & 1 ? fuzz_csl : fuzz_csv;
        size_t size = strlen(text);
        char *exact;
        memcpy(work, text, size);
        for (uint32_t n = fuzz_below(5); n > 0 && size > 0; n--) size = fuzz_damage(work, size, sizeof work);
        exact = malloc(size > 0 ? size : 1); /* so that a sanitizer sees a read beyond the end */
        fuzz_require(exact != NULL, "no memory");
        memcpy(exact, work, size);
        built += (unsigned long)fuzz_read(ctx, (const uint8_t *)exact, size, choice);
        free(exact);
    }
    bvx_context_destroy(ctx);
    printf("fuzz_contours: %lu inputs, %lu bodies, 0 failures\n", inputs, built);
    return built > 0 ? 0 : 1;
}

#endif
