#!/usr/bin/python3
"""Draws what `space-foosball-match --study --csv STUDY.csv` has measured.

  scripts/plot_study.py STUDY.csv FOLDER   FOLDER/tuning-one.svg, one value at a time;
                                           FOLDER/tuning-trade.svg, all points: goals beside hops
  scripts/plot_study.py --table STUDY.csv  the change of each figure over a value's studied
                                           range: least squares over all points, with its standard error
  scripts/plot_study.py --self-test        checks what is drawn, not how: without matplotlib
"""
import argparse
import csv
import io
import sys
from collections import defaultdict

LAYOUTS = {'tournament': '#0b1e4d', 'paper': '#e8955f'}
# Column of the study, label, goal (low, high).
FIGURES = (
    ('goals a minute of play', 'goals/min', (3.0, None)),
    ('hop, median', 'hop median [mm]', (20.0, 45.0)),
    ('hop, 90th percentile', 'hop 90 % [mm]', (80.0, 160.0)),
    ('nobody can reach the ball', 'out of reach [%]', (None, 10.0)),
    ('ball still', 'ball still [%]', (None, 5.0)),
    ('balls out', 'balls out/min', (None, 1.0)),
    ('playability', 'playability', (None, None)),
)


def read(text):
    """[(layout, kind, {value: setting}, {figure: result})], a point and layout each."""
    points, order = {}, []
    for row in csv.DictReader(io.StringIO(text)):
        if row['section'] not in points:
            points[row['section']] = {}
            order.append(row['section'])
        if row['value']:
            points[row['section']][row['figure'].strip()] = float(row['value'])
    out = []
    for section in order:
        layout, _, name = section.partition('; ')
        kind, *settings = name.split(' ')
        values = {key: float(value) for key, value in (s.split('=') for s in settings)}
        out.append((layout, kind, values, points[section]))
    return out


def one_at_a_time(points, figure):
    """{value: {layout: [(setting, result)]}}"""
    lines = defaultdict(lambda: defaultdict(list))
    for layout, kind, values, results in points:
        if kind == 'one' and figure in results:
            ((name, setting),) = values.items()
            lines[name][layout].append((setting, results[figure]))
    for by_layout in lines.values():
        for line in by_layout.values():
            line.sort()
    return lines


