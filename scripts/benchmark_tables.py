#!/usr/bin/env python3
"""Puts the figures of benchmarks/results/*/NAME.csv into docs/benchmarks.md, between

    <!-- figures: NAME -->    and    <!-- end of figures -->

so that it never says what was not measured. With --check it changes nothing and fails where
it and the files differ, or where a picture over a table was drawn from another file.
With --self-test it checks itself, on small trees.
"""
import argparse
import csv
import hashlib
import re
import sys
import tempfile
from pathlib import Path

import rigid_tables
from rigid_tables import grid, in_order

ROOT = Path(__file__).resolve().parent.parent
BLOCK = re.compile(r'(<!-- figures: (\w+) -->\n)(.*?)(<!-- end of figures -->)', re.S)
PAGE = 'docs/benchmarks.md'
COLUMNS = ['subject', 'engine', 'metric', 'value', 'unit']


def flat(rows):
    lines = ['| subject | engine | metric | value |', '| --- | --- | --- | ---: |']
    lines += [f'| {r["subject"]} | {r["engine"]} | {r["metric"]} | {r["value"]} {r["unit"]} |'.replace(' |  |', ' | |')
              for r in rows]
    return [*lines, '']


def verdicts(rows, ours='Virtual Physics'):
    """What was reached beside its goal, which is at most that."""
    value = {(r['subject'], r['engine'], r['metric']): r['value'] for r in rows}
    lines = ['| what | of | reached | goal | |', '| --- | --- | ---: | ---: | --- |']
    for r in rows:
        reached = value.get((r['subject'], ours, r['metric']))
        if r['engine'] == 'goal' and reached:
            verdict = 'met' if float(reached) <= float(r['value']) else 'short'
            lines.append(f'| {r["metric"].replace("_", " ")} | {r["subject"]} | {reached} | '
                         f'{r["value"]} {r["unit"]} | {verdict} |'.replace('  |', ' |'))
    return [*lines, '']


def multibody(rows):
    """Times by model and engine, batches by model and lanes, and what was reached beside its goal."""
    value = {(r['subject'], r['engine'], r['metric']): r['value'] for r in rows}
    engines = in_order(r['engine'] for r in rows if r['metric'] == 'forward_us')
    models = in_order(r['subject'] for r in rows if r['metric'] == 'forward_us')
    lines = []
    for metric, title in [('forward_us', 'forward dynamics [us]'), ('inverse_us', 'inverse dynamics [us]'),
                          ('mass_us', 'mass matrix [us]')]:
        lines += grid(title, models, engines, lambda model, engine: value.get((model, engine, metric)))
    lanes = in_order(m.group(1) for r in rows if (m := re.fullmatch(r'forward_batch_(\w+)_us', r['metric'])))
    lines += grid('forward dynamics in batches [us a state]', models, lanes,
                  lambda model, lane: value.get((model, 'Virtual Physics', f'forward_batch_{lane}_us')))
    for call in ('forward', 'inverse'):
        lanes = in_order(m.group(1) for r in rows
                         if (m := re.fullmatch(rf'{call}_derivatives_(double\d*|float\d*)_us', r['metric'])))
        if lanes:
            lines += grid(f'derivatives of {call} dynamics, of one state and in packs [us a state]', models, lanes,
                          lambda model, lane: value.get((model, 'Virtual Physics', f'{call}_derivatives_{lane}_us')))
    return [*lines, *verdicts(rows)]


def robots(rows):
    """Each metric by robot and engine, and what was reached beside its goal."""
    value = {(r['subject'], r['engine'], r['metric']): r['value'] for r in rows}
    names = in_order(r['subject'] for r in rows)
    lines = []
    for metric, title in [('step_us', 'median step [us]'), ('penetration_mm', 'deepest penetration [mm]'),
                          ('speed_at_end', 'fastest joint at the end [rad/s]')]:
        lines += grid(title, names, ['Virtual Physics', 'MuJoCo'],
                      lambda name, engine: value[name, engine, metric])
    return [*lines, *verdicts(rows)]


def threads(rows):
    """The mean step by scene and number of threads, and what was reached beside its goal."""
    value = {(r['subject'], r['metric']): r['value'] for r in rows}
    counts = in_order(m.group(1) for r in rows if (m := re.fullmatch(r'step_mean_(\d+)_us', r['metric'])))
    return [*grid('mean step by number of threads [us]', in_order(r['subject'] for r in rows), counts,
                  lambda subject, count: value.get((subject, f'step_mean_{count}_us'))), *verdicts(rows)]


def operations(rows):
    value = {(r['subject'], r['engine'], r['metric']): r['value'] for r in rows}

    def cell(subject, engine):
        return f'{value[subject, engine, "multiplications"]} / {value[subject, engine, "additions"]}'
    return grid('multiplications / additions', in_order(r['subject'] for r in rows),
                in_order(r['engine'] for r in rows), cell)


