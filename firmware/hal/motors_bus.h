// Selects the controller of the motors' bus.
#ifndef FIRMWARE_HAL_MOTORS_BUS_H
#define FIRMWARE_HAL_MOTORS_BUS_H

#if defined(__AVR_ATmega2560__)
#include "hal/twi.h"
#else
#include "core/soft_i2c.h"
#include "hal/i2c_wires.h"
#endif

namespace firmware {

#if defined(__AVR_ATmega2560__)
typedef Twi MotorsBus;
#else
typedef SoftI2c<I2cWires> MotorsBus;  // the chip's own TWI pins are used for the data of two mice
#endif

}  // namespace firmware

#endif
