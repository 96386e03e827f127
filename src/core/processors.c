/* processors.c - how many threads are worth having: processors that this process may run on, what its control
 * groups grant of them, and what OMP_NUM_THREADS and OMP_THREAD_LIMIT require, by which schedulers of many
 * processes divide a machine.
 *
 * A group (of version 2) has cpu.max ("150000 100000": one and a half processors, "max 100000": all). Every
 * group above it limits it too. Inside a container the path that /proc tells may be that outside; then the
 * mounted folder itself is the container's. Nothing is kept between calls.
 *
 * And when: helpers must cost next to nothing where there is nothing for them to gain, in small calls and on
 * processors that others keep busy. Three rules see to that; none can show in a result, as what a task
 * computes depends on its index only.
 *
 *   - The calling thread begins alone. Helpers are started once a context's steps have taken COLD_TIME, and
 *     are woken for a step that has taken SMALL_TIME and is not done: clocks measure the work, no estimate
 *     has to be right.
 *   - There are no more helpers than processors without work, where the system reports (Linux).
 *   - A helper that loses its processor makes the caller wait. The caller then works alone for a multiple of
 *     that time, a longer one each time it happens again. */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* what -std=c99 hides: affinity, clocks */
#endif

#include "core/context.h"

#if (defined(_REENTRANT) || defined(_OPENMP)) && !defined(BVX_FREESTANDING)
#define HAVE_HELPERS 1
#endif
#if defined(HAVE_HELPERS) && defined(_OPENMP)
#include <omp.h>
#endif

#if defined(HAVE_HELPERS) && (defined(__unix__) || defined(__APPLE__))
#include <fcntl.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>
#if defined(__linux__)
#include <sched.h>
#endif

enum { GROUP_FILE = 4096, GROUP_PATH = 1024 };

/* The text of a small file, ended by 0; its length, or -1. */
static int64_t read_text(const char *path, char *text, size_t room)
{
    int const file = open(path, O_RDONLY);
    int64_t length = 0;
    ssize_t n = 1;

    if (file < 0) return -1;
    /* A read may give less than was requested. */
    while (n > 0 && (size_t)length < room - 1) {
        n = read(file, text + length, room - 1 - (size_t)length);
        if (n > 0) length += n;
    }
    close(file);
    text[length] = 0;
    return n < 0 ? -1 : length;
}

/* The number at *text, which moves after it; -1 when there is none. */
static int64_t take_count(const char **text)
{
    const char *p = *text;
    int64_t n = 0;
    /* After blanks and commas, as variables have lists. */
    while (*p == ' ' || *p == ',') p++;
    if (*p < '0' || *p > '9') return -1;
    for (; *p >= '0' && *p <= '9'; p++) n = n < INT64_C(1000000000000) ? n * 10 + (*p - '0') : n;
    *text = p;
    return n;
}

static int32_t lesser_quota(int32_t a, int32_t b)
{
    return a == 0 || (b != 0 && b < a) ? b : a;
}

/* What the group of this path grants, and all above it up to the mounted folder itself. */
static int32_t group_quota(const char *mounted, const char *group, size_t length)
{
    size_t const first = bvxi_text_length(mounted);
    char path[GROUP_PATH], text[128];
    int32_t least = 0;

    if (first + length + sizeof "/cpu.max" > sizeof path) return 0;
    memcpy(path, mounted, first);
    memcpy(path + first, group, length);
    for (;;) {
        while (length > 0 && group[length - 1] == '/') length--;
        memcpy(path + first + length, "/cpu.max", sizeof "/cpu.max");
        if (read_text(path, text, sizeof text) >= 0) {
            const char *p = text;
            int64_t const quota = take_count(&p), period = take_count(&p);
            /* Processors that quota of each period are worth, to the nearest whole one; 0: all. */
            int64_t whole = quota <= 0 || period <= 0 ? INT32_MAX : (quota + period / 2) / period;
            whole = whole < 1 ? 1 : whole > BVXI_MAX_THREADS ? 0 : whole;
            least = lesser_quota(least, (int32_t)whole);
        }
        if (length == 0) return least;
        while (length > 0 && group[length - 1] != '/') length--;
        memcpy(path + first, group, length);
    }
}

/* Of the lines number:controllers:path that of version 2, which names no controllers. */
int32_t bvxi_processor_quota(const char *groups, const char *mounted)
{
    char text[GROUP_FILE];
    int64_t const length = read_text(groups, text, sizeof text);
    for (const char *p = text; length > 0 && p < text + length; p++) {
        const char *const end = bvxi_find_byte(p, text + length, '\n');
        if (end - p > 3 && memcmp(p, "0::", 3) == 0)
            return group_quota(mounted, p + 3, (size_t)(end - p) - 3);
        p = end;
    }
    return 0;
}

int32_t bvxi_online_processors(void)
{
#if defined(_SC_NPROCESSORS_ONLN)
    long const online = sysconf(_SC_NPROCESSORS_ONLN);
    return online < 1 ? 1 : online > BVXI_MAX_THREADS ? BVXI_MAX_THREADS : (int32_t)online;
#else
    return 1;
#endif
}

static int32_t allowed_processors(void)
{
#if defined(__linux__) && defined(CPU_COUNT)
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return (int32_t)CPU_COUNT(&set);
#endif
    return bvxi_online_processors();
}

