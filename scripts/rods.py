#!/usr/bin/env python3
"""For a maker at a bench, before there is a game: what a cabinet's controller sends, and a first calibration.

  scripts/rods.py counts ADDRESS       live counts of each rod (serial:/dev/ttyACM0, hid:/dev/hidraw0,
                                       file:FILE); Ctrl-C ends it and prints the sums since the start
  scripts/rods.py calibration FILE     writes the calibration of sensors that are mounted square, or of
                                       one rod from its measured counts
  scripts/rods.py simulate FILE        writes a recording of a controller whose rods move, to try the
                                       rest without parts
  scripts/rods.py --self-test

Rods are numbered from 1, at team 0's goal, to 8; frames and files list them in that order. Exit codes: 0 done;
1 no frame came, or the device went away; 2 a bad option or file.

The frame is described in wire/include/wire/device_frame.h, the calibration in docs/cabinet.md.
"""
import argparse
import contextlib
import io
import json
import math
import os
import select
import stat
import struct
import sys
import tempfile
import termios
import time

RODS, FRAME_BYTES, REPORT_BYTES, VERSION = 8, 46, 64, 2


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def encode(sequence, time_us, counts, present=0xFF, overflow=0, quality=0, index=0, version=VERSION):
    body = struct.pack('<BBHI16H4B', version, 0, sequence & 0xFFFF, time_us & 0xFFFFFFFF,
                       *(c & 0xFFFF for pair in counts for c in pair), present, overflow, quality, index)
    return body + struct.pack('<H', crc16(body))


def decode(data):
    """None unless it is a frame: sequence, counts, present, overflow, quality, index. Version 1 has no index."""
    if len(data) != FRAME_BYTES or data[0] not in (1, VERSION) or data[0] == 1 and data[43] != 0:
        return None
    if struct.unpack_from('<H', data, 44)[0] != crc16(data[:44]):
        return None
    words = struct.unpack_from('<16H', data, 8)
    return struct.unpack_from('<H', data, 2)[0], list(zip(words[::2], words[1::2])), *data[40:44]


def cobs_encode(data):
    return b''.join(bytes([len(run) + 1]) + run for run in data.split(b'\0')) + b'\0'  # frames are short


def cobs_decode(data):
    out, at = b'', 0
    while at < len(data):
        code = data[at]
        if code == 0 or at + code > len(data):
            return b''
        out += data[at + 1:at + code]
        at += code
        if code < 0xFF and at < len(data):
            out += b'\0'
    return out


class Counter:
    """Adds up what frames say; counts wrap at 16 bits."""

    def __init__(self):
        self.sums = [[0, 0] for _ in range(RODS)]
        self.frames = self.lost = self.bad = self.errors = 0
        self.present = self.overflow = self.index = 0
        self.last = None

    def take(self, data):
        frame = decode(data)
        if frame is None:
            self.bad += 1
            return
        sequence, counts, self.present, overflow, quality, self.index = frame
        self.overflow |= overflow
        self.errors += quality
        self.frames += 1
        if self.last:
            self.lost += (sequence - self.last[0] - 1) & 0xFFFF
            for rod in range(RODS):
                for axis in range(2):
                    change = counts[rod][axis] - self.last[1][rod][axis] & 0xFFFF
                    self.sums[rod][axis] += change - 0x10000 if change >= 0x8000 else change
        self.last = (sequence, counts)


class Frames:
    """Cuts bytes into frames: reports of 64 bytes, or COBS up to each 0."""

    def __init__(self, reports):
        self.reports, self.rest, self.whole = reports, b'', reports

    def cut(self, data):
        self.rest += data
        while self.reports and len(self.rest) >= REPORT_BYTES:
            report, self.rest = self.rest[:REPORT_BYTES], self.rest[REPORT_BYTES:]
            yield report[:FRAME_BYTES]
        while not self.reports and b'\0' in self.rest:
            coded, self.rest = self.rest.split(b'\0', 1)
            if coded and self.whole:
                yield cobs_decode(coded)
            self.whole = True  # the first may be the end of a frame


