// What the PC sends: pulses for the motors, settings.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { encodeCommand } from './packets.mjs';
import { Rig, kRods, lastWrite, pulse, say, slowestPulses } from './rig.mjs';

const kAllOff = 2;
const kSettings = 3;
const kMotorsEnable = 17;

function withMotors(options) {
  const rig = new Rig(options).start();
  rig.board.runMs(50);
  rig.frames();
  return rig;
}

test('all drivers are set up for real-time playback, silent', () => {
  const rig = withMotors();
  for (const driver of rig.motors.drivers) {
    assert.equal(driver.registers[0x01], 5);
    assert.equal(driver.registers[0x1d] & 0x28, 0x28, 'open loop, unsigned');
    assert.equal(driver.registers[0x02], 0);
  }
  assert.ok(rig.board.pinIsHigh(kMotorsEnable));
  rig.expectNoFault();
});

test('a pulse begins at most 2 ms after its command, on all rods at once too, and ends in time', () => {
  const rig = withMotors();
  const { longest, all } = slowestPulses(rig, 40);
  say(`from a command to its write at most ${(longest / 1e3).toFixed(0)} us, ` +
    `eight commands at once ${(all / 1e3).toFixed(0)} us`);
  assert.ok(longest <= 2e6 && all <= 2e6);
  rig.expectNoFault();
});

test('a command that comes just before the program sleeps does not wait for the next sample', () => {
  const kDisableInterrupts = 0xb672; // CPSID i, ...
  const kSleep = 0xbf30; // ... and WFI soon after it
  const rig = withMotors();
  const opcode = (i) => rig.board.rp2040.readUint16((rig.board.core.PC & ~1) + 2 * i);
  const goesToSleep = () => opcode(0) === kDisableInterrupts &&
    Array.from({ length: 24 }, (_, i) => opcode(i + 1)).includes(kSleep);
  let longest = 0;
  for (let round = 0; round < 60; ++round) {
    rig.board.run(4e6 + 97e3 * round);
    const { board } = rig;
    do board.step(board.clock.nanos + 1e6);
    while (board.core.waiting || !goesToSleep());
    const sent = board.clock.nanos;
    assert.ok(rig.command(pulse(round % 8, 100 + round, 1)));
    assert.ok(board.runUntil(() => lastWrite(rig, round % 8).value === 100 + round, 3));
    longest = Math.max(longest, lastWrite(rig, round % 8).at - sent);
  }
  assert.ok(longest <= 0.65e6, `${longest}`);
});

test('pulses without end get a quarter of a motor on average', () => {
  const rig = withMotors();
  const begun = rig.board.clock.nanos;
  for (let i = 0; i < 25; ++i) {
    rig.command(pulse(3, 255, 250));
    rig.board.runMs(100);
  }
  const ms = rig.motors.energy(3, begun);
  assert.ok(ms <= 0.26 * 2500 + 260, `${ms}`);
  assert.ok(ms >= 0.2 * 2500, `${ms}`);
});

test('all off ends every pulse, and with the switch off none begins', () => {
  const rig = withMotors();
  for (const rod of [0, 5]) {
    rig.command(pulse(rod, 90, 200));
    rig.board.runMs(2);
    assert.equal(lastWrite(rig, rod).value, 90);
  }
  rig.command({ kind: kAllOff });
  rig.board.runMs(3);
  for (const rod of [0, 5]) assert.equal(lastWrite(rig, rod).value, 0);
  rig.command({ kind: kSettings, resolution: 20, brightness: 64, switches: 1 });
  rig.board.runMs(300);
  assert.ok(!rig.board.pinIsHigh(kMotorsEnable));
  rig.command(pulse(0, 90, 200));
  rig.board.runMs(5);
  assert.equal(lastWrite(rig, 0).value, 0);
});

for (const [what, motors] of [['no multiplexer', { multiplexer: false }], ['no driver', { attached: 0 }],
  ['a bus that is stuck', { stuck: true }]]) {
  test(`with ${what} the reports go on and commands are swallowed`, () => {
    const rig = withMotors({ motors });
    for (const rod of kRods) {
      assert.ok(rig.board.runUntil(() => rig.command(pulse(rod, 100, 50)), 2));
    }
    rig.host.naks = 0;
    const frames = rig.framesOfMs(300);
    assert.ok(frames.length >= 299 && rig.host.naks === 0);
    assert.equal(rig.motors.drivers[0].writes.filter(({ value }) => value !== 0).length, 0);
    assert.equal(rig.board.resets, 0);
  });
}

test('a driver that vanishes while its motor runs has the supply of all switched off', () => {
  const rig = withMotors();
  rig.command(pulse(2, 120, 60));
  rig.board.runMs(5);
  assert.equal(lastWrite(rig, 2).value, 120);
  rig.motors.attached = 0xfb;
  let low = false;
  const stop = rig.every(100, () => (low ||= !rig.board.pinIsHigh(kMotorsEnable)));
  rig.board.runMs(70);
  stop();
  assert.ok(low);
});

