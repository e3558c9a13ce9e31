/*
 * Board without a board: what the HAL's functions do, on variables that the emulator reads and writes.
 * On the real board HAL and CubeMX take its place; README.md says how.
 *
 * Settings in CubeMX:
 *   CAN1   1 Mbit/s, automatic bus-off management; interrupt CAN1 RX0 on, preemption priority 1
 *   TIM6   prescaler so that it counts at TIMER_HZ: 89 where its clock has 90 MHz. Interrupt on, preemption
 *          priority 1 as well
 *   IWDG   10 ms: prescaler 4, reload 79 (LSI of 32 kHz)
 *   PC13   input (button B1 of the Nucleo board)
 */
#include "stm32f4xx_hal.h"

#include <string.h>

void board_init(void);
void CAN1_RX0_IRQHandler(void);
void TIM6_DAC_IRQHandler(void);

CAN_HandleTypeDef hcan1;
IWDG_HandleTypeDef hiwdg;
TIM_TypeDef stub_tim6;
TIM_HandleTypeDef htim6 = {&stub_tim6};
GPIO_TypeDef stub_gpioc = {GPIO_PIN_13}; /* not pressed */

static CAN_FilterTypeDef filter;

/* A frame, the same for both directions. */
typedef struct {
    uint32_t id;
    uint32_t bytes;
    uint8_t data[8];
} frame;

frame stub_received;                      /* what the encoder sends */
frame stub_sent[3];                       /* what the drives get: three mailboxes, as CAN1 has */
uint32_t stub_full;                       /* 1: the mailboxes are full, as after a broken wire */
uint32_t stub_overrun;                    /* 1: the timer overflows again while the step is at work */
uint32_t stub_sent_count, stub_fed_count; /* frames sent, and how often the watchdog was fed */

void board_init(void)
{
}

HAL_StatusTypeDef HAL_CAN_ConfigFilter(CAN_HandleTypeDef *hcan, const CAN_FilterTypeDef *sFilterConfig)
{
    (void)hcan;
    filter = *sFilterConfig;
    return HAL_OK;
}

HAL_StatusTypeDef HAL_CAN_Start(CAN_HandleTypeDef *hcan)
{
    (void)hcan;
    return HAL_OK;
}

HAL_StatusTypeDef HAL_CAN_ActivateNotification(CAN_HandleTypeDef *hcan, uint32_t ActiveITs)
{
    (void)hcan;
    (void)ActiveITs;
    return HAL_OK;
}

HAL_StatusTypeDef HAL_CAN_GetRxMessage(
    CAN_HandleTypeDef *hcan, uint32_t RxFifo, CAN_RxHeaderTypeDef *pHeader, uint8_t aData[])
{
    (void)hcan;
    (void)RxFifo;
    memset(pHeader, 0, sizeof *pHeader);
    pHeader->StdId = stub_received.id;
    pHeader->DLC = stub_received.bytes;
    memcpy(aData, stub_received.data, 8);
    return HAL_OK;
}

HAL_StatusTypeDef HAL_CAN_AddTxMessage(
    CAN_HandleTypeDef *hcan, const CAN_TxHeaderTypeDef *pHeader, const uint8_t aData[], uint32_t *pTxMailbox)
{
    (void)hcan;
    if (stub_full) {
        return HAL_ERROR;
    }
    *pTxMailbox = stub_sent_count++ % 3;
    stub_sent[*pTxMailbox].id = pHeader->IDE == CAN_ID_EXT ? pHeader->ExtId : pHeader->StdId;
    stub_sent[*pTxMailbox].bytes = pHeader->DLC;
    memcpy(stub_sent[*pTxMailbox].data, aData, pHeader->DLC);
    return HAL_OK;
}

void HAL_CAN_IRQHandler(CAN_HandleTypeDef *hcan)
{
    HAL_CAN_RxFifo0MsgPendingCallback(hcan);
}

HAL_StatusTypeDef HAL_TIM_Base_Start_IT(TIM_HandleTypeDef *htim)
{
    (void)htim;
    return HAL_OK;
}

void HAL_TIM_IRQHandler(TIM_HandleTypeDef *htim)
{
    htim->Instance->SR = stub_overrun ? TIM_FLAG_UPDATE : 0; /* ST's clears the flag here, before the callback */
    HAL_TIM_PeriodElapsedCallback(htim);
}

HAL_StatusTypeDef HAL_IWDG_Refresh(IWDG_HandleTypeDef *hiwdg_)
{
    (void)hiwdg_;
    ++stub_fed_count;
    return HAL_OK;
}

GPIO_PinState HAL_GPIO_ReadPin(const GPIO_TypeDef *GPIOx, uint16_t GPIO_Pin)
{
    return GPIOx->IDR & GPIO_Pin ? GPIO_PIN_SET : GPIO_PIN_RESET;
}

void CAN1_RX0_IRQHandler(void)
{
    if (filter.FilterActivation && ((stub_received.id << 5 ^ filter.FilterIdHigh) & filter.FilterMaskIdHigh) == 0) {
        HAL_CAN_IRQHandler(&hcan1); /* else the frame does not interrupt the processor */
    }
}

void TIM6_DAC_IRQHandler(void)
{
    HAL_TIM_IRQHandler(&htim6);
}
