/*
 * From amperes to amperes: one leg on an STM32F446 (Cortex-M4F). README.md has the wiring and what to change.
 *
 * Encoders send angles and velocities over CAN. A timer interrupts at the rate of the law. Each step computes the
 * torque of the joints (law_step), the currents of the motors (law_command), and sends them over CAN.
 *
 * Rules:
 * - The leg moves only after the button was pressed. Before, the law gives its safe torque, which damps the leg.
 * - A fault stops the motion: safe torque again, until the button is pressed; zero while an encoder is missing.
 * - The watchdog is fed only when a step was done in time and its frames were accepted.
 */
#include "law.h"
#include "stm32f4xx_hal.h"

#include <math.h>

/* What CubeMX writes: handles of the peripherals, and their settings (stubs/board.c lists them). */
extern CAN_HandleTypeDef hcan1;
extern IWDG_HandleTypeDef hiwdg;
extern TIM_HandleTypeDef htim6;
void board_init(void);

/* ---- What you change for your leg ------------------------------------------------------------------------------- */

#define TIMER_HZ 1e6 /* what TIM6 counts, after its prescaler */

/* Encoder j sends frame ENCODER_ID + j: int32 counts, int16 velocity [mrad/s], both little-endian, uint8 counter. */
#define ENCODER_ID 0x100u
#define ENCODER_BYTES 7u
#define RAD_PER_COUNT ((law_real)(2.0 * 3.14159265358979 / 65536.0))

/* Drive j takes its current as a VESC does: extended frame, identifier 1 << 8 | drive, int32 [mA], big-endian. */
#define SET_CURRENT (1u << 8)

static const uint32_t drive[LAW_JOINTS] = {1, 2, 3};
static const int32_t zero[LAW_JOINTS] = {0, 0, 0};            /* counts where the angle of the URDF is zero */
static const law_real sense[LAW_JOINTS] = {1.0f, 1.0f, 1.0f}; /* -1 where the encoder counts against the URDF */

/* Motion: from where the leg is at the start to `swing` [rad] further, and back, once in PERIOD seconds. */
#define PERIOD 2.0f /* [s] */
static const law_real swing[LAW_JOINTS] = {0.5f, -0.7f, 0.15f};

/* ---- State: the interrupts of CAN and timer have the same priority, so that neither sees half of the other ----- */

static law_state state;
static law_input in;
static unsigned fresh;                     /* bit j: joint j has reported since the last step that used it */
static uint8_t counter[LAW_JOINTS];        /* last counter of each encoder */
static int running;                        /* whether the leg follows its motion */
static int held;                           /* whether the button was down in the last step */
static uint32_t tick;                      /* steps since the motion began, modulo its period */
static law_real start[LAW_JOINTS];         /* angles at its beginning [rad] */
static volatile uint32_t done;             /* steps that were done in time */

/* An encoder's frame. One that repeats its counter is old: the sensor hangs, although its bus works. */
void HAL_CAN_RxFifo0MsgPendingCallback(CAN_HandleTypeDef *hcan)
{
    CAN_RxHeaderTypeDef header;
    uint8_t data[8];
    uint32_t j;
    if (HAL_CAN_GetRxMessage(hcan, CAN_RX_FIFO0, &header, data) != HAL_OK || header.IDE != CAN_ID_STD) {
        return;
    }
    j = header.StdId - ENCODER_ID;
    if (j < LAW_JOINTS && header.DLC == ENCODER_BYTES && data[6] != counter[j]) {
        int32_t counts = (int32_t)(data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16 | (uint32_t)data[3] << 24);
        int16_t velocity = (int16_t)(data[4] | (uint16_t)data[5] << 8);
        in.q[j] = sense[j] * RAD_PER_COUNT * (law_real)(counts - zero[j]);
        in.v[j] = sense[j] * 0.001f * (law_real)velocity;
        counter[j] = data[6];
        fresh |= 1u << j;
    }
}

