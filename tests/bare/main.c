/* main.c - the core on a Cortex-M3 without operating system, heap and floating-point
 * unit: everything lives in one static array. Prints the golden line of bare_case.h
 * and the memory that it took, by semihosting; tests/tools/bare.sh compares. */
#define SHAPE_MAX 600
#include "golden/bare_case.h"

#include <string.h>

enum { ARENA_BYTES = 120 * 1024, TEXT_BYTES = 256 };

static _Alignas(64) unsigned char arena[ARENA_BYTES];
static shape torus;
static char text[TEXT_BYTES];
static size_t text_size;

/* ---- Semihosting: the emulator serves these calls ---- */

static int32_t semihost(int32_t operation, const void *argument)
{
    register int32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void say(const char *words)
{
    while (*words != 0 && text_size + 1 < sizeof text) text[text_size++] = *words++;
}

static void say_number(uint64_t n, uint64_t base)
{
    char digits[24];
    int32_t count = 0;

    do digits[count++] = "0123456789abcdef"[n % base];
    while ((n /= base) != 0);
    if (base == 16) {
        while (count < 16) digits[count++] = '0';
    }
    while (count > 0 && text_size + 1 < sizeof text) text[text_size++] = digits[--count];
}

int main(void)
{
    bvx_context_options options = {.struct_size = sizeof options};
    bvx_context *ctx = NULL;
    bare_result r = {0, 0, 0, 0};
    bvx_status status;

    options.arena.memory = arena;
    options.arena.size = sizeof arena;
    status = bvx_context_create(&options, &ctx);
    if (status == BVX_OK) status = bare_case(ctx, &torus, &r);
    if (status == BVX_OK) {
        say("torus_32_bare set=");
        say_number(r.set, 10);
        say(" bits=");
        say_number(r.bits, 16);
        say(" triangles=");
        say_number(r.triangles, 10);
        say(" mesh=");
        say_number(r.mesh, 16);
        say("\narena ");
        say_number(bvx_memory_peak(ctx), 10);
    } else {
        say("FAIL ");
        say(ctx != NULL ? bvx_last_message(ctx) : bvx_status_text(status));
    }
    say("\n");
    semihost(0x04, text);                             /* SYS_WRITE0 */
    semihost(0x18, (const void *)(uintptr_t)0x20026); /* SYS_EXIT, application exit */
    for (;;) {}
}

/* ---- Start ---- */

extern uint32_t bare_data_from[], bare_data[], bare_data_end[], bare_bss[], bare_bss_end[], bare_stack[];

void reset(void);
void reset(void)
{
    memcpy(bare_data, bare_data_from, (size_t)((unsigned char *)bare_data_end - (unsigned char *)bare_data));
    memset(bare_bss, 0, (size_t)((unsigned char *)bare_bss_end - (unsigned char *)bare_bss));
    main();
}

static void fault(void)
{
    semihost(0x04, "FAIL fault\n");
    semihost(0x18, (const void *)(uintptr_t)0x20023);
    for (;;) {}
}

/* Stack, reset, non-maskable interrupt, hard, memory, bus and usage faults. */
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))bare_stack, reset, fault, fault, fault, fault, fault,
};
