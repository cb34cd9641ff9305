// Index marks: Hall switches at an expander that shares the motors' bus.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Rig, randomNumbers, say, slowestPulses } from './rig.mjs';

function withMarks(options = {}) {
  const rig = new Rig({ motors: { expander: true, ...options.motors } }).start();
  rig.board.runMs(50);
  rig.frames();
  return rig;
}

test('a mark is in the frame a reading and a report after it came under its switch, and gone as soon', () => {
  const rig = withMarks();
  const random = randomNumbers(5);
  let longest = 0;
  for (let i = 0; i < 60; ++i) {
    rig.board.run(1e6 + 31e3 * random(40));
    rig.frames();
    rig.motors.under = random(256);
    const changed = rig.board.clock.nanos;
    assert.ok(rig.board.runUntil(() => rig.frames().some((frame) => frame.index === rig.motors.under), 4));
    longest = Math.max(longest, rig.board.clock.nanos - changed);
  }
  say(`from a switch to the report at most ${(longest / 1e3).toFixed(0)} us`);
  assert.ok(longest <= 2.2e6);  // one of each a millisecond, and the time that they take
  const before = rig.motors.reads;
  rig.framesOfMs(100);
  assert.ok(Math.abs(rig.motors.reads - before - 100) <= 2, `${rig.motors.reads - before} readings in 100 ms`);
  rig.expectNoFault();
});

test('with marks read each millisecond a pulse still begins at most 2 ms after its command', () => {
  const rig = withMarks();
  rig.motors.under = 0x24;
  const { longest, all } = slowestPulses(rig, 30);
  say(`from a command to its write at most ${(longest / 1e3).toFixed(0)} us, eight at once ${(all / 1e3).toFixed(0)} us`);
  assert.ok(longest <= 2e6 && all <= 2e6);
  assert.ok(rig.framesOfMs(20).every((frame) => frame.index === 0x24));
  rig.expectNoFault();
});

test('an expander that is plugged in later is found within a second, one that vanishes leaves no marks', () => {
  const rig = withMarks({ motors: { expander: false } });
  rig.motors.under = 0x81;
  assert.ok(rig.framesOfMs(200).every((frame) => frame.index === 0));
  rig.motors.expander = true;
  assert.ok(rig.board.runUntil(() => rig.frames().some((frame) => frame.index === 0x81), 1100));
  rig.motors.expander = false;
  assert.ok(rig.board.runUntil(() => rig.frames().some((frame) => frame.index === 0), 3));
  assert.ok(rig.framesOfMs(100).length >= 99);
  rig.expectNoFault();
});

test('on a bus that is stuck there are no marks, and the reports go on', () => {
  const rig = withMarks();
  rig.motors.under = 0xff;
  rig.framesOfMs(3);
  assert.equal(rig.last.index, 0xff);
  rig.motors.stuck = true;
  rig.framesOfMs(5);
  rig.host.naks = 0;
  const frames = rig.framesOfMs(300);
  assert.ok(frames.length >= 299 && rig.host.naks === 0);
  assert.ok(frames.every((frame) => frame.index === 0));
  assert.equal(rig.board.resets, 0);
});
