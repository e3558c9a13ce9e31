/* Vectors and start of the program. On the real board ST's startup_stm32f446xx.s takes its place. */
#include <stdint.h>

void Reset_Handler(void);
void CAN1_RX0_IRQHandler(void);
void TIM6_DAC_IRQHandler(void);
int main(void);

/* From the linker script. */
extern uint32_t _estack, _sidata, _sdata, _edata, _sbss, _ebss;

#define SCB_CPACR (*(volatile uint32_t *)0xE000ED88u)

static void forever(void)
{
    for (;;) { /* the watchdog ends it */
    }
}

typedef void (*vector)(void);

__attribute__((section(".isr_vector"), used)) static const struct {
    uint32_t *stack;
    vector exceptions[15], interrupts[97]; /* number of the reference manual */
} vectors = {
    &_estack,
    {Reset_Handler, forever, forever, forever, forever, forever, 0, 0, 0, 0, forever, forever, 0, forever, forever},
    {[20] = CAN1_RX0_IRQHandler, [54] = TIM6_DAC_IRQHandler},
};

void Reset_Handler(void)
{
    uint32_t *from = &_sidata, *to;
    SCB_CPACR |= 0xFu << 20; /* floating point unit on */
    for (to = &_sdata; to < &_edata; ++to, ++from) {
        *to = *from;
    }
    for (to = &_sbss; to < &_ebss; ++to) {
        *to = 0;
    }
    main();
    forever();
}
