// Which pins and peripherals each board gives. docs/wiring.md has the same table for the person
// with the soldering iron. All 16 lines are open drain with external pull-ups: PORT stays 0, DDR
// pulls low.
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
#elif defined(__AVR_ATmega2560__)
// Arduino Mega: pins 22..29 and 37..30, side by side on the double header.
#define BOARD_CLOCK_PIN PINA
#define BOARD_CLOCK_PORT PORTA
#define BOARD_CLOCK_DDR DDRA
#define BOARD_DATA_PIN PINC
#define BOARD_DATA_PORT PORTC
#define BOARD_DATA_DDR DDRC
#else
#error "no pin table for this micro-controller"
#endif

static_assert(F_CPU == 16000000UL, "timers, UART and USB are set up for a 16 MHz crystal");

#endif
