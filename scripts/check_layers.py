#!/usr/bin/env python3
"""Reads every #include and fails on an arrow that runs back.

The rules are the two tables below; ARCHITECTURE.md draws them. A layer is a folder; an include is
resolved to a file of the repository, and that file's layer must be among those that the including
layer may use. Includes that resolve to nothing here are the system's and other libraries'; the pure
layers have a list of those that they may not use. Circles of includes are refused everywhere.

  scripts/check_layers.py               checks the repository
  scripts/check_layers.py --self-test   checks this script against small trees, good and bad
"""
import argparse
import os
import re
import sys
import tempfile
from pathlib import Path

# Longest prefix wins. A public header of vphysics belongs to the layer that it is the face of.
LAYERS = {
    'os/': 'os',
    'vphysics/src/lie/': 'lie',
    'vphysics/include/vphysics/assert.h': 'lie',
    'vphysics/src/assert.cpp': 'lie',
    'vphysics/src/cpu_level.h': 'lie',
    'vphysics/src/parallel.h': 'lie',
    'vphysics/include/vphysics/task_scheduler.h': 'lie',
    'vphysics/include/vphysics/error.h': 'lie',
    'vphysics/include/vphysics/ids.h': 'lie',
    'vphysics/include/vphysics/lie.h': 'lie',
    'vphysics/include/vphysics/lie/': 'lie',
    'vphysics/src/multibody/': 'multibody',
    'vphysics/include/vphysics/multibody.h': 'multibody',
    'vphysics/include/vphysics/multibody/': 'multibody',
    'vphysics/src/files/': 'files',
    'vphysics/src/mesh_file/': 'mesh-file',
    'vphysics/include/vphysics/mesh_file.h': 'mesh-file',
    'vphysics/src/urdf/': 'urdf',
    'vphysics/src/urdf_world/': 'urdf-world',
    'vphysics/include/vphysics/urdf_world.h': 'urdf-world',
    'vphysics/include/vphysics/multibody/urdf.h': 'urdf',
    'vphysics/src/collide/': 'collide',
    'vphysics/include/vphysics/compound.h': 'collide',
    'vphysics/include/vphysics/convex_hull.h': 'collide',
    'vphysics/include/vphysics/height_field.h': 'collide',
    'vphysics/include/vphysics/shapes.h': 'collide',
    'vphysics/include/vphysics/triangle_mesh.h': 'collide',
    'vphysics/src/solve/': 'solve',
    'vphysics/': 'vphysics-tests',
    'vphysics/src/': 'world',
    'vphysics/include/': 'world',
    'vphysics/samples/': 'vphysics-samples',
    'scenes/': 'scenes-tests',
    'scenes/src/': 'scenes',
    'scenes/include/': 'scenes',
    'foosball/': 'foosball-tests',
    'foosball/src/': 'foosball',
    'foosball/include/': 'foosball',
    'wire/': 'wire',
    'wire/include/wire/device_command.h': 'device-frame',
    'wire/include/wire/device_frame.h': 'device-frame',
    'wire/include/wire/device_settings.h': 'device-frame',
    'cabinet/': 'cabinet',
    'cabinet/include/cabinet/hand.h': 'hand',
    'cabinet/include/cabinet/haptics.h': 'hand',
    'cabinet/include/cabinet/rod_input.h': 'hand',
    'cabinet/include/cabinet/rate_filter.h': 'hand',
    'firmware/': 'firmware',
    'results/': 'results',
    'profile/': 'profile',
    'characters/': 'characters',
    'server/': 'server',
    'match/': 'match',
    'draw/': 'draw',
    'client/': 'client',
    'sandbox/': 'sandbox',
    'foosball/include/foosball/assists.h': 'table',
    'foosball/include/foosball/character.h': 'table',
    'foosball/include/foosball/feed.h': 'table',
    'foosball/include/foosball/game_setup.h': 'table',
    'foosball/include/foosball/judgment.h': 'table',
    'foosball/include/foosball/play_style.h': 'table',
    'foosball/include/foosball/rod_motion.h': 'table',
    'foosball/include/foosball/rules.h': 'table',
    'foosball/include/foosball/table.h': 'table',
    'foosball/include/foosball/tuning.h': 'table',
    'tools/': 'tools',
    'tools/video/': 'video',
    'tools/watch/': 'watch',
    'tools/calibrate/': 'calibrate',
    'benchmarks/': 'benchmarks',
    'tests/': 'tests',
}

