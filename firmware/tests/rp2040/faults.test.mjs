// What may happen to a cabinet: sensors come and go, lines are stuck, the program is.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Rig, kRods, say } from './rig.mjs';

const sum = (frames, field) => frames.reduce((total, frame) => total + frame[field], 0);
const quiet = (frames) => frames.every((frame) => frame.quality === 0 && frame.flags === 0);
const kOthers = kRods.filter((rod) => rod !== 4);

// All rods move all the time; only rod 4 may lose counts.
function shaken(rig) {
  let step = 0;
  return rig.every(500, () => {
    ++step;
    for (const rod of kRods) rig.move(rod, ((step * (rod + 3)) % 61) - 25, (step % 17) - 8);
  });
}

test('a sensor that is unplugged is absent within 30 ms, and back within 250 ms of being plugged in', () => {
  const rig = new Rig().start();
  const stop = shaken(rig);
  const { clock } = rig.board;
  assert.ok(quiet(rig.framesOfMs(100)));
  rig.sensors.sensors[4].unplug();
  const gone = clock.nanos;
  assert.ok(rig.waitForPresent(0xef, 100));
  const goneMs = (clock.nanos - gone) / 1e6;
  assert.ok(goneMs <= 30, `${goneMs}`);
  const before = rig.last.slide[4];
  const frames = rig.framesOfMs(300);
  assert.ok(frames.length >= 299);
  assert.equal(rig.last.slide[4], before, 'nothing is made up');
  rig.sensors.sensors[4].plug();
  const back = clock.nanos;
  const flags = [];
  assert.ok(rig.board.runUntil(() => {
    flags.push(...rig.frames().map((frame) => frame.flags));
    return rig.last.present === 0xff;
  }, 400));
  const backMs = (clock.nanos - back) / 1e6;
  assert.ok(backMs <= 250, `${backMs}`);
  assert.equal(flags.at(-1) & 1, 1);
  rig.slide[4] = rig.last.slide[4];
  rig.spin[4] = rig.last.spin[4];
  rig.framesOfMs(50);
  stop();
  rig.framesOfMs(5);
  rig.expectCounts(kOthers);
  say(`unplugged: known after ${goneMs.toFixed(1)} ms; plugged in: counts after ${backMs.toFixed(1)} ms`);
});

test('a sensor that lost its supply between two questions is set up again and counted', () => {
  const rig = new Rig().start();
  const stop = shaken(rig);
  rig.framesOfMs(50);
  rig.sensors.sensors[4].power();
  assert.ok(rig.waitForPresent(0xef, 60));
  assert.ok(rig.waitForPresent(0xff, 250));
  stop();
  assert.equal(rig.sensors.sensors[4].registers[0x0f], 19);
  rig.framesOfMs(5);
  rig.expectCounts(kOthers);
});

for (const level of [false, true]) {
  test(`a data line stuck ${level ? 'high' : 'low'} takes away its own rod only, and is counted`, () => {
    const rig = new Rig().start();
    const stop = shaken(rig);
    rig.framesOfMs(50);
    rig.sensors.sensors[4].stuck = level;
    rig.sensors.drive();
    const frames = rig.framesOfMs(60);
    assert.equal(rig.last.present, 0xef);
    assert.ok(sum(frames, 'quality') >= 1);
    rig.sensors.sensors[4].stuck = undefined;
    assert.ok(rig.waitForPresent(0xff, 250));
    stop();
    rig.framesOfMs(5);
    rig.expectCounts(kOthers);
  });
}

// Between two questions, and each time counts are swallowed.
test('counts that a data line held low for a moment swallows are an error that is counted', () => {
  const rig = new Rig().start();
  rig.framesOfMs(50);
  for (let i = 0; i < 12; ++i) {
    const [sensor] = rig.sensors.sensors;
    rig.frames();
    sensor.stuck = false;
    rig.sensors.drive();
    rig.move(0, 30, 40);
    rig.board.runMs(1.2);
    sensor.stuck = undefined;
    rig.sensors.drive();
    rig.board.runMs(7.3);
    assert.ok(sum(rig.frames(), 'quality') >= 1, `${i}`);
    assert.ok(rig.waitForPresent(0xff, 250));
  }
});

test('without any sensor it reports a thousand times a second that there is none', () => {
  const rig = new Rig({ plugged: 0 }).start(0);
  const frames = rig.framesOfMs(500);
  assert.ok(frames.length >= 499);
  assert.ok(frames.every((frame) => frame.present === 0 && frame.overflow === 0));
  for (const sensor of rig.sensors.sensors) sensor.plug();
  assert.ok(rig.waitForPresent(0xff, 300));
});

test('the LED says: no host, no sensor, not all, all is well', () => {
  const ticks = (rig) => {
    const seen = new Set();
    let lit = 0;
    for (let i = 0; i < 20; ++i) {
      rig.board.runMs(50);
      lit += rig.board.ledBrightness > 0 ? 1 : 0;
      seen.add(rig.board.ledBrightness);
    }
    return { lit: lit / 2, brightness: Math.max(...seen) };
  };
  const rig = new Rig({ plugged: 0 });
  assert.equal(ticks(rig).lit, 5);
  rig.start(0);
  assert.equal(ticks(rig).lit, 1);
  rig.sensors.sensors[2].plug();
  assert.ok(rig.waitForPresent(4, 300));
  assert.equal(ticks(rig).lit, 9);
  for (const sensor of rig.sensors.sensors) if (!sensor.plugged) sensor.plug();
  assert.ok(rig.waitForPresent(0xff, 300));
  assert.deepEqual(ticks(rig), { lit: 10, brightness: 64 });
});

test('a program that is stuck is reset by the watchdog, comes back and says so', () => {
  const rig = new Rig().start();
  assert.ok(quiet(rig.framesOfMs(20)));
  // A jump to itself where the program is, with interrupts off.
  rig.board.rp2040.writeUint16(rig.board.core.PC & ~1, 0xe7fe);
  rig.board.core.PM = true;
  rig.board.core.waiting = false;
  const stuck = rig.board.clock.nanos;
  assert.ok(rig.board.runUntil(() => rig.board.resets === 1, 200));
  const resetMs = (rig.board.clock.nanos - stuck) / 1e6;
  assert.ok(resetMs <= 101, `${resetMs}`);
  rig.last = undefined;
  rig.host.take();
  rig.host.enumerate();
  assert.ok(rig.board.runUntil(() => rig.host.reports.length > 0, 100));
  assert.equal(rig.frames()[0].quality, 1);
  assert.ok(rig.waitForPresent(0xff, 400));
  assert.equal(rig.board.resets, 1);
  say(`reset ${resetMs.toFixed(1)} ms after the program was stuck`);
});

test('a button held for a second leads into the boot loader, a short press does not', () => {
  const rig = new Rig().start();
  rig.board.pressButton(true);
  rig.board.runMs(900);
  rig.board.pressButton(false);
  rig.board.runMs(200);
  assert.ok(!rig.board.inBootLoader);
  rig.board.pressButton(true);
  assert.ok(rig.board.runUntil(() => rig.board.inBootLoader, 1100));
});
