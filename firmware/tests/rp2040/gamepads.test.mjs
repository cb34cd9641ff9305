// The rods as gamepads, read by a host that parses their report descriptors itself.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Rig, kRods, lastWrite, pulse, randomNumbers, say } from './rig.mjs';

const kSettings = 3, kStick = 4;
const kGamepads = 2; // of switches
const kGamePad = 0x10005;
const kX = 0x10030, kY = 0x10031, kRx = 0x10033, kRy = 0x10034, kButton1 = 0x90001, kButton2 = 0x90002;

// HID 1.11, 6.2.2: the fields of an input report without a number, by usage (page << 16 | usage).
function parseDescriptor(bytes) {
  let [page, size, count, minimum, maximum, bit] = [0, 0, 0, 0, 0, 0];
  let usages = [], first = 0;
  const applications = [], fields = new Map();
  for (let at = 0; at < bytes.length;) {
    const prefix = bytes[at++], length = [0, 1, 2, 4][prefix & 3];
    let value = 0;
    for (let i = 0; i < length; ++i) value += bytes[at + i] * 2 ** (8 * i);
    const signed = length && value >= 2 ** (8 * length - 1) ? value - 2 ** (8 * length) : value;
    at += length;
    switch (prefix & 0xfc) {
      case 0x04: page = value; break;
      case 0x14: minimum = signed; break;
      case 0x24: maximum = signed; break;
      case 0x74: size = value; break;
      case 0x94: count = value; break;
      case 0x08: usages.push(page * 65536 + value); break;
      case 0x18: first = value; break;
      case 0x28: for (let usage = first; usage <= value; ++usage) usages.push(page * 65536 + usage); break;
      case 0xa0: if (value === 1) applications.push(usages.at(-1)); usages = []; break;
      case 0xc0: break;
      case 0x80:
        for (let i = 0; i < count; ++i, bit += size)
          if (!(value & 1)) fields.set(usages[i], { bit, size, minimum, maximum });
        usages = [];
        break;
      default: assert.fail(`item ${prefix}`);
    }
  }
  return { applications, fields, bits: bit };
}
function valueOf(bytes, { bit, size, minimum }) {
  let value = 0;
  for (let i = 0; i < size; ++i) value += ((bytes[(bit + i) >> 3] >> ((bit + i) & 7)) & 1) * 2 ** i;
  return minimum < 0 && value >= 2 ** (size - 1) ? value - 2 ** size : value;
}

class PadRig extends Rig {
  switchGamepads(on) {
    assert.ok(this.command({ kind: kSettings, resolution: 20, brightness: 64, switches: on ? kGamepads : 0 }));
    assert.ok(this.board.runUntil(() => !this.host.isAttached, 1500), 'it leaves the bus');
    this.host.polling = false;
    return this.enumerateAgain();
  }
  enumerateAgain() {
    this.host.enumerate();
    this.pads = this.host.interfaces.slice(1).map(({ descriptor }) => parseDescriptor(descriptor));
    this.values = this.pads.map(() => new Map());
    this.host.takePads();
    assert.ok(this.waitForPresent(0xff, 500));
    return this;
  }
  read(pad, usage) {
    for (const { interface: number, bytes } of this.host.takePads()) {
      const { fields, bits } = this.pads[number - 1];
      assert.equal(8 * bytes.length, bits);
      for (const [field, place] of fields) this.values[number - 1].set(field, valueOf(bytes, place));
    }
    return this.values[pad - 1].get(usage);
  }
  moveSlowly(rod, slide, spin) {
    for (let i = 0; i < 40; ++i) {
      const part = (whole) => Math.trunc((whole * (i + 1)) / 40) - Math.trunc((whole * i) / 40);
      this.move(rod, part(slide), part(spin));
      this.board.runMs(2);
    }
    this.board.runMs(5);
  }
}
const near = (value, wanted, by, what) => assert.ok(Math.abs(value - wanted) <= by, `${what}: ${value}, not ${wanted}`);
const gamepads = () => new PadRig().start().switchGamepads(true);

