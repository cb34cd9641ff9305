#!/usr/bin/env python3
"""Tables of ./bench rigid and ./bench scaling, for benchmark_tables.py.

  scripts/rigid_tables.py --self-test    checks them against rows whose tables are known
"""
import math
import re
import sys

OURS, WASM, PEER = 'Virtual Physics', 'Virtual Physics (WebAssembly)', 'Bullet'
RATES = (60, 1000)  # shown; the files have 240 Hz too, and the goals are of all
# A step of Bullet's at 60 Hz where the goals at 1000 Hz were set [us].
PEER_WHEN_SET = {'towers1120': 3400, 'pyramid1128': 10300, 'pile1120': 13300}
CUT_SHORT = ('\\* not to the end of the scene within its processor time: as it was until then, and what still falls '
             "costs little; shares of Bullet's time are over the steps that both have made")
STANDING = ('out_of_place', 'penetration_mm', 'drift_mm')


def grid(corner, rows, columns, cell):
    """A table whose cells are told by cell(row, column); rows without any cell are left out."""
    lines = [f'| {corner} | {" | ".join(columns)} |', f'| --- |{" ---: |" * len(columns)}']
    for row in rows:
        cells = [cell(row, column) for column in columns]
        if any(cells):
            lines.append(f'| {row} | {" | ".join(c or "-" for c in cells)} |')
    return [*lines, '']


def in_order(words):
    return list(dict.fromkeys(words))


def listed(words):
    """a, b and c."""
    words = list(words)
    return ' and '.join([', '.join(words[:-1]), words[-1]] if words[1:] else words)


def number(text, digits=3):
    """With so many digits that count, never as 1.2e+05."""
    x = float(text)
    if not math.isfinite(x) or x == 0.0:
        return f'{x:g}'
    if abs(x) < 0.001:
        return '<0.001'
    return f'{x:.{max(0, digits - 1 - math.floor(math.log10(abs(x))))}f}'


class Runs:
    """Rows of a file, by scene, rate and engine."""

    def __init__(self, rows):
        self.rows = [r for r in rows if r['engine'] != 'goal']
        self.goals = [r for r in rows if r['engine'] == 'goal']
        self.value = {(r['subject'], r['engine'], r['metric']): r['value'] for r in self.rows}
        self.unit = {(r['subject'], r['engine'], r['metric']): r['unit'] for r in self.rows}
        self.engines = in_order(r['engine'] for r in self.rows if r['metric'] in ('step_median_us', 'missing'))
        self.subjects = in_order(r['subject'] for r in self.rows)
        self.scenes = in_order(s.partition('@')[0] for s in self.subjects)

    def ended(self, subject, engine):
        # The value is rounded to four digits.
        key = (subject, engine, 'simulated_s')
        return key in self.value and float(self.value[key]) > 0.999 * float(self.unit[key].split()[1])

    def mark(self, subject, engine):
        return '' if self.ended(subject, engine) else ' *'

    def shown(self, subject, engine, metric, digits=3):
        """Nothing where there is none; with a star if the run was not to the end."""
        text = self.value.get((subject, engine, metric))
        return text and number(text, digits) + self.mark(subject, engine)

    def in_place(self, subject, engine):
        key = (subject, engine, 'in_place')
        if key not in self.value:
            return '-'
        of = self.unit[key].split()[1]
        return 'all' if self.value[key] == of else f'{self.value[key]} of {of}'

    def where(self, subjects):
        """Scenes, with their rates if it is not all of them."""
        rates = {}
        for subject in subjects:
            scene, _, rate = subject.partition('@')
            rates.setdefault(scene, []).append(rate)
        return '; '.join(scene if len(of) == sum(s.startswith(f'{scene}@') for s in self.subjects)
                         else f'{scene} at {listed(of)} Hz' for scene, of in rates.items())

    def notes(self):
        """What the dashes and stars of the tables stand for."""
        lines = []
        if any(not self.ended(r['subject'], r['engine']) for r in self.rows if r['metric'] == 'step_median_us'):
            lines += [CUT_SHORT, '']
        missing = {}
        for r in self.rows:
            if r['metric'] == 'missing':
                missing.setdefault((r['engine'], r['value']), []).append(r['subject'])
        if missing:
            lines += ['Without figures:', '']
            lines += [f'- {engine}: {why} ({self.where(of)})' for (engine, why), of in missing.items()]
            lines += ['']
        return lines


