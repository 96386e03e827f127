/* shade.c - drawn samples to pixels: one light near the eye, ambient light from the depths around, a thin
 * outline; and a normal for a voxel from the voxels around it.
 *
 * Sources at the headings below. Guarantee: no transcendental functions, so the bytes are the same
 * everywhere. */
#include "render/picture.h"

#include <math.h>

/* ---- A normal from the voxels around ---- */

/* Idea: the set voxels within a ball have their middle away from the surface, so it lies against the normal
 * (Thürmer, Wüthrich. Normal computation for discrete surfaces in 3D space. 1997). Seven bits of a row are
 * looked up at once. */

enum { BALL = 3, BALL_BITS = 2 * BALL + 1 };

/* Seven bits of a row from x on, bit shift of a word; bits outside the row are 0. */
static unsigned ball_bits(const uint64_t *row, const uint64_t *also, int32_t words, int32_t word,
                          int32_t shift)
{
    if (word >= 0 && shift <= 64 - BALL_BITS)
        return (unsigned)((row[word] | also[word]) >> shift) & ((1u << BALL_BITS) - 1);
    uint64_t const low = word >= 0 && word < words ? row[word] | also[word] : 0;
    uint64_t const high = word + 1 < words ? row[word + 1] | also[word + 1] : 0;
    return (unsigned)((low >> shift | (shift > 0 ? high << (64 - shift) : 0)) & ((1u << BALL_BITS) - 1));
}

void bvxi_voxel_normal(const bvx_grid *grid, const uint64_t *also, const double spacing[3], int32_t i,
                       int32_t j, int32_t k, double n[3])
{
    /* bits of a row that lie in the ball (a^2 + b^2 + c^2 <= 13), by the row's b^2 + c^2 */
    static const uint8_t in_ball[2 * BALL * BALL + 1] = {
        0x7f, 0x7f, 0x7f, 0x7f, 0x7f, 0x3e, 0x3e, 0x3e, 0x3e, 0x3e, 0x1c, 0x1c, 0x1c, 0x08, 0, 0, 0, 0, 0};

    /* of three bits: how many, and the sum of their places left (-3, -2,
     * -1) and right (1, 2, 3) of the middle */
    static const int8_t count[8] = {0, 1, 1, 2, 1, 2, 2, 3};
    static const int8_t left[8] = {0, -3, -2, -5, -1, -4, -3, -6}, right[8] = {0, 1, 2, 3, 3, 4, 5, 6};
    int32_t const word = i < BALL ? -1 : (i - BALL) >> 6, shift = i - BALL - word * 64;
    int32_t sum[3] = {0, 0, 0};

    for (int32_t c = -BALL; c <= BALL; c++) {
        if (k + c < 0 || k + c >= grid->size[2]) continue;
        for (int32_t b = -BALL; b <= BALL; b++) {
            if (j + b < 0 || j + b >= grid->size[1]) continue;
            size_t const row = ((size_t)(k + c) * (size_t)grid->size[1] + (size_t)(j + b)) *
                               (size_t)grid->words_per_row;
            unsigned const bits = ball_bits(grid->words + row, also + row, grid->words_per_row, word, shift) &
                                  in_ball[b * b + c * c];
            int32_t const set = count[bits & 7] + (int32_t)(bits >> 3 & 1) + count[bits >> 4];
            sum[0] += left[bits & 7] + right[bits >> 4];
            sum[1] += set * b;
            sum[2] += set * c;
        }
    }
    for (int a = 0; a < 3; a++) n[a] = -(double)sum[a] * spacing[a];
}

/* ---- Drawn samples to pixels: one light near the eye, ambient light from the depths around, a thin
 * outline ---- */

/* Ambient light: from a sample, rays go out over the picture in evenly spread directions; what rises highest
 * above the sample's tangent plane along a ray takes away the light from there, the less the farther it is
 * (screen-space ambient occlusion). The samples of a pixel share out the directions, so a pixel sees all of
 * them.
 * Source of the idea: Bavoil, Sainz, Dimitrov. Image-space Horizon-based Ambient Occlusion. 2008. Ours needs
 * no angles: the sine of the elevation is normal . ray / length, and the greatest one is found from squares.
 * Outline: a sample beside one that lies far behind its tangent plane, or beside nothing, is darkened.
 * Insides (triangles seen from behind) get a reddish colour, so that holes and flipped triangles show. */

enum { SHADE_ROUND = 48, SHADE_STEPS = 4, SHADE_MOST_TAPS = 12 * SHADE_STEPS };

#define SHADE_REACH      0.16 /* how far occlusion looks, of the picture's shorter side */
#define SHADE_LEAST_RISE 0.04 /* sines below it come from rounding and from facets of smooth shapes */
#define SHADE_WRAP \
    0.15 /* how far light reaches around the edge of the lit side: shapes show in the shadow too */
