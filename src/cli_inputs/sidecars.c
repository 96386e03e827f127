/* sidecars.c - the side-car that says where a grid lies.
 *
 * .npy and .vox hold voxels only. Where their lattice lies stands in a side-car beside them, FILE.npy.json;
 * without one the voxels start at 0 and have sides of 1. A side-car that is damaged or belongs to a grid of
 * another size is an error. */
#include "cli_inputs/inputs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bvx_status take_lattice(cli_run *run, const cli_bytes *b, bvx_grid *grid)
{
    bvx_grid whole;

    /* A grid as large as the whole file, since a side-car tells of all of it; its words are not looked at. */
    whole = *grid;
    memset(whole.low, 0, sizeof whole.low);
    memcpy(whole.size, grid->lattice.dims, sizeof whole.size);
    whole.words_per_row = (whole.size[0] - 1) / 64 + 1;
    whole.word_capacity = UINT64_MAX;
    if (whole.words == NULL) whole.words = &whole.word_capacity; /* a volume has none */
    /* The library checks that sizes agree, so it is shown the whole file and not the part. */
    bvx_status const status = bvx_read_lattice(run->context, b->bytes, b->size, &whole);
    if (status != BVX_OK) return status;
    grid->lattice = whole.lattice;
    for (int a = 0; a < 3; a++) grid->low[a] += whole.low[a];
    return BVX_OK;
}

int cli_read_sidecar(cli_run *run, const char *path, bvx_grid *grid, int *placed)
{
    char *const name = strcmp(path, "-") == 0 ? NULL : cli_sidecar_name(path);
    cli_bytes b = {NULL, 0, 0, 0};
    int status = CLI_DONE;

    *placed = 0;
    if (name == NULL) return strcmp(path, "-") == 0 ? CLI_DONE : cli_fail(run, "no memory for a file's name");
    FILE *const file = cli_open_file(name, "rb");
    if (file != NULL) {
        fclose(file);
        status = cli_read_file(run, name, &b);
        if (status == CLI_DONE) {
            bvx_status const read = take_lattice(run, &b, grid);
            if (read != BVX_OK) status = cli_fail_status(run, read, name);
            else *placed = 1;
        }
        free(b.bytes);
    } else if (errno != ENOENT) {
        status = cli_fail(run, "%s: %s", name, strerror(errno));
    }
    free(name);
    return status;
}
