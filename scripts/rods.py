#!/usr/bin/env python3
"""For a maker at a bench, before there is a game: what a cabinet's controller sends, and a first calibration.

  scripts/rods.py counts ADDRESS       live counts of each rod (serial:/dev/ttyACM0, hid:/dev/hidraw0,
                                       file:FILE); Ctrl-C ends it and prints the sums since the start
  scripts/rods.py calibration FILE     writes the calibration of sensors that are mounted square, or of
                                       one rod from its measured counts
  scripts/rods.py simulate FILE        writes a recording of a controller whose rods move, to try the
                                       rest without parts
  scripts/rods.py --self-test

The frame is described in wire/include/wire/device_frame.h, the calibration in docs/cabinet.md.
"""
import argparse
import json
import math
import os
import select
import struct
import sys
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


def open_address(address):
    scheme, _, path = address.partition(':')
    if scheme not in ('serial', 'hid', 'file') or not path:
        sys.exit(f'"{address}" names no device: write serial:/dev/ttyACM0, hid:/dev/hidraw0 or file:FILE.')
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOCTTY)
    except OSError as error:
        sys.exit(f'{path} cannot be opened: {error.strerror}. Rights: docs/cabinet.md, "Connect".')
    if scheme == 'serial':
        speed = termios.B1000000
        control = termios.CS8 | termios.CREAD | termios.CLOCAL
        termios.tcsetattr(descriptor, termios.TCSANOW,
                          [0, 0, control, 0, speed, speed, [b'\0'] * 6 + [b'\1'] + [b'\0'] * 25])
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
        lines.append(f'{rod:3}  {"yes" if counter.present & bit else "-":7} {counter.sums[rod][0]:9} '
                     f'{counter.sums[rod][1]:9}{"  mark" if counter.index & bit else ""}'
                     f'{"  overflow" if counter.overflow & bit else ""}')
    return lines


def show_counts(options):
    descriptor, frames, finite = open_address(options.address)
    counter, begun, shown, drawn = Counter(), time.monotonic(), 0, False
    before = (begun, 0)
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
        print(f'{options.address}: {error.strerror}', file=sys.stderr)
    print('\n'.join(table(counter, 0 if finite else counter.frames / max(time.monotonic() - begun, 1e-3))))
    if counter.frames == 0:
        print('There was no frame: another device, other firmware, or no power? docs/build/troubleshooting.md',
              file=sys.stderr)
        return 1
    return 0


def square(diameter_mm, counts_per_mm):
    per_count = 1e-3 / counts_per_mm
    return {'slide_m_per_count': [per_count, 0.0], 'angle_rad_per_count': [0.0, per_count / (diameter_mm / 2000)]}


def solved(stroke, travel_m, turn, turns):
    """[a b; c d] with [a b; c d] [N P; M Q] = [travel 0; 0 2 pi turns]."""
    (n, m), (p, q) = stroke, turn
    determinant = n * q - p * m
    if abs(determinant) < 0.05 * math.hypot(n, m) * math.hypot(p, q) or determinant == 0:
        sys.exit('Strokes and turns give nearly the same counts: was the rod turned in one and pushed in the other?')
    angle = 2 * math.pi * turns
    return {'slide_m_per_count': [travel_m * q / determinant, -travel_m * p / determinant],
            'angle_rad_per_count': [-angle * m / determinant, angle * n / determinant]}


def pair(text):
    a, b = text.split(',')
    return int(a), int(b)


def make_calibration(options):
    if options.rod is None:
        rods = [square(options.diameter_mm, options.counts_per_mm) for _ in range(RODS)]
    else:
        if None in (options.stroke, options.travel_mm, options.turn, options.turns):
            sys.exit('--rod needs --stroke, --travel-mm, --turn and --turns: what was measured.')
        try:
            with open(options.file, encoding='utf-8') as file:
                rods = json.load(file)['rods']
            rods[options.rod]
        except (OSError, ValueError, LookupError, TypeError):
            sys.exit(f'{options.file} is no calibration yet: write one first, without --rod.')
        rods[options.rod] = solved(options.stroke, 1e-3 * options.travel_mm, options.turn, options.turns)
    rows = ',\n'.join('    ' + json.dumps(rod) for rod in rods)
    with open(options.file, 'w', encoding='utf-8') as file:
        file.write(f'{{\n  "version": 2,\n  "rods": [\n{rows}\n  ]\n}}\n')
    print(f'written {options.file}')
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
    with open(options.file, 'wb') as file:
        file.write(simulated(options.seconds))
    print(f'written {options.file}')
    return 0


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
    print('rods: self-test passed')
    return 0


def main():
    if sys.argv[1:] == ['--self-test']:
        return self_test()
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = cli.add_subparsers(required=True)
    counts = verbs.add_parser('counts', help='live counts of a controller')
    counts.add_argument('address')
    counts.add_argument('--seconds', type=float, default=0, help='end after so many')
    counts.set_defaults(run=show_counts)
    calibration = verbs.add_parser('calibration', help='write a calibration file')
    calibration.add_argument('file')
    calibration.add_argument('--diameter-mm', type=float, default=16, help='of the rods (16)')
    calibration.add_argument('--counts-per-mm', type=float, default=8, help='of the sensors (8)')
    calibration.add_argument('--rod', type=int, choices=range(RODS), help='only this one, in the file that is there')
    calibration.add_argument('--stroke', type=pair, metavar='N,M', help='slide and spin counts of all strokes')
    calibration.add_argument('--travel-mm', type=float, help='of all these strokes together')
    calibration.add_argument('--turn', type=pair, metavar='P,Q', help='slide and spin counts of all turns')
    calibration.add_argument('--turns', type=float, help='how many these were')
    calibration.set_defaults(run=make_calibration)
    simulate = verbs.add_parser('simulate', help='write a recording of rods that move')
    simulate.add_argument('file')
    simulate.add_argument('--seconds', type=float, default=20)
    simulate.set_defaults(run=make_recording)
    options = cli.parse_args()
    return options.run(options)


if __name__ == '__main__':
    sys.exit(main())