#define SHADE_JUMP 0.012 /* depth behind the tangent plane that makes an outline, of the shorter side */

static const double shade_light[3] = {-0.34, 0.46, 0.82};
static const double shade_inside[3] = {1.0, 0.74, 0.64}; /* times the colour */

typedef struct shade_tap {
    int32_t dx, dy;
    double x, y, length2; /* the same as numbers, and x^2 + y^2 */
} shade_tap;

struct bvxi_shade {
    const bvxi_picture *picture;
    int32_t directions; /* of each of a pixel's samples */
    double reach2;      /* square of the reach [Units: samples^2] */
    double jump;        /* [Units: samples] */
    double light[3];
    int32_t reach; /* no tap is farther away along a side [Units: samples] */
    /* of each of a pixel's samples: directions, each with its steps */
    shade_tap tap[16][SHADE_MOST_TAPS];
};

/* ---- which places are looked at ---- */

static int32_t shade_offset(double v)
{
    return (int32_t)floor(v + 0.5);
}

/* Steps grow with the square of their number: fine near the sample, coarse far away. */
static void shade_taps(bvxi_shade *s, int32_t patterns, double reach)
{
    double circle[SHADE_ROUND][2];

    /* Directions around the circle: halve a sixth three times, then turn on. */
    double cosine = 0.5, sine = sqrt(0.75);

    /* By the half-angle formulas, which need square roots only: cosines are not the same on every machine. */
    for (int k = 0; k < 3; k++) {
        double const half = sqrt((1.0 + cosine) * 0.5);
        sine = sine / (2.0 * half);
        cosine = half;
    }
    circle[0][0] = 1.0;
    circle[0][1] = 0.0;
    for (int k = 1; k < SHADE_ROUND; k++) {
        circle[k][0] = circle[k - 1][0] * cosine - circle[k - 1][1] * sine;
        circle[k][1] = circle[k - 1][0] * sine + circle[k - 1][1] * cosine;
    }
    for (int32_t p = 0; p < patterns; p++) {
        /* Samples of one pixel look at different places: together they look at all of them. */
        double const phase = ((double)p + 0.5) / (double)patterns;
        shade_tap *tap = s->tap[p];
        for (int32_t d = 0; d < s->directions; d++) {
            const double *const way = circle[(d * patterns + p) * SHADE_ROUND / (s->directions * patterns)];
            for (int32_t k = 0; k < SHADE_STEPS; k++, tap++) {
                double const share = ((double)k + phase) / SHADE_STEPS;
                /* A step of less than a pixel would look at the sample itself. */
                double const length = share * share * reach < 1.0 ? 1.0 : share * share * reach;
                tap->dx = shade_offset(way[0] * length);
                tap->dy = shade_offset(way[1] * length);
                tap->x = tap->dx;
                tap->y = tap->dy;
                tap->length2 = tap->x * tap->x + tap->y * tap->y;
            }
        }
    }
}

bvx_status bvxi_shade_open(bvx_context *ctx, const bvxi_picture *picture, bvxi_shade **shade)
{
    static const int32_t directions[5] = {0, 12, 6, 4, 3};
    const bvxi_raster *const r = &picture->raster;
    double const side = (double)(r->width < r->height ? r->width : r->height);
    double const length = sqrt(bvxi_vec_dot(shade_light, shade_light));
    bvxi_shade *s;

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, sizeof *s, "the picture's shading", &s));

    s->picture = picture;
    s->directions = directions[picture->options.samples];
    s->reach2 = side * SHADE_REACH * side * SHADE_REACH;
    s->reach = (int32_t)(side * SHADE_REACH) + 2;
    s->jump = side * SHADE_JUMP + 3.0 * picture->roughness;
    for (int a = 0; a < 3; a++) s->light[a] = shade_light[a] / length;
    shade_taps(s, picture->options.samples * picture->options.samples, side * SHADE_REACH);
    *shade = s;
    return BVX_OK;
}

/* ---- one sample ---- */

