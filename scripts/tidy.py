#!/usr/bin/env python3
"""Runs clang-tidy: on all of the libraries and programs each time, on every change with everything.

Half of what clang-tidy costs is the headers of a source, and half of the rest the analyzer, which
follows paths. So:
- The libraries and programs are looked at together, as a unity build (--unity, a folder that is
  configured so, with its generated sources) compiles them: by all checks but the analyzer, and by the
  analyzer too where a source of theirs changed since the base (CHECK_BASE, or where this branch left
  main). They are copied into one file each: of a file that is included the analyzer follows no path.
- Of what a unity build compiles alone, tests and the readers of command lines, all that changed is
  looked at, however long it takes.
- Then, newest first and until 120 s after the beginning (SF_TIDY_SECONDS), the analyzer has the other
  libraries and programs, and all checks the other sources. How many were left out is said; --all
  leaves out none.
"""
import argparse
import bisect
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INCLUDED = re.compile(r'^#include "(/[^"]+)"', re.M)
# Two sources of one file may well have the same include.
TOGETHER = '--checks=-readability-duplicate-include'
WITHOUT_ANALYZER = TOGETHER + ',-clang-analyzer-*'
ANALYZER = '--checks=-*,clang-analyzer-*,-clang-analyzer-optin.performance.Padding'

# What must be found in the second of two sources, where it is: by the analyzer, and by a plain check.
FAULTY = '''int* found(int key) { return key > 0 ? &key : nullptr; }
int read_it(int key) {
  int* at = nullptr;
  if (key > 3) return *at;
  return 0;
}
bool same(bool a) { if (a) return true; else return false; }
'''
FAULTS = [(4, 'clang-analyzer-core.NullDereference'), (7, 'readability-simplify-boolean-expr')]


