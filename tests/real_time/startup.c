/* From reset to main on a Cortex-M7, and how much of the stack was used. */
#include <stdint.h>
#include <stdlib.h>

extern uint32_t stack_low[], stack_top[], data_load[], data_start[], data_end[], bss_start[], bss_end[];
extern void initialise_monitor_handles(void); /* newlib's: files and the console by semihosting */
int main(void);
unsigned long stack_used(void);
void reset(void);

#define PAINT 0xa5a5a5a5u
#define COPROCESSORS (*(volatile uint32_t *)0xe000ed88u) /* CPACR */

unsigned long stack_used(void) {
    const uint32_t *place = stack_low;
    while (place < stack_top && *place == PAINT) place++;
    return (unsigned long)(stack_top - place) * sizeof *place;
}

static void halt(void) {
    for (;;) {}
}

void reset(void) {
    COPROCESSORS |= 0xfu << 20; /* the floating-point unit, before any number */
    __asm volatile("dsb\nisb");
    for (uint32_t *to = data_start, *from = data_load; to < data_end;) *to++ = *from++;
    for (uint32_t *to = bss_start; to < bss_end;) *to++ = 0;
    uint32_t here; /* what lies below this is free */
    for (uint32_t *to = stack_low; to < &here - 64; to++) *to = PAINT;
    initialise_monitor_handles();
    exit(main());
}

/* The core reads its stack and its first instruction here; no interrupt is used. */
__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    (void (*)(void))stack_top, reset, halt, halt, halt, halt, halt, [11] = halt, [14] = halt, [15] = halt,
};