/* Share of the ambient light that does not reach a sample, in [0, 1]. */
static double shade_occlusion(const bvxi_shade *s, int32_t x, int32_t y, int32_t pattern, const double n[3])
{
    const bvxi_raster *const r = &s->picture->raster;
    const shade_tap *ray = s->tap[pattern];
    double const roughness = s->picture->roughness;
    double const z = (double)r->depth[(size_t)y * (size_t)r->width + (size_t)x];
    /* Far from the border no tap leaves the picture: one test for all of them. */
    int const inner = x >= s->reach && y >= s->reach && x < r->width - s->reach && y < r->height - s->reach;
    double sum = 0.0;

    for (int32_t d = 0; d < s->directions; d++, ray += SHADE_STEPS) {
        double most = 0.0;
        for (int32_t k = 0; k < SHADE_STEPS; k++) {
            const shade_tap *const tap = ray + k;
            int32_t const tx = x + tap->dx, ty = y + tap->dy;
            if (!inner && (tx < 0 || ty < 0 || tx >= r->width || ty >= r->height)) break;
            double const dz = (double)r->depth[(size_t)ty * (size_t)r->width + (size_t)tx] - z;
            /* Height over the tangent plane; steps of voxels below the roughness do not count. */
            double const rise = n[0] * tap->x - n[1] * tap->y + n[2] * dz - roughness;
            if (rise > 0.0) {
                double const length2 = tap->length2 + dz * dz;
                double const fade = 1.0 - length2 / s->reach2;
                double const sine2 = rise * rise / length2;
                /* Squares are compared, so that there is one root a direction and not one a tap. */
                if (fade > 0.0 && sine2 > SHADE_LEAST_RISE * SHADE_LEAST_RISE && sine2 * fade * fade > most)
                    most = sine2 * fade * fade;
            }
        }
        sum += sqrt(most);
    }
    return sum / s->directions;
}

/* 1 when a neighbour one pixel away lies far behind the tangent plane. */
static int shade_is_outline(const bvxi_shade *s, int32_t x, int32_t y, const double n[3])
{
    static const int32_t side[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const bvxi_raster *const r = &s->picture->raster;
    int32_t const away = s->picture->options.samples;
    double const z = (double)r->depth[(size_t)y * (size_t)r->width + (size_t)x];

    /* A surface seen at a flat angle falls away fast: the slope is bounded, or all would be outline. */
    double const steep = n[2] > 0.1 ? n[2] : 0.1;

    for (int k = 0; k < 4; k++) {
        int32_t const dx = side[k][0] * away, dy = side[k][1] * away;
        if (x + dx < 0 || y + dy < 0 || x + dx >= r->width || y + dy >= r->height) continue;
        double const there = (double)r->depth[(size_t)(y + dy) * (size_t)r->width + (size_t)(x + dx)];
        if (z - (n[0] * dx - n[1] * dy) / steep - there > s->jump) return 1;
    }
    return 0;
}

/* ---- pixels ---- */

static void shade_pixel(const bvxi_shade *s, int32_t px, int32_t py, bvxi_seen *seen, uint8_t *pixel)
{
    const bvxi_picture *const p = s->picture;
    const bvxi_raster *const r = &p->raster;
    int32_t const side = p->options.samples;
    double sum[3] = {0.0, 0.0, 0.0};

    for (int32_t k = 0; k < side * side; k++) {
        int32_t const x = px * side + k % side, y = py * side + k / side;
        uint32_t const id = r->id[(size_t)y * (size_t)r->width + (size_t)x];
        if (id == BVXI_RASTER_EMPTY) {
            for (int a = 0; a < 3; a++) sum[a] += p->options.background[a];
            continue;
        }
        bvxi_seen *const here = seen + k / side; /* a row of samples goes from neighbour to neighbour */
        p->see(p->model, r, id, x, y, here);
        double const open = 1.0 - shade_occlusion(s, x, y, k, here->tangent);
        double const facing = (bvxi_vec_dot(here->normal, s->light) + SHADE_WRAP) / (1.0 + SHADE_WRAP);
        double const ambient = (0.34 + 0.06 * here->normal[1]) * open * open;
        double const direct = facing > 0.0 ? 0.74 * facing * (0.45 + 0.55 * open) : 0.0;
        /* Little of it is ambient, and it is squared: corners get dark, open places stay even. */
        double const strength = ((ambient + direct) *
                                 (shade_is_outline(s, x, y, here->tangent) ? 0.5 : 1.0)) *
                                here->light;
        for (int a = 0; a < 3; a++)
            sum[a] += here->colour[a] * strength * (here->inside ? shade_inside[a] : 1.0);
    }
    for (int a = 0; a < 3; a++) {
        double const v = sum[a] / (side * side);
        pixel[a] = (uint8_t)(v <= 0.0 ? 0.0 : v >= 254.5 ? 255.0 : v + 0.5);
    }
}

void bvxi_shade_rows(const bvxi_shade *shade, int32_t begin, int32_t end)
{
    const bvx_image *const image = &shade->picture->image;
    bvxi_seen seen[4]; /* of each row of a pixel's samples */
    memset(seen, 0, sizeof seen);
    for (int32_t y = begin; y < end; y++)
        for (int32_t x = 0; x < image->width; x++)
            shade_pixel(shade, x, y, seen,
                        image->pixels + ((size_t)y * (size_t)image->width + (size_t)x) * 3);
}