test('are another product with four interfaces besides that of the frames, which go on', () => {
  const rig = new Rig().start();
  const before = rig.host.reportDescriptor;
  const pads = gamepads();
  assert.equal(pads.host.device[10] | (pads.host.device[11] << 8), 0x0002);
  assert.equal(pads.host.interfaces.length, 5);
  assert.deepEqual(pads.host.interfaces.map(({ endpoint }) => endpoint), [1, 3, 4, 5, 6]);
  assert.deepEqual(pads.host.reportDescriptor, before);
  pads.host.naks = 0;
  pads.framesOfMs(100);
  pads.host.naks = 0;
  assert.ok(Math.abs(pads.framesOfMs(1000).length - 1000) <= 1);
  assert.ok(pads.host.naks <= 1, `${pads.host.naks}`);
  pads.expectNoFault();
});

test('each is one gamepad of two sticks around 0, and buttons from the first on', () => {
  const rig = gamepads();
  for (const { applications, fields, bits } of rig.pads) {
    assert.deepEqual(applications, [kGamePad]);
    assert.equal(bits % 8, 0);
    for (const axis of [kX, kY, kRx, kRy]) assert.equal(fields.get(axis).minimum, -fields.get(axis).maximum);
    assert.ok(fields.has(kButton1) && fields.has(kButton2));
    assert.ok([...fields.keys()].every((usage) => usage >> 16 === 9 || [kX, kY, kRx, kRy].includes(usage)));
  }
});

test('each sensor moves its stick by the share of travel and turn that it moved', () => {
  const rig = gamepads();
  const sticks = [[1, false], [1, true], [4, true], [2, false], [4, false], [2, true], [3, true], [3, false]];
  for (const rod of kRods) {
    assert.ok(rig.command({ kind: kStick, rod, travel: 8000 + 80 * rod, turn: 4000 }));
    rig.board.runMs(300);
  }
  for (const rod of kRods) {
    const [pad, right] = sticks[rod];
    near(rig.read(pad, right ? kRy : kY), 0, 20, `rod ${rod} at first`);
    rig.moveSlowly(rod, (8000 + 80 * rod) / 4, -500);
    near(rig.read(pad, right ? kRy : kY), -16384, 20, `slide of rod ${rod}`);
    near(rig.read(pad, right ? kRx : kX), -16384, 20, `spin of rod ${rod}`);
  }
  rig.framesOfMs(5);
  rig.expectCounts();
  rig.expectNoFault();
});

test('a push to the stop sets the stick right, and a turn comes round', () => {
  const rig = gamepads();
  assert.ok(rig.command({ kind: kStick, rod: 0, travel: 8000, turn: 4000 }));
  rig.board.runMs(300);
  rig.moveSlowly(0, 20000, 0);
  assert.equal(rig.read(1, kY), -32767);
  rig.moveSlowly(0, -4000, 1000);
  near(rig.read(1, kY), 0, 20, 'back from the stop');
  assert.equal(rig.read(1, kX), 32767, 'a quarter turn');
  rig.moveSlowly(0, 0, 1000);
  near(rig.read(1, kX), 0, 20, 'half a turn');
  rig.moveSlowly(0, 0, 2000);
  near(rig.read(1, kX), 0, 20, 'a whole turn');
  rig.expectNoFault();
});

test('a shot presses the button of its hand', () => {
  const rig = gamepads();
  assert.ok(rig.command({ kind: kStick, rod: 1, travel: 8000, turn: 4000 }));
  rig.board.runMs(300);
  for (let ms = 0; ms < 30; ++ms) {
    rig.move(1, 0, 20); // 31 rad/s
    rig.board.runMs(1);
  }
  assert.equal(rig.read(1, kButton2), 1);
  assert.equal(rig.read(1, kButton1), 0);
  rig.board.runMs(200);
  assert.equal(rig.read(1, kButton2), 0);
});

test('a game that does not know the frames reads the gamepads alone', () => {
  const rig = gamepads();
  assert.ok(rig.command({ kind: kStick, rod: 0, travel: 8000, turn: 4000 }));
  rig.board.runMs(300);
  rig.host.readsFrames = false;
  rig.moveSlowly(0, 2000, 500);
  near(rig.read(1, kY), -16384, 20, 'slide');
  near(rig.read(1, kX), 16384, 20, 'spin');
  rig.host.readsFrames = true;
  rig.framesOfMs(20);
  rig.expectCounts();
});

