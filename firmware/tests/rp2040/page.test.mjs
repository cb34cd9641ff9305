// The page for browsers (cabinet/page/controller.html) against the firmware: it reads its reports, and
// what it sends is taken.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { decodeFrame, encodeCommand } from './packets.mjs';
import { Rig, kRods } from './rig.mjs';

const html = readFileSync(process.env.CONTROLLER_PAGE, 'utf8');
const script = html.match(/<script id="packets">([^]*?)<\/script>/)[1];
const page = new Function(`${script}; return { decodeFrame, decodeSettings, increment, pulseReport,
  settingsReport, tellReport, stickReport, measuredStick, withFrames, crc16 };`)();
const view = (bytes) => new DataView(bytes.buffer, bytes.byteOffset, bytes.length);

test('what the firmware reports is what the page shows', () => {
  const rig = new Rig({ plugged: 0xf7, motors: { expander: true, under: 0x12 } }).start(0xf7);
  const before = rig.last.slide.map((slide, rod) => ({ slide, spin: rig.last.spin[rod] }));
  for (const rod of kRods) if (rod !== 3) rig.move(rod, 100 * rod + 1, -30000 + rod);
  rig.board.runMs(20);
  const reports = rig.host.take();
  const shown = page.decodeFrame(view(reports.at(-1).bytes));
  const read = decodeFrame(reports.at(-1).bytes);
  assert.equal(shown.sequence, read.sequence);
  assert.equal(shown.timeUs, read.timeUs);
  for (const rod of kRods) {
    assert.equal(shown.rods[rod].present, rod !== 3);
    assert.equal(shown.rods[rod].mark, rod === 1 || rod === 4);
    if (rod === 3) continue;
    assert.equal(page.increment(before[rod].slide, shown.rods[rod].slide), 100 * rod + 1);
    assert.equal(page.increment(before[rod].spin, shown.rods[rod].spin), -30000 + rod);
  }
  const broken = reports.at(-1).bytes.slice();
  broken[9] ^= 1;
  assert.equal(page.decodeFrame(view(broken)), null);
  const before2 = reports.at(-1).bytes.slice(); // of version 1, which has no marks
  before2[0] = 1;
  const sealed = (bytes) => {
    view(bytes).setUint16(44, page.crc16(bytes.subarray(0, 44)), true);
    return view(bytes);
  };
  assert.equal(page.decodeFrame(sealed(before2)), null);
  before2[43] = 0;
  assert.ok(page.decodeFrame(sealed(before2)).rods.every((rod) => !rod.mark));
  assert.equal(page.decodeFrame(view(new Uint8Array(7))), null);
});

test('settings and pulses of the page are those that the firmware takes', () => {
  const settings = page.settingsReport({ resolution: 60, brightness: 200, ps2: 0, silent: false });
  const pulse = page.pulseReport(5, 128, 60);
  assert.deepEqual([...settings.subarray(0, 16)],
    [...encodeCommand({ kind: 3, resolution: 60, brightness: 200 })]);
  assert.deepEqual([...pulse.subarray(0, 16)],
    [...encodeCommand({ kind: 1, rod: 5, amplitude: 128, durationMs: 60 })]);
  assert.equal(settings.length, 64);
  const rig = new Rig().start();
  assert.ok(rig.host.sendReport(pulse.subarray(0, 16)));
  assert.ok(rig.board.runUntil(() => rig.motors.drivers[5].writes.at(-1)?.value === 128, 3));
  assert.ok(rig.host.sendReport(settings.subarray(0, 16)));
  rig.board.runMs(400);
  assert.equal(rig.sensors.sensors[7].registers[0x0f], 59);
});

test('the switch of gamepads and what was measured of a rod are what the firmware takes', () => {
  const report = page.settingsReport({ resolution: 20, brightness: 64, ps2: 0, silent: true, gamepads: true });
  assert.deepEqual([...report.subarray(0, 16)],
    [...encodeCommand({ kind: 3, resolution: 20, brightness: 64, switches: 3 })]);
  const stick = page.stickReport(6, { travel: -9876, turn: 4021 });
  assert.deepEqual([...stick.subarray(0, 16)],
    [...encodeCommand({ kind: 4, rod: 6, travel: 9876, turn: 4021, reversed: 1 })]);
  assert.deepEqual([...page.stickReport(0, { travel: 64, turn: -64 }).subarray(0, 16)],
    [...encodeCommand({ kind: 4, rod: 0, travel: 64, turn: 64, reversed: 2 })]);
  const rig = new Rig().start();
  rig.frames();
  for (const bytes of [stick, report])
    assert.ok(rig.board.runUntil(() => rig.host.sendReport(bytes.subarray(0, 16)), 500));
  assert.ok(rig.board.runUntil(() => !rig.host.isAttached, 1500));
  assert.equal(rig.frames().reduce((errors, frame) => errors + frame.quality, 0), 0);
  rig.host.polling = false;
  rig.host.enumerate();
  assert.equal(rig.host.interfaces.length, 5);
});

