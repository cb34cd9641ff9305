// A board with sensors, motors and a host, and what all tests do with it.
import assert from 'node:assert/strict';
import { Board, readUf2 } from './board.mjs';
import { Motors } from './motors.mjs';
import { decodeFrame, encodeCommand } from './packets.mjs';
import { SensorArray } from './sensors.mjs';
import { UsbHost } from './usb_host.mjs';

export const kImage = readUf2(process.env.FIRMWARE_UF2 ?? 'space-foosball-rp2040.uf2');
export const kRods = [0, 1, 2, 3, 4, 5, 6, 7];

// Numbers of 0..n-1, the same in each run.
export function randomNumbers(seed) {
  let state = BigInt(seed) * 2n + 1n;
  return (n) => {
    state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    return Number((state >> 33n) % BigInt(n));
  };
}

export class Rig {
  constructor({ flash = kImage, host = {}, motors = {}, plugged = 0xff } = {}) {
    this.board = new Board(flash);
    this.sensors = new SensorArray();
    this.motors = Object.assign(new Motors(), motors);
    this.host = new UsbHost(host);
    kRods.forEach((rod) => (this.sensors.sensors[rod].plugged = (plugged & (1 << rod)) !== 0));
    for (const part of [this.sensors, this.motors, this.host]) this.board.attach((board) => part.wire(board));
    this.board.attach((board) => board.rp2040.gpio[22].setInputValue(true));
    this.slide = kRods.map(() => 0);
    this.spin = kRods.map(() => 0);
    this.last = undefined;
  }

  // Until the host reads frames that say that just these sensors answer.
  start(present = 0xff) {
    this.host.enumerate();
    assert.ok(this.waitForPresent(present, 400), `present: ${this.last?.present}`);
    return this;
  }
  waitForPresent(present, limitMs) {
    return this.board.runUntil(() => {
      this.frames();
      return this.last?.present === present;
    }, limitMs);
  }

  // Those since the last call, each with `at`, when the host asked for it.
  frames() {
    const frames = this.host.take().map(({ at, bytes }) => {
      const frame = decodeFrame(bytes);
      assert.ok(frame, 'a report that is no frame');
      return { at, ...frame };
    });
    if (frames.length) this.last = frames.at(-1);
    return frames;
  }
  framesOfMs(ms) {
    this.frames();
    this.board.runMs(ms);
    return this.frames();
  }

  move(rod, slide, spin) {
    this.moveSensor(this.sensors.sensors[rod], slide, spin);
  }
  moveSensor(sensor, slide, spin) {
    this.sensors.advance();
    sensor.move(slide, spin);
    this.slide[sensor.index] = (this.slide[sensor.index] + slide) & 0xffff;
    this.spin[sensor.index] = (this.spin[sensor.index] + spin) & 0xffff;
  }
  // Every so often, by the board's clock, until the returned function is called.
  every(us, act) {
    const alarm = this.board.clock.createAlarm(() => {
      act();
      if (going) alarm.schedule(us * 1e3);
    });
    let going = true;
    alarm.schedule(us * 1e3);
    return () => (going = false);
  }
  expectCounts(rods = kRods) {
    for (const rod of rods) {
      assert.equal(this.last.slide[rod], this.slide[rod], `slide of rod ${rod}`);
      assert.equal(this.last.spin[rod], this.spin[rod], `spin of rod ${rod}`);
    }
  }
  command(fields) {
    return this.host.sendReport(encodeCommand(fields));
  }

  // What no program may do to the chip, the bus or the sensors.
  expectNoFault() {
    assert.deepEqual(this.board.faults.slice(0, 5), []);
    assert.deepEqual(this.host.faults.slice(0, 5), []);
    assert.deepEqual(this.sensors.violations.slice(0, 5), []);
  }
}

export function say(text) {
  console.log(`# ${text}`);
}

export const pulse = (rod, amplitude, durationMs) => ({ kind: 1, rod, amplitude, durationMs });
export const lastWrite = (rig, rod) => rig.motors.drivers[rod].writes.at(-1);

// Pulses one after the other, then one on all rods at once: how long after its command the latest
// begins [ns]. Each ends in time.
export function slowestPulses(rig, rounds) {
  let longest = 0;
  for (let round = 0; round < rounds; ++round) {
    rig.board.run(5e6 + 137e3 * round);
    const sent = rig.board.clock.nanos;
    assert.ok(rig.command(pulse(round % 8, 40 + round, 20)));
    assert.ok(rig.board.runUntil(() => lastWrite(rig, round % 8).value === 40 + round, 3));
    longest = Math.max(longest, lastWrite(rig, round % 8).at - sent);
    rig.board.runMs(24);
    const end = lastWrite(rig, round % 8);
    assert.equal(end.value, 0);
    assert.ok(Math.abs(end.at - sent - 20e6) < 2e6, `${end.at - sent}`);
  }
  const sent = rig.board.clock.nanos;
  for (const rod of kRods) assert.ok(rig.board.runUntil(() => rig.command(pulse(rod, 200, 50)), 1));
  rig.board.runMs(4);
  kRods.forEach((rod) => assert.equal(lastWrite(rig, rod).value, 200));
  return { longest, all: Math.max(...kRods.map((rod) => lastWrite(rig, rod).at)) - sent };
}