def steps(runs, rate):
    """Median steps; of ours also the 99th percentile and the share of Bullet's."""
    own = {'its p99': ('step_p99_us', 4), f"its share of {PEER}'s": ('share_of_bullet', 3)}

    def cell(scene, column):
        metric, digits = own.get(column, ('step_median_us', 4))
        return runs.shown(f'{scene}@{rate}', OURS if column in own else column, metric, digits)
    others = [e for e in runs.engines if e != OURS]
    return grid(f'median step at {rate} Hz [us]', runs.scenes, [OURS, *own, *others], cell)


def standing(runs, rate):
    def cell(scene, engine):
        subject = f'{scene}@{rate}'
        if (subject, engine, 'in_place') not in runs.value:
            return None
        lengths = [runs.value.get((subject, engine, metric)) for metric in ('penetration_mm', 'drift_mm')]
        return ' / '.join([runs.in_place(subject, engine), *(number(x) if x else '-' for x in lengths)]) + \
            runs.mark(subject, engine)
    return grid(f'in place / penetration [mm] / drift [mm] at {rate} Hz', runs.scenes, runs.engines, cell)


def gaps(runs):
    def cell(row, engine):
        return runs.shown(row.replace(' at ', '@').removesuffix(' Hz'), engine, 'joint_gap_mm')
    rows = [f'{scene} at {rate} Hz' for scene in runs.scenes for rate in RATES]
    return grid('joints apart by [mm]', rows, runs.engines, cell)


def memory(runs):
    def cell(scene, engine):
        found = [runs.value.get((f'{scene}@{rate}', engine, 'rss_mb')) for rate in RATES]
        return max(filter(None, found), key=float, default=None)
    return grid('peak memory of the program [MB]', runs.scenes, runs.engines, cell)


def verdict(runs, subject, metrics, reached, goal, name, unit=''):
    """A goal's row, and whether it is met: by a run to its end, if it is one run's."""
    scene, _, rate = subject.partition('@')
    values = [runs.value.get((subject, OURS, metric)) for metric in metrics]
    limits = [g['value'] for metric in metrics for g in runs.goals if (g['subject'], g['metric']) == (subject, metric)]
    met = all(v is not None and float(v) <= float(limit) for v, limit in zip(values, limits))
    whole = metrics == ('growth_exponent',) or runs.ended(subject, OURS)
    met = met and whole
    where = f'{name} at {rate} Hz{f" [{unit}]" if unit else ""}'
    return met, f'{scene}, {where}', \
        f'| {where} | {scene} | {reached}{"" if whole or reached == "-" else " *"} | {goal} | ' \
        f'{"met" if met else "**short**"} |'


TITLES = {'step_median_us': ('median step', 'us'), 'share_of_bullet': ("step as a share of Bullet's", ''),
          'growth_exponent': ('p of the n^p that fits the cost of n boxes', '')}


def verdicts(runs):
    """What was reached beside its goal, which is at most that; what is short first in words."""
    wanted = {(g['subject'], g['metric']): g for g in runs.goals}
    found = []
    for (subject, metric), goal in wanted.items():
        if metric in TITLES:
            name, unit = TITLES[metric]
            reached = runs.value.get((subject, OURS, metric), '-')
            found.append(verdict(runs, subject, (metric,), reached, goal['value'], name, unit))
        elif metric == STANDING[0]:
            limits = [wanted[subject, m]['value'] for m in STANDING[1:]]
            values = [runs.value.get((subject, OURS, m), '-') for m in STANDING[1:]]
            found.append(verdict(runs, subject, STANDING, ' / '.join([runs.in_place(subject, OURS), *values]),
                                 ' / '.join(['all', *limits]), 'in place / penetration / drift', 'mm'))
        elif metric not in STANDING:
            raise ValueError(f'a goal that the tables do not know: {metric} of {subject}')
    if not found:
        return [], []
    short = [what for met, what, _ in found if not met]
    said = f'{len(found) - len(short)} of {len(found)} goals are met; short: {"; ".join(short)}.' if short else \
        f'All goals are met: {len(found)} of {len(found)}.'
    return [said, ''], ['| what | of | reached | goal, at most | |', '| --- | --- | ---: | ---: | --- |',
                        *(line for _, _, line in found), '']


