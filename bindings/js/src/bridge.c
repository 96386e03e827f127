/* bridge.c - what the JavaScript package needs beside bitvox.h: progress reports that reach JavaScript.
 *
 * All else is called as it is: the package fills the library's own structs, whose layouts build.mjs reads
 * from the header and the compiler confirms (layout.h, made by build.mjs). */
#include "bitvox_io.h"
#include "mesh/mesh.h"

#include <stddef.h>

#include "layout.h"

/* Given by JavaScript: a result other than 0 cancels. */
__attribute__((import_module("bitvox"), import_name("report"))) int32_t bridge_report(const char *stage,
                                                                                      double fraction);

static int32_t forward(void *user, const char *stage, double fraction)
{
    (void)user;
    return bridge_report(stage, fraction);
}

/* The function as the library takes it: its index in the table of functions. */
bvx_progress_fn *bridge_progress(void)
{
    return forward;
}