def git(*words):
    done = subprocess.run(['git', '-C', str(ROOT), *words], capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ''


def base_commit():
    head = git('rev-parse', 'HEAD')
    for name in filter(None, [os.environ.get('CHECK_BASE'), 'origin/main', 'main']):
        base = git('merge-base', 'HEAD', name)
        if base and base != head:
            return base
    return None


def not_committed():
    return git('diff', '--name-only', 'HEAD').splitlines() + \
        git('ls-files', '--others', '--exclude-standard').splitlines()


def relative(path):
    return os.path.relpath(path, ROOT)


def commands_of(folder):
    return json.loads((ROOT / folder / 'compile_commands.json').read_text())


class Together:
    """Sources that are compiled together, as one file; their command is that of the unity file."""

    def __init__(self, folder, number, command, sources):
        self.path = Path(folder) / f'{number}.cpp'
        self.sources = sources
        self.begins = []  # for each source, the lines before it
        text, lines = [], 0
        for source in sources:
            self.begins.append(lines)
            text.append((ROOT / source).read_text().rstrip('\n') + '\n')
            lines += text[-1].count('\n')
        self.path.write_text(''.join(text))
        beside = dict.fromkeys(f'-I{ROOT / Path(source).parent}' for source in sources)
        words = shlex.split(command['command'])
        words[-1] = str(self.path)
        self.command = {'directory': command['directory'], 'file': str(self.path),
                        'arguments': words[:1] + list(beside) + words[1:]}

    def with_places(self, said):
        """What clang-tidy said, with the places as the sources have them."""
        def place(match):
            line = int(match.group(1))
            index = bisect.bisect_left(self.begins, line) - 1
            return f'{ROOT / self.sources[index]}:{line - self.begins[index]}:'
        return re.sub(re.escape(str(self.path)) + r':(\d+):', place, said)


def written_together(commands, folder):
    """The sources of ours in a unity build, together as it has them; written to folder."""
    out = []
    for command in commands:
        name = os.path.join(command['directory'], command['file'])
        sources = INCLUDED.findall(Path(name).read_text()) if '/Unity/' in name else []
        sources = [s for s in map(relative, sources) if not s.startswith(('..', 'build/'))]
        if sources:
            out.append(Together(folder, len(out), command, sources))
    (Path(folder) / 'compile_commands.json').write_text(json.dumps([t.command for t in out]))
    return out


def sources_for(changed, compiled):
    """The compiled files that show the changed ones: themselves, or for a header one that includes it."""
    chosen = []
    for name in changed:
        if name in compiled:
            chosen.append(name)
        elif name.endswith('.h'):
            stem = Path(name).stem
            twins = [c for c in compiled if Path(c).stem == stem]
            text = f'{stem}.h"'
            users = twins or [c for c in compiled if text in (ROOT / c).read_text(errors='replace')]
            chosen += users[:1]
    return list(dict.fromkeys(chosen))


def run_tidy(name, build, options=()):
    return subprocess.run(['clang-tidy', '--quiet', *options, '-p', build, str(name)], cwd=ROOT,
                          capture_output=True, text=True)


def finds_faults():
    """Else a clean run would show nothing."""
    with tempfile.TemporaryDirectory(dir=ROOT / 'build') as folder:
        sources = [Path(folder) / 'sound.cpp', Path(folder) / 'faulty.cpp']
        sources[0].write_text('int sound() { return 1; }\n')
        sources[1].write_text(FAULTY)
        command = {'directory': folder, 'command': 'clang++ -std=c++20 -c unity.cxx'}
        both = Together(folder, 0, command, [relative(s) for s in sources])
        (Path(folder) / 'compile_commands.json').write_text(json.dumps([both.command]))
        said = both.with_places(run_tidy(both.path, folder, [TOGETHER]).stdout)
        return all(re.search(rf'{re.escape(str(sources[1]))}:{line}:.*{fault}', said)
                   for line, fault in FAULTS)


class Look:
    """clang-tidy over files, several at a time; what it says is printed."""

    def __init__(self, jobs):
        self.pool = ThreadPoolExecutor(jobs)
        self.started = time.monotonic()
        self.faulty, self.skipped = [], []

    def _look(self, name, build, options=(), places=lambda said: said):
        done = run_tidy(name, build, options)
        if done.returncode != 0:
            self.faulty.append(name)
            print(places(done.stdout.strip() or done.stderr.strip()), flush=True)

    def _look_until(self, until, name, *how):
        if time.monotonic() - self.started > until:
            self.skipped.append(name)
        else:
            self._look(name, *how)

    def at_together(self, parts, folder, checks, until=float('inf')):
        return [self.pool.submit(self._look_until, until, part.path, folder, [checks], part.with_places)
                for part in parts]

    def at_each(self, names, build, until=float('inf')):
        return [self.pool.submit(self._look_until, until, name, build) for name in names]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--unity', default='build/clang-debug', help='a unity build, configured')
    parser.add_argument('--build', default='build/clang', help='a build of all sources, tests each alone')
    parser.add_argument('--jobs', type=int, default=os.cpu_count())
    parser.add_argument('--budget', type=float, default=os.environ.get('SF_TIDY_SECONDS', 120),
                        help='seconds after which no further test that did not change is begun')
    parser.add_argument('--all', action='store_true', help='every test, however long it takes')
    args = parser.parse_args()

    if not finds_faults():
        print('tidy: clang-tidy does not report the faults of sources that are looked at together')
        return 1
    folder = ROOT / 'build' / 'tidy'
    folder.mkdir(parents=True, exist_ok=True)
    together = written_together(commands_of(args.unity), folder)
    shipped = {source for part in together for source in part.sources}
    compiled = [relative(os.path.join(c['directory'], c['file'])) for c in commands_of(args.build)]
    alone = [c for c in dict.fromkeys(compiled)
             if c not in shipped and not c.startswith(('..', 'build/'))]
    base = base_commit()
    changed = not_committed() + (git('diff', '--name-only', f'{base}..HEAD').splitlines() if base else [])
    newest = git('log', '--name-only', '--format=').split()
    must = sources_for(changed, alone)
    others = [c for c in dict.fromkeys(sources_for(newest, alone) + alone) if c not in must]
    touched = set(sources_for(changed, sorted(shipped)))  # of a header, one that includes it
    whole = [part for part in together if touched & set(part.sources)]
    age = {name: i for i, name in reversed(list(enumerate(newest)))}
    rest = sorted((part for part in together if part not in whole),
                  key=lambda part: min(age.get(source, len(age)) for source in part.sources))

    look, until = Look(args.jobs), float('inf') if args.all else args.budget
    parts = look.at_together(whole, str(folder), TOGETHER)
    parts += look.at_together(rest, str(folder), WITHOUT_ANALYZER)
    parts += look.at_each(must, args.build)
    parts += look.at_together(rest, str(folder), ANALYZER, until)
    parts += look.at_each(others, args.build, until)
    for part in parts:
        part.result()

    skipped = set(look.skipped)
    analyzed = sum(len(part.sources) for part in together if part.path not in skipped)
    since = f' (all {len(must) + len(touched)} changed since {base[:9]})' if base else ''
    print(f'tidy: {len(shipped)} of {len(shipped)} sources of libraries and programs, {analyzed} with the '
          f'analyzer; {len(alone) - len(skipped & set(alone))} of {len(alone)} tests and command lines{since}; '
          f'{len(look.faulty)} with faults')
    return 1 if look.faulty else 0


if __name__ == '__main__':
    sys.exit(main())
