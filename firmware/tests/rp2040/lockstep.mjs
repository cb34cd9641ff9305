// The simulated RP2040 in the hands of another program: each line that comes in is a millisecond, each
// line that goes out what happened in it. In: {to: the surface under each sensor [counts since power-on;
// slide and spin of each rod], marks: those under their switches, commands: [hex], troubles: [{kind, rod, ms}]}. Out: {now, packets: [[us,
// hex]], motors: [[us, rod, amplitude]], told: [[rod, us, slide, spin]], resets}.
import { readSync, writeSync } from 'node:fs';
import { Rig, kRods } from './rig.mjs';

const kMsNanos = 1e6;
const kCommandNanos = 0.1e6; // into the millisecond: when the host hands a command over, one a frame

const rig = new Rig();
const { board, host, motors, sensors } = rig;
let from = new Array(16).fill(0);
let to = from;
let began = 0;
let told = [];
const handed = kRods.map(() => [0, 0]);
const commands = [];
const later = []; // {at, act}
const written = motors.drivers.map(() => 0);

// A sensor that is read has seen what passed until now.
for (const sensor of sensors.sensors) {
  const { index } = sensor;
  const latch = sensor.latch.bind(sensor);
  const follow = () => {
    const part = Math.min(Math.max((board.clock.nanos - began) / kMsNanos, 0), 1);
    const whole = [0, 1].map((axis) => {
      const i = 2 * index + axis;
      return Math.floor(from[i] + (to[i] - from[i]) * part);
    });
    sensor.move(whole[0] - handed[index][0], whole[1] - handed[index][1]);
    handed[index] = whole;
  };
  sensor.latch = () => {
    follow();
    told.push([index, Math.floor(board.clock.nanos / 1e3), ...handed[index]]);
    return latch();
  };
}

const after = (ms, act) => later.push({ at: board.clock.nanos + ms * kMsNanos, act });
const troubles = {
  unplug({ rod, ms }) {
    const sensor = sensors.sensors[rod];
    sensor.unplug();
    after(ms, () => sensor.plug());
  },
  supply({ rod }) {
    sensors.sensors[rod].power();
  },
  stuck({ rod, ms, level }) {
    const sensor = sensors.sensors[rod];
    sensor.stuck = level;
    sensors.drive();
    after(ms, () => {
      sensor.stuck = undefined;
      sensors.drive();
    });
  },
  // The program jumps to itself with interrupts off: only the watchdog helps.
  hang() {
    board.rp2040.writeUint16(board.core.PC & ~1, 0xe7fe);
    board.core.PM = true;
    board.core.waiting = false;
  },
};

function runTo(end) {
  while (board.clock.nanos < end) {
    board.run(Math.min(end - board.clock.nanos, 50e3));
    if (!host.configured && host.isAttached) host.enumerate();
    for (let i = later.length - 1; i >= 0; --i) {
      if (later[i].at <= board.clock.nanos) later.splice(i, 1)[0].act();
    }
  }
}

let end = 0;
let troubled = false; // a sensor that is plugged in amid a transfer sees a part of it
function step(request) {
  from = to;
  to = request.to;
  began = end;
  if (request.marks !== undefined) {
    motors.expander = true;
    motors.under = request.marks;
  }
  for (const hex of request.commands ?? []) commands.push(Buffer.from(hex, 'hex'));
  for (const trouble of request.troubles ?? []) {
    troubles[trouble.kind](trouble);
    troubled = true;
  }
  runTo(began + kCommandNanos);
  if (commands.length && host.configured && host.sendReport(commands[0])) commands.shift();
  end = began + kMsNanos;
  runTo(end);
  const us = (nanos) => Math.floor(nanos / 1e3);
  const answer = {
    now: us(end),
    packets: host.take().map(({ at, bytes }) => [us(at), Buffer.from(bytes).toString('hex')]),
    motors: motors.drivers.flatMap((driver, rod) => {
      const fresh = driver.writes.slice(written[rod]);
      written[rod] = driver.writes.length;
      return fresh.map(({ at, value }) => [us(at), rod, value]);
    }),
    told,
    resets: board.resets,
    faults: [...board.faults, ...host.faults, ...(troubled ? [] : sensors.violations)].slice(0, 5),
  };
  told = [];
  return answer;
}

const chunk = Buffer.alloc(1 << 16);
let line = '';
for (;;) {
  const size = readSync(0, chunk);
  if (size === 0) break;
  line += chunk.toString('latin1', 0, size);
  for (let at = line.indexOf('\n'); at >= 0; at = line.indexOf('\n')) {
    const answer = Buffer.from(`${JSON.stringify(step(JSON.parse(line.slice(0, at))))}\n`);
    line = line.slice(at + 1);
    for (let sent = 0; sent < answer.length;) sent += writeSync(1, answer, sent);
  }
}