def bits(runs):
    """Whether our WebAssembly build's poses are the native one's, of the runs that went as far."""
    simulated = {s: [runs.value.get((s, e, 'simulated_s')) for e in (OURS, WASM)] for s in runs.subjects}
    both = [s for s, (native, wasm) in simulated.items() if native and native == wasm]
    if not both:
        return []
    other = [s for s in both if (s, WASM, 'bits_as_native') not in runs.value]
    where = f'all {len(both)} runs that went as far.'
    if other:
        where = f'{len(both) - len(other)} of the {len(both)} runs that went as far; not in: {runs.where(other)}.'
    return [f'As WebAssembly {OURS} ends with the native poses, to the bit, in {where}', '']


def slower(runs, rates):
    """Where Bullet needs less."""
    where = [f'{scene} at {rate} Hz ({number(share)} times)' for rate in rates for scene in runs.scenes
             if (share := runs.value.get((f'{scene}@{rate}', OURS, 'share_of_bullet'))) and float(share) > 1.0]
    return [f"A step is dearer than {PEER}'s in {listed(where)}.", ''] if where else []


def beside(runs):
    """The goals at 1000 Hz are for a machine's speed, which Bullet tells."""
    now = {scene: runs.shown(f'{scene}@60', PEER, 'step_median_us', 4) for scene in PEER_WHEN_SET}
    scenes = [scene for scene in PEER_WHEN_SET if now[scene]]
    if not scenes:
        return []
    then = listed(str(PEER_WHEN_SET[s]) for s in scenes)
    return [f'In this run Bullet needs {listed(now[s] for s in scenes)} us a step of {listed(scenes)} at 60 Hz; '
            f'the goals at 1000 Hz are for a machine where it needs {then}.', '']


def rigid(rows):
    runs = Runs(rows)
    said, goals = verdicts(runs)
    rates = [rate for rate in RATES if any(s.endswith(f'@{rate}') for s in runs.subjects)]
    lines = [*said, *slower(runs, rates)]
    for table in (steps, standing):
        for rate in rates:
            lines += table(runs, rate)
    return [*lines, *gaps(runs), *memory(runs), *runs.notes(), *bits(runs), *goals, *beside(runs)]


def scaling(rows):
    """Steps by number of boxes; of ours also what n log n from the fewest on would be, and memory."""
    runs = Runs(rows)
    sizes = sorted(int(m.group(1)) for s in runs.subjects if (m := re.fullmatch(r'heap(\d+)@60', s)))

    def settled(n, engine=OURS):
        return runs.value.get((f'heap{n}@60', engine, 'step_settled_us'))

    def cell(row, column):
        n = int(row.replace(',', ''))
        if column == beside_n_log_n:
            first = sizes[0]
            if not settled(n) or not settled(first):
                return None
            line = float(settled(first)) * n * math.log(n) / (first * math.log(first))
            return f'{float(settled(n)) / line:.2f}'
        if column == of_memory:
            return runs.value.get((f'heap{n}@60', OURS, 'rss_mb'))
        us = settled(n, column)
        return us and number(float(us) / 1000.0)
    beside_n_log_n, of_memory = f'{OURS}, of n log n', f'{OURS}, peak memory [MB]'
    others = [e for e in runs.engines if e != OURS]
    lines = grid('boxes; median step once they lie [ms]', [f'{n:,}' for n in sizes],
                 [OURS, *others, beside_n_log_n, of_memory], cell)
    unfinished = {}
    for engine in runs.engines:
        for n in sizes:
            if (f'heap{n}@60', engine, 'step_median_us') in runs.value and not settled(n, engine):
                unfinished.setdefault(engine, []).append(f'{n:,}')
    if unfinished:
        of = '; '.join(f'{engine} with {listed(counts)}' for engine, counts in unfinished.items())
        lines += [f'Not to the end within its processor time: {of}.', '']
    memory_of = [float(m) for n in (sizes[0], sizes[-1]) if (m := cell(str(n), of_memory))] if sizes[1:] else []
    if len(memory_of) == 2:
        each = 1000.0 * (memory_of[1] - memory_of[0]) / (sizes[-1] - sizes[0])
        lines += [f'From {sizes[0]:,} to {sizes[-1]:,} boxes its memory grows by {number(each, 2)} kB a box, '
                  f'contacts and all.', '']
    said, goals = verdicts(runs)
    notes = [line for line in runs.notes() if not line.startswith('\\*')]
    return [*said, *lines, *notes, *goals]


