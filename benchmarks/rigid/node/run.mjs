// The main of the engines that node runs: node run.mjs ENGINE SCENE.json HZ CPU_SECONDS FILE. It says and
// is told the same lines, and writes the same file, as benchmarks/rigid/runner.cpp, which describes them.
import { readFileSync, readSync, writeFileSync, writeSync } from 'node:fs';

const [engineName, sceneFile, hz, cpuSeconds, file] = process.argv.slice(2);

function say(word, text = '') {
  writeSync(1, `${word} ${text}\n`);
}

function* lines() {
  const bytes = Buffer.alloc(256);
  let received = '';
  for (;;) {
    let got;
    try {
      got = readSync(0, bytes);
    } catch (error) {
      if (error.code === 'EAGAIN') continue;
      throw error;
    }
    if (got === 0) return;
    received += bytes.toString('utf8', 0, got);
    for (let at; (at = received.indexOf('\n')) >= 0; received = received.slice(at + 1)) yield received.slice(0, at);
  }
}

// Of the process: node gives no thread's own. Its helpers have work only while code is being compiled.
function cpuMicroseconds() {
  const used = process.cpuUsage();
  return used.user + used.system;
}

// The most that was resident at once. Not by resourceUsage(), which begins at what the parent had.
function peakMegabytes() {
  return Number(/VmHWM:\s*(\d+)/.exec(readFileSync('/proc/self/status', 'utf8'))?.[1] ?? 0) / 1024;
}

class Run {
  constructor(scene, engine, rate, budget) {
    Object.assign(this, { scene, engine, budget, dt: 1 / rate, steps: Math.round(scene.seconds * rate) });
    Object.assign(this, { done: 0, spent: 0, happened: 0, times: [], beforeLast: null });
  }

  step(keep) {
    const { events, launches } = this.scene;
    while (this.happened < events.length && events[this.happened].time <= (this.done + 0.5) * this.dt) {
      const { kind, index } = events[this.happened++];
      if (kind === 'launch') this.engine.launch(launches[index]);
      else this.engine[kind](index);
    }
    if (this.done + 1 === this.steps) this.beforeLast = this.positions();
    const begun = cpuMicroseconds();
    this.engine.step();
    const took = cpuMicroseconds() - begun;
    this.spent += took;
    if (keep) this.times.push(took);
    ++this.done;
  }

  turn(count) {
    for (let i = 0; i < count && this.done < this.steps; ++i) {
      this.step(i > 0 || count < 10);
      if (this.spent > this.budget && this.done < this.steps) return 'budget';
    }
    return this.done === this.steps ? 'finished' : null;
  }

  // What does not exist has the pose of its start.
  pose(i) {
    const { position, rotation } = this.scene.bodies[i].pose;
    return this.engine.pose(i) ?? { p: position, q: rotation };
  }

  positions() {
    return this.scene.bodies.map((_, i) => this.pose(i).p);
  }

  // As in runner.cpp.
  fastest() {
    if (this.done < this.steps) return -1;
    let longest = 0;
    for (const [i, body] of this.scene.bodies.entries()) {
      if (body.motion !== 'dynamic') continue;
      const { p } = this.pose(i), q = this.beforeLast[i];
      longest = Math.max(longest, Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    }
    return longest / this.dt;
  }

  // A pose is { p: [x, y, z], q: [x, y, z, w] }; written as the columns of the rotation and the position.
  write() {
    const out = [`simulated ${this.done * this.dt}`, `rss_mb ${peakMegabytes()}`,
      `fastest ${this.fastest()}`, `steps ${this.times.length}`, ...this.times, `poses ${this.scene.bodies.length}`];
    for (let i = 0; i < this.scene.bodies.length; ++i) {
      const { p, q: [x, y, z, w] } = this.pose(i);
      const s = 2 / (x * x + y * y + z * z + w * w);
      out.push([1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y),
        s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x),
        s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y), ...p].join(' '));
    }
    writeFileSync(file, out.concat('whole', '').join('\n'));
  }
}

async function main() {
  const scene = JSON.parse(readFileSync(sceneFile, 'utf8'));
  if (scene.bodies.some((b) => b.parts.some((part) => part.shape.kind === 'terrain'))) {
    return say('cannot', 'this comparison gives it no terrain');
  }
  const { make } = await import(`./${engineName}.mjs`);
  const engine = await make(scene, 1 / Number(hz));
  say('ready', engine.settings);
  const run = new Run(scene, engine, Number(hz), 1e6 * Number(cpuSeconds));
  for (const line of lines()) {
    const why = run.turn(Number(line));
    if (!why) {
      say('more');
      continue;
    }
    run.write();
    return say('end', why);
  }
}

main().then(() => process.exit(0), (error) => {
  console.error(error);
  say('cannot', `${error.message ?? error}`.split('\n')[0]);
  process.exit(1);
});
