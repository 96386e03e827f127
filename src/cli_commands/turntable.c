/* turntable.c - directions around an axis, the same to the last bit on every machine.
 *
 * A frame's angle is a whole fraction of a turn. Whole quarters are taken off in integers; what remains, at
 * most an eighth of a turn, goes into the series of sine and cosine, in which only + - * / stand. */
#include "cli_commands/commands.h"

#include <math.h>

#define QUARTER 1.5707963267948966

static double series_of_cosine(double x)
{
    double const x2 = x * x;
    double sum = 1.0;
    for (int n = 20; n > 0; n -= 2) sum = 1.0 - sum * x2 / (n * (n - 1)); /* the next term is below 2^-70 */
    return sum;
}

static double series_of_sine(double x)
{
    double const x2 = x * x;
    double sum = 1.0;
    for (int n = 21; n > 1; n -= 2) sum = 1.0 - sum * x2 / (n * (n - 1));
    return x * sum;
}

/* Cosine and sine of i / n of a turn, 0 <= i < n. */
static void turn_by(int32_t i, int32_t n, double *cosine, double *sine)
{
    int64_t const quarters = 4 * (int64_t)i / n, rest = 4 * (int64_t)i % n;
    /* Series are short near 0, so the angle is taken from the nearer quarter. */
    int const late = 2 * rest > n; /* nearer to the next quarter */
    double const x = QUARTER * (double)(late ? n - rest : rest) / (double)n;
    double const c = late ? series_of_sine(x) : series_of_cosine(x);
    double const s = late ? series_of_cosine(x) : series_of_sine(x);
    *cosine = quarters == 0 ? c : quarters == 1 ? -s : quarters == 2 ? -c : s;
    *sine = quarters == 0 ? s : quarters == 1 ? c : quarters == 2 ? -s : -c;
}

static double inner(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Length 1, by the greatest part first: squares neither overflow nor vanish. */
static void unit_of(const double v[3], double n[3])
{
    double most = 0.0, length;

    for (int a = 0; a < 3; a++) {
        most = v[a] > most ? v[a] : most;
        most = -v[a] > most ? -v[a] : most;
    }
    for (int a = 0; a < 3; a++) n[a] = v[a] / most;
    length = sqrt(inner(n, n));
    for (int a = 0; a < 3; a++) n[a] /= length;
}

int cli_turn(const double direction[3], const double axis[3], int32_t i, int32_t n, double turned[3])
{
    double d[3], u[3], flat[3], side[3], cosine, sine, along;

    unit_of(direction, d);
    unit_of(axis, u);
    along = inner(d, u);
    for (int a = 0; a < 3; a++) flat[a] = d[a] - along * u[a];
    /* The eye lies on the axis: turning would change nothing. */
    if (inner(flat, flat) < 1e-12) return 0;
    side[0] = u[1] * flat[2] - u[2] * flat[1];
    side[1] = u[2] * flat[0] - u[0] * flat[2];
    side[2] = u[0] * flat[1] - u[1] * flat[0];
    turn_by(i, n, &cosine, &sine);
    for (int a = 0; a < 3; a++) turned[a] = along * u[a] + cosine * flat[a] + sine * side[a];
    return 1;
}

void cli_turn_room(const double low[3], const double high[3], const double middle[3],
                   const double direction[3], const double axis[3], double room[2])
{
    double d[3], u[3], across[3], side[2][3];

    unit_of(direction, d);
    unit_of(axis, u);
    for (int a = 0; a < 3; a++) across[a] = u[(a + 1) % 3] * d[(a + 2) % 3] - u[(a + 2) % 3] * d[(a + 1) % 3];
    unit_of(across, side[0]);
    for (int a = 0; a < 3; a++)
        side[1][a] = d[(a + 1) % 3] * side[0][(a + 2) % 3] - d[(a + 2) % 3] * side[0][(a + 1) % 3];
    /* A box is seen as wide as its farthest corner. */
    for (int corner = 0; corner < 8; corner++) {
        double q[3];
        for (int a = 0; a < 3; a++) q[a] = ((corner >> a & 1) != 0 ? high[a] : low[a]) - middle[a];
        for (int k = 0; k < 2; k++) {
            double const along = inner(q, side[k]), far = along < 0.0 ? -along : along;
            room[k] = far > room[k] ? far : room[k];
        }
    }
}
