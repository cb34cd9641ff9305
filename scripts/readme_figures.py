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


def table(name, root):
    lines = []
    for path in sorted((root / 'benchmarks/results').glob(f'*/{name}.csv')):
        with path.open(newline='') as file:
            rows = list(csv.DictReader(file))
        if not rows or list(rows[0]) != COLUMNS:
            raise ValueError(f'{path.relative_to(root)}: expected the columns {",".join(COLUMNS)}')
        lines += [f'On {path.parent.name}:', '', '| subject | engine | metric | value |',
                  '| --- | --- | --- | ---: |']
        lines += [f'| {r["subject"]} | {r["engine"]} | {r["metric"]} | {r["value"]} {r["unit"]} |'.replace(' |  |', ' | |')
                  for r in rows]
        lines.append('')
    if not lines:
        raise ValueError(f'README.md shows {name}, which nobody has measured: run ./bench {name} and '
                         f'keep its file in benchmarks/results')
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