def solve(matrix, columns):
    """The columns of matrix^-1 columns, by elimination with pivots; both are lists of rows."""
    n = len(matrix)
    rows = [list(matrix[i]) + list(columns[i]) for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        if abs(rows[pivot][i]) < 1e-12:
            return None
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for r in range(n):
            if r != i:
                rows[r] = [x - rows[r][i] * y for x, y in zip(rows[r], rows[i])]
    return [row[n:] for row in rows]


def fit(points, layout, figure):
    """Least squares over all points of a layout, a plane about the defaults: {value: (change of the
    figure from one end of the studied range to the other, its standard error)}."""
    defaults = next((v for l, k, v, _ in points if l == layout and k == 'defaults'), {})
    chosen = [({**defaults, **v}, r[figure]) for l, _, v, r in points if l == layout and figure in r]
    names = [n for n in defaults if len({v[n] for v, _ in chosen}) > 1]
    ranges = [max(v[n] for v, _ in chosen) - min(v[n] for v, _ in chosen) for n in names]
    rows = [[1.0] + [(v[n] - defaults[n]) / r for n, r in zip(names, ranges)] for v, _ in chosen]
    results = [y for _, y in chosen]
    size = len(names) + 1
    if len(rows) <= size:
        return {}
    normal = [[sum(row[i] * row[j] for row in rows) for j in range(size)] for i in range(size)]
    right = [sum(row[i] * y for row, y in zip(rows, results)) for i in range(size)]
    unit = [[1.0 if i == j else 0.0 for j in range(size)] for i in range(size)]
    solved = solve(normal, [[y] + u for y, u in zip(right, unit)])
    if solved is None:
        return {}
    best = [row[0] for row in solved]
    left = sum((y - sum(b * x for b, x in zip(best, row))) ** 2 for row, y in zip(rows, results))
    variance = left / (len(rows) - size)
    errors = [(variance * solved[i][1 + i]) ** 0.5 for i in range(size)]
    return {name: (best[1 + i], errors[1 + i]) for i, name in enumerate(names)}


def table(points):
    return [(name, layout, label, change, error)
            for figure, label, _ in FIGURES for layout in LAYOUTS
            for name, (change, error) in fit(points, layout, figure).items()]


def draw(points, folder):
    import matplotlib
    matplotlib.use('svg')
    matplotlib.rcParams['svg.hashsalt'] = 'study'
    import matplotlib.pyplot as plt
    names = list(one_at_a_time(points, FIGURES[0][0]))
    picture, axes = plt.subplots(len(FIGURES), len(names), figsize=(2.1 * len(names), 1.8 * len(FIGURES)), sharey='row',
                                 sharex='col', squeeze=False)
    for row, (figure, label, (low, high)) in enumerate(FIGURES):
        lines = one_at_a_time(points, figure)
        axes[row][0].set_ylabel(label)
        for column, name in enumerate(names):
            ax = axes[row][column]
            for layout, colour in LAYOUTS.items():
                line = lines[name][layout]
                ax.plot([x for x, _ in line], [y for _, y in line], '.-', color=colour, label=layout)
            for bound in (low, high):
                if bound is not None:
                    ax.axhline(bound, color='#888888', linewidth=0.8, linestyle='--')
            if row + 1 == len(FIGURES):
                ax.set_xlabel(name)
    axes[0][0].legend(fontsize='small')
    picture.tight_layout()
    picture.savefig(f'{folder}/tuning-one.svg', metadata={'Date': None})
    picture, ax = plt.subplots(figsize=(7, 5))
    for layout, colour in LAYOUTS.items():
        for kind, mark in (('fill', 'o'), ('one', '.'), ('defaults', '*')):
            chosen = [r for l, k, _, r in points if l == layout and k == kind]
            chosen = [r for r in chosen if all(f in r for f in ('hop, 90th percentile', 'goals a minute of play'))]
            ax.plot([r['hop, 90th percentile'] for r in chosen], [r['goals a minute of play'] for r in chosen], mark,
                    color=colour, label=f'{layout}, {kind}', markersize=12 if mark == '*' else 5)
    ax.axhline(3.0, color='#888888', linewidth=0.8, linestyle='--')
    ax.set_xlabel('hop, 90th percentile [mm]')
    ax.set_ylabel('goals a minute of play')
    ax.legend(fontsize='small')
    picture.tight_layout()
    picture.savefig(f'{folder}/tuning-trade.svg', metadata={'Date': None})


def self_test():
    text = ('section,figure,value,standard error,unit,goal,judgment\n'
            '"tournament; defaults gravity=14 hop_gain=2","goals a minute of play",2.5,,,,\n'
            '"tournament; one gravity=20","goals a minute of play",4,,,,\n'
            '"tournament; one gravity=10","goals a minute of play",2,,,,\n'
            '"paper; one gravity=10","goals a minute of play",,,,,\n'
            '"paper; fill gravity=10 hop_gain=2","  of the slide",1,,,,\n')
    points = read(text)
    assert points[0][:3] == ('tournament', 'defaults', {'gravity': 14.0, 'hop_gain': 2.0})
    assert points[4] == ('paper', 'fill', {'gravity': 10.0, 'hop_gain': 2.0}, {'of the slide': 1.0})
    line = one_at_a_time(points, 'goals a minute of play')['gravity']['tournament']
    assert line == [(10.0, 2.0), (20.0, 4.0)], line
    # A plane, 3 + 2 per range of a and -1 per range of b about the defaults (0.5, 0), off by
    # +-0.1 in a way that is no part of a plane.
    points = [('paper', 'defaults', {'a': 0.5, 'b': 0.0}, {'f': 3.0})]
    for i, a in enumerate((0.0, 1.0)):
        for j, b in enumerate((0.0, 10.0)):
            off = 0.1 if i == j else -0.1
            points.append(('paper', 'fill', {'a': a, 'b': b}, {'f': 3.0 + 2.0 * (a - 0.5) - 0.1 * b + off}))
    found = fit(points, 'paper', 'f')
    assert abs(found['a'][0] - 2.0) < 1e-9 and abs(found['b'][0] + 1.0) < 1e-9, found
    # Residuals of square sum 0.04 with two degrees of freedom: by hand, sqrt(0.02 / 1) of a.
    assert abs(found['a'][1] - 0.02 ** 0.5) < 1e-9, found
    assert fit(points, 'tournament', 'f') == {}
    print('plot_study: ok')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('--table', action='store_true')
    parser.add_argument('study', nargs='?')
    parser.add_argument('folder', nargs='?')
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if options.study is None or (options.folder is None and not options.table):
        parser.error('name a study, and a folder or --table')
    with open(options.study, encoding='utf-8') as file:
        points = read(file.read())
    if options.table:
        for name, layout, label, change, error in table(points):
            print(f'{name:20} {layout:12} {label:18} {change:+8.2f} +- {error:.2f}')
    else:
        draw(points, options.folder)
    return None


if __name__ == '__main__':
    sys.exit(main())
