"""Follows the build guide's pages by their own commands, with simulated controllers in place of parts.

usage: guide_followed_test.py REPOSITORY BIN_DIRECTORY      (needs a display: xvfb-run)

The commands are read from the pages, so that a page that says what does not work fails here. What a
person does with a rod is done by `cabinet-bench --record`, through the firmware in its simulator. Every
command of every page is typed, or is one of those that CANNOT names with the reason.
"""
import fcntl
import json
import math
import os
import pty
import re
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import tty
import unittest

BIN = sys.argv.pop(2)
REPOSITORY = sys.argv.pop(1)
DEADLINE_S = 60
SERIAL = '/dev/ttyACM0'
HID = ('/dev/space-foosball', '/dev/hidraw0')
# In the order in which a maker comes to them.
PAGES = ['build/README.md', 'build/parts.md', 'wiring.md', 'build/test-and-calibrate.md', 'build/afternoon.md', 'build/pair.md',
         'build/cabinet.md', 'cabinet.md', 'build/troubleshooting.md']
# What begins a command in the middle of a sentence.
PROGRAM = re.compile(r'(sudo |SF_\w+=\S+ )?(\./(play|bench|check)|scripts/[\w.]+|build/release/bin/[\w-]+|'
                     r'space-foosball[ -](doctor|calibrate)|cabinet-bench|cabinet_tests|avrdude|teensy_loader_cli|openscad|'
                     r'adduser|apt-get|udevadm|head|stty|ls)( |$)')
# Why a command cannot be typed here.
CANNOT = {
    r'sudo (apt-get|cp|adduser|udevadm) .*': 'changes the machine',
    r'(avrdude|teensy_loader_cli) .*': 'needs a board in its boot loader',
    r'ls /dev/.*': 'shows what this machine has',
    r'\./check( --only docs)?': 'this test is a part of it',
    r'\./play --device evdev:.*': 'needs two mice of the kernel: cabinet_tests has simulated ones',
    r'space-foosball[ -](doctor|calibrate)': 'of the installed package: package_holds_what_it_says has it',
    r'space-foosball --cabinet-gamepads .*': 'needs gamepads of the kernel: cabinet_gamepads_test has simulated ones',
    r'(SF_MOUNTS=30 )?cabinet_tests .*': 'a test of its own, or half an hour of it',
    r'cabinet-bench --counts-per-mm .*': 'plays for ten minutes on each controller',
    r'\./bench cabinet.*': 'plays on each controller, for minutes',
}
# A command that needs more than ./check installs: by hand where it is not there.
NEEDS = {'openscad': 'openscad', 'scripts/build_parts.sh': 'openscad', 'scripts/release_firmware.sh': 'arm-none-eabi-gcc'}


def page(name):
    with open(os.path.join(REPOSITORY, 'docs', name), encoding='utf-8') as file:
        return file.read()


def commands(text):
    """The lines of all fenced blocks."""
    blocks = re.findall(r'^```\n(.*?)^```', text, re.S | re.M)
    return [line.split() for block in blocks for line in block.splitlines() if line]


def all_commands(text):
    """Lines of fenced blocks, and commands within sentences; in their order."""
    found = []
    text = re.sub(r'^```\w+\n.*?^```', '', text, flags=re.S | re.M)  # data, code
    for block, span in re.findall(r'^```\n(.*?)^```|(?<!`)`([^`]+)`(?!`)', text, re.S | re.M):
        found += [line.split('  #')[0].strip() for line in block.splitlines()]
        span = ' '.join(span.split())
        if PROGRAM.match(span) or re.match(r'[a-z][\w./-]* (.* )?(-[a-z-]|/)', span):
            found.append(span)
    return [line for line in found if line]


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


class Line:
    """A pty on which a recording is sent again and again, as fast as it is read."""

    def __init__(self, pieces):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.path = os.ttyname(self.slave)
        self.pieces = pieces
        self.ended = threading.Event()
        self.sent = threading.Event()
        self.thread = threading.Thread(target=self.send)
        self.thread.start()

    def free(self):
        """A line that a program has taken for itself is free when it ends; but this test has it open too."""
        fcntl.ioctl(self.slave, termios.TIOCNXCL)

    def room(self):
        waiting, = struct.unpack('i', fcntl.ioctl(self.slave, termios.FIONREAD, b'    '))
        return waiting < 2048

    def send(self):
        while not self.ended.is_set():
            for i, piece in enumerate(self.pieces):
                while not self.room():  # nobody reads
                    if self.ended.wait(0.001):
                        return
                os.write(self.master, piece)
                if i % 4 == 0 and self.ended.wait(0.001):
                    return
            self.sent.set()

    def close(self):
        self.ended.set()
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)


def serial_pieces(recording):
    return [frame + b'\0' for frame in recording.split(b'\0') if frame]


def report_pieces(recording):
    return [recording[at:at + 64] for at in range(0, len(recording), 64)]


