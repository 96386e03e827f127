/* sheet_four.c - the solid angle of the sheet over a mesh's holes, from four places at once.
 *
 * The sums of sheet.c in four lanes. Parts are opened where one of the four requires it, so each is as near
 * as by itself; neighbours require nearly the same. Where digits count, lanes that do not require it stand
 * still meanwhile. What is rare (a place in a triangle's plane, near edges and triangles to be listed) is
 * done lane by lane.
 * Guarantee: that of sheet.c. Without vectors its own functions are evaluated four times. */
#include "winding/sheet.h"
#include "core/simd.h"

#define four_point BVXI_SIMD(bvxi_four_point)
#define four_sum   BVXI_SIMD(bvxi_four_sum)
#define four_angle BVXI_SIMD(bvxi_four_angle)

#if BVXI_SIMD_BASE
#define BVXI_SIMD_LEVEL _base
#include "winding/sheet_lanes_body.h"

#include "winding/sheet_four_body.h"
#undef BVXI_SIMD_LEVEL
#endif

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "winding/sheet_lanes_body.h"

#include "winding/sheet_four_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_sheet_angles_four(const bvxi_sheet *s, const int64_t p[4][3], double near, double turns[4])
{
#if BVXI_HAVE_AVX2
    if (s->fast) {
        angles_four_avx2(s, p, near, turns);
        return;
    }
#endif
#if BVXI_SIMD_BASE
    angles_four_base(s, p, near, turns);
#else
    for (int l = 0; l < 4; l++) turns[l] = bvxi_sheet_angle(s, p[l], near);
#endif
}

void bvxi_sheet_around_four(const bvxi_sheet *s, const int64_t p[4][3], double reach, double near,
                            double edge_rest, bvxi_sheet_look look[4])
{
#if BVXI_HAVE_AVX2
    if (s->fast) {
        around_four_avx2(s, p, reach, near, edge_rest, look);
        return;
    }
#endif
#if BVXI_SIMD_BASE
    around_four_base(s, p, reach, near, edge_rest, look);
#else
    for (int l = 0; l < 4; l++) bvxi_sheet_around(s, p[l], reach, near, edge_rest, &look[l]);
#endif
}

void bvxi_sheet_turns_four(const bvxi_sheet *s, const int64_t p[4][3], int32_t want_clear,
                           bvxi_sheet_answer answer[4])
{
#if BVXI_HAVE_AVX2
    if (s->fast) {
        turns_four_avx2(s, p, want_clear, answer);
        return;
    }
#endif
#if BVXI_SIMD_BASE
    turns_four_base(s, p, want_clear, answer);
#else
    for (int l = 0; l < 4; l++) answer[l] = bvxi_sheet_turns(s, p[l], want_clear);
#endif
}
