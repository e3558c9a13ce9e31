/*
 * The part of ST's HAL that main.c uses, with its names and types, on memory in place of registers.
 * On the real board this folder is left out, and ST's stm32f4xx_hal.h takes its place.
 */
#ifndef STM32F4XX_HAL_H
#define STM32F4XX_HAL_H

#include <stdint.h>

typedef enum { HAL_OK = 0, HAL_ERROR } HAL_StatusTypeDef;
typedef enum { DISABLE = 0, ENABLE } FunctionalState;

#define __WFI() __asm volatile("wfi")

/* CAN */
typedef struct {
    uint32_t StdId, ExtId, IDE, RTR, DLC, Timestamp, FilterMatchIndex;
} CAN_RxHeaderTypeDef;

typedef struct {
    uint32_t StdId, ExtId, IDE, RTR, DLC;
    FunctionalState TransmitGlobalTime;
} CAN_TxHeaderTypeDef;

typedef struct {
    uint32_t FilterIdHigh, FilterIdLow, FilterMaskIdHigh, FilterMaskIdLow, FilterFIFOAssignment, FilterBank;
    uint32_t FilterMode, FilterScale, FilterActivation, SlaveStartFilterBank;
} CAN_FilterTypeDef;

typedef struct {
    int unused;
} CAN_HandleTypeDef;

#define CAN_ID_STD 0x0u
#define CAN_ID_EXT 0x4u
#define CAN_RTR_DATA 0x0u
#define CAN_RX_FIFO0 0x0u
#define CAN_FILTERMODE_IDMASK 0x0u
#define CAN_FILTERSCALE_32BIT 0x1u
#define CAN_FILTER_FIFO0 0x0u
#define CAN_FILTER_ENABLE 0x1u
#define CAN_IT_RX_FIFO0_MSG_PENDING 0x2u

HAL_StatusTypeDef HAL_CAN_ConfigFilter(CAN_HandleTypeDef *hcan, const CAN_FilterTypeDef *sFilterConfig);
HAL_StatusTypeDef HAL_CAN_Start(CAN_HandleTypeDef *hcan);
HAL_StatusTypeDef HAL_CAN_ActivateNotification(CAN_HandleTypeDef *hcan, uint32_t ActiveITs);
HAL_StatusTypeDef HAL_CAN_GetRxMessage(
    CAN_HandleTypeDef *hcan, uint32_t RxFifo, CAN_RxHeaderTypeDef *pHeader, uint8_t aData[]);
HAL_StatusTypeDef HAL_CAN_AddTxMessage(
    CAN_HandleTypeDef *hcan, const CAN_TxHeaderTypeDef *pHeader, const uint8_t aData[], uint32_t *pTxMailbox);
void HAL_CAN_IRQHandler(CAN_HandleTypeDef *hcan);
void HAL_CAN_RxFifo0MsgPendingCallback(CAN_HandleTypeDef *hcan);

/* Timer */
typedef struct {
    volatile uint32_t SR, ARR;
} TIM_TypeDef;

typedef struct {
    TIM_TypeDef *Instance;
} TIM_HandleTypeDef;

#define TIM_FLAG_UPDATE 0x1u
#define __HAL_TIM_SET_AUTORELOAD(handle, value) ((handle)->Instance->ARR = (value))
#define __HAL_TIM_GET_FLAG(handle, flag) (((handle)->Instance->SR & (flag)) == (flag))

HAL_StatusTypeDef HAL_TIM_Base_Start_IT(TIM_HandleTypeDef *htim);
void HAL_TIM_IRQHandler(TIM_HandleTypeDef *htim);
void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *htim);

/* Watchdog */
typedef struct {
    int unused;
} IWDG_HandleTypeDef;

HAL_StatusTypeDef HAL_IWDG_Refresh(IWDG_HandleTypeDef *hiwdg);

/* Pins */
typedef enum { GPIO_PIN_RESET = 0, GPIO_PIN_SET } GPIO_PinState;

typedef struct {
    volatile uint32_t IDR;
} GPIO_TypeDef;

extern GPIO_TypeDef stub_gpioc;

#define GPIOC (&stub_gpioc)
#define GPIO_PIN_13 0x2000u

GPIO_PinState HAL_GPIO_ReadPin(const GPIO_TypeDef *GPIOx, uint16_t GPIO_Pin);

#endif