test('the way back is the same command, no count is lost on either, and settings outlive the power', () => {
  const rig = gamepads();
  rig.move(2, 300, -70);
  rig.switchGamepads(false);
  assert.equal(rig.host.interfaces.length, 1);
  assert.equal(rig.host.device[10], 1);
  rig.move(2, -20, 30);
  rig.switchGamepads(true);
  assert.equal(rig.host.interfaces.length, 5);
  rig.framesOfMs(20);
  rig.expectCounts();
  rig.command({ kind: kStick, rod: 3, travel: 8000, turn: 4000, reversed: 3 });
  rig.board.runMs(400);
  rig.expectNoFault();
  const again = new PadRig({ flash: rig.board.flash });
  again.enumerateAgain();
  assert.equal(again.host.device[10], 2);
  again.moveSlowly(3, 2000, 500);
  near(again.read(2, kY), 16384, 20, 'reversed slide');
  near(again.read(2, kX), -16384, 20, 'reversed spin');
});

// A stop of a quarter of a second while flash is written must not shorten the time off the bus.
test('a switch with other settings right behind it leaves the bus for long enough', () => {
  const rig = new PadRig().start();
  assert.ok(rig.command({ kind: kSettings, resolution: 20, brightness: 64, switches: kGamepads }));
  for (const rod of [0, 1])
    assert.ok(rig.board.runUntil(() => rig.command({ kind: kStick, rod, travel: 8000, turn: 4000 }), 1000));
  assert.ok(rig.board.runUntil(() => !rig.host.isAttached, 3000));
  const left = rig.board.clock.nanos;
  assert.ok(rig.board.runUntil(() => rig.host.isAttached, 3000));
  assert.ok(rig.board.clock.nanos - left >= 90e6, `${rig.board.clock.nanos - left}`);
  rig.host.polling = false;
  rig.enumerateAgain();
  assert.equal(rig.host.interfaces.length, 5);
  rig.expectNoFault();
});

test('a halted gamepad is silent until it is cleared, the others are not', () => {
  const rig = gamepads();
  assert.ok(rig.host.request(0x02, 3, 0, 0x85, 0));
  assert.deepEqual([...rig.host.request(0x82, 0, 0, 0x85, 2)], [1, 0]);
  rig.host.takePads();
  rig.board.runMs(600);
  const heard = new Set(rig.host.takePads().map((report) => report.interface));
  assert.deepEqual([...heard].sort(), [1, 2, 4]);
  assert.ok(rig.host.request(0x02, 1, 0, 0x85, 0));
  rig.host.interfaces[3].pid = false;
  rig.board.runMs(600);
  assert.ok(rig.host.takePads().some((report) => report.interface === 3));
  rig.expectNoFault();
});

test('while all rods move nothing is lost, reports are on time, and pulses too', () => {
  const rig = gamepads();
  rig.framesOfMs(1200); // the motors' drivers are set up again, eight a second
  const random = randomNumbers(13);
  const stop = rig.every(250, () => kRods.forEach((rod) => rig.move(rod, random(81) - 40, random(81) - 40)));
  rig.host.takePads();
  rig.host.naks = 0;
  let longest = 0;
  const frames = [];
  for (let round = 0; round < 40; ++round) {
    const sent = rig.board.clock.nanos;
    assert.ok(rig.command(pulse(round % 8, 40 + round, 10)));
    assert.ok(rig.board.runUntil(() => lastWrite(rig, round % 8).value === 40 + round, 3), `round ${round}`);
    longest = Math.max(longest, lastWrite(rig, round % 8).at - sent);
    rig.board.runMs(25);
    frames.push(...rig.frames());
  }
  stop();
  const seconds = frames.length / 1000;
  const reports = [1, 2, 3, 4].map((pad) => rig.host.padReports.filter((report) => report.interface === pad).length);
  say(`${frames.length} frames, ${rig.host.naks} late, ${Math.min(...reports)} reports of a gamepad, ` +
    `pulse after ${(longest / 1e3).toFixed(0)} us`);
  assert.ok(rig.host.naks <= 2, `${rig.host.naks}`);
  frames.slice(1).forEach((frame, i) => assert.equal(frame.sequence, (frames[i].sequence + 1) & 0xffff));
  reports.forEach((count) => assert.ok(count >= 950 * seconds, `${count}`));
  assert.ok(longest <= 2e6);
  rig.framesOfMs(20);
  rig.expectCounts();
  rig.expectNoFault();
});
