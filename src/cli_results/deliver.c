/* deliver.c - what a command has made: written, told and warned of in one place. */
#include "cli_results/results.h"

#include <stdlib.h>

void cli_note_voxels(cli_run *run, const bvx_lattice *lattice, uint64_t set)
{
    run->report.lattice = *lattice;
    run->report.set = set;
    run->report.has_lattice = run->report.has_set = 1;
}

static void tell_made(cli_run *run, cli_made *made)
{
    const bvx_grid *const grid = made->grid != NULL     ? made->grid
                                 : made->field != NULL  ? &made->field->band
                                 : made->voxels != NULL ? made->voxels->grid
                                                        : made->shown;
    const char *const out = run->options->output;

    if (grid != NULL) cli_note_voxels(run, &grid->lattice, made->set);
    if (run->job->tell != NULL) run->job->tell(run, run->work, made);
    if (made->voxels != NULL) cli_tell_voxels(run, made->voxels, made);
    cli_tell_turn(run, made);
    cli_tell_lost(run, made);

    if (grid != NULL) cli_tell_grid(run, &made->head, grid, made->set, made->placed);
    if (made->members.size != 0) cli_text_add(&run->report.more, "%s", made->members.bytes);
    if (!made->untitled)
        cli_say(run, "%s%s%s\n", cli_input_name(run->options->input[run->command->least_inputs - 1]),
                out != NULL ? " -> " : "", out != NULL ? cli_output_name(run, out) : "");
    cli_say_lines(run, &made->head);
    cli_say_lines(run, &made->text);
    cli_say_warnings(run);
}

int cli_perform(cli_run *run)
{
    cli_made made = {.run = run, .placed = 1};

    run->job = &run->command->job;
    if (run->command->choose != NULL) CLI_TRY(run->command->choose(run, &run->job));
    /* Zeroed: what was not reached is freed as empty. One byte more, since a job may need nothing. */
    run->work = calloc(1, run->job->size + 1);
    if (run->work == NULL) return cli_fail(run, "no memory to start");
    int result = run->job->make(run, run->work, &made);
    if (result == CLI_DONE)
        result = made.write != NULL    ? made.write(run, run->work)
                 : made.voxels != NULL ? cli_write_voxels(run, made.voxels)
                 : made.field != NULL  ? cli_write_field(run, made.field)
                 : made.grid != NULL   ? cli_write_grid(run, made.grid)
                 : made.mesh != NULL   ? cli_write_mesh(run, made.mesh)
                                       : CLI_DONE;
    if (result == CLI_DONE) tell_made(run, &made);
    if (result == CLI_DONE && made.judge != NULL) result = made.judge(run, run->work);

    cli_text_free(&made.head);
    cli_text_free(&made.text);
    cli_text_free(&made.members);
    return result;
}

void cli_release(cli_run *run)
{
    for (const cli_owned *o = run->work != NULL ? run->job->owns : NULL; o != NULL && o->kind != 0; o++)
        for (int32_t i = 0; i < o->count; i++) {
            void *const it = (char *)run->work + o->at + (size_t)i * o->size;
            switch (o->kind) {
            case CLI_OWNS_MESH: bvx_mesh_free(run->context, it); break;
            case CLI_OWNS_GRID: bvx_grid_free(run->context, it); break;
            case CLI_OWNS_FIELD: bvx_field_free(run->context, it); break;
            case CLI_OWNS_SECTIONS: bvx_sections_free(run->context, it); break;
            case CLI_OWNS_INPUT: cli_free_input(run, it); break;
            case CLI_OWNS_VOLUME: cli_free_volume(run, it); break;
            case CLI_OWNS_TREE: cli_free_tree(run, it); break;
            case CLI_OWNS_VOXELS: cli_free_voxels(run, it); break;
            default: free(*(void **)it); break;
            }
        }
    if (run->work != NULL && run->job->free != NULL) run->job->free(run, run->work);
    free(run->work);
    run->work = NULL;
    run->source = NULL;
    run->names = NULL;
    run->colours = NULL;
}
