#!/usr/bin/python3
"""Draws what ./bench rigid and ./bench scaling have measured.

  scripts/plot_rigid.py steps RIGID.csv FOLDER        FOLDER/rigid-step-times.png
  scripts/plot_rigid.py scaling SCALING.csv FOLDER    FOLDER/rigid-scaling.png
  scripts/plot_rigid.py --self-test                   checks what is drawn, not how: without matplotlib

Each picture names, by its SHA-256, the file that it was drawn from (benchmark_tables.py asks for it).
"""
import argparse
import csv
import hashlib
import io
import math
import sys
from collections import defaultdict
from pathlib import Path

# In this order, in all pictures.
COLOURS = {
    'Virtual Physics': '#0b1e4d',
    'Bullet': '#e8955f',
    'ODE': '#f4cf63',
    'MuJoCo': '#c0392b',
    'Virtual Physics (WebAssembly)': '#5aa9e6',
    'Jolt (WebAssembly)': '#7cc48d',
    'Rapier (WebAssembly)': '#a569bd',
}
OURS = 'Virtual Physics'
RATES = (60, 1000)
GREY = '#777777'


def read(file):
    """Values by scene and rate, engine and metric; a goal is an engine."""
    values = defaultdict(lambda: defaultdict(dict))
    for row in csv.DictReader(file):
        scene, _, rate = row['subject'].partition('@')
        if row['engine'] not in (*COLOURS, 'goal'):
            raise ValueError(f'no colour is chosen for {row["engine"]}')
        values[scene, int(rate)][row['engine']][row['metric']] = row['value']
    return values


def groups(values, rate):
    """Of each scene but the tables, which are ours alone: by engine the median step and whether the run was to its
    end, or None; and the goal, if there is one."""
    found = {}
    for (scene, of), engines in values.items():
        if of != rate or scene.startswith('table') or not set(engines) - {'goal'}:
            continue
        bars = {engine: (float(engines[engine]['step_median_us']), 'step_settled_us' in engines[engine])
                if 'step_median_us' in engines.get(engine, {}) else None for engine in COLOURS}
        goal = engines.get('goal', {}).get('step_median_us')
        found[scene] = (bars, float(goal) if goal else None)
    return found


def curves(values):
    """By engine the boxes and the median step of the last quarter of the run, when they lie [ms]."""
    found = {engine: sorted((int(scene[4:]), float(engines[engine]['step_settled_us']) / 1000.0)
                            for (scene, _), engines in values.items()
                            if scene[4:].isdigit() and 'step_settled_us' in engines.get(engine, {}))
             for engine in COLOURS}
    return {engine: points for engine, points in found.items() if points}


def n_log_n(points, last):
    """Through the first of the points, up to last."""
    n0, t0 = points[0]
    counts = [n0 * (last / n0) ** (k / 40) for k in range(41)]
    return [(n, t0 * n * math.log(n) / (n0 * math.log(n0))) for n in counts]


def pyplot():
    try:
        import matplotlib
    except ImportError:
        sys.exit('plot_rigid.py needs matplotlib: scripts/packages.sh install bench')
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    plt.rcParams.update({'font.size': 9, 'axes.spines.top': False, 'axes.spines.right': False})
    return plt


