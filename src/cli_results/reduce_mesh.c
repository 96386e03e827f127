/* reduce_mesh.c - --triangles and --error of the commands that make one mesh: its edges collapse once it is
 * made.
 *
 * --error is the distance from the mesh as it was made, not from what it was made of. */
#include "cli_results/results.h"

#include <inttypes.h>

int cli_reduce(cli_run *run, bvx_mesh *mesh, cli_reduction *r)
{
    const cli_options *const o = run->options;
    uint64_t const target = o->triangles.count != 0 ? (uint64_t)o->triangles.value[0] : 0;
    double error = o->errors.value[0];
    bvx_mesh less = {0};
    bvx_simplify_options s;
    bvx_mesh_view view;
    cli_box box;

    /* --error is in percent of the diagonal of the mesh that collapses. */
    r->before = mesh->triangle_count;
    if (!cli_reduces(run) || mesh->triangle_count == 0) return CLI_DONE;
    cli_mesh_box(mesh, &box);
    if (o->errors.percent[0]) error *= cli_diagonal(box.low, box.high) / 100.0;

    /* One target, a count or a distance: rules have refused both. */
    bvx_simplify_options_init(&s, sizeof s);
    if (target != 0) s.target_triangles = &target;
    else s.target_errors = &error;
    s.error_kind = o->error_kind;
    s.reports = &r->level;

    bvx_mesh_view_of(mesh, &view);
    cli_stage_begin(run, "simplify");
    CLI_TRY(cli_stage_check(run, bvx_mesh_simplify(run->context, &view, &s, 1, &less), run->options->output));

    /* The report keeps the size of the mesh that it was. */
    bvx_mesh_free(run->context, mesh);
    *mesh = less;
    r->done = 1;
    return CLI_DONE;
}

void cli_tell_reduction(const cli_run *run, const cli_reduction *r, cli_made *made)
{
    cli_text *const t = &made->members;

    if (!r->done) return;
    cli_tell(made,
             "  collapsed   %" PRIu64 " of %" PRIu64
             " triangles are left%s; smallest angle %.2f degrees, %" PRIu64 " crossings\n",
             r->level.triangles, r->before, r->level.met ? "" : ", more than requested", r->level.least_angle,
             r->level.crossings);
    cli_text_add(t, ", \"simplify\": {\"triangles_before\": %" PRIu64, r->before);
    cli_json_count(t, "triangles", r->level.triangles);
    cli_json_truth(t, "met", r->level.met);
    cli_json_value(t, "least_angle", r->level.least_angle);
    cli_json_count(t, "crossings", r->level.crossings);
    cli_text_add(t, "}");
    /* Below this nothing closed and free of crossings is left; the target was not a promise. */
    if (!r->level.met)
        cli_advise(made,
                   "%s has %" PRIu64 " triangles, not %" PRIu64
                   ": these are the fewest that collapsing edges leaves sound",
                   run->options->output, r->level.triangles, (uint64_t)run->options->triangles.value[0]);
}