ENGINE = {'lie', 'multibody', 'collide', 'solve', 'world'}
ENGINE_FACE = 'public headers of vphysics'  # what other rooms may see of the engine

# layer: the layers it may use beside itself.
MAY_USE = {
    'lie': set(),
    'multibody': {'lie'},
    'collide': {'lie'},
    'solve': {'lie', 'multibody', 'collide'},
    'world': {'lie', 'multibody', 'collide', 'solve'},
    # A library of its own reads files; the engine proper is pure.
    'files': {'lie'},
    'mesh-file': {'lie', 'collide', 'files'},
    'urdf': {'lie', 'multibody', 'files'},
    'urdf-world': {ENGINE_FACE, 'mesh-file', 'urdf', 'files'},
    'vphysics-tests': ENGINE | {'files', 'mesh-file', 'urdf', 'urdf-world', 'scenes'},
    'vphysics-samples': {ENGINE_FACE},
    'table': {ENGINE_FACE},
    'scenes': {ENGINE_FACE},
    'scenes-tests': {ENGINE_FACE, 'scenes'},
    'foosball': {ENGINE_FACE, 'table'},
    'foosball-tests': {ENGINE_FACE, 'table', 'foosball'},
    'device-frame': set(),
    'wire': {'device-frame'},
    'os': set(),
    'hand': {'device-frame'},
    'cabinet': {'os', 'device-frame', 'hand'},
    'firmware': {'device-frame'},
    'results': set(),
    'profile': {ENGINE_FACE, 'table'},
    'characters': {ENGINE_FACE, 'profile', 'table', 'wire'},
    'server': {ENGINE_FACE, 'profile', 'characters', 'os', 'results', 'table', 'foosball', 'wire', 'device-frame', 'cabinet', 'hand'},
    # Plays and records matches as the server does, without its sockets.
    'match': {ENGINE_FACE, 'profile', 'characters', 'os', 'table', 'foosball', 'wire', 'device-frame', 'cabinet', 'hand', 'server', 'results'},
    # The client draws from snapshots only: the table's geometry, the rules' numbers, never the match.
    'draw': set(),
    'client': {ENGINE_FACE, 'characters', 'os', 'draw', 'profile', 'table', 'wire', 'device-frame', 'hand'},
    # Has its worlds in its own process; knows of no match and no wire.
    'sandbox': {ENGINE_FACE, 'os', 'draw', 'scenes'},
    # A recording drawn as the client draws it: in these two, and only there, server and client meet.
    'video': {ENGINE_FACE, 'characters', 'os', 'draw', 'table', 'foosball', 'wire', 'cabinet', 'server', 'client'},
    'watch': {ENGINE_FACE, 'characters', 'os', 'draw', 'table', 'foosball', 'wire', 'cabinet', 'hand', 'server',
              'client', 'video'},
    'calibrate': {ENGINE_FACE, 'os', 'draw', 'table', 'device-frame', 'hand', 'cabinet', 'client'},
    'tools': {ENGINE_FACE, 'os', 'results', 'table', 'scenes', 'foosball', 'wire', 'device-frame', 'cabinet', 'hand', 'server'},
    'benchmarks': {ENGINE_FACE, 'table', 'scenes'},
    'tests': {ENGINE_FACE, 'os', 'table', 'scenes', 'foosball', 'wire', 'device-frame', 'cabinet', 'calibrate', 'hand',
              'firmware', 'server', 'draw', 'client'},
}

# No clock, no file, no socket, no thread, no randomness that was not handed in.
# Large pages of memory are asked for by sys/mman.h.
IMPURE = re.compile(
    r'^(chrono|ctime|time\.h|random|fstream|iostream|cstdio|stdio\.h|filesystem|thread|mutex|future|'
    r'condition_variable|unistd\.h|fcntl\.h|sys/(?!mman\.h).*|arpa/.*|netinet/.*|poll\.h|pthread\.h|asio.*|'
    r'spdlog/.*|GLFW/.*|GLES.*|AL/.*|unordered_map|unordered_set)$')
PURE = ENGINE | {'table', 'foosball', 'scenes'}

SOURCES = ('.h', '.hpp', '.c', '.cpp', '.inl')
SKIPPED = {'build', 'out', '.git'}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]')


def layer_of(path):
    best = max((p for p in LAYERS if path == p or (p.endswith('/') and path.startswith(p))), key=len,
               default=None)
    return LAYERS[best] if best else None


