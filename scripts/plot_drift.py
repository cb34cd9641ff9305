#!/usr/bin/python3
"""Draws how energy and momentum drift (./bench drift) from its curves.

  scripts/plot_drift.py CURVES FOLDER    FOLDER/drift-tumbling.png and FOLDER/drift-pendulum.png
"""
import argparse
import csv
import sys
from collections import defaultdict
from pathlib import Path

try:
    import matplotlib
except ImportError:
    sys.exit('plot_drift.py needs matplotlib: scripts/packages.sh install bench')
matplotlib.use('Agg')
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)
from matplotlib.ticker import LogLocator, NullFormatter  # noqa: E402

# Colour, width, dash. Curves that coincide lie on each other, the narrow on the wide.
STYLES = {
    'vphysics: semi-implicit Euler': ('#5aa9e6', 1.5, 'solid'),
    'vphysics: RK4': ('#2447b5', 1.5, 'solid'),
    'vphysics: adaptive 1e-10': ('#8e44ad', 1.5, 'solid'),
    'vphysics: variational': ('#0b1e4d', 2.8, 'solid'),
    'MuJoCo: Euler': ('#f2b48c', 6.5, 'solid'),
    'MuJoCo: implicit': ('#c0392b', 1.8, (0, (4, 1.5))),
    'MuJoCo: RK4': ('#f4cf63', 5.0, 'solid'),
    'DART: semi-implicit Euler': ('#7cc48d', 3.6, 'solid'),
}
TITLES = {'tumbling': 'A tumbling asymmetric body without gravity',
          'pendulum': 'A pendulum of ten links, let go from the horizontal'}
FLOOR = 1e-17  # what is exactly kept is drawn here


def read(path):
    curves = defaultdict(lambda: defaultdict(list))
    with open(path, newline='') as file:
        for row in csv.DictReader(file):
            curves[row['subject']][row['engine']].append(
                (float(row['time_s']), float(row['energy_error']), float(row['momentum_error'])))
    return curves


def draw(axes, movers, column, label):
    ends = {}
    for name, points in movers.items():
        colour, width, dash = STYLES[name]
        y = [max(point[column], FLOOR) for point in points]
        axes.loglog([point[0] for point in points], y, label=name, color=colour, linestyle=dash, linewidth=width,
                    zorder=2 + 1 / width)
        ends[name] = (points[-1][0], y[-1])
    latest = max(end[0] for end in ends.values())
    for name, (time, y) in ends.items():
        if time < 0.5 * latest:
            axes.plot(time, y, 'x', color=STYLES[name][0], markersize=9, markeredgewidth=2)
            axes.annotate('unstable', (time, y), xytext=(6, 2), textcoords='offset points', fontsize=8,
                          color=STYLES[name][0])
    axes.set_ylabel(label)
    axes.set_ylim(bottom=FLOOR / 2)
    axes.yaxis.set_major_locator(LogLocator(numticks=20))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(True, which='major', color='#dddddd', linewidth=0.7)


def picture(subject, movers, path):
    panels = [(1, 'energy error, relative')]
    if subject == 'tumbling':
        panels.append((2, 'angular momentum error, relative'))
    else:
        panels = [(1, 'energy error / energy of the fall')]
    figure, all_axes = plt.subplots(len(panels), 1, sharex=True, squeeze=False,
                                    figsize=(10, 3.7 * len(panels) + 0.6))
    for axes, (column, label) in zip(all_axes[:, 0], panels):
        draw(axes, movers, column, label)
    all_axes[-1, 0].set_xlabel('time [s], in steps of 1 ms')
    all_axes[0, 0].set_title(TITLES[subject])
    handles, labels = all_axes[0, 0].get_legend_handles_labels()
    all_axes[0, 0].legend(handles, labels, loc='upper left', bbox_to_anchor=(1.01, 1), borderaxespad=0, frameon=False,
                          handlelength=3.2, fontsize=9)
    figure.align_ylabels()
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={'Software': None})
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description='Draws how energy and momentum drift.')
    parser.add_argument('curves', type=Path)
    parser.add_argument('folder', type=Path)
    arguments = parser.parse_args()
    for subject, movers in read(arguments.curves).items():
        picture(subject, movers, arguments.folder / f'drift-{subject}.png')


if __name__ == '__main__':
    main()
