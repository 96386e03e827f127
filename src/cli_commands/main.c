/* main.c - the bitvox program: commands, help, exit status. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define MAIN_POSIX 1
#else
#define MAIN_POSIX 0
#endif

#include "cli_shell/cli.h"

#include <stdio.h>
#include <string.h>
#if MAIN_POSIX
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>
#endif

static const cli_command *const commands[] = {&cli_lod, &cli_simplify, &cli_info, &cli_voxelize, &cli_repair, &cli_fill, &cli_morph, &cli_components, &cli_refine, &cli_sections,
                                             &cli_slice, &cli_boolean, &cli_faces, &cli_convert, &cli_compare, &cli_render};

enum { COMMANDS = sizeof commands / sizeof commands[0] };

const cli_command *cli_command_at(int i)
{
    return i >= 0 && i < COMMANDS ? commands[i] : NULL;
}

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

/* A reader that has seen enough, as head has, is not a failure: the program ends as others do, by the signal and without a
 * word. All files are written by now. */
static void end_without_reader(void)
{
#if MAIN_POSIX
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};

    if (poll(&out, 1, 0) != 1 || (out.revents & POLLERR) == 0) return;
    signal(SIGPIPE, SIG_DFL);
    raise(SIGPIPE);
#endif
}

static int end_of_output(cli_run *run)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) return CLI_DONE;
    end_without_reader();
    return cli_fail(run, "standard output cannot be written");
}

/* ---- help ---- */

static void print_overview(FILE *to)
{
    fprintf(to, "bitvox - shapes to bit-packed voxels and back\n\n"
                "usage: bitvox COMMAND IN -o OUT [options]\n\n");
    for (int i = 0; i < COMMANDS; i++) fprintf(to, "  %-11s %s\n", commands[i]->name, commands[i]->does);
    fprintf(to, "\nbitvox COMMAND --help tells a command's options; bitvox --version tells the version;\n"
                "bitvox help --man is the manual page, bitvox help --bash-completion a script for bash.\n"
                "Exit status: 0 done, 1 bad input or failure, 2 wrong usage, 130 interrupted.\n");
}

static void print_help(const cli_command *c)
{
    printf("usage: bitvox %s %s\n\n%s\n\noptions:\n", c->name, c->usage, c->details);
    cli_print_options(c->bit);
    printf("\n%s:\n", strchr(c->example, '\n') != NULL ? "examples" : "example");
    for (const char *p = c->example; *p != 0;) {
        size_t const n = strcspn(p, "\n");
        printf("  %.*s\n", (int)n, p);
        p += n + (p[n] != 0);
    }
}

static int refuse_command(cli_run *run, const char *name)
{
    const char *const nearest = cli_nearest(name, next_command, NULL);
    if (nearest != NULL) return cli_usage(run, "'%s' is no command; is '%s' meant?", name, nearest);
    return cli_usage(run, "'%s' is no command; see 'bitvox help'", name);
}

static int help(cli_run *run, int count, char **word)
{
    if (count > 1) return cli_usage(run, "'%s' is one word too many; help takes one command", word[1]);
    if (count == 0) print_overview(stdout);
    else if (strcmp(word[0], "--man") == 0) cli_print_manual();
    else if (strcmp(word[0], "--bash-completion") == 0) cli_print_completion();
    else if (find_command(word[0]) != NULL) print_help(find_command(word[0]));
    else return refuse_command(run, word[0]);
    return end_of_output(run);
}

static int print_version(cli_run *run)
{
    int32_t const v = bvx_version();
    printf("bitvox %d.%d.%d\n", (int)(v / 10000), (int)(v / 100 % 100), (int)(v % 100));
    return end_of_output(run);
}

/* ---- running ---- */

int cli_make_context(cli_run *run, uint64_t file_bytes)
{
    uint64_t const memory = run->options.memory_limit != 0 ? run->options.memory_limit : cli_memory_there();
    bvx_context_options o;
    bvx_status status;
    bvx_context_options_init(&o, sizeof o);
    o.threads = run->options.threads;
    cli_blocks_offer(&o);
    o.progress = cli_progress;
    o.progress_user = run;
    if (memory != 0) o.memory_limit = memory > file_bytes ? memory - file_bytes : 1;
    run->context_limit = run->options.memory_limit != 0 ? o.memory_limit : 0; /* choices do not depend on the machine */
    status = bvx_context_create(&o, &run->context);
    return status == BVX_OK ? CLI_DONE : cli_fail_status(run, status, NULL);
}

/* The last words: the report of --json, or what is left of the text. */
int cli_end_of_run(cli_run *run, int status)
{
    if (!run->options.json || cli_report_print(run, status)) return status == CLI_DONE ? end_of_output(run) : status;

    if (status != CLI_DONE) return status;
    end_without_reader();
    return cli_fail(run, "standard output cannot be written");
}

static int run_command(cli_run *run, int count, char **word)
{
    int status = cli_parse(run, count, word);
    if (status == CLI_DONE && run->options.help) {
        print_help(run->command);
        return end_of_output(run);
    }
    if (status == CLI_DONE) {
        run->start = cli_seconds();
        run->progress.row = -1;
        cli_watch_run(run);
        if (run->options.output_dir != NULL) return cli_run_batch(run);
        status = run->command->run(run);
        cli_progress_end(run, status);
        cli_note_peak(run, 0);
        cli_drop_outputs(run);
    }
    status = cli_end_of_run(run, status);
    bvx_context_destroy(run->context);
    return status;
}

/* A closed standard stream must not hand its number to the next file that is opened; what is written to it fails. */
static void hold_standard_streams(void)
{
#if MAIN_POSIX
    for (int i = 0; i < 3; i++)
        if (fcntl(i, F_GETFD) == -1) (void)!open("/dev/null", i == 0 ? O_WRONLY : O_RDONLY);
#endif
}

static int is_asked_for(const char *name, int count, char **word)
{
    for (int i = 0; i < count && strcmp(word[i], "--") != 0; i++)
        if (strcmp(word[i], name) == 0) return 1;
    return 0;
}

static int run_words(cli_run *run, int count, char **word)
{
    if (count <= 0) {
        print_overview(stderr);
        return CLI_USAGE;
    }
    if (strcmp(word[0], "help") == 0) return help(run, count - 1, word + 1);
    if (strcmp(word[0], "--help") == 0 || strcmp(word[0], "-h") == 0) return help(run, 0, NULL);
    if (strcmp(word[0], "--version") == 0) return print_version(run);
    run->command = find_command(word[0]);
    if (run->command != NULL) return run_command(run, count - 1, word + 1);
    run->options.json = is_asked_for("--json", count, word);
    return cli_end_of_run(run, refuse_command(run, word[0]));
}

int main(int count, char **word)
{
    static cli_run run; /* zeroed, and too large for some stacks */
    int status;
    hold_standard_streams();
    cli_watch_start();
    run.options.samples = -1;
    run.options.fill = BVX_FILL_AUTO;
    status = run_words(&run, count - 1, word + 1);
    cli_watch_end(status);
    return status;
}