/* "0.20 0.18 0.12 1/80 11206": of 80 threads of the machine one runs or
 * waits for a processor, the calling one. */
int32_t bvxi_running_threads(void)
{
    char text[128];
    int64_t const length = read_text("/proc/loadavg", text, sizeof text);
    const char *const end = text + (length > 0 ? length : 0);
    const char *p = bvxi_find_byte(text, end, '/');
    if (p == end) return 0;
    /* The digits before the slash are those that run. */
    while (p > text && p[-1] >= '0' && p[-1] <= '9') p--;
    int64_t const running = take_count(&p);
    return running < 0 ? 0 : running > BVXI_MAX_THREADS ? BVXI_MAX_THREADS : (int32_t)running;
}

/* The first number of such a variable ("4", "4,2"); 0 when it is not set. */
static int32_t asked_for(const char *variable)
{
    const char *text = getenv(variable);
    int64_t const n = text == NULL ? 0 : take_count(&text);
    return n < 1 || n > BVXI_MAX_THREADS ? 0 : (int32_t)n;
}

int32_t bvxi_processors(void)
{
    int32_t const asked = asked_for("OMP_NUM_THREADS"), limit = asked_for("OMP_THREAD_LIMIT");
    int32_t n = asked != 0 ? asked : allowed_processors();
    /* Only without the variable: a scheduler knows what it grants. */
    if (asked == 0 && n > 1) n = lesser_quota(n, bvxi_processor_quota("/proc/self/cgroup", "/sys/fs/cgroup"));
    n = lesser_quota(n, limit);
    return n > BVXI_MAX_THREADS ? BVXI_MAX_THREADS : n;
}

static int64_t clock_time(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

int64_t bvxi_now(void)
{
    return clock_time(CLOCK_MONOTONIC);
}

int64_t bvxi_processor_time(void)
{
    return clock_time(CLOCK_THREAD_CPUTIME_ID);
}

#else

int32_t bvxi_processor_quota(const char *groups, const char *mounted)
{
    (void)groups, (void)mounted;
    return 0;
}

int32_t bvxi_online_processors(void)
{
    return 1;
}

int32_t bvxi_running_threads(void)
{
    return 0;
}

/* Without a thread's own clock none is seen to lose its processor. */
int64_t bvxi_processor_time(void)
{
    return bvxi_now();
}

#if defined(HAVE_HELPERS) && defined(_OPENMP)
int64_t bvxi_now(void)
{
    return (int64_t)(omp_get_wtime() * 1e9);
}

int32_t bvxi_processors(void)
{
    int const n = omp_get_max_threads();
    return n < 1 ? 1 : n > BVXI_MAX_THREADS ? BVXI_MAX_THREADS : n;
}
#else
int64_t bvxi_now(void)
{
    return 0;
}

int32_t bvxi_processors(void)
{
    return 1;
}
#endif

#endif

/* ---- When helpers are worth their wake ---- */

/* Nanoseconds. A wake costs some 5000, a start and a look at the system's load ten times that. */
enum { COLD_TIME = 200000, SMALL_TIME = 20000, LOOK_TIME = 3000000, NOTICED_WAIT = 200000 };

enum { FEW_TASKS = 8, REST_LEAST = 8, REST_MOST = 64 };

void bvxi_worth_begin(bvxi_worth *w, int32_t threads)
{
    *w = (bvxi_worth){.most = threads - 1, .rest = REST_LEAST};
}

static int has_processors(bvxi_worth *w, int64_t now)
{
    if (now < w->rest_until && w->eager < 2) return 0;
    /* Seldom, as a look takes longer than a small step. */
    if (now >= w->look_at && !w->eager) {
        int32_t const running = bvxi_running_threads();
        if (w->online == 0) w->online = bvxi_online_processors();
        w->idle = w->online - running < 0 ? 0 : w->online - running;
        /* Not known here: all may be called. */
        if (running == 0 || w->idle > w->most) w->idle = w->most;
        w->look_at = now + LOOK_TIME;
    }
    return w->idle > 0;
}

int32_t bvxi_begin_alone(bvxi_worth *w, int32_t count, bvx_task_fn *task, void *user)
{
    int64_t const start = bvxi_now();
    int64_t const cold = COLD_TIME - w->alone;
    /* few tasks may be long ones */
    int64_t const large = cold > 0 ? cold : count <= FEW_TASKS ? 0 : SMALL_TIME;
    int64_t const least = w->eager ? 0 : large;
    int64_t now = start;
    int32_t i = 0;

    while (i < count && (now - start < least || !has_processors(w, now))) {
        task(user, i++, 0);
        now = bvxi_now();
    }
    if (cold > 0) w->alone += now - start;
    return i;
}

void bvxi_worth_waited(bvxi_worth *w, int64_t start, int64_t lost)
{
    int64_t const waited = bvxi_now() - start;
    /* A wait that was long because helpers had no processor: alone for a while, longer each time. */
    if (waited >= NOTICED_WAIT && lost >= waited / 2) {
        w->rest_until = start + waited + waited * w->rest;
        if (w->rest < REST_MOST) w->rest *= 2;
    } else if (w->rest > REST_LEAST) w->rest /= 2;
}

void bvxi_pool_be_eager(bvxi_pool *pool, int32_t how)
{
    bvxi_worth *const w = (bvxi_worth *)(void *)pool; /* what a pool begins with */
    w->eager = how;
    w->idle = w->most;
}
