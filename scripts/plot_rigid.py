#!/usr/bin/python3
"""Draws what ./bench rigid and ./bench scaling have measured.

  scripts/plot_rigid.py steps RIGID.csv FOLDER        FOLDER/rigid-step-times.png
  scripts/plot_rigid.py scaling SCALING.csv FOLDER    FOLDER/rigid-scaling.png
"""
import argparse
import csv
import math
import sys
from collections import defaultdict
from pathlib import Path

try:
    import matplotlib
except ImportError:
    sys.exit('plot_rigid.py needs matplotlib: scripts/packages.sh install bench')
matplotlib.use('Agg')
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)

COLOURS = {
    'Virtual Physics': '#0b1e4d',
    'Virtual Physics (WebAssembly)': '#5aa9e6',
    'Bullet': '#f2b48c',
    'ODE': '#f4cf63',
    'MuJoCo': '#c0392b',
    'Jolt (WebAssembly)': '#7cc48d',
    'Rapier (WebAssembly)': '#8e44ad',
}
RATES = (60, 1000)


def read(path):
    """Values by subject, engine and metric; text where it is no number."""
    values = defaultdict(lambda: defaultdict(dict))
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            scene, _, rate = row['subject'].partition('@')
            if rate and row['engine'] != 'goal':
                values[scene, int(rate)][row['engine']][row['metric']] = row['value']
    return values


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={'Software': None})
    plt.close(figure)


def bars(axes, values, rate):
    """A group of bars for each scene; who did not reach the scene's end is hatched."""
    scenes = [scene for scene, of in values if of == rate and not scene.startswith('table')]
    engines = [e for e in COLOURS if any('step_median_us' in values[s, rate].get(e, {}) for s in scenes)]
    height = 0.84 / max(1, len(engines))
    for row, scene in enumerate(scenes):
        for k, engine in enumerate(engines):
            of = values[scene, rate].get(engine, {})
            if 'step_median_us' not in of:
                continue
            whole = 'step_settled_us' in of
            y = row - 0.42 + (k + 0.5) * height
            axes.barh(y, float(of['step_median_us']), height, color=COLOURS[engine],
                      hatch=None if whole else '////', edgecolor='white' if not whole else 'none', linewidth=0)
    axes.axvline(1e6 / rate, color='#888888', linewidth=1, linestyle=(0, (4, 2)))
    axes.set_xscale('log')
    axes.set_yticks(range(len(scenes)), scenes)
    axes.invert_yaxis()
    axes.set_title(f'{rate} Hz', fontsize=11)
    axes.set_xlabel('processor time of a step, median [us]')
    axes.grid(True, axis='x', which='major', color='#dddddd', linewidth=0.7)
    axes.set_axisbelow(True)
    return engines


def steps(values, path):
    rates = [rate for rate in RATES if any(of == rate for _, of in values)]
    figure, all_axes = plt.subplots(1, len(rates), squeeze=False, figsize=(6.2 * len(rates), 7.0))
    shown = []
    for axes, rate in zip(all_axes[0], rates):
        shown += [e for e in bars(axes, values, rate) if e not in shown]
    handles = [plt.Rectangle((0, 0), 1, 1, color=COLOURS[e]) for e in shown]
    labels = list(shown)
    handles += [plt.Rectangle((0, 0), 1, 1, facecolor='#bbbbbb', hatch='////', edgecolor='white', linewidth=0),
                plt.Line2D([], [], color='#888888', linewidth=1, linestyle=(0, (4, 2)))]
    labels += ['not to the end of the scene', 'real time']
    figure.legend(handles, labels, loc='lower center', ncol=4, frameon=False, fontsize=9)
    figure.tight_layout(rect=(0, 0.08, 1, 1))
    figure.savefig(path, dpi=110, metadata={'Software': None})
    plt.close(figure)


def scaling(values, path):
    """The last quarter of each run, when the pile lies."""
    curves = defaultdict(list)
    for (scene, _), engines in values.items():
        if not scene.startswith('heap'):
            continue
        for engine, of in engines.items():
            if 'step_settled_us' in of:
                curves[engine].append((int(scene[4:]), float(of['step_settled_us'])))
    figure, axes = plt.subplots(figsize=(8.5, 5.6))
    for engine, points in curves.items():
        points.sort()
        axes.loglog(*zip(*points), 'o-', label=engine, color=COLOURS[engine], linewidth=1.8, markersize=4)
    ours = curves.get('Virtual Physics')
    if ours:
        n0, t0 = ours[0]
        counts = [n for n, _ in ours]
        axes.loglog(counts, [t0 * n * math.log(n) / (n0 * math.log(n0)) for n in counts], color='#888888',
                    linewidth=1, linestyle=(0, (4, 2)), label='n log n')
    axes.set_xlabel('boxes in the pit')
    axes.set_ylabel('processor time of a step once they lie, median [us]')
    axes.set_title('Piles of 1,000 to 100,000 boxes, all awake, at 60 Hz on one core', fontsize=11)
    axes.grid(True, which='major', color='#dddddd', linewidth=0.7)
    axes.legend(frameon=False, fontsize=9)
    save(figure, path)


def main():
    parser = argparse.ArgumentParser(description='Draws what ./bench rigid and scaling have measured.')
    parser.add_argument('what', choices=['steps', 'scaling'])
    parser.add_argument('csv', type=Path)
    parser.add_argument('folder', type=Path)
    arguments = parser.parse_args()
    values = read(arguments.csv)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    name = 'rigid-step-times.png' if arguments.what == 'steps' else 'rigid-scaling.png'
    (steps if arguments.what == 'steps' else scaling)(values, arguments.folder / name)
    print(f'drawn as {arguments.folder / name}')


if __name__ == '__main__':
    main()
