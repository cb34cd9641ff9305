#!/usr/bin/env python3
"""Renders the printed parts of cabinet/parts/ with OpenSCAD: scripts/build_parts.sh runs it.

Each part becomes an STL file, which is checked: every edge joins exactly two triangles that run it in
opposite ways (a closed mesh), the volume is positive, the part fits the printer's bed and lies on it. Parts
that are put together must not be in one place (cabinet/parts/fits.scad).
With --pictures the guide's pictures are drawn too. --pictures-current fails where a picture is missing
or older than what it shows. --self-test checks the check of meshes.
"""
import argparse
import hashlib
import re
import struct
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / 'cabinet/parts'
PICTURES = ROOT / 'docs/build/pictures'
DRAWN_FROM = PICTURES / 'parts.sha256'
BED_MM = (200.0, 200.0, 180.0)  # of a small printer
PICTURE_BYTES = 60_000
IMAGE_SIZE = (1600, 1200)  # before it is cropped and scaled

# Name of the STL file: source, definitions.
PARTS = {
    'rod_bearing': ('rod_bearing.scad', {}),
    'sensor_clamp': ('sensor_mount.scad', {'part': 'clamp'}),
    'sensor_plate_pmw3360': ('sensor_mount.scad', {'part': 'plate', 'board': 'pmw3360'}),
    'sensor_plate_ps2': ('sensor_mount.scad', {'part': 'plate', 'board': 'ps2'}),
    'lens_gauge': ('sensor_mount.scad', {'part': 'gauge'}),
    'stop_collar': ('stop_collar.scad', {}),
    'index_ring': ('index_ring.scad', {}),
    'handle': ('handle.scad', {}),
}
# What is put together: pairs of cabinet/parts/fits.scad.
FITS = ['gauge plate', 'board plate', 'rod plate', 'rod clamp', 'clamp plate', 'bearing clamp']
BOARDS = ['pmw3360', 'ps2']
# Name of the picture: source, definitions, rotation of the camera.
VIEWS = {
    'step-1-bearing': ('assembly.scad', {'stage': 1}, '62,0,40'),
    'step-2-clamp': ('assembly.scad', {'stage': 2}, '62,0,40'),
    'step-3-rod': ('assembly.scad', {'stage': 3}, '62,0,40'),
    'step-4-board': ('assembly.scad', {'stage': 4}, '62,0,40'),
    'step-5-distance': ('assembly.scad', {'stage': 5}, '68,0,48'),
    'step-6-finished': ('assembly.scad', {'stage': 6}, '62,0,40'),
    'exploded': ('assembly.scad', {'stage': 7}, '66,0,24'),
    'broomstick': ('assembly.scad', {'stage': 8}, '64,0,32'),
    'part-rod-bearing': ('rod_bearing.scad', {}, '60,0,35'),
    'part-sensor-clamp': ('sensor_mount.scad', {'part': 'clamp'}, '60,0,125'),
    'part-sensor-plate': ('sensor_mount.scad', {'part': 'plate'}, '50,0,35'),
    'part-lens-gauge': ('sensor_mount.scad', {'part': 'gauge'}, '60,0,35'),
    'part-stop-collar': ('stop_collar.scad', {}, '60,0,215'),
    'part-index-ring': ('index_ring.scad', {}, '50,0,35'),
    'part-handle': ('handle.scad', {}, '60,0,35'),
}


def triangles_of(data):
    """Of an STL file, text or binary: each three points of three numbers."""
    if data.startswith(b'solid') and b'vertex' in data:
        points = [tuple(map(float, v)) for v in re.findall(r'vertex\s+(\S+)\s+(\S+)\s+(\S+)', data.decode())]
        return [tuple(points[i:i + 3]) for i in range(0, len(points), 3)]
    count = struct.unpack_from('<I', data, 80)[0]
    rows = (struct.unpack_from('<12f', data, 84 + 50 * i) for i in range(count))
    return [(row[3:6], row[6:9], row[9:12]) for row in rows]


def volume_of(triangles):
    return sum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) for a, b, c in triangles) / 6