def plain(axis, marks=(1,)):
    """1,000 instead of 10^3; marks: of each decade."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
    axis.set_major_locator(LogLocator(subs=marks, numticks=12))
    axis.set_major_formatter(FuncFormatter(lambda x, _: f'{x:,.0f}' if x >= 1 else f'{x:g}'))
    axis.set_minor_formatter(NullFormatter())


def draw_bars(axes, found, engines, rate):
    height = 0.82 / len(engines)
    for row, (bars, goal) in enumerate(found.values()):
        for k, engine in enumerate(engines):
            y = row - 0.41 + (k + 0.5) * height
            if bars[engine]:
                median, whole = bars[engine]
                axes.barh(y, median, height, color=COLOURS[engine], hatch=None if whole else '/////', edgecolor='white',
                          linewidth=0)
            else:
                axes.text(0.012, y, 'none', transform=axes.get_yaxis_transform(), va='center', fontsize=6.5, color=GREY)
        if goal:
            axes.plot([goal, goal], [row - 0.48, row - 0.39 + height], color='black', linewidth=1.8,
                      solid_capstyle='butt')
    axes.axvline(1e6 / rate, color=GREY, linewidth=1, linestyle=(0, (4, 2)), zorder=0.5)
    axes.set_xscale('log')
    plain(axes.xaxis)
    axes.set_yticks(range(len(found)), list(found))
    axes.set_ylim(len(found) - 0.45, -0.55)
    axes.tick_params(axis='y', length=0)
    axes.set_title(f'{rate} Hz', fontsize=10)
    axes.set_xlabel('median step [us of processor time]')
    axes.grid(True, axis='x', which='major', color='#dddddd', linewidth=0.7)
    axes.set_axisbelow(True)


def limits(all_found):
    """Of the axis of times, with room for the shortest bar."""
    times = [bar[0] for found in all_found for bars, _ in found.values() for bar in bars.values() if bar]
    return 0.5 * min(times), 1.3 * max(times)


def legend(plt, figure, engines, all_found):
    handles = [plt.Rectangle((0, 0), 1, 1, color=COLOURS[e]) for e in engines]
    labels = list(engines)
    if any(bar and not bar[1] for found in all_found for bars, _ in found.values() for bar in bars.values()):
        handles.append(plt.Rectangle((0, 0), 1, 1, facecolor='#aaaaaa', hatch='/////', edgecolor='white', linewidth=0))
        labels.append('not to the end of the scene')
    handles.append(plt.Line2D([], [], color=GREY, linewidth=1, linestyle=(0, (4, 2))))
    labels.append('real time')
    if any(goal for found in all_found for _, goal in found.values()):
        handles.append(plt.Line2D([], [], color='black', linewidth=0, marker='|', markersize=9, markeredgewidth=1.6))
        labels.append(f'goal of {OURS}')
    figure.legend(handles, labels, loc='lower center', ncol=3, frameon=False, fontsize=8.5)


def steps(values, path, source):
    plt = pyplot()
    all_found = {rate: found for rate in RATES if (found := groups(values, rate))}
    engines = [e for e in COLOURS if any(bars[e] for found in all_found.values() for bars, _ in found.values())]
    rows = max(len(found) for found in all_found.values())
    tall = 0.125 * len(engines) * rows + 1.7
    figure, all_axes = plt.subplots(1, len(all_found), squeeze=False, figsize=(9.2, tall), sharex=True)
    for axes, (rate, found) in zip(all_axes[0], all_found.items()):
        draw_bars(axes, found, engines, rate)
        axes.set_xlim(limits(all_found.values()))
    if len({tuple(found) for found in all_found.values()}) == 1:
        for axes in all_axes[0][1:]:
            axes.set_yticklabels([])
    legend(plt, figure, engines, all_found.values())
    figure.tight_layout(rect=(0, 0.75 / tall, 1, 1))
    save(plt, figure, path, source)


def scaling(values, path, source):
    plt = pyplot()
    found = curves(values)
    figure, axes = plt.subplots(figsize=(8.2, 5.2))
    if OURS in found:
        last = max(n for points in found.values() for n, _ in points)
        axes.loglog(*zip(*n_log_n(found[OURS], last)), color=GREY, linewidth=1.2, linestyle=(0, (4, 2)),
                    label='n log n, from the first pile on')
    for engine, points in found.items():
        axes.loglog(*zip(*points), 'o-', label=engine, color=COLOURS[engine],
                    linewidth=2.2 if engine == OURS else 1.6, markersize=5)
    for axis in (axes.xaxis, axes.yaxis):
        plain(axis, (1, 2, 5))
    axes.set_xlabel('boxes in the pit')
    axes.set_ylabel('median step once they lie [ms of processor time]')
    axes.set_title('Piles of boxes, all awake, at 60 Hz on one core', fontsize=10)
    axes.grid(True, which='major', color='#dddddd', linewidth=0.7)
    handles, labels = axes.get_legend_handles_labels()
    axes.legend(handles[1:] + handles[:1], labels[1:] + labels[:1], frameon=False, loc='upper left')
    figure.tight_layout()
    save(plt, figure, path, source)


def save(plt, figure, path, source):
    figure.savefig(path, dpi=140, metadata={'Software': None, 'Source': source})
    plt.close(figure)


SAMPLE = '''\
subject,engine,metric,value,unit
towers1120@60,Bullet,step_median_us,2500,us
towers1120@60,Virtual Physics,step_median_us,600,us
towers1120@60,Virtual Physics,step_settled_us,650,us
towers1120@60,MuJoCo,missing,no room,
towers1120@60,goal,drift_mm,5,mm
towers1120@1000,Virtual Physics,step_median_us,250,us
towers1120@1000,goal,step_median_us,640,us
table1@1000,Virtual Physics,step_median_us,6,us
heap2000@60,Virtual Physics,step_settled_us,4000,us
heap1000@60,Virtual Physics,step_settled_us,1500,us
heap1000@60,Rapier (WebAssembly),step_settled_us,7000,us
heap1000@60,Bullet,step_median_us,7000,us
heaps@60,Virtual Physics,growth_exponent,1.2,
heaps@60,goal,growth_exponent,1.11,
'''


def self_test():
    wrong = []

    def expect(what, found, wanted):
        if found != wanted:
            wrong.append(f'{what}: expected {wanted}, found {found}')
    values = read(io.StringIO(SAMPLE))
    towers, goal = groups(values, 60)['towers1120']
    expect('order', list(towers), list(COLOURS))
    expect('a whole run', towers['Virtual Physics'], (600.0, True))
    expect('a run that was cut', towers['Bullet'], (2500.0, False))
    expect('one left out', towers['MuJoCo'], None)
    expect('another goal', goal, None)
    expect('scenes', list(groups(values, 1000)), ['towers1120'])
    expect('a goal', groups(values, 1000)['towers1120'][1], 640.0)
    expect('curves', curves(values), {'Virtual Physics': [(1000, 1.5), (2000, 4.0)],
                                      'Rapier (WebAssembly)': [(1000, 7.0)]})
    line = n_log_n([(1000, 1.5), (2000, 4.0)], 100000)
    expect('the line of n log n', [[round(x, 6) for x in line[k]] for k in (0, -1)], [[1000.0, 1.5], [100000.0, 250.0]])
    try:
        read(io.StringIO(SAMPLE.replace('Bullet', 'Bulet')))
        wrong.append('an engine without a colour is taken')
    except ValueError:
        pass
    for line in wrong:
        print(line, file=sys.stderr)
    print(f'plots, self-test: {len(wrong)} wrong')
    return 1 if wrong else 0


def main():
    if sys.argv[1:] == ['--self-test']:
        return self_test()
    parser = argparse.ArgumentParser(description='Draws what ./bench rigid and scaling have measured.')
    parser.add_argument('what', choices=['steps', 'scaling'])
    parser.add_argument('csv', type=Path)
    parser.add_argument('folder', type=Path)
    arguments = parser.parse_args()
    kept = arguments.csv.read_bytes()
    values = read(io.StringIO(kept.decode()))
    arguments.folder.mkdir(parents=True, exist_ok=True)
    name, draw = ('rigid-step-times.png', steps) if arguments.what == 'steps' else ('rigid-scaling.png', scaling)
    draw(values, arguments.folder / name, hashlib.sha256(kept).hexdigest())
    print(f'drawn as {arguments.folder / name}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
