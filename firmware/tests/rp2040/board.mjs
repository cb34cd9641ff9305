// A Raspberry Pi Pico in rp2040js: the .uf2 is put into its flash and started as the boot ROM does it.
// The simulator has no boot ROM, no flash chip behind its SSI, no mask of I2C's interrupts, no reset
// of I2C and none by its watchdog: here they are. Time is simulated; nothing here looks at a clock.
import { readFileSync } from 'node:fs';
import { GPIOPinState, RP2040 } from 'rp2040js';

const kFlash = 0x10000000;
const kSecondStage = 0x20041f00;
const kSecondStageBytes = 256;

// 0x14: the table of functions, 0x18: the function that looks one up; each of them stops at a BKPT of
// its own, on which the simulator calls back.
const kTable = 0x200;
const kStubs = 0x300;
const kRomNames = ['UB', 'IF', 'EX', 'RE', 'RP', 'FC', 'CX'];
const kLookUp = [0x8802, 0x2a00, 0xd005, 0x428a, 0xd001, 0x3004, 0xe7f8, 0x8840, 0x4770, 0x2000, 0x4770];

export function readUf2(path) {
  const file = readFileSync(path);
  const flash = new Uint8Array(2 << 20).fill(0xff);
  for (let at = 0; at < file.length; at += 512) {
    const word = (i) => file.readUInt32LE(at + 4 * i);
    const good = word(0) === 0x0a324655 && word(1) === 0x9e5d5157 && file.readUInt32LE(at + 508) === 0x0ab16f30;
    if (!good || word(7) !== 0xe48bff56 || word(5) !== at / 512 || word(6) !== file.length / 512) {
      throw new Error(`block ${at / 512} is no UF2 block for the RP2040`);
    }
    flash.set(file.subarray(at + 32, at + 32 + word(4)), word(3) - kFlash);
  }
  return flash;
}

// As the boot ROM computes it over the second stage.
function bootCrc(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte << 24;
    for (let bit = 0; bit < 8; ++bit) crc = (crc << 1) ^ (crc & 0x80000000 ? 0x04c11db7 : 0);
  }
  return crc >>> 0;
}

// The flash chip's commands, byte by byte, while its select line is low.
class FlashChip {
  constructor(uniqueId) {
    this.uniqueId = uniqueId;
    this.received = [];
  }
  exchange(byte) {
    this.received.push(byte);
    if (this.received[0] !== 0x4b || this.received.length <= 5) return 0;
    return this.uniqueId[this.received.length - 6];
  }
}

const registers = (read, write) => ({ readUint32: read, writeUint32Atomic: (offset, value) => write(offset, value) });

export class Board {
  // flash: of readUf2(); it stays the board's through resets.
  constructor(flash, { uniqueId = [0xe6, 0x61, 0x38, 0x52, 0x83, 0x0f, 0xa5, 0x21] } = {}) {
    this.flash = flash.slice();
    this.chip = new FlashChip(uniqueId);
    this.faults = []; // of the program: what it may not do
    this.resets = 0;
    this.erased = 0;
    this.i2cResets = 0;
    this.inBootLoader = false;
    this.attached = []; // models that are wired to each new chip
    this.sleptNanos = 0;
    this.powerOn();
  }

  powerOn(watchdog) {
    const chip = new RP2040();
    this.chipBefore = this.rp2040;
    this.rp2040 = chip;
    this.core = chip.core;
    if (this.clock) chip.clock.nanosCounter = this.clock.nanos; // time goes on
    this.clock = chip.clock;
    this.cycleNanos = 1e9 / chip.clkSys;
    chip.addClockListener((hertz) => (this.cycleNanos = 1e9 / hertz));
    const fault = (level) => (name, text) => this.faults.push(`${level} ${name}: ${text}`);
    chip.logger = { debug() {}, info() {}, warn: fault('warning'), error: fault('error') };
    chip.flash.set(this.flash);
    this.addRom();
    this.addFlashCommands();
    this.addI2c();
    this.addWatchdog(watchdog);
    this.boot();
    for (const attach of this.attached) attach(this);
  }

