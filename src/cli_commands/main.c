/* main.c - the bitvox program: commands, help, exit status. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define MAIN_POSIX      1
#else
#define MAIN_POSIX 0
#endif

#include "cli_commands/commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if MAIN_POSIX
#include <fcntl.h>
#include <unistd.h>
#endif

static const char *next_command(const void *user, int i)
{
    (void)user;
    return i < CLI_COMMANDS ? cli_commands[i]->name : i == CLI_COMMANDS ? "help" : NULL;
}

static const cli_command *find_command(const char *name)
{
    for (int i = 0; i < CLI_COMMANDS; i++)
        if (strcmp(cli_commands[i]->name, name) == 0) return cli_commands[i];
    return NULL;
}

static void print_overview(FILE *to)
{
    fprintf(to, "bitvox - shapes to bit-packed voxels and back\n\n"
                "usage: bitvox COMMAND IN -o OUT [options]\n\n");
    for (int i = 0; i < CLI_COMMANDS; i++)
        fprintf(to, "  %-11s %s\n", cli_commands[i]->name, cli_commands[i]->does);
    fprintf(to, "\nbitvox COMMAND --help lists what most runs need, --help-all every option;\n"
                "bitvox --version prints the version;\n"
                "bitvox help --man is the manual page, bitvox help --bash-completion a script for bash.\n"
                "Exit status: 0 done, 1 bad input or failure, 2 wrong usage, 130 interrupted.\n");
}

static void print_help(const cli_command *c, int all)
{
    int left = all ? CLI_MAX_OPTIONS : 2;
    printf("usage: bitvox %s %s\n\n%s\n%s", c->name, c->usage, c->details, all ? "" : "\noptions:\n");
    cli_print_options(c, all);
    printf("\n%s:\n", strchr(c->example, '\n') != NULL ? "examples" : "example");
    for (const char *p = c->example; *p != 0 && left-- > 0;) {
        size_t const n = strcspn(p, "\n");
        printf("  %.*s\n", (int)n, p);
        p += n + (p[n] != 0);
    }
}

static int refuse_command(cli_run *run, const char *name)
{
    const char *const nearest = cli_nearest(name, next_command, NULL);
    if (nearest != NULL) return cli_usage(run, "unknown command '%s'; did you mean '%s'?", name, nearest);
    return cli_usage(run, "unknown command '%s'; see 'bitvox help'", name);
}

static int help(cli_run *run, int count, char **word)
{
    if (count > 1) return cli_usage(run, "'%s' is one word too many; help takes one command", word[1]);
    if (count == 0) print_overview(stdout);
    else if (strcmp(word[0], "--man") == 0) cli_print_manual(cli_commands);
    else if (strcmp(word[0], "--bash-completion") == 0) cli_print_completion(cli_commands);
    else if (find_command(word[0]) != NULL) print_help(find_command(word[0]), 0);
    else return refuse_command(run, word[0]);
    return cli_end_of_output(run);
}

static int run_command(cli_run *run, int count, char **word)
{
    run->own = calloc(1, run->command->own + 1);
    if (run->own == NULL) return cli_end_of_run(run, cli_fail(run, "no memory to start"));
    if (run->command->start != NULL) run->command->start(run->own);
    int status = cli_parse(run, count, word);

    /* Help wins over everything else on the line, errors included. */
    if (status == CLI_DONE && run->general->help) {
        print_help(run->command, run->general->help == 2);
        return cli_end_of_output(run);
    }
    if (status == CLI_DONE) status = cli_check_line(run);
    if (status == CLI_DONE) {
        run->start = cli_seconds();
        if (run->options->output_dir != NULL || (run->command->bit == CLI_INFO && run->options->inputs > 1))
            return cli_run_batch(run);
        status = cli_perform(run);
        cli_progress_end(run, status);
        cli_note_peak(run, 0);
        cli_drop_outputs(run);
    }
    status = cli_end_of_run(run, status);
    cli_release(run);
    free(run->own);
    bvx_context_destroy(run->context);
    return status;
}

static int run_words(cli_run *run, int count, char **word)
{
    if (count <= 0) {
        print_overview(stderr);
        return CLI_USAGE;
    }
    /* Words that are no commands come first: no command may have their names. */
    if (strcmp(word[0], "help") == 0) return help(run, count - 1, word + 1);
    if (strcmp(word[0], "--help") == 0 || strcmp(word[0], "-h") == 0) return help(run, 0, NULL);
    if (strcmp(word[0], "--version") == 0) {
        int32_t const v = bvx_version();
        printf("bitvox %d.%d.%d\n", (int)(v / 10000), (int)(v / 100 % 100), (int)(v % 100));
        return cli_end_of_output(run);
    }
    run->command = find_command(word[0]);
    run->name = run->command != NULL ? run->command->name : NULL;
    if (run->command != NULL) return run_command(run, count - 1, word + 1);
    for (int i = 0; i < count && strcmp(word[i], "--") != 0; i++)
        if (strcmp(word[i], "--json") == 0) run->options->general.json = 1;
    return cli_end_of_run(run, refuse_command(run, word[0]));
}

int main(int count, char **word)
{
    static cli_run run; /* zeroed, and too large for some stacks */
    static cli_options options;

    word = cli_words(&count, word);
    run.options = &options;
    run.general = &options.general;
    run.commands = cli_commands;
    /* Before any file is opened and any thread started. A closed standard stream must not hand its number to the next
     * opened file; writes to it fail. */
#if MAIN_POSIX
    for (int i = 0; i < 3; i++)
        if (fcntl(i, F_GETFD) == -1) (void)!open("/dev/null", i == 0 ? O_WRONLY : O_RDONLY);
#endif
    cli_watch_start();
    options.samples = -1;
    return run_words(&run, count - 1, word + 1);
}
