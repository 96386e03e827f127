/* write_nrrd.c - a grid to NRRD: uint8, raw, with its head attached.
 *
 * Source: Kindlmann. Definition of NRRD File Format. The space has three dimensions and no name: a lattice
 * does not know left from right. "space origin" is the centre of the first sample by that definition, half a
 * voxel above the corner; since adding that half may round, a key of our own keeps the corner for our
 * reader. */
#include "io_grid/grid_formats.h"

static void nrrd_put_double(bvxi_output *out, double v)
{
    char text[32];
    bvxi_output_add(out, text, (size_t)bvxi_print_double(v, text));
}

/* (x,y,z) */
static void nrrd_put_vector(bvxi_output *out, double x, double y, double z)
{
    bvxi_output_text(out, "(");
    nrrd_put_double(out, x);
    bvxi_output_text(out, ",");
    nrrd_put_double(out, y);
    bvxi_output_text(out, ",");
    nrrd_put_double(out, z);
    bvxi_output_text(out, ")");
}

static void nrrd_put_head(const bvx_grid *grid, bvxi_output *out)
{
    const double *const s = grid->lattice.spacing;
    double c[3];

    bvxi_grid_corner(grid, c);
    bvxi_output_text(out, "NRRD0004\ntype: uint8\ndimension: 3\nspace dimension: 3\nsizes:");
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, " ");
        bvxi_output_number(out, (uint64_t)grid->size[a]);
    }

    /* Each axis of the grid is one of space, so its direction has one component. */
    bvxi_output_text(out, "\nspace directions: ");
    nrrd_put_vector(out, s[0], 0, 0);
    bvxi_output_text(out, " ");
    nrrd_put_vector(out, 0, s[1], 0);
    bvxi_output_text(out, " ");
    nrrd_put_vector(out, 0, 0, s[2]);
    bvxi_output_text(out, "\nspace origin: ");
    nrrd_put_vector(out, c[0] + 0.5 * s[0], c[1] + 0.5 * s[1], c[2] + 0.5 * s[2]);
    bvxi_output_text(
        out, "\ncenterings: cell cell cell\nkinds: domain domain domain\nencoding: raw\n" BVXI_NRRD_CORNER_KEY
             ":=");

    /* A key of our own: the corner itself, which half a voxel may not lead back to. */
    nrrd_put_vector(out, c[0], c[1], c[2]);
    bvxi_output_text(out, "\n\n");
}

bvx_status bvxi_write_nrrd(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file)
{
    static const bvxi_dense_file nrrd = {"the NRRD file", nrrd_put_head, ""};
    BVXI_TRY(bvxi_check_written_corner(ctx, "NRRD", grid));
    return bvxi_write_dense(ctx, grid, &nrrd, file);
}
