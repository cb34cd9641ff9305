// Eight motion sensors of the PMW3360 class, after its datasheet: registers, burst mode, the times that
// it asks for. What a program does against them is kept in `violations`, and answered with nonsense.
const kFirstData = 0;
const kFirstSelect = 8;
const kClock = 18;
const kDataIn = 19;
const kNanosPerMs = 1e6;

const kTimes = {
  period: 500, // of the clock: 2 MHz
  select: 120, // tNCS-SCLK
  readDelay: 160e3, // tSRAD
  burstDelay: 35e3, // tSRAD_MOTBR
  burstExit: 500, // tBEXIT
  writeHold: 35e3, // tSCLK-NCS of a write
  afterWrite: 180e3, // tSWW, tSWR
  afterRead: 20e3, // tSRW, tSRR
};
const kWakeMs = 50;
const signed = (counts) => Math.max(-32768, Math.min(32767, counts));

export class Sensor {
  constructor(array, index) {
    this.array = array;
    this.index = index;
    this.plugged = true;
    this.stuck = undefined; // true or false: what holds the data line
    this.observation = 0x3f; // a bit of each process that runs
    this.power();
  }
  // As it is when it gets its supply.
  power() {
    this.registers = new Uint8Array(128);
    this.registers[0x00] = 0x42;
    this.registers[0x01] = 0x01;
    this.registers[0x0f] = 0x31; // 5000 counts/inch
    this.registers[0x10] = 0x20; // rest modes on
    this.registers[0x3f] = 0xbd;
    this.burstMode = false;
    this.awakeAt = Infinity; // until it is told to reset
    this.x = 0;
    this.y = 0;
    this.bits = 0;
    this.lastWrite = this.lastRead = -Infinity;
  }
  unplug() {
    this.plugged = false;
    this.array.drive();
  }
  plug() {
    this.plugged = true;
    this.power();
  }
  get ready() {
    return this.array.now >= this.awakeAt;
  }
  move(x, y) {
    if (!this.ready) return;
    this.x += x;
    this.y += y;
  }
  violate(what) {
    this.array.violations.push(`sensor ${this.index} at ${(this.array.now / 1e3).toFixed(1)} us: ${what}`);
  }

