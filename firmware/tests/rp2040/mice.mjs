// PS/2 mice on the pins: clocked by themselves at 12.5 kHz, as firmware/tests/sim has them for the AVR.
const kFirstData = 0;
const kFirstClock = 8;
const kReportUs = 5000;
const kSelfTestUs = 300e3;

export class Mouse {
  constructor(rod) {
    this.rod = rod;
    this.x = 0;
    this.y = 0;
    this.plugged = true;
    this.power();
  }
  power() {
    this.queue = [];
    this.enabled = false;
    this.argument = false;
    this.rate = 100;
    this.resolution = 2;
    this.x = 0;
    this.y = 0;
    this.life = this.live();
  }
  wire(board) {
    this.board = board;
    const { gpio } = board.rp2040;
    this.data = gpio[kFirstData + this.rod];
    this.clock = gpio[kFirstClock + this.rod];
    const hostLow = (pin) => pin.outputEnable && !pin.outputValue;
    for (const pin of [this.data, this.clock]) {
      pin.addListener(() => this.drive());
    }
    this.hostHoldsClock = () => hostLow(this.clock);
    this.hostHoldsData = () => hostLow(this.data);
    this.dataLow = this.clockLow = false;
    this.drive();
    const alarm = board.clock.createAlarm(() => alarm.schedule(1e3 * (this.plugged ? this.life.next().value : 1000)));
    alarm.schedule(1e3);
  }
  drive(clockLow = this.clockLow, dataLow = this.dataLow) {
    this.clockLow = clockLow;
    this.dataLow = dataLow;
    const levels = [[this.data, !dataLow && !this.hostHoldsData()], [this.clock, !clockLow && !this.hostHoldsClock()]];
    for (const [pin, level] of levels) if (pin.rawInputValue !== level) pin.setInputValue(level);
  }
  unplug() {
    this.plugged = false;
    this.drive(false, false);
  }
  plug() {
    this.plugged = true;
    this.power();
  }
  move(x, y) {
    if (!this.enabled) return false;
    this.x += x;
    this.y += y;
    return true;
  }
  get settled() {
    return this.x === 0 && this.y === 0 && this.queue.length === 0;
  }

  // Everything below yields the microseconds until it goes on.
  *live() {
    yield kSelfTestUs;
    this.queue.push(0xaa, 0x00);
    let reportAt = 0;
    for (;;) {
      if (this.hostHoldsClock()) yield 10;
      else if (this.hostHoldsData()) yield* this.receive();
      else if (this.queue.length) yield* this.send();
      else if (this.enabled && this.board.clock.micros >= reportAt && (this.x || this.y)) {
        reportAt = this.board.clock.micros + kReportUs;
        this.queue.push(...this.packet());
      } else yield 40;
    }
  }
  packet() {
    const part = (counts) => Math.max(-255, Math.min(255, counts));
    const [x, y] = [part(this.x), part(this.y)];
    this.x -= x;
    this.y -= y;
    return [0x08 | (x < 0 ? 0x10 : 0) | (y < 0 ? 0x20 : 0), x & 0xff, y & 0xff];
  }
  *send() {
    const byte = this.queue[0];
    const bits = [0];
    for (let i = 0; i < 8; ++i) bits.push((byte >> i) & 1);
    bits.push(1 ^ (bits.reduce((sum, bit) => sum + bit, 0) & 1), 1);
    for (const bit of bits) {
      if (this.hostHoldsClock()) {
        this.drive(false, false);
        return;
      }
      this.drive(false, bit === 0);
      yield 15;
      this.drive(true);
      yield 35;
      this.drive(false);
      yield 30;
    }
    this.queue.shift();
    yield 60;
  }
  *receive() {
    const bits = [];
    for (let i = 0; i < 10; ++i) {
      yield 30;
      this.drive(true);
      yield 40;
      this.drive(false);
      bits.push(this.hostHoldsData() ? 0 : 1);
      yield 10;
    }
    this.drive(false, true);
    yield 15;
    this.drive(true);
    yield 40;
    this.drive(false);
    yield 10;
    this.drive(false, false);
    yield 40;
    const byte = bits.slice(0, 8).reduce((sum, bit, i) => sum | (bit << i), 0);
    const good = bits.slice(0, 9).reduce((sum, bit) => sum + bit, 0) % 2 === 1 && bits[9] === 1;
    this.queue = [good ? 0xfa : 0xfe];
    if (good) yield* this.obey(byte);
  }
  *obey(byte) {
    if (this.argument) {
      if (this.argument === 0xf3) this.rate = byte;
      else this.resolution = byte;
      this.argument = false;
      return;
    }
    if (byte === 0xf3 || byte === 0xe8) this.argument = byte;
    if (byte === 0xf4) this.enabled = true;
    if (byte === 0xeb) this.queue.push(...this.packet());
    if (byte === 0xff) {
      this.enabled = false;
      yield* this.send();
      yield kSelfTestUs;
      this.queue = [0xaa, 0x00];
    }
  }
}