def refuse(sentence):
    """Leaves with one sentence."""
    print(f'rods.py: {sentence}', file=sys.stderr)
    sys.exit(2)


def open_path(scheme, path):
    """Not a pipe, at which opening would wait."""
    try:
        mode = os.stat(path).st_mode
        if scheme == 'file' and not stat.S_ISREG(mode):
            refuse(f'{path} is no regular file: give a recording of a controller.')
        if scheme != 'file' and not stat.S_ISCHR(mode):
            refuse(f'{path} is no device; for a recording write file:{path}')
        descriptor = os.open(path, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
        os.set_blocking(descriptor, True)
        return descriptor
    except OSError as error:
        refuse(f'{path} cannot be opened: {error.strerror}. Rights: docs/cabinet.md, "Connect".')


def open_address(address):
    scheme, _, path = address.partition(':')
    if scheme not in ('serial', 'hid', 'file') or not path:
        refuse(f'"{address}" is not a device: write serial:/dev/ttyACM0, hid:/dev/hidraw0 or file:FILE.')
    descriptor = open_path(scheme, path)
    if scheme == 'serial':
        speed = termios.B1000000
        control = termios.CS8 | termios.CREAD | termios.CLOCAL
        try:
            termios.tcsetattr(descriptor, termios.TCSANOW,
                              [0, 0, control, 0, speed, speed, [b'\0'] * 6 + [b'\1'] + [b'\0'] * 25])
        except termios.error:
            refuse(f'{path} is no serial line; a controller that speaks HID is hid:/dev/hidraw0.')
    reports = scheme == 'hid'
    if scheme == 'file':
        head = os.pread(descriptor, REPORT_BYTES, 0)
        reports = decode(head[:FRAME_BYTES]) is not None
    return descriptor, Frames(reports), scheme == 'file'


def table(counter, rate):
    lines = [f'{rate:6.0f} frames/s, {counter.lost} lost, {counter.bad} bad, {counter.errors} errors at the mice',
             'rod  answers     slide      spin']
    for rod in range(RODS):
        bit = 1 << rod
        lines.append(f'{rod + 1:3}  {"yes" if counter.present & bit else "-":7} {counter.sums[rod][0]:9} '
                     f'{counter.sums[rod][1]:9}{"  mark" if counter.index & bit else ""}'
                     f'{"  overflow" if counter.overflow & bit else ""}')
    return lines


def show_counts(options):
    descriptor, frames, finite = open_address(options.address)
    counter, begun, shown, drawn = Counter(), time.monotonic(), 0, False
    before, gone = (begun, 0), False
    try:
        while not options.seconds or time.monotonic() - begun < options.seconds:
            ready, _, _ = select.select([descriptor], [], [], 0.1)
            data = os.read(descriptor, 4096) if ready else b''
            if ready and not data:
                break
            for frame in frames.cut(data):
                counter.take(frame)
            now = time.monotonic()
            if now - shown > 0.2 and not finite and sys.stdout.isatty():
                rate = (counter.frames - before[1]) / max(now - before[0], 1e-3)
                before = (now, counter.frames)
                print(('\x1b[10A' if drawn else '') + '\n'.join(line + '\x1b[K' for line in table(counter, rate)))
                shown, drawn = now, True
    except KeyboardInterrupt:
        pass
    except OSError as error:
        gone = True
        print(f'{options.address} went away: {error.strerror}. Plug it in again.', file=sys.stderr)
    print('\n'.join(table(counter, 0 if finite else counter.frames / max(time.monotonic() - begun, 1e-3))))
    if counter.frames == 0:
        print('There was no frame: another device, other firmware, or no power? docs/build/troubleshooting.md',
              file=sys.stderr)
    return 1 if gone or counter.frames == 0 else 0


def square(diameter_mm, counts_per_mm):
    per_count = 1e-3 / counts_per_mm
    return {'slide_m_per_count': [per_count, 0.0], 'angle_rad_per_count': [0.0, per_count / (diameter_mm / 2000)]}


def solved(stroke, travel_m, turn, turns):
    """[a b; c d] with [a b; c d] [N P; M Q] = [travel 0; 0 2 pi turns]."""
    (n, m), (p, q) = stroke, turn
    determinant = n * q - p * m
    if abs(determinant) < 0.05 * math.hypot(n, m) * math.hypot(p, q) or determinant == 0:
        refuse('strokes and turns give nearly the same counts: was the rod turned in one and pushed in the other?')
    angle = 2 * math.pi * turns
    return {'slide_m_per_count': [travel_m * q / determinant, -travel_m * p / determinant],
            'angle_rad_per_count': [-angle * m / determinant, angle * n / determinant]}


def read_calibration(path):
    try:
        with open(path, encoding='utf-8') as file:
            calibration = json.load(file)
        if len(calibration['rods']) == RODS and isinstance(calibration['rods'], list):
            return calibration
    except (OSError, ValueError, LookupError, TypeError):
        pass
    return refuse(f'{path} is no calibration yet: write one first, without --rod.')


def write_file(path, data):
    try:
        os.makedirs(os.path.dirname(path) or '.', exist_ok=True)  # out/ is not there in a fresh copy
        with open(path, 'wb') as file:
            file.write(data)
    except OSError as error:
        refuse(f'{path} cannot be written: {error.strerror}. Name a file in a folder that can be written.')
    print(f'written {path}')


def make_calibration(options):
    measured = {'--stroke': options.stroke, '--travel-mm': options.travel_mm, '--turn': options.turn,
                '--turns': options.turns}
    if options.rod is None:
        if any(value is not None for value in measured.values()):
            refuse(f'{", ".join(measured)} are of one rod: say which by --rod 1 to {RODS}.')
        head = {}
        rods = [square(options.diameter_mm, options.counts_per_mm) for _ in range(RODS)]
    else:
        if missing := [name for name, value in measured.items() if value is None]:
            refuse(f'--rod needs {" and ".join(missing)} too: what was measured.')
        head = read_calibration(options.file)
        rods = head.pop('rods')
        rods[options.rod - 1] = solved(options.stroke, 1e-3 * options.travel_mm, options.turn, options.turns)
    head.update(version=3, made=time.strftime('%Y-%m-%dT%H:%M:%SZ', time.gmtime()))
    keys = ''.join(f'  {json.dumps(key)}: {json.dumps(value)},\n' for key, value in head.items())
    rows = ',\n'.join('    ' + json.dumps(rod) for rod in rods)
    write_file(options.file, f'{{\n{keys}  "rods": [\n{rows}\n  ]\n}}\n'.encode())
    return 0


def simulated(seconds, diameter_mm=16, counts_per_mm=8, period_us=4000):
    """COBS frames of rods that go to and fro by 100 mm and turn to and fro by 90 degrees."""
    stream = b''
    for i in range(int(seconds * 1e6 / period_us)):
        t = 1e-6 * i * period_us
        counts = [(round(50 * counts_per_mm * math.sin(2 * math.pi * t / (3 + rod))),
                   round(math.pi / 4 * diameter_mm / 2 * counts_per_mm * math.sin(2 * math.pi * t / (2 + rod))))
                  for rod in range(RODS)]
        stream += cobs_encode(encode(i, i * period_us, counts))
    return stream


def make_recording(options):
    write_file(options.file, simulated(options.seconds))
    return 0


# --- the command line ---

class Parser(argparse.ArgumentParser):
    def error(self, message):
        refuse(f'{message}; --help explains the options.')


def number_within(least, most, either_sign=False):
    """A finite number of that size: of what is known of rods and sensors, so that the game takes the file."""
    def parse(text):
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if least <= (abs(value) if either_sign else value) <= most:
            return value
        sign = ', of either sign' if either_sign else ''
        raise argparse.ArgumentTypeError(f'"{text}" is not a number from {least:g} to {most:g}{sign}')
    return parse


def rod_number(text):
    if text in map(str, range(1, RODS + 1)):
        return int(text)
    raise argparse.ArgumentTypeError(f'"{text}" is not a rod: they are 1, at team 0\'s goal, to {RODS}')


def counts_pair(text):
    a, comma, b = text.partition(',')
    try:
        return int(a), int(b)
    except ValueError:
        raise argparse.ArgumentTypeError(f'"{text}" is no pair of counts such as 2016,-12') from None


def self_test_of_options():
    def leaves_with(code, *arguments):
        said = io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
            try:
                got = run(list(map(str, arguments)))
            except SystemExit as left:
                got = left.code
        text = said.getvalue()
        assert (got, text.count('\n')) == (code, 1 if code else 0) and 'Traceback' not in text, (arguments, got, text)
        return text

    with tempfile.TemporaryDirectory() as folder:
        table, lost = f'{folder}/table.json', f'{folder}/file/within'
        with open(f'{folder}/file', 'wb'):
            pass
        for option, values in {'--diameter-mm': (0, -16, 'nan', 'inf', 'a', 1e300), '--counts-per-mm': (0, 'nan'),
                               '--rod': (0, 9, 1.5, 'a', -1), '--turns': (0, 'nan'),
                               '--stroke': ('1', '1,a', '')}.items():
            for value in values:
                leaves_with(2, 'calibration', table, f'{option}={value}')
        leaves_with(2, 'calibration', lost)
        leaves_with(2, 'simulate', lost)
        for seconds in ('nan', -1, 0, 1e9):
            leaves_with(2, 'simulate', f'{folder}/x', f'--seconds={seconds}')
        measured = ('--stroke=2016,12', '--travel-mm=252', '--turn=-10,2011', '--turns=-5')
        leaves_with(2, 'calibration', table, '--rod=6', *measured)  # no file yet
        leaves_with(2, 'calibration', table, *measured)
        leaves_with(0, 'calibration', table)
        leaves_with(2, 'calibration', table, '--rod=6')
        leaves_with(2, 'calibration', table, '--rod=6', '--stroke=0,0', *measured[1:])
        calibration = read_calibration(table) | {'serial': 'SF-1'}
        with open(table, 'w', encoding='utf-8') as file:
            json.dump(calibration, file)
        leaves_with(0, 'calibration', table, '--rod=8', *measured)
        changed = read_calibration(table)
        assert changed['serial'] == 'SF-1' and changed['rods'][:7] == calibration['rods'][:7]
        assert changed['rods'][7] != calibration['rods'][7]
        os.mkfifo(f'{folder}/pipe')
        for address in ('file:' + folder, f'file:{folder}/pipe', f'serial:{folder}/pipe', 'serial:/dev/null',
                        f'hid:{table}', 'x', 'serial:', f'serial:{lost}'):
            leaves_with(2, 'counts', address)
        leaves_with(0, 'simulate', f'{folder}/out/bench.bin', '--seconds=0.1')
        leaves_with(0, 'counts', f'file:{folder}/out/bench.bin')
    assert table_of_rods() == [str(rod) for rod in range(1, 9)]


def table_of_rods():
    return [line.split()[0] for line in table(Counter(), 0)[2:]]


def self_test():
    assert crc16(b'123456789') == 0x29B1  # CRC-16/CCITT-FALSE
    frame = encode(7, 123456, [(i, -i) for i in range(8)])
    assert len(frame) == FRAME_BYTES and decode(frame)[1][3] == (3, 0xFFFD)
    assert cobs_decode(cobs_encode(frame)[:-1]) == frame and len(cobs_encode(frame)) == 48
    report = frame + bytes(REPORT_BYTES - FRAME_BYTES)
    assert list(Frames(True).cut(report * 2)) == [frame, frame]
    assert decode(frame[:-1] + bytes([frame[-1] ^ 1])) is None
    still = [(0, 0)] * RODS
    assert decode(encode(0, 0, still, index=4))[5] == 4 and decode(encode(0, 0, still, version=1)) is not None
    assert decode(encode(0, 0, still, index=4, version=1)) is None and decode(encode(0, 0, still, version=3)) is None
    counter, frames = Counter(), Frames(False)
    stream = b'xx\0' + simulated(1.5)
    for i in range(0, len(stream), 7):
        for cut in frames.cut(stream[i:i + 7]):
            counter.take(cut)
    assert (counter.frames, counter.lost, counter.bad) == (375, 0, 0)
    wrapping = Counter()
    for i, count in enumerate([0, 30000, 60000, 60000]):
        wrapping.take(encode(i + (i == 3), 0, [(count, -count)] * 8))
    assert wrapping.sums[0] == [60000, -60000] and wrapping.lost == 1
    known = square(16, 8)
    tilt = math.radians(4)
    c, s = math.cos(tilt), math.sin(tilt)
    stroke, turn = (8 * 1000 * c, -8 * 1000 * s), (8 * 5 * math.pi * 16 * s, 8 * 5 * math.pi * 16 * c)
    found = solved(stroke, 1.0, turn, 5)
    for x, y in [(stroke, (1.0, 0)), (turn, (0, 10 * math.pi))]:
        a, b = found['slide_m_per_count'], found['angle_rad_per_count']
        assert abs(a[0] * x[0] + a[1] * x[1] - y[0]) < 1e-9 and abs(b[0] * x[0] + b[1] * x[1] - y[1]) < 1e-9
    assert abs(known['angle_rad_per_count'][1] - 0.015625) < 1e-12
    self_test_of_options()
    print('rods: self-test passed')
    return 0


def run(arguments):
    cli = Parser(prog='rods.py', description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = cli.add_subparsers(required=True, metavar='counts, calibration or simulate')
    counts = verbs.add_parser('counts', help='live counts of a controller')
    counts.add_argument('address')
    counts.add_argument('--seconds', type=number_within(0, 1e6), default=0, help='end after this time, in seconds')
    counts.set_defaults(run=show_counts)
    calibration = verbs.add_parser('calibration', help='write a calibration file')
    calibration.add_argument('file')
    calibration.add_argument('--diameter-mm', type=number_within(5, 60), default=16, help='of the rods (16)')
    calibration.add_argument('--counts-per-mm', type=number_within(1, 472), default=8, help='of the sensors (8)')
    calibration.add_argument('--rod', type=rod_number, metavar='1..8',
                             help="only this one, in the existing file; 1 is at team 0's goal")
    calibration.add_argument('--stroke', type=counts_pair, metavar='N,M', help='slide and spin counts of all strokes')
    calibration.add_argument('--travel-mm', type=number_within(1, 1e5, True), help='of all these strokes together')
    calibration.add_argument('--turn', type=counts_pair, metavar='P,Q', help='slide and spin counts of all turns')
    calibration.add_argument('--turns', type=number_within(0.1, 1000, True), help='how many these were')
    calibration.set_defaults(run=make_calibration)
    simulate = verbs.add_parser('simulate', help='write a recording of rods that move')
    simulate.add_argument('file')
    simulate.add_argument('--seconds', type=number_within(0.1, 3600), default=20, help='of play (20)')
    simulate.set_defaults(run=make_recording)
    options = cli.parse_args(arguments)
    return options.run(options)


def main():
    return self_test() if sys.argv[1:] == ['--self-test'] else run(sys.argv[1:])


if __name__ == '__main__':
    sys.exit(main())
