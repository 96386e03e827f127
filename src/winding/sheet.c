/* sheet.c - the solid angle of the sheet over a mesh's holes.
 *
 * Sources: Van Oosterom, Strackee. The Solid Angle of a Plane Triangle. 1983; Barill, Dickson, Schmidt,
 * Levin, Jacobson. Fast Winding Numbers for Soups and Clouds. 2018 (far parts as dipoles); Jacobson, Kavan,
 * Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized Winding Numbers. 2013 (what lies
 * behind a hole follows from its edge only).
 *
 * A part of the sheet that is far off counts as a dipole at the middle of its ball. With area A, radius r,
 * distance d the error is below A r / (2 pi (d - r)^3) turns; parts are opened until the sum of that leaves
 * no doubt, at last all of them. Moving along, the angle changes, but for whole turns where the sheet is
 * crossed, as the field of a current along its edge (Biot and Savart): its gradient is a sum over the edges
 * of what was opened and over the dipoles. Within a reach t of the place it stays linear but for t^2 length /
 * (4 pi (d - t)^3) for each edge, and for each dipole 3 t^2 A / (4 pi (d - r - t)^4) and its error. On which
 * side of a triangle a centre lies is decided in integers, ties as everywhere (covered_rows.h), as crossings
 * are.
 *
 * One text serves one place and four at once (sheet_lanes_body.h, sheet_four_body.h): angles have the same
 * digits, and what is reported around a place is as right. */
#include "core/simd.h"
#include "winding/turns.h"

/* Parts are opened until each is off by less; the last opens all. */
enum { SHEET_LEVELS = 3 };
static const double sheet_near[SHEET_LEVELS] = {1e-3, 5e-5, -1};

#define four_point BVXI_SIMD(bvxi_four_point)
#define four_sum   BVXI_SIMD(bvxi_four_sum)
#define four_angle BVXI_SIMD(bvxi_four_angle)

enum { SHEET_LANES_one = 1, SHEET_LANES_base = 4, SHEET_LANES_avx2 = 4 };
#define sheet_lanes BVXI_SIMD(SHEET_LANES)

#define BVXI_SIMD_LEVEL _one
#include "winding/sheet_lanes_body.h"

#include "winding/sheet_four_body.h"
#undef BVXI_SIMD_LEVEL

#define BVXI_SIMD_LEVEL _base
#include "winding/sheet_lanes_body.h"

#include "winding/sheet_four_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "winding/sheet_lanes_body.h"

#include "winding/sheet_four_body.h"
#undef BVXI_SIMD_LEVEL
#endif

double bvxi_sheet_angle(const bvxi_sheet *s, const int64_t p[3], double near)
{
    double turns, error;
    angles_one(s, (const int64_t(*)[3])p, near, 0, &turns, &error);
    return turns;
}

static void angles_of_four(const bvxi_sheet *s, const int64_t p[4][3], double near, int alone,
                           double turns[4], double error[4])
{
    BVXI_PATH(s->fast, angles_base(s, p, near, alone, turns, error),
              angles_avx2(s, p, near, alone, turns, error));
}

void bvxi_sheet_angles_four(const bvxi_sheet *s, const int64_t p[4][3], double near, double turns[4])
{
    double error[4];
    angles_of_four(s, p, near, 1, turns, error);
}

void bvxi_sheet_around(const bvxi_sheet *s, const int64_t p[3], double reach, double near, double edge_rest,
                       bvxi_sheet_look *look)
{
    around_one(s, (const int64_t(*)[3])p, reach, near, edge_rest, look);
}

void bvxi_sheet_around_four(const bvxi_sheet *s, const int64_t p[4][3], double reach, double near,
                            double edge_rest, bvxi_sheet_look look[4])
{
    BVXI_PATH(s->fast, around_base(s, p, reach, near, edge_rest, look),
              around_avx2(s, p, reach, near, edge_rest, look));
}

/* What turns, off by less than error, say. Returns 1 when nothing is left open. */
static int conclude_turns(double turns, double error, int32_t want_clear, bvxi_sheet_answer *answer)
{
    double const whole = floor(turns + 0.5), signed_off = turns - whole; /* -1/2 .. 1/2 */
    double const off = signed_off < 0 ? -signed_off : signed_off;
    double const from_quarter = off < 0.25 ? 0.25 - off : off - 0.25;
    answer->tie = off + error < 0.5 ? 0 : signed_off < 0 ? -1 : 1;
    answer->whole = (int32_t)whole;
    answer->clear = off < 0.25;
    return !answer->tie && (!want_clear || from_quarter > error);
}

/* Each level opens more parts; the first that leaves no doubt answers. */
static bvxi_sheet_answer turns_from_level(const bvxi_sheet *s, const int64_t p[3], int level,
                                          int32_t want_clear)
{
    bvxi_sheet_answer answer = {0, 0, 0};
    for (; level < SHEET_LEVELS; level++) {
        double turns, error;
        angles_one(s, (const int64_t(*)[3])p, sheet_near[level], 0, &turns, &error);
        if (conclude_turns(turns, error, want_clear, &answer)) break;
    }
    return answer;
}

bvxi_sheet_answer bvxi_sheet_turns(const bvxi_sheet *s, const int64_t p[3], int32_t want_clear)
{
    return turns_from_level(s, p, 0, want_clear);
}

void bvxi_sheet_turns_four(const bvxi_sheet *s, const int64_t p[4][3], int32_t want_clear,
                           bvxi_sheet_answer answer[4])
{
    double turns[4], error[4];
    angles_of_four(s, p, sheet_near[0], 0, turns, error);
    for (int l = 0; l < 4; l++)
        if (!conclude_turns(turns[l], error[l], want_clear, &answer[l]))
            answer[l] = turns_from_level(s, p[l], 1, want_clear);
}

double bvxi_sheet_cells_angle(const bvxi_sheet *s, const int64_t p[3], const uint32_t *cells, uint64_t count)
{
    double turns;
    cells_angles_one(s, (const int64_t(*)[3])p, cells, count, &turns);
    return turns;
}

void bvxi_sheet_cells_angles_four(const bvxi_sheet *s, const int64_t p[4][3], const uint32_t *cells,
                                  uint64_t count, double turns[4])
{
    BVXI_PATH(s->fast, cells_angles_base(s, p, cells, count, turns),
              cells_angles_avx2(s, p, cells, count, turns));
}

void bvxi_sheet_cells_around(const bvxi_sheet *s, const int64_t p[3], const uint32_t *cells, uint64_t count,
                             double reach, double edge_rest, bvxi_sheet_look *look)
{
    bvxi_four_sum_one sum;
    begin_looks_one(reach, edge_rest, look, &sum);
    add_cells_one(s, (const int64_t(*)[3])p, cells, count, &sum);
    end_looks_one(&sum);
}