def faults_of(triangles, bed=BED_MM):
    if not triangles:
        return ['it is empty']
    faults = []
    edges = Counter((t[i], t[(i + 1) % 3]) for t in triangles for i in range(3) if t[i] != t[(i + 1) % 3])
    loose = sum(1 for (a, b), n in edges.items() if n != 1 or edges[(b, a)] != 1)
    if loose:
        faults.append(f'the mesh is not closed: {loose} edges do not join two triangles')
    if volume_of(triangles) <= 0:
        faults.append('its volume is not positive: it is inside out')
    low, high = extent_of(triangles)
    for axis, size in enumerate(bed):
        if high[axis] - low[axis] > size:
            faults.append(f'it is {high[axis] - low[axis]:.0f} mm along {"xyz"[axis]}; the bed has {size:.0f}')
    return faults


def extent_of(triangles):
    points = [p for t in triangles for p in t]
    return [min(p[i] for p in points) for i in range(3)], [max(p[i] for p in points) for i in range(3)]


def ran_openscad(source, defined, out, *options):
    words = ['openscad', '-o', str(out), *options]
    for name, value in defined.items():
        words += ['-D', f'{name}={value}' if isinstance(value, int) else f'{name}="{value}"']
    return subprocess.run([*words, str(SOURCES / source)], capture_output=True, text=True)


def openscad(source, defined, out, *options):
    ran = ran_openscad(source, defined, out, *options)
    if ran.returncode or 'WARNING' in ran.stderr:
        sys.exit(f'openscad {source} {defined}:\n{ran.stderr}')


def overlaps():
    """Of what is put together."""
    with tempfile.TemporaryDirectory() as folder:
        for pair in FITS:
            for board in BOARDS:
                ran = ran_openscad('fits.scad', {'pair': pair, 'board': board}, Path(folder) / 'common.stl')
                if 'object is empty' not in ran.stderr or 'WARNING' in ran.stderr:
                    yield f'{" and ".join(pair.split())}, board {board}, are in one place\n{ran.stderr}'


def make_parts(out):
    out.mkdir(parents=True, exist_ok=True)
    bad = 0
    for name, (source, defined) in PARTS.items():
        file = out / f'{name}.stl'
        openscad(source, defined, file)
        triangles = triangles_of(file.read_bytes())
        faults = faults_of(triangles)
        low, high = extent_of(triangles) if triangles else ([0] * 3, [0] * 3)
        size = ' x '.join(f'{high[i] - low[i]:.1f}' for i in range(3))
        grams = volume_of(triangles) * 1.27e-3  # PETG, without cavities
        print(f'{name:22} {size:22} mm  {len(triangles):6} triangles  {grams:5.0f} g if solid')
        for fault in faults:
            print(f'{name}: {fault}', file=sys.stderr)
        bad += len(faults)
    for fault in overlaps():
        print(fault, file=sys.stderr)
        bad += 1
    return bad


def draw_pictures(names):
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in names or VIEWS:
        source, defined, camera = VIEWS[name]
        small = name.startswith('part-')
        with tempfile.TemporaryDirectory() as folder:
            raw, scaled = Path(folder) / 'raw.png', Path(folder) / 'scaled.png'
            openscad(source, defined, raw, '--imgsize={},{}'.format(*IMAGE_SIZE), f'--camera=0,0,0,{camera},500', '--viewall',
                     '--autocenter', '--colorscheme=Tomorrow', '--projection=p')
            subprocess.run(['ffmpeg', '-loglevel', 'error', '-y', '-i', raw, '-vf',
                            f'crop={crop_of(raw)},scale={400 if small else 800}:{300 if small else 500}:'
                            'force_original_aspect_ratio=decrease:flags=area', scaled], check=True)
            subprocess.run(['pngquant', '--force', '--strip', '--speed', '1', '--output',
                            PICTURES / f'{name}.png', '48', scaled], check=True)
    if not names:
        DRAWN_FROM.write_text(sources_hash() + '\n')