/* Reference of this step. A leg that stands still has none: NaN makes the law give its safe torque. */
static void reference(void)
{
    const law_real w = 6.2831853f / PERIOD;
    law_real phase = w * (law_real)tick / (law_real)LAW_RATE;
    int j;
    for (j = 0; j < LAW_JOINTS; ++j) {
        in.q_d[j] = running ? start[j] + 0.5f * swing[j] * (1.0f - cosf(phase)) : NAN;
        in.v_d[j] = running ? 0.5f * swing[j] * w * sinf(phase) : NAN;
    }
    tick = (tick + 1) % (uint32_t)(PERIOD * (law_real)LAW_RATE);
    ++in.target;
}

/* Let frames ENCODER_ID to ENCODER_ID + 3 in, and nothing else. */
static void filter_frames(void)
{
    CAN_FilterTypeDef filter = {0};
    filter.FilterIdHigh = ENCODER_ID << 5;
    filter.FilterMaskIdHigh = 0x7FCu << 5;
    filter.FilterMode = CAN_FILTERMODE_IDMASK;
    filter.FilterScale = CAN_FILTERSCALE_32BIT;
    filter.FilterFIFOAssignment = CAN_FILTER_FIFO0;
    filter.FilterActivation = CAN_FILTER_ENABLE;
    filter.SlaveStartFilterBank = 14;
    HAL_CAN_ConfigFilter(&hcan1, &filter);
}

static int send_current(int j, law_real amperes)
{
    CAN_TxHeaderTypeDef header = {0};
    int32_t value = (int32_t)lrintf(1000.0f * amperes);
    uint32_t bits = (uint32_t)value, mailbox;
    uint8_t data[4] = {(uint8_t)(bits >> 24), (uint8_t)(bits >> 16), (uint8_t)(bits >> 8), (uint8_t)bits};
    header.ExtId = SET_CURRENT | drive[j];
    header.IDE = CAN_ID_EXT;
    header.RTR = CAN_RTR_DATA;
    header.DLC = sizeof data;
    return HAL_CAN_AddTxMessage(&hcan1, &header, data, &mailbox) == HAL_OK;
}

/* One step, LAW_RATE times a second: also when frames are late or missing. */
void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *htim)
{
    law_real tau[LAW_JOINTS], current[LAW_JOINTS];
    law_status status;
    int j, accepted = 1, pressed = HAL_GPIO_ReadPin(GPIOC, GPIO_PIN_13) == GPIO_PIN_RESET;
    if (htim != &htim6) {
        return;
    }
    if (fresh == (1u << LAW_JOINTS) - 1u) { /* one joint that is silent makes all of the reading old */
        fresh = 0;
        ++in.reading;
    }
    reference();
    status = law_step(&state, &in, tau);
    law_command(in.q, in.v, tau, current);
    for (j = 0; j < LAW_JOINTS; ++j) {
        accepted &= send_current(j, current[j]);
    }
    if (status != LAW_OK) {
        running = 0;
    }
    if (status == LAW_TARGET_NOT_FINITE && pressed && !held) { /* nothing is missing but a reference */
        for (j = 0; j < LAW_JOINTS; ++j) {
            start[j] = in.q[j];
        }
        tick = 0;
        running = 1;
    }
    held = pressed;
    if (accepted && !__HAL_TIM_GET_FLAG(htim, TIM_FLAG_UPDATE)) { /* else the next period has begun already */
        ++done;
    }
}

int main(void)
{
    uint32_t fed = 0;
    board_init();
    law_init(&state);
    __HAL_TIM_SET_AUTORELOAD(&htim6, (uint32_t)(TIMER_HZ / (double)LAW_RATE) - 1u);
    filter_frames();
    HAL_CAN_Start(&hcan1);
    HAL_CAN_ActivateNotification(&hcan1, CAN_IT_RX_FIFO0_MSG_PENDING);
    HAL_TIM_Base_Start_IT(&htim6);
    for (;;) {
        __WFI();
        if (done != fed) { /* here, not in the interrupt: it proves that this loop lives too */
            fed = done;
            HAL_IWDG_Refresh(&hiwdg);
        }
    }
}