test('the settings that the firmware tells are those that it was sent, and no frame is lost for them', () => {
  const rig = new Rig().start();
  rig.frames();
  const told = () => {
    assert.ok(rig.board.runUntil(() => rig.host.sendReport(page.tellReport(0x1234).subarray(0, 16)), 500));
    rig.board.runMs(5);
    const reports = rig.host.take().map(({ bytes }) => bytes);
    const frames = reports.flatMap((bytes) => decodeFrame(bytes) ?? []);
    assert.equal(frames.length, reports.length - 1);
    frames.slice(1).forEach((frame, i) => assert.equal(frame.sequence, frames[i].sequence + 1 & 0xffff));
    return reports.map((bytes) => page.decodeSettings(view(bytes))).find((settings) => settings);
  };
  const fresh = told();
  assert.deepEqual({ ...fresh, sticks: 0 }, { version: 2, sequence: 0x1234, hasSensors: true, canBeGamepads: true, resolution: 20, brightness: 64,
    ps2: 0, silent: false, gamepads: false, sticks: 0 });
  assert.ok(fresh.sticks.every(({ travel, turn }) => travel === 0 && turn === 0));
  const wanted = { resolution: 60, brightness: 200, ps2: 0x80, silent: true, gamepads: false };
  for (const report of [page.settingsReport(wanted), page.stickReport(6, { travel: -9876, turn: 4021 }),
    page.stickReport(0, { travel: 64, turn: -65 })]) {
    assert.ok(rig.board.runUntil(() => rig.host.sendReport(report.subarray(0, 16)), 500));
    rig.board.runMs(100);
  }
  rig.host.take();
  const { sticks, ...settings } = told();
  assert.deepEqual(settings, { version: 2, sequence: 0x1234, hasSensors: true, canBeGamepads: true, ...wanted });
  assert.deepEqual([sticks[6], sticks[0], sticks[1]], [{ travel: -9876, turn: 4021 }, { travel: 64, turn: -65 }, { travel: 0, turn: 0 }]);
});

// A hand that is not exact: a rod turns a little as it is pushed, and slides a little as it is turned.
test('a rod that was pushed to both stops and turned once is measured, either way round', () => {
  for (const [slideSign, spinSign] of [[1, 1], [-1, 1], [1, -1], [-1, -1]]) {
    const trace = [];
    const go = (slide, spin) => trace.push([500 + slideSign * slide, -300 + spinSign * spin]);
    go(0, 0);
    for (let i = 0; i <= 100; ++i) go(7 * i, (i * 3) % 40);
    for (let i = 0; i <= 100; ++i) go(700 - 12 * i, 30 - (i * 5) % 50);
    for (let i = 0; i <= 100; ++i) go(-500 + (i % 7), 4 * i);
    go(-499, 401);
    assert.deepEqual(page.measuredStick(trace), { travel: slideSign * 1200, turn: spinSign * 401 });
  }
  // One that was at its near stop already when the measuring began.
  assert.deepEqual(page.measuredStick([[0, 0], [4000, 0], [0, 0], [0, 900]]), { travel: 4000, turn: 900 });
  assert.equal(page.measuredStick([]), null);
  assert.equal(page.measuredStick([[5, 7]]), null);
  assert.equal(page.measuredStick([[0, 0], [700, 0], [-500, 0]]), null, 'not turned');
  assert.equal(page.measuredStick([[0, 0], [0, 400]]), null, 'not pushed');
});

test('of the devices that a browser lists the one with frames is taken', () => {
  const pad = { collections: [{ usagePage: 1, usage: 5 }] };
  const frames = { collections: [{ usagePage: 0xff00, usage: 1 }] };
  assert.equal(page.withFrames([pad, pad, frames, pad]), frames);
  assert.equal(page.withFrames([pad]), undefined);
  assert.equal(page.withFrames([]), undefined);
});
