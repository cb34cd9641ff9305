"""Follows the build guide's pages by their own commands, with simulated controllers in place of parts.

usage: guide_followed_test.py REPOSITORY BIN_DIRECTORY

The commands are read from the pages, so that a page that says what does not work fails here. What a
person does with a rod is done by `cabinet-bench --record`, through the firmware in its simulator.
"""
import json
import math
import os
import pty
import re
import signal
import subprocess
import sys
import tempfile
import threading
import tty
import unittest

BIN = sys.argv.pop(2)
REPOSITORY = sys.argv.pop(1)
DEADLINE_S = 60
SERIAL = '/dev/ttyACM0'


def page(name):
    with open(os.path.join(REPOSITORY, 'docs', 'build', name), encoding='utf-8') as file:
        return file.read()


def commands(text):
    """The lines of all fenced blocks."""
    blocks = re.findall(r'^```\n(.*?)^```', text, re.S | re.M)
    return [line.split() for block in blocks for line in block.splitlines() if line]


def section(text, heading):
    return text.split(f'\n## {heading}\n')[1].split('\n## ')[0]


def rows(printed):
    """label: (answers, slide, spin, overflow) of the table that `counts` prints."""
    found = {}
    for line in printed.splitlines():
        words = line.split()
        if len(words) >= 4 and words[0].isdigit() and words[1] in ('yes', '-'):
            found[words[0]] = (words[1] == 'yes', int(words[2]), int(words[3]), 'overflow' in words)
    return found


class SerialLine:
    """A pty on which a recording is sent again and again, a frame each millisecond or so."""

    def __init__(self, recording):
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        self.path = os.ttyname(slave)
        self.slave = slave
        self.frames = [frame + b'\0' for frame in recording.split(b'\0') if frame]
        self.ended = threading.Event()
        self.sent = threading.Event()
        os.set_blocking(self.master, False)
        self.thread = threading.Thread(target=self.send)
        self.thread.start()

    def send(self):
        while not self.ended.is_set():
            for frame in self.frames:
                try:
                    os.write(self.master, frame)
                except BlockingIOError:
                    pass  # nobody reads
                if self.ended.wait(0.001):
                    return
            self.sent.set()

    def close(self):
        self.ended.set()
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)


