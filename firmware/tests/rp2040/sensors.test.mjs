// Eight simulated motion sensors: set up as the datasheet says, every count exact, in time.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Rig, kRods, randomNumbers, say } from './rig.mjs';

const kSeconds = Number(process.env.SF_RP2040_SECONDS ?? 20);

test('sets all sensors up with their own program, at 2000 counts/inch and without rest modes', () => {
  const rig = new Rig().start();
  for (const sensor of rig.sensors.sensors) {
    assert.equal(sensor.registers[0x0f], 19);
    assert.equal(sensor.registers[0x10], 0);
  }
  // Not while they are asked a question.
  assert.ok(rig.board.runUntil(() => rig.sensors.sensors.every((sensor) => sensor.burstMode), 2));
  rig.expectNoFault();
});

test(`counts ${kSeconds} s of motion on all rods to the last one, wrapping`, () => {
  const rig = new Rig().start();
  const random = randomNumbers(11);
  let counts = 0;
  const stop = rig.every(500, () => {
    for (const rod of kRods) {
      const slide = random(481) - 200; // drifts: 40 a step, 80000 a second, so that it wraps
      const spin = random(401) - 200;
      rig.move(rod, slide, spin);
      counts += Math.abs(slide) + Math.abs(spin);
    }
  });
  let overflow = 0;
  let quality = 0;
  const begin = process.hrtime.bigint();
  for (let ms = 0; ms < kSeconds * 1000; ms += 100) {
    for (const frame of rig.framesOfMs(100)) {
      overflow |= frame.overflow;
      quality += frame.quality;
      assert.equal(frame.present, 0xff);
    }
  }
  stop();
  rig.framesOfMs(5);
  rig.expectCounts();
  assert.equal(overflow, 0);
  assert.equal(quality, 0);
  rig.expectNoFault();
  const speed = (kSeconds * 1e9) / Number(process.hrtime.bigint() - begin);
  say(`${counts} counts in ${kSeconds} s, none lost; simulated at ${speed.toFixed(2)} times real time`);
});

test('a motion is in a report at most 1.1 ms later', () => {
  const rig = new Rig().start();
  rig.framesOfMs(50);
  const random = randomNumbers(12);
  const waiting = kRods.map(() => []);
  const latencies = [];
  const alarms = kRods.map((rod) => {
    const alarm = rig.board.clock.createAlarm(() => {
      rig.move(rod, 1, 0);
      waiting[rod].push({ at: rig.board.clock.nanos, count: rig.slide[rod] });
      alarm.schedule((150 + random(1700)) * 1e3 + random(1000));
    });
    alarm.schedule(random(1000) * 1e3);
    return alarm;
  });
  const slept = rig.board.sleptNanos;
  for (const frame of rig.framesOfMs(1500)) {
    for (const rod of kRods) {
      const seen = (entry) => ((frame.slide[rod] - entry.count) & 0xffff) < 0x8000;
      while (waiting[rod].length && waiting[rod][0].at < frame.at && seen(waiting[rod][0])) {
        latencies.push((frame.at - waiting[rod].shift().at) / 1e3);
      }
    }
  }
  const busy = 100 * (1 - (rig.board.sleptNanos - slept) / 1500e6);
  alarms.forEach((alarm) => alarm.cancel());
  latencies.sort((a, b) => a - b);
  const at = (share) => latencies[Math.floor(share * (latencies.length - 1))].toFixed(0);
  say(`${latencies.length} edges: p50 ${at(0.5)}, p99 ${at(0.99)}, max ${at(1)} us to the report; ` +
    `${busy.toFixed(1)} % of the processor`);
  assert.ok(latencies.length > 8000);
  assert.ok(latencies.at(-1) <= 1100, `${latencies.at(-1)}`);
});

test('a delta at its limit, and one that no sensor follows, are flagged and nothing else is', () => {
  const rig = new Rig().start();
  const overflow = (frames) => frames.reduce((all, frame) => all | frame.overflow, 0);
  rig.move(1, 400, -400); // 5.1 m/s in a millisecond, which the sensor follows
  assert.equal(overflow(rig.framesOfMs(5)), 0);
  rig.expectCounts();
  rig.move(2, 700, 0);
  assert.equal(overflow(rig.framesOfMs(5)), 1 << 2);
  rig.expectCounts();
  rig.move(6, 0, -40000); // beyond 16 bits: the sensor's delta stands at its limit
  assert.equal(overflow(rig.framesOfMs(5)), 1 << 6);
  assert.equal(rig.last.spin[6], 0x8000);
  assert.equal(overflow(rig.framesOfMs(20)), 0);
});
