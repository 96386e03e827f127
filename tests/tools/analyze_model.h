/* analyze_model.h - what holds across files and the analyzers, which look at one at a time, cannot see. Read
 * in before each source by analyze.sh, which defines ANALYZED_<its name> and IN_<its room>; never compiled
 * into anything.
 *
 * A function that reports a failure returns the status that it is given, which is no success; an allocation
 * that succeeds gives a block. The file that defines such a function sees it as it is: there the analyzers
 * check what is said here. */
#ifdef IN_cli
#define _DEFAULT_SOURCE
#define _POSIX_C_SOURCE 200809L
#endif
#include "core/core.h"
#include "io_contour/contour_text.h"
#include "io/formats.h"
#include "io_grid/grid_formats.h"
#include "io_mesh/ply_file.h"
#include "mesh/view.h"
#ifdef IN_cli
#include "cli_commands/commands.h"
#undef _DEFAULT_SOURCE
#endif

void model_cannot_be(void) __attribute__((noreturn));

static __attribute__((noinline, unused)) bvx_status model_failure(bvx_status status)
{
    if (status == BVX_OK) model_cannot_be();
    return status;
}

static __attribute__((noinline, unused)) bvx_status model_block(bvx_status status, void *block)
{
    if (status == BVX_OK && *(void **)block == NULL) model_cannot_be();
    return status;
}

#ifndef ANALYZED_memory
#define bvxi_alloc(ctx, kind, size, what, block) \
    model_block((bvxi_alloc)(ctx, kind, size, what, block), block)
#define bvxi_alloc_zero(ctx, kind, size, what, block) \
    model_block((bvxi_alloc_zero)(ctx, kind, size, what, block), block)
#define bvxi_resize(ctx, kind, block, size, to, what) \
    model_block((bvxi_resize)(ctx, kind, block, size, to, what), block)
#endif
#ifndef ANALYZED_message
#define bvxi_fail(...)      model_failure((bvxi_fail)(__VA_ARGS__))
#define bvxi_fail_null(...) model_failure((bvxi_fail_null)(__VA_ARGS__))
#define bvxi_fail_at(...)   model_failure((bvxi_fail_at)(__VA_ARGS__))
#endif
#ifndef ANALYZED_contour_text
#define bvxi_contour_fail(...)        model_failure((bvxi_contour_fail)(__VA_ARGS__))
#define bvxi_contour_fail_number(...) model_failure((bvxi_contour_fail_number)(__VA_ARGS__))
#endif
#ifndef ANALYZED_read_mesh
#define bvxi_fail_expected(...) model_failure((bvxi_fail_expected)(__VA_ARGS__))
#endif
#ifndef ANALYZED_read_dense
#define bvxi_fail_short_array(...) model_failure((bvxi_fail_short_array)(__VA_ARGS__))
#endif
#ifndef ANALYZED_read_ply
#define bvxi_ply_fail_end(...)    model_failure((bvxi_ply_fail_end)(__VA_ARGS__))
#define bvxi_ply_fail_finite(...) model_failure((bvxi_ply_fail_finite)(__VA_ARGS__))
#define bvxi_ply_fail_corner(...) model_failure((bvxi_ply_fail_corner)(__VA_ARGS__))
#define bvxi_ply_fail_length(...) model_failure((bvxi_ply_fail_length)(__VA_ARGS__))
#endif
#ifndef ANALYZED_view
#define bvxi_view_fail_index(...)  model_failure((bvxi_view_fail_index)(__VA_ARGS__))
#define bvxi_view_fail_finite(...) model_failure((bvxi_view_fail_finite)(__VA_ARGS__))
#endif
#if defined(IN_cli) && !defined(ANALYZED_messages)
#define cli_fail(...)             model_failure((cli_fail)(__VA_ARGS__))
#define cli_usage(...)            model_failure((cli_usage)(__VA_ARGS__))
#define cli_fail_status(...)      model_failure((cli_fail_status)(__VA_ARGS__))
#define cli_fail_interrupted(...) model_failure((cli_fail_interrupted)(__VA_ARGS__))
#endif