class GuideFollowed(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        os.mkdir(os.path.join(self.folder.name, 'out'))
        os.symlink(os.path.join(REPOSITORY, 'scripts'), os.path.join(self.folder.name, 'scripts'))
        self.line = None

    def run_in_folder(self, words, **options):
        return subprocess.run(words, cwd=self.folder.name, capture_output=True, text=True, timeout=DEADLINE_S,
                              check=False, **options)

    def type(self, words):
        """Types a command of a page; returns what it prints."""
        if self.line:
            words = [word.replace(SERIAL, self.line.path) for word in words]
        if words[0] == './play':  # its server, without its window
            return self.serve(words[1:])
        if words[:2] == ['scripts/rods.py', 'counts'] and not words[2].startswith('file:'):
            return self.count_until_interrupted(words)
        done = self.run_in_folder(words)
        self.assertEqual(done.returncode, 0, f'{words}: {done.stdout}{done.stderr}')
        return done.stdout

    def count_until_interrupted(self, words):
        process = subprocess.Popen(words, cwd=self.folder.name, stdout=subprocess.PIPE, text=True)
        for _ in range(2):  # all of it, from the reader's start on
            self.line.sent.clear()
            self.assertTrue(self.line.sent.wait(DEADLINE_S))
        process.send_signal(signal.SIGINT)
        printed, _ = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, 0)
        return printed

    def serve(self, options):
        stats = os.path.join(self.folder.name, 'stats.json')
        done = self.run_in_folder([os.path.join(BIN, 'space-foosball-server'), '--port', '0', '--seconds', '3',
                                   '--no-real-time', '--stats-file', stats, *options])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(stats, encoding='utf-8') as file:
            return json.load(file)

    def record(self, *moves, options=()):
        path = os.path.join('out', 'moves.bin')
        done = self.run_in_folder([os.path.join(BIN, 'cabinet-bench'), '--board', '2560', '--record', path, *options,
                                   *(word for move in moves for word in ('--move', move))])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return path

    def counts(self, *moves, options=()):
        """Slide and spin counts of the only rod that moved, and its label."""
        path = self.record(*moves, options=options)
        printed = rows(self.type(['scripts/rods.py', 'counts', 'file:' + path]))
        self.assertEqual(len(printed), 8)
        moved = {label: row[1:3] for label, row in printed.items() if abs(row[1]) + abs(row[2]) > 20}
        self.assertEqual(len(moved), 1)
        self.assertTrue(all(row[0] and not row[3] for row in printed.values()))
        return next(iter(moved.items()))

    def test_without_parts(self):
        for words in commands(section(page('test-and-calibrate.md'), 'Without parts')):
            said = self.type(words)
            if words[1] == 'counts':
                self.assertTrue(all(row[0] for row in rows(said).values()))
        self.assertGreater(said['device_frames'], 20)
        self.assertEqual(said['device_bad'], 0)

    def test_counts_are_what_the_page_says(self):
        text = section(page('test-and-calibrate.md'), 'Test')
        slide, tilted = map(int, re.search(r'changes by about (\d+) .*?less than (\d+)', text).groups())
        spin = int(re.search(r'column changes by about (\d+)', text[text.index('five times'):]).group(1))
        for options in (('--square',), ('--seed', '5')):
            _, (along, across) = self.counts('6:100:0', options=options)
            self.assertLess(abs(abs(along) - slide), 0.06 * slide)
            self.assertLess(abs(across), tilted)
            _, (along, around) = self.counts('6:0:5', options=options)
            self.assertLess(abs(abs(around) - spin), 0.06 * spin)

    def test_one_stroke_and_five_turns_calibrate_a_rod(self):
        pages = section(page('test-and-calibrate.md'), 'Calibrate a rod by one stroke and five turns')
        begin, one_rod = commands(pages)
        self.type(begin)
        seed = ('--seed', '5')
        label, stroke = self.counts('6:252:0', options=seed)
        _, turn = self.counts('6:0:-5', options=seed)
        measured = {'--stroke': f'--stroke={stroke[0]},{stroke[1]}', '--turn': f'--turn={turn[0]},{turn[1]}'}
        words = [measured.get(word.split('=')[0], word) for word in one_rod]
        words[words.index('--rod') + 1] = label
        self.type(words)
        with open(os.path.join(self.folder.name, words[2]), encoding='utf-8') as file:
            rods = json.load(file)['rods']
        moved = rods[list(rows(self.type(['scripts/rods.py', 'counts', 'file:out/moves.bin']))).index(label)]
        rows_of_file = moved['slide_m_per_count'], moved['angle_rad_per_count']
        for move, millimetres, degrees in (('6:100:0', 100, 0), ('6:0:1', 0, 360)):
            _, (slide, spin) = self.counts(move, options=seed)
            at = [row[0] * slide + row[1] * spin for row in rows_of_file]
            self.assertAlmostEqual(1e3 * at[0], millimetres, delta=1.5)
            self.assertAlmostEqual(math.degrees(at[1]), degrees, delta=4)

    def test_an_afternoon(self):
        with open(os.path.join(self.folder.name, self.record('6:120:0', '6:-120:2', '6:0:-2')), 'rb') as file:
            self.line = SerialLine(file.read())
        self.addCleanup(self.line.close)
        counts, calibration, play = commands(section(page('afternoon.md'), 'Play'))
        printed = rows(self.type(counts))
        self.assertEqual(len(printed), 8)
        self.assertTrue(any(row[1] or row[2] for row in printed.values()))
        self.type(calibration)
        said = self.type(play)
        self.assertGreater(said['device_frames'], 20)


if __name__ == '__main__':
    unittest.main(verbosity=2)
