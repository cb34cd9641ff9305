// The host at the other end of the RP2040's USB controller: control transfers, and once a millisecond an
// IN token for the report of each interface. rp2040js takes a buffer the moment it is handed over; a host does that when it
// asks, so its DPRAMUpdated() is not called, and the buffers are looked at here.
const kFull = 1 << 15;
const kData1 = 1 << 13;
const kStall = 1 << 11;
const kAvailable = 1 << 10;
const kControlIn = 0x80;
const kControlOut = 0x84;
const kReportIn = 0x88;
const kCommandOut = 0x8c;
const kPullUp = 1 << 16;
const kBusReset = 1 << 19;
const kBitNanos = 1000 / 12;
const kTokenNanos = 3000;

// How long a data packet is on the bus: sync, PID, data and CRC, a bit stuffed after six ones, end.
function packetNanos(bytes) {
  let bits = 16 + 8 * bytes.length + 16 + 3;
  let ones = 0;
  for (const byte of bytes) {
    for (let bit = 0; bit < 8; ++bit) {
      ones = (byte >> bit) & 1 ? ones + 1 : 0;
      if (ones === 6) {
        ++bits;
        ones = 0;
      }
    }
  }
  return bits * kBitNanos;
}

export class UsbHost {
  // pollUs: the token's place in each millisecond; jitterUs(n): what the n-th differs from it.
  constructor({ pollUs = 40, jitterUs = () => 0 } = {}) {
    this.pollUs = pollUs;
    this.jitterUs = jitterUs;
    this.reports = []; // {at, bytes}: when the token came
    this.naks = 0;
    this.padReports = []; // {interface, bytes}: of the interfaces besides that of the frames
    this.readsFrames = true; // no: no program has opened that one, and Linux does not ask for it
    this.interfaces = [];
    this.faults = [];
    this.frames = 0;
    this.polling = false;
    this.configured = false;
  }

  // For Board.attach().
  wire(board) {
    this.board = board;
    this.usb = board.rp2040.usbCtrl;
    this.memory = board.rp2040.usbDPRAMView;
    this.usb.DPRAMUpdated = () => {};
    this.polling = false;
    this.configured = false;
    const { clock } = board;
    this.reportDone = clock.createAlarm(() => this.usb.indicateBufferReady(1, false));
    this.token = clock.createAlarm(() => {
      if (this.readsFrames) this.pollReport();
      for (const pad of this.interfaces.slice(1)) this.pollPad(pad);
    });
    this.padDone = new Map(); // by endpoint
    this.frame = clock.createAlarm(() => {
      ++this.frames;
      this.frame.schedule(1e6);
      if (this.polling) this.token.schedule((this.pollUs + this.jitterUs(this.frames)) * 1e3);
    });
    this.frame.schedule(1e6 - (clock.nanos % 1e6));
  }
  get isAttached() {
    return (this.usb.sieCtrl & kPullUp) !== 0;
  }
  control(at) {
    return this.memory.getUint32(at, true);
  }

  pollReport() {
    const control = this.control(kReportIn);
    if (!(control & kAvailable)) {
      if (!(control & kStall)) ++this.naks;
      return;
    }
    const size = control & 0x3ff;
    const bytes = this.board.rp2040.usbDPRAM.slice(0x180, 0x180 + size);
    const pid = (control & kData1) !== 0;
    if (!(control & kFull)) this.faults.push('a report that is not full');
    this.memory.setUint32(kReportIn, control & ~(kAvailable | kFull), true);
    this.reportDone.schedule(kTokenNanos + packetNanos(bytes) + 2000);
    if (pid !== this.reportPid) {
      this.faults.push(`a report with DATA${pid ? 1 : 0}, which the host takes for the last one again`);
      return;
    }
    this.reportPid = !pid;
    this.reports.push({ at: this.board.clock.nanos, bytes });
  }
  pollPad(pad) {
    const at = 0x80 + 8 * pad.endpoint;
    const control = this.control(at);
    if (control & kStall || !(control & kAvailable)) return;
    const buffer = this.control(8 * pad.endpoint) & 0xffc0;
    const bytes = this.board.rp2040.usbDPRAM.slice(buffer, buffer + (control & 0x3ff));
    if (((control & kData1) !== 0) !== pad.pid) this.faults.push('a report of a gamepad with the wrong PID');
    pad.pid = !pad.pid;
    this.memory.setUint32(at, control & ~(kAvailable | kFull), true);
    if (!this.padDone.has(pad.endpoint)) {
      this.padDone.set(pad.endpoint,
        this.board.clock.createAlarm(() => this.usb.indicateBufferReady(pad.endpoint, false)));
    }
    this.padDone.get(pad.endpoint).schedule(kTokenNanos + packetNanos(bytes) + 2000);
    this.padReports.push({ interface: pad.number, bytes });
  }
  takePads() {
    const { padReports } = this;
    this.padReports = [];
    return padReports;
  }
  take() {
    const { reports } = this;
    this.reports = [];
    return reports;
  }

