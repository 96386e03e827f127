/* main.c - the bitvox program: commands, help, exit status. */
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

static const cli_command *const commands[] = {&cli_lod, &cli_info, &cli_voxelize, &cli_render};

enum { COMMANDS = sizeof commands / sizeof commands[0] };

static const char *next_command(const void *user, int i)
{
    (void)user;
    return i < COMMANDS ? commands[i]->name : i == COMMANDS ? "help" : NULL;
}

static const cli_command *find_command(const char *name)
{
    for (int i = 0; i < COMMANDS; i++)
        if (strcmp(commands[i]->name, name) == 0) return commands[i];
    return NULL;
}

static void print_overview(FILE *to)
{
    fprintf(to, "bitvox - shapes to bit-packed voxels and back\n\n"
                "usage: bitvox COMMAND IN -o OUT [options]\n\n");
    for (int i = 0; i < COMMANDS; i++) fprintf(to, "  %-10s %s\n", commands[i]->name, commands[i]->does);
    fprintf(to, "\nbitvox COMMAND --help tells a command's options; bitvox --version tells the version.\n"
                "Exit status: 0 done, 1 bad input or failure, 2 wrong usage, 130 interrupted.\n");
}

static int print_help(const cli_command *c)
{
    printf("usage: bitvox %s %s\n\n%s\n\noptions:\n", c->name, c->usage, c->details);
    cli_print_options(c->bit);
    printf("\nexample:\n  %s\n", c->example);
    return fflush(stdout) == 0 ? CLI_DONE : CLI_FAILED;
}

static int refuse_command(cli_run *run, const char *name)
{
    const char *const nearest = cli_nearest(name, next_command, NULL);
    if (nearest != NULL) return cli_usage(run, "'%s' is no command; is '%s' meant?", name, nearest);
    return cli_usage(run, "'%s' is no command; see 'bitvox help'", name);
}

static int help(cli_run *run, int count, char **word)
{
    const cli_command *command;
    if (count == 0) {
        print_overview(stdout);
        return fflush(stdout) == 0 ? CLI_DONE : CLI_FAILED;
    }
    if (count > 1) return cli_usage(run, "'%s' is one word too many; help takes one command", word[1]);
    command = find_command(word[0]);
    return command != NULL ? print_help(command) : refuse_command(run, word[0]);
}

static int print_version(void)
{
    int32_t const v = bvx_version();
    printf("bitvox %d.%d.%d\n", (int)(v / 10000), (int)(v / 100 % 100), (int)(v % 100));
    return fflush(stdout) == 0 ? CLI_DONE : CLI_FAILED;
}

int cli_make_context(cli_run *run, uint64_t file_bytes)
{
    bvx_context_options o;
    bvx_status status;
    bvx_context_options_init(&o, sizeof o);
    o.threads = run->options.threads;
    cli_pool_offer(&o);
    o.progress = cli_progress;
    o.progress_user = run;
    if (run->options.memory_limit != 0)
        o.memory_limit = run->options.memory_limit > file_bytes ? run->options.memory_limit - file_bytes : 1;
    run->context_limit = o.memory_limit;
    status = bvx_context_create(&o, &run->context);
    return status == BVX_OK ? CLI_DONE : cli_fail_status(run, status, NULL);
}

static int run_command(cli_run *run, int count, char **word)
{
    int status = cli_parse(run, count, word);
    if (status == CLI_DONE && run->options.help) return print_help(run->command);
    if (status == CLI_DONE) {
        cli_catch_interrupts();
        run->start = cli_seconds();
        status = run->command->run(run);
        cli_clear_bar(run);
        if (bvx_memory_peak(run->context) > run->report.peak_bytes) run->report.peak_bytes = bvx_memory_peak(run->context);
        cli_drop_outputs(run);
    }
    if (run->options.json && !cli_report_print(run, status) && status == CLI_DONE) status = CLI_FAILED;
    if (status == CLI_DONE && fflush(stdout) != 0) status = cli_fail(run, "standard output cannot be written");
    bvx_context_destroy(run->context);
    cli_report_free(&run->report);
    return status;
}

int main(int count, char **word)
{
    static cli_run run; /* zeroed, and too large for some stacks */
    run.options.samples = -1;
    if (count < 2) {
        print_overview(stderr);
        return CLI_USAGE;
    }
    if (strcmp(word[1], "help") == 0) return help(&run, count - 2, word + 2);
    if (strcmp(word[1], "--help") == 0 || strcmp(word[1], "-h") == 0) return help(&run, 0, NULL);
    if (strcmp(word[1], "--version") == 0) return print_version();
    run.command = find_command(word[1]);
    if (run.command == NULL) return refuse_command(&run, word[1]);
    return run_command(&run, count - 2, word + 2);
}