def is_engine_face(path):
    return path.startswith('vphysics/include/')


class Tree:
    """The sources under a root, and what an include in one of them means."""

    def __init__(self, root):
        self.root = Path(root)
        self.files = []
        self.by_suffix = {}
        for folder, folders, names in os.walk(self.root):
            folders[:] = sorted(f for f in folders if f not in SKIPPED)
            for name in sorted(names):
                if name.endswith(SOURCES):
                    self._add((Path(folder) / name).relative_to(self.root).as_posix())

    def _add(self, path):
        self.files.append(path)
        parts = path.split('/')
        for i in range(len(parts)):
            self.by_suffix.setdefault('/'.join(parts[i:]), []).append(path)

    def resolve(self, source, name):
        beside = os.path.normpath(os.path.join(os.path.dirname(source), name)).replace(os.sep, '/')
        if (self.root / beside).is_file():
            return beside
        if name.startswith('..'):
            return None
        found = [f for f in self.by_suffix.get(name, []) if f != source]
        room = source.split('/')[0]
        # Of several, the public header, then the one of the same room: as the include paths have it.
        found.sort(key=lambda f: (not f.endswith('/include/' + name), f.split('/')[0] != room, f))
        return found[0] if found else None

    def includes(self, source):
        text = (self.root / source).read_text(encoding='utf-8', errors='replace')
        for number, line in enumerate(text.splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                yield number, match.group(2)


def rule_broken(source, target):
    """The sentence that says which rule the include breaks, or None."""
    own, other = layer_of(source), layer_of(target)
    if own is None:
        return None
    if other is None:
        return f'{target} is in no layer: give it one in scripts/check_layers.py'
    allowed = MAY_USE[own]
    if other == own or other in allowed:
        return None
    if ENGINE_FACE in allowed and is_engine_face(target):
        return None
    return f'layer "{own}" may use {", ".join(sorted(allowed)) or "no other layer"}; this is "{other}"'


def circle_from(start, graph, done):
    """A circle of includes reachable from start, as a list of files, or None."""
    path, on_path, stack = [start], {start}, [iter(graph.get(start, ()))]
    while stack:
        target = next(stack[-1], None)
        if target is None:
            stack.pop()
            done.add(path[-1])
            on_path.discard(path.pop())
        elif target in on_path:
            return path[path.index(target):] + [target]
        elif target not in done:
            path.append(target)
            on_path.add(target)
            stack.append(iter(graph.get(target, ())))
    return None


def check(root):
    """All faults under root, as "file:line: sentence", and how much was read."""
    tree = Tree(root)
    faults, graph, count = [], {}, 0
    for source in tree.files:
        if layer_of(source) is None:
            faults.append(f'{source}:1: in no layer: give it one in scripts/check_layers.py')
        for line, name in tree.includes(source):
            count += 1
            target = tree.resolve(source, name)
            if name.endswith('.cpp'):
                broken = 'a source is compiled, not included'
            elif target:
                graph.setdefault(source, []).append(target)
                broken = rule_broken(source, target)
            else:
                broken = None
                if layer_of(source) in PURE and IMPURE.match(name):
                    broken = f'<{name}> in layer "{layer_of(source)}", which is pure simulation: ' \
                             'no clock, file, socket, thread, generator or unordered container'
            if broken:
                faults.append(f'{source}:{line}: includes "{name}": {broken}')
    done = set()
    for source in sorted(graph):
        if source not in done:
            circle = circle_from(source, graph, done)
            if circle:
                faults.append(f'{circle[0]}:1: a circle of includes: {" -> ".join(circle)}')
                break
    return faults, len(tree.files), count


GOOD = {
    'vphysics/include/vphysics/lie.h': '#include <cmath>\n',
    'vphysics/include/vphysics/world.h': '#include "vphysics/lie.h"\n',
    'vphysics/src/world/world.cpp': '#include "vphysics/world.h"\n#include "solve/contact.h"\n',
    'vphysics/src/solve/contact.h': '#include "vphysics/lie.h"\n#include "collide/narrow.h"\n',
    'vphysics/src/collide/narrow.h': '#include "vphysics/lie.h"\n',
    'foosball/include/foosball/match.h': '#include "vphysics/world.h"\n#include "foosball/table.h"\n',
    'foosball/include/foosball/table.h': '#include "vphysics/lie.h"\n',
    'wire/include/wire/device_frame.h': '#include <cstdint>\n',
    'wire/include/wire/snapshot.h': '#include "wire/device_frame.h"\n',
    'cabinet/include/cabinet/hand.h': '#include <chrono>\n',
    'cabinet/src/source.cpp': '#include "wire/device_frame.h"\n#include "cabinet/hand.h"\n',
    'client/src/draw.cpp': '#include "foosball/table.h"\n#include "wire/snapshot.h"\n',
    'os/include/os/clock.h': '#include <time.h>\n',
    'server/src/loop.cpp': '#include "foosball/match.h"\n#include "os/clock.h"\n#include <chrono>\n',
    'foosball/tests/match_test.cpp': '#include "foosball/match.h"\n#include <fstream>\n',
}
# Added to GOOD one at a time: the file, its text, and the place that must be named.
BAD = [
    ('vphysics/src/lie/exp.cpp', '\n#include "vphysics/world.h"\n', 'vphysics/src/lie/exp.cpp:2'),
    ('vphysics/src/collide/broad.h', '#include "solve/contact.h"\n', 'vphysics/src/collide/broad.h:1'),
    ('vphysics/src/world/ball.cpp', '#include "foosball/table.h"\n', 'vphysics/src/world/ball.cpp:1'),
    ('foosball/src/men.cpp', '#include "collide/narrow.h"\n', 'foosball/src/men.cpp:1'),
    ('foosball/src/clock.cpp', '#include <chrono>\n', 'foosball/src/clock.cpp:1'),
    ('wire/src/encode.cpp', '#include "vphysics/lie.h"\n', 'wire/src/encode.cpp:1'),
    ('cabinet/src/a.cpp', '#  include  "wire/snapshot.h"\n', 'cabinet/src/a.cpp:1'),
    ('firmware/core/ps2.cpp', '#include "cabinet/hand.h"\n', 'firmware/core/ps2.cpp:1'),
    ('client/src/rules.cpp', '#include "foosball/match.h"\n', 'client/src/rules.cpp:1'),
    ('client/src/back.cpp', '#include "../../server/src/loop.h"\n', 'client/src/back.cpp:1'),
    ('server/src/draw.cpp', '#include "client/src/view.h"\n', 'server/src/draw.cpp:1'),
    ('vphysics/samples/s.cpp', '#include "solve/contact.h"\n', 'vphysics/samples/s.cpp:1'),
    ('os/src/a.cpp', '#include "cabinet/hand.h"\n', 'os/src/a.cpp:1'),
    ('vphysics/src/world/clock.cpp', '#include "os/clock.h"\n', 'vphysics/src/world/clock.cpp:1'),
    ('draw/src/a.cpp', '#include "vphysics/world.h"\n', 'draw/src/a.cpp:1'),
    ('sandbox/src/a.cpp', '#include "wire/snapshot.h"\n', 'sandbox/src/a.cpp:1'),
    ('cellar/a.cpp', '', 'cellar/a.cpp:1'),
    ('wire/src/all.cpp', '#include "text.cpp"\n', 'wire/src/all.cpp:1'),
    ('wire/src/a.h', '#include "b.h"\n', 'a circle of includes'),
]
BESIDE_BAD = {'server/src/loop.h': '', 'client/src/view.h': '', 'wire/src/b.h': '#include "a.h"\n'}


def write(root, files):
    for name, text in files.items():
        path = Path(root) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def self_test():
    wrong = []
    for name, text, expected in [('', '', None)] + BAD:
        with tempfile.TemporaryDirectory() as root:
            write(root, GOOD)
            if name:
                needed = {k: v for k, v in BESIDE_BAD.items()
                          if os.path.basename(k) in text or k.startswith(os.path.dirname(name) + '/b')}
                write(root, needed | {name: text})
            faults, _, _ = check(root)
        if expected is None and faults:
            wrong.append(f'the good tree was refused: {faults}')
        if expected and (len(faults) != 1 or expected not in faults[0]):
            wrong.append(f'{name}: expected one fault naming {expected}, got {faults}')
    for line in wrong:
        print(line, file=sys.stderr)
    print(f'layers, self-test: {len(BAD) + 1} trees, {len(wrong)} judged wrongly')
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('--root', default=Path(__file__).resolve().parent.parent)
    args = parser.parse_args()
    if args.self_test:
        return self_test()
    faults, files, includes = check(args.root)
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f'layers: {includes} includes in {files} files, {len(faults)} against the arrows')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
