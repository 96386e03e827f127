/* volume_info.c - what a scalar volume holds: type, range and a histogram, to choose --level or --range
 * by. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <string.h>

enum { INFO_BINS = 16, INFO_BAR = 40 };

typedef struct volume_facts {
    double least, greatest;
    uint64_t nan, infinite, zero, finite;
    uint64_t bin[INFO_BINS]; /* of equal width from least to greatest */
    uint64_t fullest;
    int bins;     /* one a value where few whole numbers are there */
    double width; /* of a bin */
} volume_facts;

static double sample_value(const char *at, int32_t type)
{
    switch (type) {
/* Samples lie at any address, so each is copied out before it is read. */
#define SAMPLE(name, kind)        \
    case name: {                  \
        kind v;                   \
        memcpy(&v, at, sizeof v); \
        return (double)v;         \
    }
        SAMPLE(BVX_SAMPLE_U8, uint8_t)
        SAMPLE(BVX_SAMPLE_I8, int8_t)
        SAMPLE(BVX_SAMPLE_U16, uint16_t)
        SAMPLE(BVX_SAMPLE_I16, int16_t)
        SAMPLE(BVX_SAMPLE_U32, uint32_t)
        SAMPLE(BVX_SAMPLE_I32, int32_t)
        SAMPLE(BVX_SAMPLE_U64, uint64_t)
        SAMPLE(BVX_SAMPLE_I64, int64_t)
        SAMPLE(BVX_SAMPLE_F32, float)
#undef SAMPLE
    default: {
        double v;
        memcpy(&v, at, sizeof v);
        return v;
    }
    }
}

static void note_range(volume_facts *f, double v)
{
    /* NaN and infinity differ from themselves when subtracted; only NaN differs as it is. */
    if (v - v != 0.0) {
        f->nan += v != v;
        f->infinite += v == v;
        return;
    }
    if (f->finite == 0 || v < f->least) f->least = v;
    if (f->finite == 0 || v > f->greatest) f->greatest = v;
    f->zero += v == 0.0;
    f->finite++;
}

static void note_bin(volume_facts *f, double v)
{
    double const place = (v - f->least) / f->width;
    if (v - v != 0.0 || !(place >= 0.0)) return;
    /* The greatest value lies at the end of the last bin. */
    int const bin = place < f->bins ? (int)place : f->bins - 1;
    f->bin[bin]++;
}

static void walk_samples(const bvx_volume_view *v, void (*note)(volume_facts *f, double value),
                         volume_facts *f)
{
    int64_t stride[3];
    cli_volume_strides(v, stride);
    for (int64_t z = 0; z < v->size[2]; z++)
        for (int64_t y = 0; y < v->size[1]; y++) {
            const char *const row = (const char *)v->samples + z * stride[2] + y * stride[1];
            for (int64_t x = 0; x < v->size[0]; x++)
                note(f, sample_value(row + x * stride[0], v->sample_type));
        }
}

static void tell_facts(const cli_run *run, const bvx_volume_view *v, const volume_facts *f, cli_made *made)
{
    cli_text *const t = &made->members, *const lines = &made->head;

    cli_text_add(t, ", \"samples\": {\"type\": \"%s\"", cli_sample_names[v->sample_type - BVX_SAMPLE_U8]);
    cli_json_value(t, "least", f->least);
    cli_json_value(t, "greatest", f->greatest);
    cli_json_count(t, "nan", f->nan);
    cli_json_count(t, "infinite", f->infinite);
    cli_json_count(t, "zero", f->zero);
    cli_json_value(t, "bin_width", f->width);
    cli_text_add(t, ", \"histogram\": [");
    for (int i = 0; i < f->bins; i++) cli_text_add(t, "%s%" PRIu64, i == 0 ? "" : ", ", f->bin[i]);
    cli_text_add(t, "]}");

    cli_text_add(lines, "samples       %s, from %.9g to %.9g; %" PRIu64 " are 0",
                 cli_sample_names[v->sample_type - BVX_SAMPLE_U8], f->least, f->greatest, f->zero);
    if (f->nan + f->infinite != 0)
        cli_text_add(lines, ", %" PRIu64 " NaN, %" PRIu64 " infinite", f->nan, f->infinite);
    cli_text_add(lines, "\n");
    for (int i = 0; i < f->bins; i++) {
        int const bar = f->fullest == 0 ? 0 : (int)(f->bin[i] * INFO_BAR / f->fullest);
        cli_text_add(lines, "  %12.6g  %-*.*s %" PRIu64 "\n", f->least + f->width * i, INFO_BAR, bar,
                     "########################################", f->bin[i]);
    }
    if (cli_input_format(run, run->options->input[0]) != BVX_FORMAT_RAW)
        cli_text_add(lines, "\nvoxels whose sample is not 0\n");
}

int cli_tell_samples(cli_run *run, const char *path, cli_made *made)
{
    cli_volume v;
    volume_facts f = {0};
    int const raw = cli_input_format(run, path) == BVX_FORMAT_RAW;
    int status = cli_read_volume(run, path, NULL, &v);

    if (status == CLI_DONE) {
        cli_stage_begin(run, "samples");
        walk_samples(&v.view, note_range, &f);
        double const range = f.greatest - f.least;
        int const whole = v.view.sample_type != BVX_SAMPLE_F32 && v.view.sample_type != BVX_SAMPLE_F64 &&
                          range < INFO_BINS;
        /* A bin a value where there are few, so that labels can be read off. */
        f.bins = whole ? (int)range + 1 : INFO_BINS;
        f.width = whole ? 1.0 : range / INFO_BINS;
        /* All samples alike have no range to divide. */
        if (f.width > 0.0) walk_samples(&v.view, note_bin, &f);
        for (int i = 0; i < INFO_BINS; i++) f.fullest = f.bin[i] > f.fullest ? f.bin[i] : f.fullest;
        cli_stage_end(run);
        /* else bits */
        if (raw || v.view.sample_type != BVX_SAMPLE_U8 || f.greatest > 1.0)
            tell_facts(run, &v.view, &f, made);
    }
    cli_free_volume(run, &v);
    return status;
}
