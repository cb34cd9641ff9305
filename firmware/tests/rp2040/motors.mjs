// Eight haptic drivers of the DRV2605 class behind a multiplexer of the TCA9548A class on I2C 0.
import { GPIOPinState } from 'rp2040js';

const kMultiplexer = 0x70;
const kDriver = 0x5a;
const kByteNanos = 9 * 2500; // 400 kHz
const kDataPin = 20;
const kClockPin = 21;

export class Motors {
  constructor() {
    this.attached = 0xff;
    this.multiplexer = true;
    this.stuck = false; // somebody holds a line: nothing ends
    this.heldClocks = 0; // for so many more the data line is held
    this.clocksByHand = 0;
    this.stopsByHand = 0;
    this.channels = 0;
    this.drivers = Array.from({ length: 8 }, () => ({ registers: new Uint8Array(64), writes: [] }));
  }
  wire(board) {
    this.board = board;
    const { clock } = board;
    const i2c = board.rp2040.i2c[0];
    this.watchPins(board.rp2040.gpio);
    let then = () => {};
    const alarm = clock.createAlarm(() => then());
    const after = (bytes, what) => {
      then = what;
      if (!this.stuck) alarm.schedule(bytes * kByteNanos);
    };
    let bytes = [];
    let address = 0;
    i2c.onStart = () => after(0.1, () => i2c.completeStart());
    i2c.onConnect = (target) => {
      address = target;
      bytes = [];
      after(1, () => i2c.completeConnect(this.answers(target)));
    };
    i2c.onWriteByte = (value) => {
      bytes.push(value);
      after(1, () => i2c.completeWrite(true));
    };
    i2c.onStop = () => after(0.1, () => {
      this.written(address, bytes);
      bytes = [];
      i2c.completeStop();
    });
  }
  // As a part that was cut off while it sent does it.
  holdData(clocks) {
    this.heldClocks = clocks;
    this.board.rp2040.gpio[kDataPin].setInputValue(clocks === 0);
  }
  watchPins(gpio) {
    const [data, clock] = [gpio[kDataPin], gpio[kClockPin]];
    data.setInputValue(this.heldClocks === 0);
    clock.setInputValue(true);
    clock.addListener((value) => {
      if (value === GPIOPinState.High) this.board.faults.push('SCL is driven high');
      if (value !== GPIOPinState.Low) return;
      ++this.clocksByHand;
      if (this.heldClocks > 0) this.holdData(this.heldClocks - 1);
    });
    data.addListener((value, before) => {
      if (value === GPIOPinState.High) this.board.faults.push('SDA is driven high');
      if (before === GPIOPinState.Low && clock.value !== GPIOPinState.Low) ++this.stopsByHand;
    });
  }
  get selected() {
    return this.drivers.filter((_, i) => this.channels & this.attached & (1 << i));
  }
  answers(address) {
    if (address === kMultiplexer) return this.multiplexer;
    return address === kDriver && this.multiplexer && this.selected.length > 0;
  }
  written(address, bytes) {
    if (bytes.length === 0) return;
    if (address === kMultiplexer) this.channels = bytes[0];
    if (address !== kDriver) return;
    for (const driver of this.selected) {
      driver.registers[bytes[0]] = bytes[1];
      if (bytes[0] === 0x02) driver.writes.push({ at: this.board.clock.nanos, value: bytes[1] });
    }
  }
  // The time that a motor ran from `since` on, weighted by amplitude [ms of full amplitude].
  energy(rod, since) {
    const { writes } = this.drivers[rod];
    const now = this.board.clock.nanos;
    let sum = 0;
    writes.forEach(({ at, value }, i) => {
      const until = writes[i + 1]?.at ?? now;
      sum += (value / 255) * Math.max(0, until - Math.max(at, since));
    });
    return sum / 1e6;
  }
}
