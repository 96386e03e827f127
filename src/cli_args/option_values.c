/* option_values.c - what stands after an option: strict numbers, lists,
 * planes, choices; and in words what it must be. */
#include "cli_args/args.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A decimal number that ends at one of the stops or at the end of the text; *rest is after it. */
static int take_real(const char *text, const char *stops, double *v, const char **rest)
{
    /* leaves out what strtod would take too: hex, inf, nan, spaces */
    size_t const n = strspn(text, "+-.0123456789eE");
    char *end;
    if (n == 0) return 0;
    *v = strtod(text, &end);
    if (end != text + n || *v - *v != 0.0) return 0;
    if (*end != 0 && strchr(stops, *end) == NULL) return 0;
    *rest = end;
    return 1;
}

static int take_whole(const char *text, const char *stops, double low, double high, int64_t *v,
                      const char **rest)
{
    int64_t n = 0;
    const char *p = text;
    if (*p < '0' || *p > '9') return 0;
    /* By hand: strtoll would take signs and spaces too. */
    for (; *p >= '0' && *p <= '9'; p++) {
        if (n > (INT64_MAX - 9) / 10) return 0;
        n = n * 10 + (*p - '0');
    }
    if (*p != 0 && strchr(stops, *p) == NULL) return 0;
    *v = n;
    *rest = p;
    return (double)n >= low && (double)n <= high;
}

static int take_list(const cli_argument *a, const char *text, const char *stops, cli_list *list)
{
    const char *p = text;
    list->count = 0;
    for (;;) {
        if (list->count == a->most) return 0;
        if (!take_whole(p, stops, a->low, a->high, &list->value[list->count], &p)) return 0;
        list->count++;
        if (*p == 0) break;
        p++;
    }
    return list->count >= a->least;
}

static int take_triple(const cli_argument *a, const char *text, cli_triple *t)
{
    const char *p = text;

    for (int k = 0; a->choice != NULL && k < 3; k++) {
        if (strcmp(text, a->choice[k]) != 0) continue;
        t->value[k] = 1.0;
        t->value[(k + 1) % 3] = t->value[(k + 2) % 3] = 0.0;
        t->given = 1;
        return 1;
    }
    for (int k = 0; k < 3; k++) {
        if (!take_real(p, k < 2 ? "," : "", &t->value[k], &p)) return 0;
        if (k < 2 && *p++ != ',') return 0;
    }
    t->given = 1;
    return 1;
}

static int take_pair(const char *text, cli_pair *t)
{
    const char *p = text;
    t->value[0] = -HUGE_VAL;
    t->value[1] = HUGE_VAL;
    if (*p != ',' && !take_real(p, ",", &t->value[0], &p)) return 0;
    if (*p++ != ',') return 0;
    if (*p != 0 && !take_real(p, "", &t->value[1], &p)) return 0;
    t->given = 1;
    return p != text + 1;
}

static int take_errors(const cli_argument *a, const char *text, cli_errors *errors)
{
    const char *p = text;
    for (errors->count = 0; errors->count < a->most;) {
        int const i = errors->count++;
        if (!take_real(p, ",%", &errors->value[i], &p) || !(errors->value[i] > 0.0)) return 0;
        /* Each distance has a unit of its own: 0.02,0.1% is understood. */
        errors->percent[i] = *p == '%';
        p += *p == '%';
        if (*p == 0) return 1;
        if (*p++ != ',') return 0;
    }
    return 0;
}

static int take_planes(const char *text, cli_planes *planes)
{
    const char *p = text;
    for (;;) {
        int const axis = p[0] >= 'x' && p[0] <= 'z' && p[1] == '=' ? p[0] - 'x' : -1;
        /* Twice the same axis is a mistake: which plane would count is a guess. */
        if (axis < 0 || planes->given[axis] || !take_real(p + 2, ",", &planes->value[axis], &p)) return 0;
        planes->given[axis] = 1;
        if (*p == 0) return 1;
        p++;
    }
}

static int take_bytes(const cli_argument *a, const char *text, uint64_t *bytes)
{
    static const char suffix[] = "KMG";
    const char *p;
    int64_t v;

    if (!take_whole(text, "KMGkmg", a->low, a->high, &v, &p)) return 0;
    int shift = 0;
    if (*p != 0) {
        const char *const s = strchr(suffix, *p >= 'a' ? *p - 'a' + 'A' : *p);
        shift = 10 * ((int)(s - suffix) + 1);
        if (p[1] != 0) return 0;
    }
    if ((uint64_t)v > UINT64_MAX >> shift) return 0;
    *bytes = (uint64_t)v << shift;
    return 1;
}

static int take_choice(const cli_argument *a, const char *text, int32_t *v)
{
    for (int i = 0; a->choice[i] != NULL; i++)
        if (text[0] != 0 && strcmp(text, a->choice[i]) == 0) {
            *v = a->base + i;
            return 1;
        }
    return 0;
}

static int take_set(const cli_argument *a, const char *text, int32_t *set)
{
    const char *p = text;
    *set = 0;
    for (;;) {
        size_t const n = strcspn(p, ",");
        int i = 0;
        while (a->choice[i] != NULL && (strlen(a->choice[i]) != n || strncmp(a->choice[i], p, n) != 0)) i++;
        if (a->choice[i] == NULL || (*set & a->base << i) != 0) return 0;
        *set |= a->base << i;
        if (p[n] == 0) return 1;
        p += n + 1;
    }
}