# What ./bench draws of a comparison: shown over its tables once it is there.
PICTURES = {'rigid': ('rigid-step-times.png', 'Time of a step by scene and engine'),
            'scaling': ('rigid-scaling.png', 'Time of a step by number of bodies')}
# Of ./bench's comparisons.
LAYOUTS = {'loop': flat, 'multibody': multibody, 'robots': robots, 'operations': operations, 'rigid': rigid_tables.rigid,
           'scaling': rigid_tables.scaling, 'threads': threads}


def picture(name, files, root):
    """The lines that show it, if there is one; it says of which file it was drawn."""
    file, title = PICTURES.get(name, ('', ''))
    path = root / 'docs/pictures' / file
    if not file or not path.exists():
        return []
    drawn = path.read_bytes()
    if not any(hashlib.sha256(f.read_bytes()).hexdigest().encode() in drawn for f in files):
        raise ValueError(f'docs/pictures/{file} was drawn from figures that are not kept: run '
                         f'scripts/pictures.sh plots')
    return [f'![{title}](pictures/{file})', '']


def table(name, root):
    if name not in LAYOUTS:
        raise ValueError(f'{PAGE} asks for figures of {name}; there are {", ".join(LAYOUTS)}')
    files = sorted((root / 'benchmarks/results').glob(f'*/{name}.csv'))
    if not files:
        return f'Not measured yet; `./bench {name}` does it.'
    lines = picture(name, files, root)
    for path in files:
        with path.open(newline='') as file:
            rows = list(csv.DictReader(file))
        if not rows or list(rows[0]) != COLUMNS:
            raise ValueError(f'{path.relative_to(root)}: expected the columns {",".join(COLUMNS)}')
        lines += [f'On {path.parent.name}:', '', *LAYOUTS[name](rows)]
    return '\n'.join(lines)


def filled(text, root):
    return BLOCK.sub(lambda m: m.group(1) + table(m.group(2), root).rstrip() + '\n' + m.group(4), text)


def self_test():
    """A tree whose page is filled; then what must be found amiss in it, each by itself."""
    wrong = []

    def expect(what, root, wanted):
        page = root / PAGE
        try:
            text = page.read_text()
            found = 'same' if filled(text, root) == text else 'differs'
        except ValueError as error:
            found = str(error)
        if wanted not in found:
            wrong.append(f'{what}: expected "{wanted}", found "{found}"')

    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        page, kept = root / PAGE, root / 'benchmarks/results/cpu/scaling.csv'
        drawn = root / 'docs/pictures/rigid-scaling.png'
        for path in (kept, drawn):
            path.parent.mkdir(parents=True)
        empty = 'before\n<!-- figures: scaling -->\n<!-- end of figures -->\nafter\n'
        page.write_text(filled(empty, root))
        expect('nothing measured', root, 'same')
        if 'Not measured yet; `./bench scaling`' not in page.read_text():
            wrong.append('the page does not say that nothing is measured')
        figures = ','.join(COLUMNS) + '\nheap1000@60,Virtual Physics,step_settled_us,1500,us\n'
        kept.write_text(figures)
        expect('the first figures', root, 'differs')
        page.write_text(filled(page.read_text(), root))
        expect('filled in', root, 'same')
        if '| 1,000 | 1.50 |' not in page.read_text() or not page.read_text().startswith('before\n<!--'):
            wrong.append('the page is not as its figures')
        kept.write_text(figures.replace('1500', '1600'))
        expect('other figures', root, 'differs')
        kept.write_text(figures)
        drawn.write_bytes(b'of ' + hashlib.sha256(kept.read_bytes()).hexdigest().encode())
        page.write_text(filled(page.read_text(), root))
        expect('with its picture', root, 'same')
        drawn.write_bytes(b'of others')
        expect('a picture of other figures', root, 'scripts/pictures.sh plots')
        drawn.unlink()
        expect('no picture', root, 'differs')
        kept.write_text('a,b\n1,2\n')
        expect('other columns', root, 'expected the columns')
        page.write_text(empty.replace('scaling', 'scalling'))
        expect('no such comparison', root, 'scalling')
    for line in wrong:
        print(line, file=sys.stderr)
    print(f'figures, self-test: {len(wrong)} wrong')
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=f'Tables of {PAGE} from benchmarks/results.')
    parser.add_argument('--check', action='store_true')
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('--root', type=Path, default=ROOT)
    args = parser.parse_args()
    if args.self_test:
        return self_test()
    page = args.root / PAGE
    text = page.read_text()
    try:
        wanted = filled(text, args.root)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    blocks = len(BLOCK.findall(text))
    if args.check:
        print(f'figures: {blocks} tables in {PAGE}, {"all as measured" if wanted == text else "out of date"}')
        if wanted != text:
            print(f'{PAGE} differs from benchmarks/results: run scripts/benchmark_tables.py', file=sys.stderr)
        return wanted != text
    page.write_text(wanted)
    print(f'figures: {blocks} tables written into {PAGE}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