  // attach(board): now, and to the chip after each reset.
  attach(attach) {
    this.attached.push(attach);
    attach(this);
  }

  boot() {
    const stage = this.flash.subarray(0, kSecondStageBytes);
    const crc = new DataView(stage.buffer, stage.byteOffset).getUint32(252, true);
    if (bootCrc(stage.subarray(0, 252)) !== crc) throw new Error('the second stage has a wrong CRC');
    this.rp2040.sram.set(stage, kSecondStage - 0x20000000);
    this.core.SP = kSecondStage;
    this.core.PC = kSecondStage;
  }

  addRom() {
    const rom = new DataView(this.rp2040.bootrom.buffer);
    rom.setUint16(0x14, kTable, true);
    rom.setUint16(0x18, 0x101, true);
    kLookUp.forEach((opcode, i) => rom.setUint16(0x100 + 2 * i, opcode, true));
    kRomNames.forEach((name, i) => {
      rom.setUint16(kTable + 4 * i, name.charCodeAt(0) | (name.charCodeAt(1) << 8), true);
      rom.setUint16(kTable + 4 * i + 2, kStubs + 4 * i + 1, true);
      rom.setUint16(kStubs + 4 * i, 0xbe00 | i, true);
      rom.setUint16(kStubs + 4 * i + 2, 0x4770, true);
    });
    this.rp2040.onBreak = (number) => {
      if (this.core.PC < kStubs || this.core.PC > kStubs + 4 * kRomNames.length) {
        this.faults.push(`a breakpoint at ${this.core.PC.toString(16)}`);
      } else {
        this.callRom(kRomNames[number], this.core.registers);
      }
    };
  }

  callRom(name, r) {
    const chip = this.rp2040;
    const memory = (from, size) => Uint8Array.from({ length: size }, (_, i) => chip.readUint8(from + i));
    switch (name) {
      case 'UB':
        this.inBootLoader = true;
        break;
      case 'EX':
        this.forbidFlash();
        break;
      case 'CX':
        this.allowFlash();
        break;
      case 'RE':
        if (!this.flashForbidden) this.faults.push('erases flash that is mapped');
        this.program(() => this.flash.fill(0xff, r[0], r[0] + r[1]));
        this.clock.tick(45e6); // a sector of a W25Q: 45 ms
        ++this.erased;
        break;
      case 'RP': {
        if (!this.flashForbidden) this.faults.push('programs flash that is mapped');
        const bytes = memory(r[1], r[2]);
        this.program(() => bytes.forEach((byte, i) => (this.flash[r[0] + i] &= byte)));
        this.clock.tick(0.4e6);
        break;
      }
    }
  }
  program(change) {
    change();
    this.rp2040.flash.set(this.flash);
  }
  // While the chip takes commands nothing can be read from it as memory.
  forbidFlash() {
    if (this.flashForbidden) return;
    this.flashForbidden = true;
    for (const name of ['readUint32', 'readUint16', 'readUint8']) {
      const read = RP2040.prototype[name];
      this.rp2040[name] = function (address) {
        if (address >>> 28 === 1 && address >>> 24 < 0x14) throw new Error('flash is read while it takes commands');
        return read.call(this, address);
      };
    }
  }
  allowFlash() {
    this.flashForbidden = false;
    for (const name of ['readUint32', 'readUint16', 'readUint8']) delete this.rp2040[name];
  }

  addFlashCommands() {
    const { peripherals } = this.rp2040;
    const ssi = peripherals[0x18000];
    let select = 0;
    const received = [];
    peripherals[0x40018] = registers(
      () => select,
      (offset, value) => {
        if (offset !== 0x0c) this.faults.push(`QSPI pin register ${offset} is written`);
        select = value;
        this.chip.received = [];
      },
    );
    const write = ssi.writeUint32.bind(ssi);
    const read = ssi.readUint32.bind(ssi);
    ssi.writeUint32 = (offset, value) => {
      if (offset !== 0x60) return offset === 0x10 || write(offset, value);
      if (((select >> 8) & 3) !== 2) this.faults.push('flash is spoken to without being selected');
      received.push(this.chip.exchange(value & 0xff));
      return undefined;
    };
    ssi.readUint32 = (offset) => {
      if (offset === 0x28) return 6 | (received.length ? 8 : 0);
      return offset === 0x60 ? received.shift() ?? 0 : read(offset);
    };
  }

