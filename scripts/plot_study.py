#!/usr/bin/python3
"""Draws what `space-foosball-match --study --csv STUDY.csv` has measured.

  scripts/plot_study.py STUDY.csv FOLDER   FOLDER/tuning-one.svg, one value at a time;
                                           FOLDER/tuning-trade.svg, all points: goals beside hops
  scripts/plot_study.py --table STUDY.csv  for each value and figure, the slope over its studied range
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
    ('nobody can reach the ball', 'out of reach [%]', (None, 8.0)),
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


def slope(line):
    """Least squares: change of the figure from one end of the studied range to the other."""
    n = len(line)
    mean_x, mean_y = sum(x for x, _ in line) / n, sum(y for _, y in line) / n
    spread = sum((x - mean_x) ** 2 for x, _ in line)
    if spread == 0.0:
        return 0.0
    return sum((x - mean_x) * (y - mean_y) for x, y in line) / spread * (line[-1][0] - line[0][0])


def table(points):
    rows = []
    for figure, label, _ in FIGURES:
        lines = one_at_a_time(points, figure)
        for name in lines:
            for layout in LAYOUTS:
                if lines[name][layout]:
                    rows.append((name, layout, label, slope(lines[name][layout])))
    return rows


def draw(points, folder):
    import matplotlib
    matplotlib.use('svg')
    matplotlib.rcParams['svg.hashsalt'] = 'study'
    import matplotlib.pyplot as plt
    names = list(one_at_a_time(points, FIGURES[0][0]))
    picture, axes = plt.subplots(len(FIGURES), len(names), figsize=(2.1 * len(names), 9), sharey='row',
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
            '"tournament; defaults","goals a minute of play",2.5,,,,\n'
            '"tournament; one gravity=20","goals a minute of play",4,,,,\n'
            '"tournament; one gravity=10","goals a minute of play",2,,,,\n'
            '"paper; one gravity=10","goals a minute of play",,,,,\n'
            '"paper; fill gravity=10 hop_gain=2","  of the slide",1,,,,\n')
    points = read(text)
    assert [p[:3] for p in points][0] == ('tournament', 'defaults', {})
    assert points[4] == ('paper', 'fill', {'gravity': 10.0, 'hop_gain': 2.0}, {'of the slide': 1.0})
    line = one_at_a_time(points, 'goals a minute of play')['gravity']['tournament']
    assert line == [(10.0, 2.0), (20.0, 4.0)], line
    assert slope(line) == 2.0 and slope([(1.0, 5.0)]) == 0.0
    assert table(points) == [('gravity', 'tournament', 'goals/min', 2.0)]
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
        for name, layout, label, change in table(points):
            print(f'{name:20} {layout:12} {label:18} {change:+8.2f}')
    else:
        draw(points, options.folder)
    return None


if __name__ == '__main__':
    sys.exit(main())
