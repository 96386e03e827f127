/* context.h - contexts and blocks for the fault tests; what cannot fail is asserted here. */
#ifndef FAULT_CONTEXT_H
#define FAULT_CONTEXT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above */
#include <cmocka.h>

#include "core/core.h"
#include "tools/fault.h"

static inline bvx_context_options default_options(void)
{
    bvx_context_options o = {.struct_size = sizeof o};
    return o;
}

static inline bvx_context *context_with(const bvx_context_options *options)
{
    bvx_context *ctx = NULL;
    assert_int_equal(bvx_context_create(options, &ctx), BVX_OK);
    assert_non_null(ctx);
    return ctx;
}

static inline void *get(bvx_context *ctx, int kind, uint64_t size)
{
    void *block = NULL;
    assert_int_equal(bvxi_alloc(ctx, kind, size, "a test's block", &block), BVX_OK);
    assert_non_null(block);
    assert_int_equal((uintptr_t)block % BVXI_ALIGN, 0);
    memset(block, 0x5A, (size_t)size);
    return block;
}

#endif