# In place of space-foosball-server: it leaves its figures, which ./play reads and throws away.
SERVER = """#!/bin/bash
trap 'kill "$server"' TERM INT
{program} "$@" &
server=$!
wait "$server"
status=$?
while (($#)); do
  [[ $1 == --stats-file ]] && cp "$2" stats.json
  shift
done
exit "$status"
"""


class GuideFollowed(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.copy_repository()
        self.lines = {}
        self.environment = {name: value for name, value in os.environ.items()
                            if not name.startswith('XDG_') and name != 'WAYLAND_DISPLAY'}
        self.environment.update(HOME=self.folder.name, TMPDIR=self.folder.name, SF_SKIP_PACKAGES='1', LIBGL_ALWAYS_SOFTWARE='1')

    def inside(self, *names):
        return os.path.join(self.folder.name, *names)

    def copy_repository(self):
        """As a maker has it who has built it: what was built elsewhere is taken to be up to date."""
        for name in os.listdir(REPOSITORY):
            if name not in ('.git', 'build', 'out'):
                os.symlink(os.path.join(REPOSITORY, name), self.inside(name))
        os.makedirs(self.inside('build/release/bin'))
        for name in os.listdir(BIN):
            if name != 'space-foosball-server':
                os.symlink(os.path.join(BIN, name), self.inside('build/release/bin', name))
        self.write('build/release/bin/space-foosball-server',
                   SERVER.format(program=shlex.quote(os.path.join(BIN, 'space-foosball-server'))))
        self.write('build/release/build.ninja', '')
        self.write('built/ninja', '#!/bin/sh\nexit 0\n')

    def write(self, name, text):
        os.makedirs(os.path.dirname(self.inside(name)), exist_ok=True)
        with open(self.inside(name), 'w', encoding='utf-8') as file:
            file.write(text)
        os.chmod(self.inside(name), 0o755)

    def connect(self, line, *paths):
        self.addCleanup(line.close)
        self.lines.update(dict.fromkeys(paths, line))

    def run_in_folder(self, words, *, seconds=DEADLINE_S, building=False):
        environment = dict(self.environment)
        if not building:
            environment['PATH'] = self.inside('built') + ':' + environment['PATH']
        return subprocess.run(words, cwd=self.folder.name, capture_output=True, text=True, timeout=seconds,
                              check=False, env=environment)

    def at_lines(self, word):
        """With the simulated lines, free for the next program, in place of a page's paths."""
        for path, line in self.lines.items():
            line.free()
            word = word.replace(path, line.path)
        return word

    def type(self, words):
        """Types a command of a page; returns what it prints, of a match its figures."""
        words = [self.at_lines(word) for word in words]
        if words[:2] == ['scripts/rods.py', 'counts'] and not words[2].startswith('file:'):
            return self.count_until_interrupted(words)
        if words[0] == './play' and words[1:2] not in (['--doctor'], ['--calibrate']):
            return self.play(words)
        done = self.run_in_folder(words)
        self.assertEqual(done.returncode, 0, f'{words}: {done.stdout}{done.stderr}')
        return done.stdout

    def count_until_interrupted(self, words):
        line = next(line for line in self.lines.values() if words[2].endswith(':' + line.path))
        process = subprocess.Popen(words, cwd=self.folder.name, stdout=subprocess.PIPE, text=True)
        for _ in range(2):  # all of it, from the reader's start on
            line.sent.clear()
            self.assertTrue(line.sent.wait(DEADLINE_S))
        process.send_signal(signal.SIGINT)
        printed, _ = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, 0)
        return printed

    def play(self, words):
        """Its window is shown for three seconds; returns the server's figures."""
        if os.path.exists(self.inside('stats.json')):
            os.remove(self.inside('stats.json'))
        done = self.run_in_folder([*words, '--seconds', '3', '--mute'])
        self.assertEqual(done.returncode, 0, f'{words}: {done.stdout}{done.stderr}')
        with open(self.inside('stats.json'), encoding='utf-8') as file:
            figures = json.load(file)
        if '--device' in words:
            self.assertGreater(figures['device_frames'], 20)
        return figures

    def connect_serial(self):
        with open(self.inside(self.record('6:120:0', '6:-120:2', '6:0:-2')), 'rb') as file:
            self.connect(Line(serial_pieces(file.read())), SERIAL)

    def connect_hid(self):
        with open(self.inside(self.record('3:100:0', '3:-100:1', board='32u4')), 'rb') as file:
            self.connect(Line(report_pieces(file.read())), *HID)

    def record(self, *moves, options=(), board='2560'):
        os.makedirs(self.inside('out'), exist_ok=True)
        path = os.path.join('out', 'moves.bin')
        done = self.run_in_folder([os.path.join(BIN, 'cabinet-bench'), '--board', board, '--record', path, *options,
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
        for words in commands(section(page('build/test-and-calibrate.md'), 'Without parts')):
            said = self.type(words)
            if words[1] == 'counts':
                self.assertTrue(all(row[0] for row in rows(said).values()))
        self.assertGreater(said['device_frames'], 20)
        self.assertEqual(said['device_bad'], 0)

    def test_counts_are_what_the_page_says(self):
        text = section(page('build/test-and-calibrate.md'), 'Test')
        slide, tilted = map(int, re.search(r'changes by about (\d+) .*?less than (\d+)', text).groups())
        spin = int(re.search(r'column changes by about (\d+)', text[text.index('five times'):]).group(1))
        for options in (('--square',), ('--seed', '5')):
            _, (along, across) = self.counts('6:100:0', options=options)
            self.assertLess(abs(abs(along) - slide), 0.06 * slide)
            self.assertLess(abs(across), tilted)
            _, (along, around) = self.counts('6:0:5', options=options)
            self.assertLess(abs(abs(around) - spin), 0.06 * spin)

    def test_one_stroke_and_five_turns_calibrate_a_rod(self):
        pages = section(page('build/test-and-calibrate.md'), 'Calibrate a rod by one stroke and five turns')
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
        self.connect_serial()
        counts, calibration, play = commands(section(page('build/afternoon.md'), 'Play'))
        printed = rows(self.type(counts))
        self.assertEqual(len(printed), 8)
        self.assertTrue(any(row[1] or row[2] for row in printed.values()))
        self.type(calibration)
        said = self.type(play)
        self.assertGreater(said['device_frames'], 20)

    def test_every_command_of_every_page_works_as_it_stands(self):
        """In the order of the pages, each in the state that the ones before have left."""
        self.connect_serial()
        self.connect_hid()
        typed, excused, lacking = set(), set(), set()
        for name in PAGES:
            for command in all_commands(page(name)):
                with self.subTest(page=name, command=command):
                    reason = next((pattern for pattern in CANNOT if re.fullmatch(pattern, command)), None)
                    if reason:
                        excused.add(reason)
                    elif self.lacks_program(command):
                        lacking.add(command)
                    elif command not in typed:
                        typed.add(command)
                        self.follow(command)
        self.assertEqual(set(CANNOT) - excused, set(), 'no page has these commands any more')
        print(f'{len(typed)} commands typed; not typed, since their program is not installed: {sorted(lacking)}')
        self.assertGreater(len(typed), 20)

    def lacks_program(self, command):
        program = command.split()[0]
        return program in NEEDS and not shutil.which(NEEDS[program])

    def follow(self, command):
        """One command of a page, with what a person does while it runs."""
        for address in ('serial:' + SERIAL, 'hid:' + HID[0]) if 'ADDRESS' in command else ('',):
            self.follow_at(command.replace('ADDRESS', address))

    def follow_at(self, command):
        words = command.split()
        if words[0] == 'build/release/bin/space-foosball-doctor' or words[:2] == ['./play', '--doctor']:
            self.ask_the_doctor(words)
        elif words[:2] == ['./play', '--calibrate']:
            self.open_calibration(words)
        elif words[0] == './play' or words[0] == 'scripts/rods.py' and len(words) > 2:
            self.type(words)
        elif words[0] != 'scripts/rods.py':  # else it is named in passing
            if words[0] == 'scripts/build_guide.py':
                command = f'python3 {command} --check'  # it would write into the pages
            done = self.run_in_folder(['bash', '-c', self.at_lines(command)], seconds=200,
                                      building=words[0] == 'scripts/release_firmware.sh')
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            if '>' in words:
                self.type(['scripts/rods.py', 'counts', 'file:' + words[-1]])

    def ask_the_doctor(self, words):
        done = self.run_in_folder([*words, '--device', self.at_lines('serial:' + SERIAL), '--seconds', '1'])
        self.assertIn(done.returncode, (0, 1), done.stdout + done.stderr)
        self.assertIn('frames', done.stdout)

    def open_calibration(self, words):
        """Its window is photographed, and left."""
        done = self.run_in_folder([*map(self.at_lines, words), '--screenshot', 'out/calibration.png'])
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(os.path.getsize(self.inside('out/calibration.png')) > 1000)

    def test_no_page_of_the_guide_is_left_out(self):
        guide = {f'build/{name}' for name in os.listdir(os.path.join(REPOSITORY, 'docs/build')) if name.endswith('.md')}
        self.assertLessEqual(guide, set(PAGES))

    def test_a_command_that_is_not_known_is_found(self):
        self.assertEqual(all_commands('x `./play --nothing` y `foo-util -x` `a N + b M` `--view above` `scripts/a.py`\n'
                                      '```\nany thing  # why\n```\n```json\n{}\n```\n'),
                         ['./play --nothing', 'foo-util -x', 'scripts/a.py', 'any thing'])


if __name__ == '__main__':
    unittest.main(verbosity=2)
