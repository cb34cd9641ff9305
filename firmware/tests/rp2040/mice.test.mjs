// PS/2 mice in place of SPI sensors, as the settings say.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Mouse } from './mice.mjs';
import { crc16 } from './packets.mjs';
import { Rig, kImage, kRods, randomNumbers, say } from './rig.mjs';

// A flash whose settings, of version 1, say which rods have a mouse.
function flashWithMice(mask) {
  const flash = kImage.slice();
  const settings = Uint8Array.of(1, 20, 64, mask, 0, 0);
  flash.set(settings, flash.length - 4096);
  new DataView(flash.buffer).setUint16(flash.length - 4096 + 6, crc16(settings), true);
  return flash;
}

class MouseRig extends Rig {
  constructor(mask) {
    super({ flash: flashWithMice(mask), plugged: 0xff & ~mask });
    this.mice = kRods.filter((rod) => mask & (1 << rod)).map((rod) => new Mouse(rod));
    // Nothing of the absent sensors on these rods may hold a line.
    this.sensors.sensors = this.sensors.sensors.filter((sensor) => !(mask & (1 << sensor.index)));
    this.mice.forEach((mouse) => this.board.attach((board) => mouse.wire(board)));
  }
  start() {
    this.host.enumerate();
    assert.ok(this.waitForPresent(0xff, 2600), `present: ${this.last?.present}`);
    this.board.runMs(20);
    return this;
  }
  moveMouse(mouse, x, y) {
    if (!mouse.move(x, y)) return;
    this.slide[mouse.rod] = (this.slide[mouse.rod] + x) & 0xffff;
    this.spin[mouse.rod] = (this.spin[mouse.rod] + y) & 0xffff;
  }
  settle() {
    assert.ok(this.board.runUntil(() => this.mice.every((mouse) => mouse.settled), 1000));
    this.framesOfMs(20);
  }
}
const quality = (frames) => frames.reduce((total, frame) => total + frame.quality, 0);

test('eight mice are set up and every count of theirs arrives, at a thousand reports a second', () => {
  const rig = new MouseRig(0xff).start();
  for (const mouse of rig.mice) assert.deepEqual([mouse.rate, mouse.resolution, mouse.enabled], [200, 3, true]);
  const random = randomNumbers(21);
  const stop = rig.every(1000, () => {
    for (const mouse of rig.mice) rig.moveMouse(mouse, random(60) - 25, random(60) - 35);
  });
  const slept = rig.board.sleptNanos;
  const frames = rig.framesOfMs(2000);
  const busy = 100 * (1 - (rig.board.sleptNanos - slept) / 2e9);
  stop();
  rig.settle();
  rig.expectCounts();
  assert.ok(frames.length >= 1999);
  assert.equal(quality(frames), 0);
  assert.deepEqual(rig.board.faults.slice(0, 5), []);
  say(`eight mice, 2 s: nothing lost, ${frames.length} reports, ${busy.toFixed(1)} % of the processor`);
});

test('four mice beside four sensors: both to the last count', () => {
  const rig = new MouseRig(0x3c).start();
  const stop = rig.every(1000, () => {
    for (const mouse of rig.mice) rig.moveMouse(mouse, 7, -9);
    for (const sensor of rig.sensors.sensors) rig.moveSensor(sensor, 90, -70);
  });
  const frames = rig.framesOfMs(1000);
  stop();
  rig.settle();
  rig.expectCounts();
  assert.equal(quality(frames), 0);
  assert.deepEqual(rig.sensors.violations.slice(0, 5), []);
});

test('a mouse that is unplugged is absent within 0.6 s, and counts again when it is back', () => {
  const rig = new MouseRig(0xff).start();
  rig.mice[6].unplug();
  assert.ok(rig.waitForPresent(0xbf, 600));
  rig.mice[6].plug();
  assert.ok(rig.waitForPresent(0xff, 1500));
  rig.moveMouse(rig.mice[6], -30, 44);
  rig.settle();
  rig.expectCounts();
});

// Defence, 393 mm: of a mouse 8 counts/mm, of a sensor 78.7; 50 mm around the rod.
test('a mouse and a sensor are sticks of gamepads by the same travel and turn', () => {
  const rig = new MouseRig(0x02).start(); // rod 2 of the table; rod 7 is the other team's
  rig.command({ kind: 3, resolution: 20, brightness: 64, ps2: 0x02, switches: 2 });
  assert.ok(rig.board.runUntil(() => !rig.host.isAttached, 1500));
  rig.host.polling = false;
  rig.host.enumerate();
  assert.ok(rig.waitForPresent(0xff, 2600));
  rig.moveMouse(rig.mice[0], 786, 100);
  const sensor = rig.sensors.sensors.find(({ index }) => index === 6);
  for (let i = 0; i < 10; ++i) {
    rig.moveSensor(sensor, 773, 98);
    rig.board.runMs(20);
  }
  rig.settle();
  rig.expectCounts();
  const pads = rig.host.takePads();
  for (const number of [1, 3]) {
    const bytes = pads.filter((report) => report.interface === number).at(-1).bytes;
    const right = new DataView(bytes.buffer, bytes.byteOffset + 4, 4);
    assert.ok(Math.abs(right.getInt16(0, true) - 32767) <= 700, `spin ${right.getInt16(0, true)}`);
    assert.ok(Math.abs(right.getInt16(2, true) + 16384) <= 100, `slide ${right.getInt16(2, true)}`);
  }
});