test('a command comes by a control transfer too; a broken one is counted and does nothing', () => {
  const rig = withMotors();
  const report = new Uint8Array(64);
  report.set(encodeCommand(pulse(6, 77, 30)));
  assert.ok(rig.host.request(0x21, 9, 0x0200, 0, 64, report));
  rig.board.runMs(2);
  assert.equal(lastWrite(rig, 6).value, 77);
  rig.board.runMs(40);
  rig.frames();
  const broken = encodeCommand(pulse(6, 77, 30));
  broken[5] ^= 1;
  rig.host.sendReport(broken);
  const frames = rig.framesOfMs(10);
  assert.equal(frames.reduce((total, frame) => total + frame.quality, 0), 1);
  assert.equal(lastWrite(rig, 6).value, 0);
  rig.expectNoFault();
});

test('settings are kept in flash; those with a wrong CRC are not taken', () => {
  const rig = new Rig().start();
  rig.command({ kind: kSettings, resolution: 60, brightness: 200 });
  rig.board.runMs(400);
  assert.ok(rig.waitForPresent(0xff, 400));
  assert.equal(rig.board.erased, 1);
  assert.equal(rig.sensors.sensors[7].registers[0x0f], 59);
  rig.expectNoFault();

  const again = new Rig({ flash: rig.board.flash }).start();
  assert.equal(again.sensors.sensors[0].registers[0x0f], 59);
  again.board.runMs(300);
  assert.equal(again.board.ledBrightness, 200);

  const flash = rig.board.flash.slice();
  flash[flash.length - 4096 + 1] ^= 4;
  const broken = new Rig({ flash }).start();
  assert.equal(broken.sensors.sensors[0].registers[0x0f], 19);
});

test('a bus that a part holds is freed by clocks, and the pulse is played', () => {
  for (const clocks of [1, 5, 9]) {
    const rig = withMotors();
    rig.motors.holdData(clocks);
    rig.command(pulse(3, 111, 100));
    rig.board.runMs(25);
    assert.equal(lastWrite(rig, 3).value, 111);
    assert.ok(rig.motors.clocksByHand <= clocks + 1, `${rig.motors.clocksByHand}`);
    assert.equal(rig.motors.stopsByHand, 1);
    rig.expectNoFault();
  }
});

test('a data line that is held for ever costs ten clocks an attempt, and no report', () => {
  const rig = withMotors();
  rig.motors.holdData(1e9);
  rig.host.naks = 0;
  rig.command(pulse(3, 111, 100));
  rig.board.runMs(30);
  // The pulse's own attempt, and the search for the driver that seems to be gone.
  assert.ok(rig.motors.clocksByHand >= 9 && rig.motors.clocksByHand <= 20, `${rig.motors.clocksByHand}`);
  const frames = rig.framesOfMs(400);
  assert.ok(frames.length >= 399 && rig.host.naks === 0);
  rig.motors.holdData(0);
  rig.board.runMs(300);
  rig.command(pulse(3, 112, 100));
  rig.board.runMs(5);
  assert.equal(lastWrite(rig, 3).value, 112);
  rig.expectNoFault();
});

test('a write that does not end is given up, and the controller is reset', () => {
  const rig = withMotors();
  assert.ok(rig.board.rp2040.i2c[0].dataHold >= 37.5, '300 ns at 125 MHz');
  const before = rig.board.i2cResets;
  rig.motors.stuck = true;
  rig.command(pulse(1, 50, 100));
  rig.board.runMs(5);
  assert.ok(rig.board.i2cResets > before);
  rig.motors.stuck = false;
  rig.board.runMs(300);
  rig.command(pulse(1, 51, 100));
  rig.board.runMs(5);
  assert.equal(lastWrite(rig, 1).value, 51);
  rig.expectNoFault();
});

test('commands that find no room are counted', () => {
  const rig = withMotors();
  const { board } = rig;
  rig.frames();
  // The program goes round in a loop of its own, its interrupts are served.
  do board.step(board.clock.nanos + 1e6);
  while (board.core.waiting || board.core.IPSR !== 0 || board.core.PM);
  const at = board.core.PC & ~1;
  const opcode = board.rp2040.readUint16(at);
  board.rp2040.writeUint16(at, 0xe7fe);
  for (let i = 0; i < 20; ++i) assert.ok(board.runUntil(() => rig.command(pulse(i % 8, 1, 1)), 1));
  board.runMs(0.1);
  board.rp2040.writeUint16(at, opcode);
  const frames = rig.framesOfMs(20);
  assert.equal(frames.reduce((total, frame) => total + frame.quality, 0), 20 - 8);
});

test('a halt of the report endpoint leaves the commands where they are', () => {
  const rig = withMotors();
  assert.ok(rig.command(pulse(0, 40, 100)));
  rig.board.runMs(5);
  for (const feature of [3, 1]) assert.ok(rig.host.request(0x02, feature, 0, 0x81, 0));
  rig.host.reportPid = false;
  assert.ok(rig.command(pulse(1, 41, 100)));
  rig.board.runMs(5);
  assert.equal(lastWrite(rig, 0).value, 40);
  assert.equal(lastWrite(rig, 1).value, 41);
  rig.expectNoFault();
});