def crop_of(picture, size=IMAGE_SIZE, margin=24):
    """width:height:x:y of what is not background, for ffmpeg's filter."""
    raw = subprocess.run(['ffmpeg', '-loglevel', 'error', '-i', picture, '-f', 'rawvideo', '-pix_fmt', 'rgb24', '-'],
                         capture_output=True, check=True).stdout
    width, height = size
    rows = [raw[3 * width * y:3 * width * (y + 1)] for y in range(height)]
    empty = raw[:3] * width
    shown = [y for y in range(height) if rows[y] != empty]
    # Of a row's ends, what is background there.
    left = min(len(rows[y]) - len(rows[y].lstrip(raw[:1])) for y in shown) // 3
    right = max(len(rows[y].rstrip(raw[:1])) for y in shown) // 3
    x, y = max(0, left - margin), max(0, shown[0] - margin)
    return f'{min(width, right + margin) - x}:{min(height, shown[-1] + 1 + margin) - y}:{x}:{y}'


def sources_hash():
    """Of all that the pictures show; comments and white space do not count."""
    text = ''
    for file in sorted(SOURCES.glob('*.scad')):
        text += file.name + ''.join(re.sub(r'//[^\n]*', '', file.read_text()).split())
    return hashlib.sha256((text + repr(sorted(VIEWS.items()))).encode()).hexdigest()


def picture_faults():
    for name in VIEWS:
        file = PICTURES / f'{name}.png'
        if not file.exists():
            yield f'{file.relative_to(ROOT)} is missing'
        elif file.stat().st_size > PICTURE_BYTES:
            yield f'{file.relative_to(ROOT)} has {file.stat().st_size} bytes, more than {PICTURE_BYTES}'
    if not DRAWN_FROM.exists() or DRAWN_FROM.read_text().strip() != sources_hash():
        yield 'the pictures of docs/build/pictures are older than cabinet/parts: run scripts/build_parts.sh --pictures'


def self_test():
    o, x, y, z = (0., 0., 0.), (1., 0., 0.), (0., 1., 0.), (0., 0., 1.)
    solid = [(o, y, x), (o, x, z), (o, z, y), (x, y, z)]
    assert faults_of(solid) == [] and abs(volume_of(solid) - 1 / 6) < 1e-12
    assert 'not closed' in faults_of(solid[:3])[0]
    assert any('inside out' in f for f in faults_of([t[::-1] for t in solid]))
    assert any('not closed' in f for f in faults_of([solid[0][::-1], *solid[1:]]))
    assert any('bed' in f for f in faults_of(solid, (0.5, 9, 9)))
    assert faults_of([]) == ['it is empty']
    text = 'solid s\n' + ''.join('facet\nouter loop\n' + ''.join(f'vertex {p[0]} {p[1]} {p[2]}\n' for p in t) +
                                 'endloop\nendfacet\n' for t in solid) + 'endsolid s\n'
    assert triangles_of(text.encode()) == solid
    binary = bytes(80) + struct.pack('<I', 4) + b''.join(
        struct.pack('<12fH', 0, 0, 0, *t[0], *t[1], *t[2], 0) for t in solid)
    assert triangles_of(binary) == solid
    print('render_parts: self-test passed')


def main():
    cli = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    cli.add_argument('--out', type=Path, default=ROOT / 'out/parts', help='folder of the STL files (out/parts)')
    cli.add_argument('--pictures', nargs='*', metavar='NAME', help='draw the pictures of docs/build/pictures')
    cli.add_argument('--pictures-current', action='store_true', help='only check that they are current')
    cli.add_argument('--self-test', action='store_true')
    options = cli.parse_args()
    if options.self_test:
        return self_test()
    if options.pictures_current:
        faults = list(picture_faults())
        print(*faults, sep='\n', end='\n' if faults else '', file=sys.stderr)
        print(f'render_parts: {len(VIEWS)} pictures, {len(faults)} faults')
        return 1 if faults else 0
    if options.pictures is not None:
        draw_pictures(options.pictures)
        return 0
    return 1 if make_parts(options.out) else 0


if __name__ == '__main__':
    sys.exit(main())