  reset() {
    this.usb.sieStatus |= kBusReset;
    this.usb.sieStatusUpdated();
    this.polling = false;
    this.configured = false;
    this.board.runMs(10);
  }

  // One packet of a control transfer; undefined: stalled.
  takeIn(pid) {
    let stalled = false;
    const ready = this.board.runUntil(() => {
      const control = this.control(kControlIn);
      stalled = (control & kStall) !== 0 && (this.usb.epStallArm & 1) !== 0;
      return stalled || (control & kAvailable) !== 0;
    }, 50);
    if (stalled) return undefined;
    if (!ready) throw new Error('no answer to a control transfer');
    const control = this.control(kControlIn);
    if (((control & kData1) !== 0) !== pid) this.faults.push('a control packet with the wrong PID');
    const bytes = this.board.rp2040.usbDPRAM.slice(0x100, 0x100 + (control & 0x3ff));
    this.memory.setUint32(kControlIn, control & ~(kAvailable | kFull), true);
    this.usb.indicateBufferReady(0, false);
    return bytes;
  }
  giveOut(bytes, pid) {
    const ready = this.board.runUntil(() => (this.control(kControlOut) & kAvailable) !== 0, 50);
    if (!ready) throw new Error('a control packet is not taken');
    const control = this.control(kControlOut);
    if (((control & kData1) !== 0) !== pid) this.faults.push('a control packet is awaited with the wrong PID');
    this.board.rp2040.usbDPRAM.set(bytes, 0x100);
    this.memory.setUint32(kControlOut, (control & ~(kAvailable | 0x3ff)) | kFull | bytes.length, true);
    this.usb.indicateBufferReady(0, true);
  }
  setup(bytes) {
    this.usb.epStallArm = 0;
    this.memory.setUint32(kControlIn, this.control(kControlIn) & ~(kAvailable | kStall), true);
    this.memory.setUint32(kControlOut, this.control(kControlOut) & ~(kAvailable | kStall), true);
    this.usb.sendSetupPacket(Uint8Array.from(bytes));
    this.board.run(30e3);
  }
  // What comes back; undefined: stalled.
  request(type, request, value, index, length, data = []) {
    this.setup([type, request, value & 0xff, value >> 8, index & 0xff, index >> 8, length & 0xff, length >> 8]);
    if (type & 0x80) {
      const got = [];
      let pid = true;
      for (;;) {
        const packet = this.takeIn(pid);
        if (!packet) return undefined;
        got.push(...packet);
        pid = !pid;
        if (packet.length < 64 || got.length >= length) break;
      }
      this.giveOut(new Uint8Array(), true);
      this.board.run(30e3);
      return Uint8Array.from(got);
    }
    if (data.length) this.giveOut(Uint8Array.from(data), true);
    const status = this.takeIn(true);
    this.board.run(30e3);
    return status;
  }
  descriptor(kind, number, length, index = 0) {
    return this.request(0x80, 6, (kind << 8) | number, index, length);
  }
  string(number) {
    const bytes = this.descriptor(3, number, 255, 0x0409);
    return bytes && Buffer.from(bytes.subarray(2)).toString('utf16le');
  }

  // As an operating system does it; then reports are asked for.
  enumerate() {
    if (!this.board.runUntil(() => this.isAttached, 500)) throw new Error('nothing is attached');
    this.reset();
    this.descriptor(1, 0, 8);
    this.reset();
    this.request(0x00, 5, 17, 0, 0);
    if ((this.usb.addrEndp & 0x7f) !== 17) this.faults.push('the address was not taken');
    this.device = this.descriptor(1, 0, 18);
    const head = this.descriptor(2, 0, 9);
    this.configuration = this.descriptor(2, 0, head[2] | (head[3] << 8));
    this.interfaces = [];
    for (let i = 0; i < this.configuration.length; i += this.configuration[i]) {
      const [, kind, address] = this.configuration.subarray(i);
      if (kind === 4) this.interfaces.push({ number: address, pid: false });
      if (kind === 5 && address & 0x80) this.interfaces.at(-1).endpoint = address & 15;
    }
    this.request(0x00, 9, 1, 0, 0);
    for (const one of this.interfaces) {
      this.request(0x21, 10, 0, one.number, 0);
      one.descriptor = this.request(0x81, 6, 0x2200, one.number, 255);
    }
    this.reportDescriptor = this.interfaces[0].descriptor;
    this.reportPid = false;
    this.commandPid = false;
    this.configured = true;
    this.polling = true;
  }

  // An output report by its endpoint; false: not taken.
  sendReport(bytes) {
    const control = this.control(kCommandOut);
    if (!(control & kAvailable)) return false;
    const report = new Uint8Array(64);
    report.set(bytes);
    if (((control & kData1) !== 0) !== this.commandPid) this.faults.push('a command is awaited with the wrong PID');
    this.commandPid = !this.commandPid;
    this.board.rp2040.usbDPRAM.set(report, 0x1c0);
    this.memory.setUint32(kCommandOut, (control & ~(kAvailable | 0x3ff)) | kFull | 64, true);
    this.usb.indicateBufferReady(1, true);
    return true;
  }
}
