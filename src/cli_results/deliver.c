/* deliver.c - what a command has made: written, told and warned of in one place. */
#include "cli_results/results.h"

/* A success: where it went, what it is, what is to be said of it. */
static void tell_made(cli_run *run, cli_made *made)
{
    const bvx_grid *const grid = made->field != NULL ? &made->field->band : made->grid;

    run->report.set = made->set;
    run->report.has_set = 1;
    if (made->members.size != 0) cli_text_add(&run->report.more, "%s", made->members.bytes);
    cli_say(run, "%s -> %s\n", cli_input_name(run->options->input[0]), run->options->output);
    cli_say_lines(run, &made->head);
    cli_say_grid(run, grid, made->set, made->placed);
    cli_say_lines(run, &made->text);
    cli_warn_lines(run, &made->warnings);
}

int cli_deliver(cli_run *run, cli_made *made)
{
    int result;

    if (made->status != BVX_OK) result = cli_fail_status(run, made->status, made->about);
    else if (made->write != NULL) result = made->write(run, made->writer);
    else if (made->field != NULL) result = cli_write_field(run, made->field);
    else result = cli_write_grid(run, made->grid);
    if (result == CLI_DONE) tell_made(run, made);

    cli_text_free(&made->head);
    cli_text_free(&made->text);
    cli_text_free(&made->members);
    cli_text_free(&made->warnings);
    return result;
}