int cli_take_value(cli_run *run, const cli_argument *a, const char *text)
{
    void *const field = (char *)(a->own ? run->own : run->options) + a->field;
    const char *rest;
    int64_t whole;
    int good;

    switch (a->kind) {
    case CLI_FLAG: *(int32_t *)field = 1; return 1;
    case CLI_FILE:
    case CLI_TEXT: *(const char **)field = text; return text[0] != 0;
    case CLI_NUMBER: return take_real(text, "", field, &rest);
    case CLI_ERRORS: return take_errors(a, text, field);
    case CLI_SET: return take_set(a, text, field);
    case CLI_INT:
        if (a->choice != NULL && take_choice(a, text, field)) return 1;
        if (!take_whole(text, "", a->low, a->high, &whole, &rest)) return 0;
        *(int32_t *)field = (int32_t)whole;
        return 1;
    case CLI_LONG: return take_whole(text, "", a->low, a->high, field, &rest);
    case CLI_REAL:
        good = take_real(text, "", field, &rest);
        if (a->least == 1) return good && *(double *)field >= a->low && *(double *)field <= a->high;
        return good && *(double *)field > a->low && *(double *)field < a->high;
    case CLI_TRIPLE: return take_triple(a, text, field);
    case CLI_PAIR: return take_pair(text, field);
    /* One number for all axes or one for each: two would leave an axis open. */
    case CLI_LIST:
        good = take_list(a, text, ",", field);
        return good && !(a->most == 3 && ((cli_list *)field)->count == 2);
    case CLI_SIZE: return take_list(a, text, "x", field);
    case CLI_CUT: return take_planes(text, field);
    case CLI_BYTES: return take_bytes(a, text, field);
    case CLI_CHOICE: return take_choice(a, text, field);
    }
    return 0;
}

void cli_describe_value(const cli_argument *a, char *text, size_t room)
{
    switch (a->kind) {
    case CLI_INT:
    case CLI_LONG:
        snprintf(text, room, "a whole number from %.0f to %.0f", a->low, a->high);
        for (int i = 0; a->choice != NULL && a->choice[i] != NULL; i++)
            snprintf(text + strlen(text), room - strlen(text), " or %s", a->choice[i]);
        break;
    case CLI_REAL:
        if (a->least == 1) snprintf(text, room, "a number from %g to %g", a->low, a->high);
        else snprintf(text, room, "a number above %g and below %g", a->low, a->high);
        break;
    case CLI_TRIPLE:
        snprintf(text, room, "three numbers like 3,-4,2%s", a->choice != NULL ? ", or x, y or z" : "");
        break;
    case CLI_PAIR: snprintf(text, room, "two numbers like 2.5,7 or one of them like 2.5,"); break;
    case CLI_LIST:
        if (a->most == 1) snprintf(text, room, "a whole number from %.0f to %.0f", a->low, a->high);
        else if (a->most == 3)
            snprintf(text, room, "one whole number or three like 64,32,16, from %.0f to %.0f", a->low,
                     a->high);
        else if (a->least == a->most) snprintf(text, room, "%d whole numbers like 0,0,0,64,64,64", a->most);
        else if (a->least == 3)
            snprintf(
                text, room,
                "three whole numbers a voxel like 8,8,8 or 8,8,8,40,40,40, at most %d, from %.0f to %.0f",
                a->most, a->low, a->high);
        else
            snprintf(text, room, "whole numbers like 64,32,16, at most %d, from %.0f to %.0f", a->most,
                     a->low, a->high);
        break;
    case CLI_SIZE:
        snprintf(text, room, "a width and a height like 1024x768, each from 1 to %.0f", a->high);
        break;
    case CLI_CUT: snprintf(text, room, "planes like x=0.5 or x=0.5,z=1, each axis once"); break;
    case CLI_BYTES: snprintf(text, room, "a count of bytes like 500M or 2G, above 0"); break;
    case CLI_CHOICE:
        snprintf(text, room, "one of:");
        for (int i = 0; a->choice[i] != NULL; i++)
            if (a->choice[i][0] != 0)
                snprintf(text + strlen(text), room - strlen(text), "%s %s", i == 0 ? "" : ",", a->choice[i]);
        break;
    case CLI_FILE: snprintf(text, room, "the name of a file"); break;
    case CLI_TEXT: snprintf(text, room, "a text that is not empty"); break;
    case CLI_NUMBER: snprintf(text, room, "a number"); break;
    case CLI_ERRORS:
        if (a->most == 1) snprintf(text, room, "a distance above 0 like 0.02 or 0.1%%");
        else snprintf(text, room, "distances above 0 like 0.02 or 0.05%%,0.2%%, at most %d", a->most);
        break;
    case CLI_SET:
        snprintf(text, room, "one or more of");
        for (int i = 0; a->choice[i] != NULL; i++)
            snprintf(text + strlen(text), room - strlen(text), "%s %s", i == 0 ? "" : ",", a->choice[i]);
        snprintf(text + strlen(text), room - strlen(text), ", with commas between");
        break;
    case CLI_FLAG: snprintf(text, room, "nothing"); break;
    }
}
