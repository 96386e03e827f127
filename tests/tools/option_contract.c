/* option_contract.c - made into a program by check_options.py: the options that the header tells of, as the
 * library and the program's table have them. option_rows.h is written from the header. Prints "wrong TAB
 * what" for each disagreement, and the table's rows. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* What call_table.h wants of a framework of tests. */
#define TEST_ASSERT_EQUAL_INT32_MESSAGE(a, b, text) \
    do {                                            \
        if ((a) != (b)) {                           \
            fprintf(stderr, "%s\n", text);          \
            abort();                                \
        }                                           \
    } while (0)
#include "call_table.h"

#include "cli_commands/commands.h"

enum { WHOLE, WIDE, REAL, BYTE, BLOCK };

static bvx_context *contract_context;
static clock_t contract_until;

/* A value that is taken may ask for much: time and memory are bounded. */
static int32_t stop_soon(void *user, const char *stage, double fraction)
{
    (void)user;
    (void)stage;
    (void)fraction;
    return clock() > contract_until;
}

static bvx_status call_with(bvx_status (*make)(const world *w), size_t at, size_t size, int shape,
                            double value)
{
    int32_t const whole = shape == WHOLE ? (int32_t)value : 0;
    uint64_t const wide = shape == WIDE ? (uint64_t)value : 0;
    world w = right_world(contract_context);

    memset(&out, 0, sizeof out);
    contract_until = clock() + CLOCKS_PER_SEC / 10;
    w.bad_at = at;
    w.bad_size = size;
    w.bad = shape == WHOLE  ? (const void *)&whole
            : shape == WIDE ? (const void *)&wide
                            : (const void *)&value;
    return make(&w);
}

static int is_for_range(bvx_status status)
{
    const bvx_error *const e = bvx_last_error(contract_context);

    return status != BVX_OK && (e->reason == BVX_REASON_RANGE || e->reason == BVX_REASON_CHOICE);
}

static void refused(const char *kind, const char *field, bvx_status (*make)(const world *w), size_t at,
                    size_t size, int shape, double value)
{
    bvx_status const status = call_with(make, at, size, shape, value);
    const char *const text = bvx_last_error(contract_context)->text;

    if (status == BVX_OK || status == BVX_CANCELLED)
        printf("wrong\tbvx_%s_options.%s: %.17g is taken, the header's limit is nearer\n", kind, field,
               value);
    else if (!is_for_range(status) || strstr(text, field) == NULL)
        printf(
            "wrong\tbvx_%s_options.%s: %.17g is refused by \"%s\", which has not the field's name or not the reason of a range\n",
            kind, field, value, text);
}

static void taken(const char *kind, const char *field, bvx_status (*make)(const world *w), size_t at,
                  size_t size, int shape, double value)
{
    bvx_status const status = call_with(make, at, size, shape, value);
    const char *const text = bvx_last_error(contract_context)->text;

    if (is_for_range(status) && strstr(text, field) != NULL)
        printf("wrong\tbvx_%s_options.%s: %.17g is refused by \"%s\", the header allows it\n", kind, field,
               value, text);
}

#include "option_rows.h"

static void print_row(const cli_command *c, const cli_argument *a)
{
    static const char *const kinds[] = {"FLAG", "INT",    "LONG",   "REAL", "TRIPLE", "PAIR",
                                        "LIST", "BYTES",  "CHOICE", "SIZE", "CUT",    "SLICES",
                                        "FILE", "NUMBER", "ERRORS", "SET",  "TEXT"};

    printf("row\t%s\t%s\t%s\t%.17g\t%.17g\t%d\t", a->name, c->name, kinds[a->kind], a->low, a->high,
           a->least);
    for (int k = 0; a->choice != NULL && a->choice[k] != NULL; k++)
        printf("%s%s", k == 0 ? "" : ",", a->choice[k]);
    printf("\t%d\t", a->base);
    for (const char *p = a->help; *p != 0; p++) fputs(*p == '\n' ? "\\n" : (char[2]){*p, 0}, stdout);
    printf("\n");
}

static void print_table(void)
{
    const cli_command *c;

    for (int i = 0; (c = cli_commands[i]) != NULL; i++) {
        const cli_argument *row[CLI_MAX_OPTIONS];
        int const rows = cli_list_rows(c, row);

        if (rows == CLI_MAX_OPTIONS) printf("wrong\t%s: more rows than CLI_MAX_OPTIONS\n", c->name);
        for (int k = 0; k < rows; k++) print_row(c, row[k]);
    }
}

int main(void)
{
    bvx_context_options o = {.struct_size = sizeof o};

    o.memory_limit = (uint64_t)256 << 20;
    o.progress.call = stop_soon;
    contract_until = clock() + 60 * CLOCKS_PER_SEC;
    if (bvx_context_create(&o, &contract_context) != BVX_OK) return 1;
    make_world(contract_context);
    all_rows();
    print_table();
    return 0;
}