  selected(isSelected) {
    const { now } = this.array;
    if (isSelected) {
      this.selectedAt = now;
      if (now - this.burstEndedAt < kTimes.burstExit) this.violate('selected before a burst had ended');
      this.bits = 0;
      this.shift = 0;
      this.writing = false;
      this.answer = undefined;
      this.out = true;
      return;
    }
    if (this.bits === 0) return;
    if (this.writing) {
      if (now - this.lastWrite < kTimes.writeHold) this.violate('released too soon after a write');
    } else if (this.address === 0x50) {
      this.burstEndedAt = now;
    }
  }
  clockFell() {
    const { now } = this.array;
    if (this.bits === 0 && now - this.selectedAt < kTimes.select) this.violate('clocked too soon');
    if (this.bits < 8 || this.writing) return;
    if (this.bits === 8) {
      const least = this.address === 0x50 ? kTimes.burstDelay : kTimes.readDelay;
      if (now - this.addressAt < least) {
        this.violate(`read ${((now - this.addressAt) / 1e3).toFixed(1)} us after the address`);
        this.answer = Uint8Array.of(0xa5, 0xa5, 0xa5, 0xa5, 0xa5, 0xa5);
      }
    }
    const bit = this.bits - 8;
    this.out = ((this.answer[bit >> 3] ?? 0) & (0x80 >> (bit & 7))) !== 0;
  }
  clockRose(dataIn) {
    const { now } = this.array;
    this.shift = ((this.shift << 1) | (dataIn ? 1 : 0)) & 0xff;
    ++this.bits;
    if (this.bits === 8) {
      this.writing = (this.shift & 0x80) !== 0;
      this.address = this.shift & 0x7f;
      this.addressAt = now;
      if (now - this.lastWrite < kTimes.afterWrite) this.violate('spoken to too soon after a write');
      if (now - this.lastRead < kTimes.afterRead) this.violate('spoken to too soon after a read');
      if (!this.writing) this.startRead(this.address);
    } else if (this.bits === 16 && this.writing) {
      this.lastWrite = now;
      this.write(this.address, this.shift);
    } else if (this.bits === 16 && this.address !== 0x50) {
      this.lastRead = now;
    }
  }
  startRead(address) {
    if (!this.ready) {
      this.answer = Uint8Array.of(address === 0 ? 0x42 : 0, 0, 0, 0, 0, 0);
      if (this.awakeAt !== Infinity && address !== 0x50) this.violate('spoken to before it was awake');
      return;
    }
    if (address === 0x50) {
      if (!this.burstMode) {
        this.answer = new Uint8Array(6);
        this.violate('a burst that was not begun by a write');
        return;
      }
      const [x, y] = this.latch();
      this.answer = Uint8Array.of(x || y ? 0x80 : 0, this.observation, x & 0xff, (x >> 8) & 0xff, y & 0xff, (y >> 8) & 0xff);
      return;
    }
    this.burstMode = false;
    if (address === 0x02) {
      const [x, y] = this.latch();
      this.registers.set([x || y ? 0x80 : 0, x & 0xff, (x >> 8) & 0xff, y & 0xff, (y >> 8) & 0xff], 2);
    }
    this.answer = Uint8Array.of(this.registers[address]);
  }
  latch() {
    const counts = [signed(this.x), signed(this.y)];
    this.x = 0;
    this.y = 0;
    return counts;
  }
  write(address, value) {
    if (address === 0x3a && value === 0x5a) {
      const { lastWrite } = this;
      this.power();
      this.lastWrite = lastWrite;
      this.awakeAt = this.array.now + kWakeMs * kNanosPerMs;
      return;
    }
    if (!this.ready) return;
    this.burstMode = address === 0x50;
    if (address !== 0x50) this.registers[address] = value;
  }
}

export class SensorArray {
  constructor() {
    this.violations = [];
    this.now = 0;
    this.sensors = Array.from({ length: 8 }, (_, i) => new Sensor(this, i));
  }
  // For Board.attach().
  wire(board) {
    this.board = board;
    const { gpio } = board.rp2040;
    this.data = gpio.slice(kFirstData, kFirstData + 8);
    this.sensors.forEach((sensor) => {
      const select = kFirstSelect + sensor.index;
      gpio[select].addListener(() => {
        this.now = board.clock.nanos;
        sensor.isSelected = !board.pinIsHigh(select);
        if (sensor.plugged) sensor.selected(sensor.isSelected);
        this.drive();
      });
      sensor.isSelected = false;
    });
    gpio[kClock].addListener(() => this.clocked(board.pinIsHigh(kClock)));
    this.fellAt = -Infinity;
    this.drive();
  }
  advance() {
    this.now = this.board.clock.nanos;
  }
  clocked(high) {
    this.now = this.board.clock.nanos;
    if (!high) {
      if (this.now - this.fellAt < kTimes.period) this.violations.push(`a clock of ${this.now - this.fellAt} ns`);
      this.fellAt = this.now;
    }
    const dataIn = this.board.pinIsHigh(kDataIn);
    for (const sensor of this.sensors) {
      if (!sensor.isSelected || !sensor.plugged) continue;
      if (high) sensor.clockRose(dataIn);
      else sensor.clockFell();
    }
    if (!high) this.drive();
  }
  // The data lines: pulled up where nobody drives.
  drive() {
    if (!this.data) return;
    for (const sensor of this.sensors) {
      let level = true;
      if (sensor.stuck !== undefined) level = sensor.stuck;
      else if (sensor.plugged && sensor.isSelected) level = sensor.out ?? true;
      const pin = this.data[sensor.index];
      if (pin.rawInputValue !== level) pin.setInputValue(level);
    }
  }
}
