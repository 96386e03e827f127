/* openmp.c - the one file that knows OpenMP. Without it every stage runs on one thread or on the caller's own. */
#include "context.h"

#if defined(_OPENMP)
#include <omp.h>

int32_t bvxi_openmp_threads(void)
{
    int const n = omp_get_max_threads();
    return n < 1 ? 1 : n > BVXI_MAX_THREADS ? BVXI_MAX_THREADS : n;
}

void bvxi_openmp_run(int32_t threads, int32_t count, bvx_task_fn *task, void *user)
{
    int const workers = threads < count ? threads : count;
#pragma omp parallel for schedule(dynamic, 1) num_threads(workers)
    for (int32_t i = 0; i < count; i++) task(user, i, omp_get_thread_num());
}

#else

int32_t bvxi_openmp_threads(void)
{
    return 0;
}

void bvxi_openmp_run(int32_t threads, int32_t count, bvx_task_fn *task, void *user)
{
    (void)threads;
    for (int32_t i = 0; i < count; i++) task(user, i, 0);
}

#endif
