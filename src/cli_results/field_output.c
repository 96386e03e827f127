/* field_output.c - distances from the centres of voxels as one file or two; voxelize --mode field. */
#include "cli_results/results.h"

#include <inttypes.h>
#include <math.h>

enum { FIELD_HALF_WIDTH = 3, FIELD_MOST_PADDING = 65536 };

static double half_width_of(const cli_run *run)
{
    if (!cli_given(run, "--half-width")) return FIELD_HALF_WIDTH;
    return run->options->half_width > 0.0 ? run->options->half_width : (double)INFINITY;
}

void cli_choose_field_padding(cli_run *run)
{
    cli_options *const o = run->options;
    double const width = half_width_of(run);

    /* The band reaches so far beyond the mesh; a field without an end takes the usual room. */
    if (!cli_given(run, "--padding") && !o->origin.given)
        o->padding = width < FIELD_MOST_PADDING ? (int32_t)ceil(width) : FIELD_HALF_WIDTH;
}

int cli_write_field(cli_run *run, const bvx_field *field)
{
    int32_t const format = bvx_format_of_name(run->options->output);
    bvx_buffer file = {0};

    cli_stage_begin(run, "write");
    cli_stage_calls(run, 2);
    return cli_finish_voxels(run, bvx_write_field(run->context, field, run->options->vectors, format, &file),
                             &file, &field->band);
}

static void tell_field(const cli_options *o, const bvx_field *f, uint64_t inside, cli_made *made)
{
    cli_text *const t = &made->members;

    cli_text_add(&made->text, "  field       %s within %.9g\n  sign        %s",
                 o->vectors ? "vectors" : "distances", f->half_width, cli_sign_names[f->sign]);
    if (f->sign != BVX_SIGN_NONE) cli_text_add(&made->text, ", %" PRIu64 " centres inside", inside);
    cli_text_add(&made->text, "\n");

    cli_text_add(t, ", \"field\": {\"sign\": \"%s\"", cli_sign_names[f->sign]);
    cli_json_value(t, "half_width", f->half_width);
    cli_json_count(t, "values", f->value_count);
    cli_json_count(t, "inside", inside);
    cli_json_truth(t, "vectors", o->vectors);
    cli_text_add(t, ", \"value_type\": \"f%d\"}", f->value_type == BVX_F64 ? 64 : 32);
    if (f->value_count == 0) cli_advise(made, "no voxel's centre is within %.9g of the mesh", f->half_width);
}

bvx_status cli_make_field(const cli_run *run, const bvx_mesh_view *view, const bvx_lattice *lattice,
                          const bvx_window *window, bvx_field *field, cli_made *made)
{
    bvx_field_options o;
    bvx_status status;
    uint64_t inside = 0;

    bvx_field_options_init(&o, sizeof o);
    o.half_width = half_width_of(run);
    o.sign = run->options->sign;
    o.value_type = cli_given(run, "--value-type") ? run->options->value_type : BVX_F32;
    o.no_vectors = !run->options->vectors;
    o.window = *window;
    status = bvx_measure_field(run->context, view, lattice, &o, field);
    /* Without a sign nothing is known to be inside. */
    if (status == BVX_OK && field->inside.words != NULL)
        status = bvx_grid_count(run->context, &field->inside, &inside);
    if (status != BVX_OK) return status;

    made->field = field;
    made->set = field->value_count;
    tell_field(run->options, field, inside, made);
    return BVX_OK;
}
