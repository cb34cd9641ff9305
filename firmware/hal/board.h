// Pins and peripherals of each board; docs/wiring.md has the same table for assembly. The 16 lines
// of the mice are open drain with external pull-ups: PORT stays 0, and DDR pulls low. The motors'
// bus is open drain too. It also uses the micro-controller's weak pull-ups, so that it stays high
// when nothing is connected.
#ifndef FIRMWARE_HAL_BOARD_H
#define FIRMWARE_HAL_BOARD_H

#include <avr/io.h>

#if defined(__AVR_ATmega32U4__)
// The only two ports of this chip with all eight pins.
#define BOARD_CLOCK_PIN PINB
#define BOARD_CLOCK_PORT PORTB
#define BOARD_CLOCK_DDR DDRB
#define BOARD_DATA_PIN PIND
#define BOARD_DATA_PORT PORTD
#define BOARD_DATA_DDR DDRD
#define BOARD_I2C_PIN PINF
#define BOARD_I2C_PORT PORTF
#define BOARD_I2C_DDR DDRF
#define BOARD_I2C_DATA_BIT 0
#define BOARD_I2C_CLOCK_BIT 1
#define BOARD_MOTORS_PORT PORTC
#define BOARD_MOTORS_DDR DDRC
#define BOARD_MOTORS_BIT 6
#define BOARD_LED_DDR DDRC  // output A of timer 4
#define BOARD_LED_BIT 7
#elif defined(__AVR_ATmega2560__)
// Arduino Mega: pins 22..29 and 37..30, adjacent on the double header.
#define BOARD_CLOCK_PIN PINA
#define BOARD_CLOCK_PORT PORTA
#define BOARD_CLOCK_DDR DDRA
#define BOARD_DATA_PIN PINC
#define BOARD_DATA_PORT PORTC
#define BOARD_DATA_DDR DDRC
// Pins 20 and 21, labelled SDA and SCL on the board, and 19 beside them; 13 with the board's LED.
#define BOARD_I2C_PIN PIND
#define BOARD_I2C_PORT PORTD
#define BOARD_I2C_DDR DDRD
#define BOARD_I2C_DATA_BIT 1
#define BOARD_I2C_CLOCK_BIT 0
#define BOARD_MOTORS_PORT PORTD
#define BOARD_MOTORS_DDR DDRD
#define BOARD_MOTORS_BIT 2
#define BOARD_LED_DDR DDRB  // output A of timer 0
#define BOARD_LED_BIT 7
#else
#error "no pin table for this micro-controller"
#endif

static_assert(F_CPU == 16000000UL, "timers, UART and USB are set up for a 16 MHz crystal");

#endif
