// The ATmega2560's two-wire interface as the controller of the motors' bus. Transfers run by
// interrupt, 5 us for each byte. If a device holds a line low, the software controller (SoftI2c)
// does the transfer, because it can give the clocks that free the bus.
#ifndef FIRMWARE_HAL_TWI_H
#define FIRMWARE_HAL_TWI_H

#include "core/soft_i2c.h"
#include "hal/i2c_wires.h"

namespace firmware {

class Twi final : public I2cReadBus {
 public:
  void write(uint8_t address, const uint8_t* bytes, uint8_t size) override;
  bool chain(uint8_t address, const uint8_t* bytes, uint8_t size) override;
  void read(uint8_t address) override;
  uint8_t byte() override { return by_hand_ ? soft_.byte() : now_.bytes[0]; }
  State state() override;
  // A transfer was started, and no step has seen its end.
  bool busy() const { return busy_; }

  // tick: unit 20 us, wraps. Call at least every 2 ms while busy().
  void step(uint8_t tick);
  void on_interrupt();

  static const uint8_t kPulseSteps = 1;
  static const bool kRunsByItself = true;

 private:
  struct Transfer {
    uint8_t first;  // address and read bit
    uint8_t size;   // number of bytes to write
    uint8_t bytes[2];
  };
  static const uint8_t kTimeoutTicks = 50;  // 1 ms; a transfer takes 0.08

  static Transfer written(uint8_t address, const uint8_t* bytes, uint8_t size);
  void begin(const Transfer& transfer);
  void watch(uint8_t tick);
  void end_write();
  void end(State state);

  SoftI2c<I2cWires> soft_;
  bool busy_ = false;
  bool by_hand_ = false;
  volatile State state_ = kIdle;
  Transfer now_ = {};
  Transfer next_ = {};  // size 0: none
  uint8_t at_ = 0;
  bool timed_ = false;
  uint8_t since_ = 0;
};

}  // namespace firmware

#endif
