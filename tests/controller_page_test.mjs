// The page for browsers (cabinet/page/controller.html) over a serial line, and over HID what is the page's own: its
// scripts in a document and a browser that are made of as little as they use. Frames are those of the ATmega2560's firmware in its simulator.
// Environment: CONTROLLER_PAGE, BIN (the folder of cabinet-bench).
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';

const html = readFileSync(process.env.CONTROLLER_PAGE, 'utf8');
const scripts = [...html.matchAll(/<script[^>]*>([^]*?)<\/script>/g)].map((match) => match[1]);
// wire/tests/golden.h, kDeviceCobs; and its CRC broken.
const kGolden = '0902010201060504030125ffffe803d3fed007a7fdb80b7bfca00f4ffb881323fa7017f7f8581bcbf7ff0802410ab800';
const kBroken = kGolden.replace('0ab8', '0ab9');
const bytes = (hex) => Uint8Array.from(hex.match(/../g), (pair) => parseInt(pair, 16));

// What the firmware sends while rod 6 is moved, from power on.
function recorded(...moves) {
  const folder = mkdtempSync(path.join(tmpdir(), 'page-'));
  try {
    const file = path.join(folder, 'moves.bin');
    execFileSync(path.join(process.env.BIN, 'cabinet-bench'),
      ['--board', '2560', '--square', '--record', file, ...moves.flatMap((move) => ['--move', move])]);
    return new Uint8Array(readFileSync(file));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

// A part of the document: what is not set is there all the same, and does nothing.
class Element {
  constructor() {
    Object.assign(this, { textContent: '', className: '', disabled: false, checked: false, value: '20', children: [] });
  }
  append(...parts) { this.children.push(...parts.filter((part) => part instanceof Element)); }
  insertAdjacentHTML(_where, markup) {
    const value = markup.match(/<input type="checkbox" value="(\d)">/)?.[1];
    if (value) this.children.push(Object.assign(new Element(), { value }));
  }
  insertRow() {
    const row = new Element();
    row.cells = [1, 2, 3, 4, 5].map(() => new Element());
    row.cells[4].firstChild = Object.assign(new Element(), { width: 400, height: 34,
      getContext: () => ({ clearRect() {}, beginPath() {}, lineTo() {}, stroke() {} }) });
    this.children.push(row);
    return row;
  }
}

// A serial port as a browser gives it; what the page writes is in written.
class Port extends EventTarget {
  constructor({ refuses, info = { usbVendorId: 0x2341, usbProductId: 0x42 } } = {}) {
    super();
    Object.assign(this, { refuses, info, written: [], readable: null, opened: null });
  }
  getInfo() { return this.info; }
  async open(options) {
    if (this.refuses) throw Object.assign(new Error(this.refuses), { name: 'NetworkError' });
    this.opened = options;
    this.listenAgain();
    this.writable = new WritableStream({ write: (chunk) => { this.written.push([...chunk]); } });
  }
  async close() { this.readable = this.opened = null; }
  listenAgain() { this.readable = new ReadableStream({ start: (end) => { this.line = end; } }); }
  // As a noisy line: this reader ends, the next one goes on.
  disturb() {
    const before = this.line;
    this.listenAgain();
    before.error(new Error('framing'));
  }
}

// A HID device as a browser gives it.
class Device extends EventTarget {
  constructor() {
    super();
    Object.assign(this, { productName: 'Space Foosball rods', productId: 1, collections: [{ usagePage: 0xff00, outputReports: [{}] }], opened: false, written: [] });
  }
  async open() { this.opened = true; }
  async close() { this.opened = false; }
  async sendReport(id, report) { this.written.push([id, ...report]); }
  report(frame) {
    const data = new DataView(Uint8Array.from([...frame, ...new Array(64 - frame.length).fill(0)]).buffer);
    this.dispatchEvent(Object.assign(new Event('inputreport'), { data }));
  }
}
function hidApi(device, known = []) {
  return Object.assign(new EventTarget(), { getDevices: async () => known, requestDevice: async () => (device ? [device] : []) });
}

// Lets what waits for streams go on.
const settled = async () => { for (let i = 0; i < 20; ++i) await new Promise(setImmediate); };

class Page {
  constructor({ hid, serial, secure = true } = {}) {
    this.parts = new Map();
    this.now = 0;
    const part = (id) => this.id(id);
    const document = {
      getElementById: part, createElement: () => new Element(),
      querySelectorAll: (what) => ({ '#motors button': part('motors').children, '#mice input': part('mice').children,
        '#mice input:checked': part('mice').children.filter(({ checked }) => checked) }[what] ?? [part('send'), part('measure'),
        ...part('motors').children]),
    };
    const names = ['document', 'window', 'navigator', 'performance', 'setInterval'];
    new Function(...names, scripts.join('\n'))(document, { isSecureContext: secure }, { hid, serial },
      { now: () => this.now }, (show) => { this.show = show; });
  }
  id(name) { return this.parts.get(name) ?? this.parts.set(name, new Element()).get(name); }
  get rods() { return this.id('rods').children.map(({ cells }) => cells.map((cell) => cell.textContent)); }
  later(ms) {
    this.now += ms;
    this.show();
  }
}

// A browser whose person chooses that port.
function serialApi(port, known = []) {
  return Object.assign(new EventTarget(), {
    filters: null, getPorts: async () => known,
    async requestPort({ filters }) {
      this.filters = filters;
      if (!port) throw Object.assign(new Error('No port selected by the user.'), { name: 'NotFoundError' });
      return port;
    },
  });
}
// As the browser has it, an event of a port comes by the port: its target.
function unplug(port, serial) {
  const event = new Event('disconnect');
  Object.defineProperty(event, 'target', { value: port });
  port.readable = null;
  port.line.error(new Error('The device has been lost.'));
  serial.dispatchEvent(event);
}

async function connected(options) {
  const port = new Port(options), serial = serialApi(port);
  const page = new Page({ serial });
  await page.id('serial').onclick();
  page.later(50);
  return { port, serial, page };
}
async function receive(port, data, piece = data.length) {
  for (let at = 0; at < data.length; at += piece) port.line.enqueue(data.slice(at, at + piece));
  await settled();
}

test('counts of a rod that is moved are those of the firmware, however the line cuts its bytes', async () => {
  const recording = recorded('6:100:0', '6:0:5');
  for (const piece of [7, 48, 1000]) {
    const { port, page } = await connected();
    assert.deepEqual([port.opened.baudRate, page.id('send').disabled], [1000000, true]);
    assert.match(page.id('state').textContent, /waiting for its first frame/);
    await receive(port, recording, piece);
    page.later(1000);
    assert.equal(page.id('state').textContent, 'The ATmega2560 at its serial port is connected.');
    assert.equal(page.id('motors').children[0].disabled, false);
    page.rods.forEach(([, state, slide, spin], rod) => {
      assert.equal(state, 'answers');
      // 100 mm and five turns of a rod of 16 mm, 8 counts/mm; which way depends on the mouse.
      assert.ok(Math.abs(Math.abs(slide) - (rod === 5 ? 800 : 0)) <= 12, `rod ${rod + 1}: ${slide}`);
      assert.ok(Math.abs(Math.abs(spin) - (rod === 5 ? 2011 : 0)) <= 30, `rod ${rod + 1}: ${spin}`);
    });
    assert.equal(page.id('faults').textContent, 'lost 0, not a frame 0, errors between sensors and controller 0');
    assert.match(page.id('rate').textContent, /^\d+ frames a second$/);
  }
});

test('a frame that is lost, one that is broken and a disturbed line are counted', async () => {
  const recording = recorded('6:20:0');
  const ends = [...recording.keys()].filter((at) => recording[at] === 0);
  const { port, page } = await connected();
  await receive(port, recording.slice(0, ends[99] + 1));
  await receive(port, recording.slice(ends[102] + 1, ends[110] + 1), 1);  // three are missing
  await receive(port, bytes(kBroken + '0502' + '00'));
  page.later(50);
  assert.match(page.id('faults').textContent, /^lost 3, not a frame 2,/);
  port.disturb();
  await settled();
  await receive(port, recording.slice(ends[110], ends[120] + 1));
  page.later(50);
  assert.match(page.id('faults').textContent, /^lost 3, not a frame 3,/);
  assert.equal(page.id('state').className, 'good');
});

test('a controller that starts again goes on from where its counts were', async () => {
  const all = recorded('6:100:0'), recording = all.slice(all.indexOf(0), all.lastIndexOf(0) + 1);  // whole frames
  const { port, page } = await connected();
  await receive(port, recording);
  await receive(port, recording);
  page.later(50);
  assert.ok(Math.abs(Math.abs(page.rods[5][2]) - 1600) <= 24, page.rods[5][2]);
  assert.match(page.id('faults').textContent, /^lost 0, not a frame 0,/);
});

// A question with its sequence.
const tell = (sequence) => sealed([1, 5, sequence, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
// As wire/device_settings.h has it; sticks: [rod, travel, turn].
function settingsReport(sequence, { version = 2, abilities = 0, resolution = 20, brightness = 64, ps2 = 0, switches = 0, stick } = {}) {
  const body = new Array(44).fill(0);
  [0x81, abilities, version, resolution, brightness, ps2, switches].forEach((value, at) => { body[at] = value; });
  if (stick) {
    const [rod, travel, turn] = stick;
    [Math.abs(travel) & 255, Math.abs(travel) >> 8, Math.abs(turn) & 255, Math.abs(turn) >> 8]
      .forEach((value, at) => { body[8 + 4 * rod + at] = value; });
    body[40] = travel < 0 ? 1 << rod : 0;
    body[41] = turn < 0 ? 1 << rod : 0;
  }
  body[42] = sequence;
  return sealed(body);
}
function stuffed(plain) {
  const out = [];
  for (let rest = [...plain]; ;) {
    const zero = rest.indexOf(0), run = zero < 0 ? rest : rest.slice(0, zero);
    out.push(run.length + 1, ...run);
    if (zero < 0) return Uint8Array.from([...out, 0]);
    rest = rest.slice(zero + 1);
  }
}

// A Mega whose first frame has been received.
async function connectedWithFrame() {
  const { port, serial, page } = await connected();
  await receive(port, bytes('00' + kGolden));
  page.later(50);
  await settled();
  return { port, serial, page };
}
const answer = (port, ...rest) => receive(port, stuffed(settingsReport(...rest)));
// A Pico whose settings have been read.
async function pico(device = new Device(), settings = { abilities: 3 }) {
  const hid = hidApi(device), page = new Page({ hid, serial: serialApi(null) });
  await page.id('hid').onclick();
  device.report(unstuffed([...bytes(kGolden)]));
  page.later(50);
  await settled();
  device.report(settingsReport(1, settings));
  page.later(50);
  return { device, hid, page };
}
const frameAfter = (frame, changes) => {
  const next = frame.slice(0, 44);
  for (const [at, by] of changes) next[at] = next[at] + by & 255;
  return sealed(next);
};

test('settings and pulses go out as COBS of the bytes that the firmware takes', async () => {
  const { port, page } = await connectedWithFrame();
  assert.deepEqual(unstuffed(port.written[0]), tell(1));
  assert.deepEqual([page.id('send').disabled, page.id('brightness').disabled], [true, true], 'what it has is not known yet');
  await answer(port, 1, { brightness: 9 });
  page.later(50);
  assert.deepEqual(['resolution', 'mice', 'gamepads', 'measure', 'brightness', 'send'].map((id) => page.id(id).disabled),
    [true, true, true, true, false, false]);
  assert.deepEqual([page.id('brightness').value, page.id('brightnessText').textContent, page.id('scales').textContent], [9, '4 %', '']);
  Object.assign(page.id('brightness'), { value: '64' });
  page.id('silent').checked = true;
  await page.id('send').onclick();
  await settled();
  // Resolution 20, brightness 64, no PS/2 rods, switches 1; a pulse of rod 6 at 128 for 60 ms.
  const settings = [1, 3, 0, 0, 0, 0, 0, 0, 20, 64, 0, 1, 0, 0], pulse = [1, 1, 0, 0, 5, 128, 60, 0, 0, 0, 0, 0, 0, 0];
  assert.deepEqual(unstuffed(port.written[1]), sealed(settings));
  assert.deepEqual(unstuffed(port.written[2]), tell(2), 'whether it has kept them');
  assert.equal(page.id('silent').disabled, true, 'about to be filled');
  await answer(port, 2, { brightness: 64, switches: 1 });
  assert.equal(page.id('sent').textContent, 'Saved.');
  page.id('motors').children[5].onclick();
  page.id('motors').children[5].onclick();
  await settled();
  assert.deepEqual(port.written.slice(3).map(unstuffed), [sealed(pulse), sealed(pulse)], 'one after the other');
  assert.match(page.id('faults').textContent, /not a frame 0,/);
});

test('settings that were not taken are said, and the form shows what the controller has', async () => {
  const kept = { brightness: 200, switches: 1 };
  for (const [is, other] of [[true, {}], [false, { brightness: 9 }], [false, { switches: 0 }], [false, { resolution: 21 }],
    [false, { ps2: 1 }], [false, { switches: 3 }]]) {
    const { port, page } = await connectedWithFrame();
    await answer(port, 1, { brightness: 9 });
    page.id('brightness').value = '200';
    page.id('silent').checked = true;
    await page.id('send').onclick();
    await answer(port, 2, { ...kept, ...other });
    assert.match(page.id('sent').textContent, is ? /^Saved/ : /^The controller did not accept them/, JSON.stringify(other));
    assert.equal(page.id('brightness').value, other.brightness ?? 200);
  }
});

test('a question that is lost is put again; firmware of before, which has no answer, can be set all the same', async () => {
  const { port, serial, page } = await connectedWithFrame();
  page.later(500);
  await settled();
  assert.equal(port.written.length, 1);
  page.later(600);
  await settled();
  assert.equal(port.written.length, 2);
  const broken = settingsReport(1, { brightness: 9 });
  broken[4] ^= 1;
  await receive(port, stuffed(broken));
  page.later(50);
  assert.match(page.id('faults').textContent, /not a frame 1,/);
  assert.equal(page.id('send').disabled, true);
  page.later(1001);
  page.later(1001);
  page.later(50);
  await settled();
  assert.equal(port.written.length, 3);
  assert.match(page.id('told').textContent, /^It cannot report its settings/);
  assert.deepEqual(['send', 'brightness', 'resolution', 'gamepads', 'measure'].map((id) => page.id(id).disabled),
    [false, false, true, true, true]);
  await page.id('send').onclick();
  page.later(50);
  await settled();
  assert.equal(port.written.length, 4, 'not asked again');
  assert.equal(page.id('send').disabled, false);
  // Flashed and connected again.
  const other = new Port();
  serial.requestPort = async () => other;
  await page.id('serial').onclick();
  await receive(other, bytes('00' + kGolden));
  page.later(50);
  await answer(other, 2, { brightness: 9 });
  assert.equal(page.id('brightness').value, 9);
});

test('an answer that is not to the last question changes nothing', async () => {
  const { port, page } = await connectedWithFrame();
  page.later(1001);
  await answer(port, 1, { brightness: 9 });
  page.id('brightness').value = '200';
  await page.id('send').onclick();
  await answer(port, 1, { brightness: 9 });  // the question was put twice
  assert.deepEqual([page.id('brightness').value, page.id('sent').textContent], ['200', 'Sent.']);
  await answer(port, 2, { brightness: 200 });
  await answer(port, 2, { brightness: 77 });
  assert.deepEqual([page.id('brightness').value, page.id('sent').textContent], [200, 'Saved.']);
  page.later(50);
  assert.match(page.id('faults').textContent, /not a frame 0,/);
});

test('settings of another version, or out of range, are not shown', async () => {
  for (const wrong of [{ version: 3 }, { resolution: 0 }, { resolution: 121 }, { switches: 4 }, { abilities: 4 },
    { stick: [1, 5, 400] }]) {
    const { port, page } = await connectedWithFrame();
    await answer(port, 1, { brightness: 9, ...wrong });
    page.later(50);
    assert.match(page.id('told').textContent, /^Its settings are of another version/);
    assert.deepEqual([page.id('brightness').value, page.id('send').disabled], ['20', false]);
    assert.match(page.id('faults').textContent, /not a frame 0,/);
  }
});

test('of a Pico all is filled, sent and compared, and measuring leaves the form alone', async () => {
  const { device, page } = await pico(new Device(), { abilities: 3, resolution: 60, ps2: 0x81, switches: 1, stick: [2, -1200, 402] });
  assert.deepEqual(['resolution', 'mice', 'gamepads', 'measure'].map((id) => page.id(id).disabled), [false, false, false, false]);
  assert.deepEqual([page.id('resolution').value, page.id('silent').checked, page.id('gamepads').checked], [60, true, false]);
  assert.deepEqual(page.id('mice').children.map(({ checked }) => checked), [true, false, false, false, false, false, false, true]);
  assert.equal(page.id('scales').textContent, 'Measured, in counts: rod 3 1200 along, 402 around.');
  page.id('mice').children[1].checked = true;
  page.id('mice').children[7].checked = false;
  await page.id('send').onclick();
  assert.deepEqual(device.written[1].slice(1, 17), sealed([1, 3, 0, 0, 0, 0, 0, 0, 60, 64, 0x03, 1, 0, 0]));
  const kept = { abilities: 3, resolution: 60, ps2: 3, switches: 1 };
  device.report(settingsReport(2, kept));
  assert.match(page.id('sent').textContent, /^Saved\. Changed sensors/);
  page.id('brightness').value = '200';  // not kept yet
  await page.id('measure').onclick();
  let frame = unstuffed([...bytes(kGolden)]);
  // Rod 6 is pulled by 300 counts, and turned by 100: bytes 28 to 31.
  for (const changes of [[[2, 1], [29, 1]], [[2, 1], [28, 44]], [[2, 1], [30, 100]]]) device.report(frame = frameAfter(frame, changes));
  await page.id('measure').onclick();
  await settled();
  assert.deepEqual(device.written[3].slice(1, 17), sealed([1, 4, 0, 0, 5, 1, 0, 0, 44, 1, 100, 0, 0, 0]));
  assert.match(page.id('measured').textContent, /^Sent: rods 6/);
  device.report(settingsReport(3, { ...kept, stick: [5, -300, 100] }));
  assert.deepEqual([page.id('measured').textContent, page.id('brightness').value], ['Saved.', '200']);
  assert.match(page.id('scales').textContent, /rod 6 300 along, 100 around/);
});

test('a controller that becomes gamepads is said to come back, before its answer and after; else it is unplugged', async () => {
  for (const [gamepads, answers, said] of [[true, true, /another device/], [true, false, /another device/], [false, true, /unplugged/]]) {
    const { device, hid, page } = await pico();
    page.id('gamepads').checked = gamepads;
    await page.id('send').onclick();
    if (answers) device.report(settingsReport(2, { abilities: 3, switches: gamepads ? 2 : 0 }));
    hid.dispatchEvent(Object.assign(new Event('disconnect'), { device }));
    await settled();
    assert.match(page.id('state').textContent, said);
  }
});

test('what one controller cannot do is its own affair: the next may, also if its firmware tells nothing', async () => {
  const port = new Port(), device = new Device();
  const page = new Page({ serial: serialApi(port), hid: hidApi(device) });
  await page.id('serial').onclick();
  await receive(port, bytes('00' + kGolden));
  page.later(50);
  await answer(port, 1, { brightness: 9 });
  const able = () => ['resolution', 'mice', 'gamepads'].map((id) => !page.id(id).disabled);
  assert.deepEqual(able(), [false, false, false]);
  await page.id('hid').onclick();
  device.report(unstuffed([...bytes(kGolden)]));
  for (let i = 0; i < 5; ++i) page.later(1001);
  assert.deepEqual(able(), [true, true, true]);
});

test('a controller that takes no commands is not asked', async () => {
  const device = Object.assign(new Device(), { collections: [{ usagePage: 0xff00, outputReports: [] }] });
  const page = new Page({ hid: hidApi(device), serial: serialApi(null) });
  await page.id('hid').onclick();
  device.report(unstuffed([...bytes(kGolden)]));
  page.later(50);
  await settled();
  assert.deepEqual([device.written.length, page.id('told').textContent, page.id('send').disabled],
    [0, 'This controller has no settings.', true]);
});

// CRC-16/CCITT-FALSE as in wire/tests: of "123456789" 29B1h.
function sealed(body) {
  const crc = crcOf(body);
  return [...body, crc & 0xff, crc >> 8];
}
function crcOf(body) {
  let crc = 0xffff;
  for (let bit = 0; bit < 8 * body.length; ++bit) {
    const fed = (crc >> 15) ^ (body[bit >> 3] >> (7 - (bit & 7)) & 1);
    crc = (crc << 1 & 0xffff) ^ (fed ? 0x1021 : 0);
  }
  return crc;
}
// Its codes say where the zeros were.
function unstuffed(coded) {
  assert.equal(coded.at(-1), 0);
  assert.ok(!coded.slice(0, -1).includes(0));
  const plain = [];
  for (let at = 0; at < coded.length - 1; at += coded[at]) {
    if (at > 0) plain.push(0);
    plain.push(...coded.slice(at + 1, at + coded[at]));
  }
  return plain;
}

test('the helpers of this test agree with the golden bytes', () => {
  assert.equal(crcOf([...'123456789'].map((c) => c.charCodeAt(0))), 0x29b1);
  assert.equal(unstuffed([...bytes(kGolden)]).length, 46);
  assert.deepEqual(sealed([1, 3, 0, 0, 0, 0, 0, 0, 20, 64, 0x81, 1, 0, 0]).slice(14), [0x5f, 0x8c]);
});

test('only lines behind which our firmware may be are offered, and choosing none says nothing', async () => {
  const serial = serialApi(null);
  const page = new Page({ serial, hid: hidApi() });
  const before = page.id('state').textContent;
  await page.id('serial').onclick();
  assert.ok(serial.filters.some(({ usbVendorId, usbProductId }) => usbVendorId === 0x2341 && usbProductId === 0x42));
  assert.ok(serial.filters.every(({ usbProductId }) => usbProductId !== undefined));
  assert.equal(page.id('state').textContent, before);
});

test('troubles are said: in use, silent, no frames, unplugged, no way to controllers', async () => {
  const { page: busy } = await connected({ refuses: 'Failed to open serial port.' });
  assert.match(busy.id('state').textContent, /cannot be opened \(Failed to open serial port\.\): end the server .*dialout/);
  assert.equal(busy.id('state').className, 'bad');

  const { port, serial, page } = await connected();
  page.later(4100);
  assert.match(page.id('state').textContent, /sends nothing/);
  await receive(port, bytes('00' + kBroken));
  page.later(50);
  assert.match(page.id('state').textContent, /sends no valid frames/);
  await receive(port, bytes(kGolden));
  page.later(50);
  assert.equal(page.id('state').className, 'good');
  unplug(port, serial);
  await settled();
  page.later(50);
  assert.match(page.id('state').textContent, /unplugged/);
  assert.equal(page.id('send').disabled, true);

  assert.match(new Page({}).id('state').textContent, /no WebHID and no Web Serial: .*Chromium/);
  assert.match(new Page({ secure: false }).id('state').textContent, /open the file from the disk/);
});

test('one controller at a time: connecting a second line closes the first', async () => {
  const { port, serial, page } = await connected();
  const other = new Port();
  serial.requestPort = async () => other;
  await page.id('serial').onclick();
  assert.equal(port.opened, null);
  await receive(other, bytes('00' + kGolden));
  page.later(50);
  assert.equal(page.id('state').className, 'good');
});

test('a line that was allowed before is opened without a question', async () => {
  const port = new Port();
  new Page({ serial: serialApi(null, [port]) });
  await settled();
  assert.equal(port.opened?.baudRate, 1000000);
});

test('over HID the page shows and sends the same, also when it is connected twice', async () => {
  const device = new Device(), hid = hidApi(device);
  const page = new Page({ hid, serial: serialApi(null) });
  await page.id('hid').onclick();
  await page.id('hid').onclick();
  const frame = unstuffed([...bytes(kGolden)]);
  const later = sealed([...frame.slice(0, 2), frame[2] + 2, ...frame.slice(3, 28), frame[28] + 5, ...frame.slice(29, 44)]);
  device.report(frame);
  device.report(later);
  page.later(50);
  assert.equal(page.id('state').textContent, 'Space Foosball rods is connected.');
  await settled();
  const [, ...asked] = device.written[0];
  assert.deepEqual(asked.slice(0, 16), tell(asked[2]));
  device.report(settingsReport(asked[2], { abilities: 3 }));
  assert.deepEqual(page.rods[5].slice(2, 4), [5, 0]);
  assert.match(page.id('faults').textContent, /^lost 1, not a frame 0,/);
  page.id('motors').children[0].onclick();
  await settled();
  assert.deepEqual(device.written[1].slice(0, 17), [0, ...sealed([1, 1, 0, 0, 0, 128, 60, 0, 0, 0, 0, 0, 0, 0])]);
  assert.equal(device.written[1].length, 65);
  hid.dispatchEvent(Object.assign(new Event('disconnect'), { device }));
  await settled();
  page.later(50);
  assert.match(page.id('state').textContent, /unplugged/);
});