  // IC_INTR_MASK, which the simulator knows and does not let a program write; IC_ENABLE_STATUS and
  // IC_SDA_HOLD, which it lacks; and the reset of the controller.
  addI2c() {
    for (const i2c of this.rp2040.i2c) {
      const write = i2c.writeUint32.bind(i2c);
      const read = i2c.readUint32.bind(i2c);
      i2c.dataHold = 1;
      i2c.writeUint32 = (offset, value) => {
        if (offset === 0x7c) {
          if (i2c.enable & 1) this.faults.push('IC_SDA_HOLD is written to while the controller is enabled');
          i2c.dataHold = value;
          return undefined;
        }
        if (offset !== 0x30) return write(offset, value);
        i2c.intEnable = value;
        return i2c.checkInterrupts();
      };
      // One that is at a transfer is not disabled before that ends.
      i2c.readUint32 = (offset) => (offset === 0x9c ? (i2c.busy || i2c.enable & 1 ? 1 : 0) : read(offset));
    }
    const resets = this.rp2040.peripherals[0x4000c];
    const write = resets.writeUint32.bind(resets);
    resets.writeUint32 = (offset, value) => {
      if (offset === 0 && value & (1 << 3)) {
        const [i2c] = this.rp2040.i2c;
        Object.assign(i2c, { state: 0, busy: false, stop: false, pendingRestart: false, enable: 0, intRaw: 0, intEnable: 0, dataHold: 1 });
        i2c.txFIFO.reset();
        i2c.checkInterrupts();
        ++this.i2cResets;
      }
      return write(offset, value);
    };
  }

  addWatchdog(before) {
    const dog = this.rp2040.peripherals[0x40058];
    if (before) {
      dog.scratchData.set(before.scratchData);
      dog.reason = before.reason;
    }
    dog.onWatchdogTrigger = () => {
      dog.alarm.enable = false; // else it goes off for ever
      this.bitten = dog;
    };
    this.watchdog = dog;
  }

  run(nanos) {
    const end = this.clock.nanos + nanos;
    while (this.clock.nanos < end) this.step(end);
  }
  runMs(ms) {
    this.run(ms * 1e6);
  }
  runUntil(done, limitMs) {
    const end = this.clock.nanos + limitMs * 1e6;
    for (;;) {
      if (done()) return true;
      if (this.clock.nanos >= end) return false;
      this.run(20e3);
    }
  }

  step(end) {
    const { core, clock } = this;
    if (this.bitten) {
      const dog = this.bitten;
      this.bitten = undefined;
      ++this.resets;
      this.powerOn(dog);
      return;
    }
    if (!core.waiting) {
      clock.tick(core.executeInstruction() * this.cycleNanos);
      return;
    }
    // WFI ends when an interrupt is already pending; the simulator looks only at new ones.
    if (core.pendingInterrupts & core.enabledInterrupts && core.checkForInterrupts()) {
      core.waiting = false;
      return;
    }
    const next = clock.nextAlarm ? Math.max(clock.nanosToNextAlarm, 0) : Infinity;
    const passed = Math.min(next, end - clock.nanos);
    this.sleptNanos += passed;
    clock.tick(passed);
  }

  // What the program drives a pin to, with the pull-ups that it switched on.
  pinIsHigh(pin) {
    const { value } = this.rp2040.gpio[pin];
    return value === GPIOPinState.High || value === GPIOPinState.InputPullUp || value === GPIOPinState.Input;
  }
  get ledBrightness() {
    return Math.round(Math.sqrt(this.rp2040.readUint32(0x40050000 + 0x14 * 4 + 0x0c) >>> 16));
  }
  pressButton(pressed) {
    this.rp2040.gpio[22].setInputValue(!pressed);
  }
}
