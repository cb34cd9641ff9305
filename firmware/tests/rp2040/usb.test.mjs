// The RP2040's own USB stack against a simulated host.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decodeFrame } from './packets.mjs';
import { Rig, randomNumbers, say } from './rig.mjs';

test('says that it is the cabinet, with the number of its flash as serial number', () => {
  const rig = new Rig().start();
  const { host } = rig;
  assert.equal(host.device.length, 18);
  assert.equal(host.device[8] | (host.device[9] << 8), 0x1209);
  assert.equal(host.device[10] | (host.device[11] << 8), 0x0001);
  assert.equal(host.string(1), 'Space Foosball');
  assert.equal(host.string(2), 'Cabinet');
  assert.equal(host.string(host.device[16]), 'E6613852830FA521');
  rig.expectNoFault();
});

test('is one HID interface with 64-byte reports in both directions each millisecond', () => {
  const { host } = new Rig().start();
  const bytes = host.configuration;
  assert.equal(bytes[2] | (bytes[3] << 8), bytes.length);
  const parts = [];
  for (let at = 0; at < bytes.length; at += bytes[at]) parts.push(bytes.subarray(at, at + bytes[at]));
  assert.deepEqual(parts.map((part) => part[1]), [2, 4, 0x21, 5, 5]);
  assert.equal(parts[1][5], 3);
  assert.equal(parts[2][7] | (parts[2][8] << 8), host.reportDescriptor.length);
  assert.deepEqual([...parts[3]], [7, 5, 0x81, 3, 64, 0, 1]);
  assert.deepEqual([...parts[4]], [7, 5, 0x01, 3, 64, 0, 1]);
  const report = Buffer.from(host.reportDescriptor);
  assert.deepEqual([...report.subarray(0, 3)], [0x06, 0x00, 0xff]);
  assert.ok(report.includes(Buffer.of(0x75, 8, 0x95, 64)));
  assert.ok(report.includes(Buffer.of(0x81, 0x02)) && report.includes(Buffer.of(0x91, 0x02)));
});

test('answers the standard questions, stalls what it does not know, and goes on', () => {
  const rig = new Rig().start();
  const { host } = rig;
  assert.deepEqual([...host.request(0x80, 0, 0, 0, 2)], [1, 0]);
  assert.deepEqual([...host.request(0x80, 8, 0, 0, 1)], [1]);
  assert.deepEqual([...host.request(0x81, 10, 0, 0, 1)], [0]);
  assert.equal(host.request(0x21, 10, 0x0700, 0, 0).length, 0);
  assert.deepEqual([...host.request(0xa1, 2, 0, 0, 1)], [7]);
  assert.equal(host.descriptor(1, 0, 8).length, 8);
  for (const asked of [64, 255, 46]) {
    const report = host.request(0xa1, 1, 0x0100, 0, asked);
    assert.equal(report.length, Math.min(asked, 64));
    const whole = new Uint8Array(64);
    whole.set(report);
    assert.ok(decodeFrame(whole));
  }
  const unknown = [[0x80, 6, 0x0309, 0x0409, 255], [0x80, 6, 0x0f00, 0, 255], [0x00, 9, 7, 0, 0],
    [0xc0, 0x42, 0, 0, 8], [0x21, 9, 0x0300, 0, 8], [0xa1, 1, 0x0300, 0, 64]];
  for (const request of unknown) assert.equal(host.request(...request), undefined, String(request));
  assert.deepEqual([...host.request(0x80, 8, 0, 0, 1)], [1]);
  assert.ok(rig.framesOfMs(100).length >= 99);
  rig.expectNoFault();
});

test('a halted endpoint is silent until it is cleared', () => {
  const rig = new Rig().start();
  const { host } = rig;
  assert.ok(host.request(0x02, 3, 0, 0x81, 0));
  assert.deepEqual([...host.request(0x82, 0, 0, 0x81, 2)], [1, 0]);
  assert.equal(rig.framesOfMs(20).length, 0);
  assert.ok(host.request(0x02, 1, 0, 0x81, 0));
  host.reportPid = false;
  assert.ok(rig.framesOfMs(20).length >= 18);
  rig.expectNoFault();
});

test('a bus reset is followed by another enumeration, and the counts stand', () => {
  const rig = new Rig().start();
  rig.move(3, 40, -50);
  rig.framesOfMs(5);
  rig.host.reset();
  rig.host.enumerate();
  rig.framesOfMs(20);
  assert.equal(rig.last.present, 0xff);
  rig.expectCounts();
  rig.expectNoFault();
});

test('reports a thousand times a second, none twice and none left out', () => {
  const rig = new Rig().start();
  rig.host.naks = 0;
  const frames = rig.framesOfMs(1000);
  assert.ok(Math.abs(frames.length - 1000) <= 1, `${frames.length}`);
  assert.equal(rig.host.naks, 0);
  frames.slice(1).forEach((frame, i) => assert.equal(frame.sequence, (frames[i].sequence + 1) & 0xffff));
  rig.expectNoFault();
});

test('a host that asks up to 40 us early or late misses few reports once that is known', () => {
  const random = randomNumbers(5);
  const rig = new Rig({ host: { pollUs: 300, jitterUs: () => random(81) - 40 } }).start();
  rig.framesOfMs(500);
  rig.host.naks = 0;
  const frames = rig.framesOfMs(1000);
  say(`with 40 us of jitter ${rig.host.naks} of 1000 reports come a millisecond late`);
  assert.ok(rig.host.naks <= 5, `${rig.host.naks}`);
  assert.ok(frames.length >= 994);
});
