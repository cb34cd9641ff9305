#!/usr/bin/env python3
"""Puts the figures of benchmarks/results/*/NAME.csv into README.md, between

    <!-- figures: NAME -->    and    <!-- end of figures -->

so that README never says what was not measured. With --check it changes nothing and fails where
README and the files differ.
"""
import argparse
import csv
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BLOCK = re.compile(r'(<!-- figures: (\w+) -->\n)(.*?)(<!-- end of figures -->)', re.S)
COLUMNS = ['subject', 'engine', 'metric', 'value', 'unit']


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
    return [*lines, *verdicts(rows)]


def operations(rows):
    value = {(r['subject'], r['engine'], r['metric']): r['value'] for r in rows}

    def cell(subject, engine):
        return f'{value[subject, engine, "multiplications"]} / {value[subject, engine, "additions"]}'
    return grid('multiplications / additions', in_order(r['subject'] for r in rows),
                in_order(r['engine'] for r in rows), cell)


def rigid(rows):
    """By scene and rate: times, how many bodies are in place, penetration and drift; then the goals."""
    value = {(r['subject'], r['engine'], r['metric']): r['value'] for r in rows}
    ended = {(r['subject'], r['engine']): r['value'] == r['unit'].split()[1] for r in rows
             if r['metric'] == 'simulated_s'}
    engines = in_order(r['engine'] for r in rows if r['metric'] == 'step_median_us')
    subjects = in_order(r['subject'] for r in rows if r['engine'] in engines)
    lines = []
    for title, metrics in [('step, median / p99 [us]', ('step_median_us', 'step_p99_us')),
                           ('in place / penetration [mm] / drift [mm]', ('in_place', 'penetration_mm', 'drift_mm')),
                           ('peak memory [MB]', ('rss_mb',))]:
        def cell(subject, engine):
            found = [value.get((subject, engine, metric)) for metric in metrics]
            if found[0] is None:
                return None
            return ' / '.join(f or '-' for f in found) + ('' if ended.get((subject, engine)) else ' *')
        lines += grid(title, subjects, engines, cell)
    return [*lines, '\\* not to the end of the scene within its processor time', '', *verdicts(rows)]


# What ./bench draws of a comparison: shown over its tables once it is there.
PICTURES = {'rigid': ('rigid-step-times.png', 'Time of a step by scene and engine'),
            'scaling': ('rigid-scaling.png', 'Time of a step by number of bodies')}
LAYOUTS = {'multibody': multibody, 'operations': operations, 'rigid': rigid}  # all others: flat


def table(name, root):
    lines = []
    for path in sorted((root / 'benchmarks/results').glob(f'*/{name}.csv')):
        with path.open(newline='') as file:
            rows = list(csv.DictReader(file))
        if not rows or list(rows[0]) != COLUMNS:
            raise ValueError(f'{path.relative_to(root)}: expected the columns {",".join(COLUMNS)}')
        lines += [f'On {path.parent.name}:', '', *LAYOUTS.get(name, flat)(rows)]
    if not lines:
        raise ValueError(f'README.md shows {name}, which nobody has measured: run ./bench {name} and '
                         f'keep its file in benchmarks/results')
    picture, title = PICTURES.get(name, ('', ''))
    if picture and (root / 'docs/pictures' / picture).exists():
        lines[:0] = [f'![{title}](docs/pictures/{picture})', '']
    return '\n'.join(lines)


def main():
    parser = argparse.ArgumentParser(description='Figures of README.md from benchmarks/results.')
    parser.add_argument('--check', action='store_true')
    parser.add_argument('--root', type=Path, default=ROOT)
    args = parser.parse_args()
    readme = args.root / 'README.md'
    text = readme.read_text()
    try:
        wanted = BLOCK.sub(lambda m: m.group(1) + table(m.group(2), args.root).rstrip() + '\n' + m.group(4), text)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    blocks = len(BLOCK.findall(text))
    if args.check:
        print(f'figures: {blocks} tables in README.md, {"all as measured" if wanted == text else "out of date"}')
        if wanted != text:
            print('README.md differs from benchmarks/results: run scripts/readme_figures.py', file=sys.stderr)
        return wanted != text
    readme.write_text(wanted)
    print(f'figures: {blocks} tables written into README.md')
    return 0


if __name__ == '__main__':
    sys.exit(main())