def parsed(text):
    names = ('subject', 'engine', 'metric', 'value', 'unit')
    return [dict(zip(names, line.split(','))) for line in text.split()]


SAMPLE = '''\
towers1120@60,Virtual_Physics,step_median_us,618.49,us
towers1120@60,Virtual_Physics,step_p99_us,983.74,us
towers1120@60,Virtual_Physics,share_of_bullet,0.2395,
towers1120@60,Virtual_Physics,in_place,1120,of_1120
towers1120@60,Virtual_Physics,penetration_mm,0.456,mm
towers1120@60,Virtual_Physics,drift_mm,0.000148,mm
towers1120@60,Virtual_Physics,rss_mb,9,MB
towers1120@60,Virtual_Physics,simulated_s,10,of_10_s
towers1120@60,Bullet,step_median_us,1.2346e+05,us
towers1120@60,Bullet,step_p99_us,3980.8,us
towers1120@60,Bullet,in_place,266,of_1120
towers1120@60,Bullet,penetration_mm,nan,mm
towers1120@60,Bullet,drift_mm,739,mm
towers1120@60,Bullet,rss_mb,12,MB
towers1120@60,Bullet,simulated_s,8.65,of_10_s
towers1120@60,MuJoCo,missing,no_room,
towers1120@60,Virtual_Physics_(WebAssembly),step_median_us,2884.7,us
towers1120@60,Virtual_Physics_(WebAssembly),simulated_s,10,of_10_s
towers1120@60,Virtual_Physics,out_of_place,0,bodies
towers1120@60,goal,share_of_bullet,0.31,
towers1120@60,goal,out_of_place,0,bodies
towers1120@60,goal,penetration_mm,5,mm
towers1120@60,goal,drift_mm,5,mm
pyramid1128@60,Virtual_Physics,step_median_us,900,us
pyramid1128@60,Virtual_Physics,simulated_s,4,of_10_s
pyramid1128@60,goal,step_median_us,1000,us
pile1120@60,Virtual_Physics,missing,stopped,
pile1120@60,goal,step_median_us,1000,us
chain200@60,Virtual_Physics,step_median_us,70,us
chain200@60,Virtual_Physics,share_of_bullet,0.5004,
chain200@60,Virtual_Physics,joint_gap_mm,0.52,mm
chain200@60,Virtual_Physics,simulated_s,8.333,of_8.33333_s
chain200@60,goal,share_of_bullet,0.5,
chain200@1000,Virtual_Physics,share_of_bullet,1.5,
towers1120@240,Virtual_Physics,step_median_us,300,us
bridge@60,MuJoCo,missing,no_room,
'''
HEAPS = '''\
heap1000@60,Virtual_Physics,step_median_us,900,us
heap1000@60,Virtual_Physics,step_settled_us,1000,us
heap1000@60,Virtual_Physics,rss_mb,10,MB
heap1000@60,Virtual_Physics,simulated_s,4,of_4_s
heap100000@60,Virtual_Physics,step_median_us,150000,us
heap100000@60,Virtual_Physics,step_settled_us,250000,us
heap100000@60,Virtual_Physics,rss_mb,1000,MB
heap100000@60,Virtual_Physics,simulated_s,4,of_4_s
heap1000@60,Bullet,step_median_us,9000,us
heap100000@60,Bullet,step_median_us,900000,us
heap100000@60,Bullet,simulated_s,1,of_4_s
heaps@60,Virtual_Physics,growth_exponent,1.2,
heaps@60,goal,growth_exponent,1.11,
'''
# Lines that must be there.
EXPECTED = [
    (rigid, SAMPLE, [
        '| median step at 60 Hz [us] | Virtual Physics | its p99 | its share of Bullet\'s | Bullet | MuJoCo | '
        'Virtual Physics (WebAssembly) |',
        '| towers1120 | 618.5 | 983.7 | 0.239 | 123460 * | - | 2885 |',
        '| pyramid1128 | 900.0 * | - | - | - | - | - |',
        '| towers1120 | all / 0.456 / <0.001 | 266 of 1120 / nan / 739 * | - | - |',
        '| towers1120 | 9 | 12 | - | - |',
        '| chain200 at 60 Hz | 0.520 | - | - | - |',
        CUT_SHORT,
        '- MuJoCo: no room (towers1120 at 60 Hz; bridge)',
        '- Virtual Physics: stopped (pile1120)',
        'As WebAssembly Virtual Physics ends with the native poses, to the bit, in 0 of the 1 runs that went as far; '
        'not in: towers1120 at 60 Hz.',
        'A step is dearer than Bullet\'s in chain200 at 1000 Hz (1.50 times).',
        '2 of 5 goals are met; short: pyramid1128, median step at 60 Hz [us]; pile1120, median step at 60 Hz [us]; '
        'chain200, step as a share of Bullet\'s at 60 Hz.',
        '| step as a share of Bullet\'s at 60 Hz | towers1120 | 0.2395 | 0.31 | met |',
        '| in place / penetration / drift at 60 Hz [mm] | towers1120 | all / 0.456 / 0.000148 | all / 5 / 5 | met |',
        '| median step at 60 Hz [us] | pyramid1128 | 900 * | 1000 | **short** |',
        '| median step at 60 Hz [us] | pile1120 | - | 1000 | **short** |',
        '| step as a share of Bullet\'s at 60 Hz | chain200 | 0.5004 | 0.5 | **short** |',
        'In this run Bullet needs 123460 * us a step of towers1120 at 60 Hz; the goals at 1000 Hz are for a machine '
        'where it needs 3400.']),
    (rigid, SAMPLE.replace('out_of_place,0', 'out_of_place,1', 1).replace('in_place,1120', 'in_place,1119', 1), [
        '| in place / penetration / drift at 60 Hz [mm] | towers1120 | 1119 of 1120 / 0.456 / 0.000148 | '
        'all / 5 / 5 | **short** |']),
    (scaling, HEAPS.replace('growth_exponent,1.2', 'growth_exponent,1.1'), ['All goals are met: 1 of 1.']),
    (scaling, HEAPS, [
        '| boxes; median step once they lie [ms] | Virtual Physics | Bullet | Virtual Physics, of n log n | '
        'Virtual Physics, peak memory [MB] |',
        '| 1,000 | 1.00 | - | 1.00 | 10 |',
        '| 100,000 | 250 | - | 1.50 | 1000 |',
        '0 of 1 goals are met; short: heaps, p of the n^p that fits the cost of n boxes at 60 Hz.',
        'Not to the end within its processor time: Bullet with 1,000 and 100,000.',
        'From 1,000 to 100,000 boxes its memory grows by 10 kB a box, contacts and all.',
        '| p of the n^p that fits the cost of n boxes at 60 Hz | heaps | 1.2 | 1.11 | **short** |']),
]


def self_test():
    wrong = []
    for layout, text, lines in EXPECTED:
        rows = [{k: v.replace('_', ' ') if k != 'metric' else v for k, v in r.items()} for r in parsed(text)]
        made = layout(rows)
        wrong += [f'{layout.__name__}: this line is not made: {line}' for line in lines if line not in made]
    for line in wrong:
        print(line, file=sys.stderr)
    print(f'rigid tables, self-test: {sum(len(lines) for _, _, lines in EXPECTED)} lines, {len(wrong)} not made')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(self_test())
