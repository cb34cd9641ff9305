#!/usr/bin/env python3
"""Runs clang-tidy, on what changed first, for a bounded time.

Half of what clang-tidy costs is the headers of a source, and half of the rest the analyzer, which
follows paths. So:
- The libraries and programs are looked at together, as a unity build (--unity, a folder that is
  configured so, with its generated sources) compiles them: by all checks but the analyzer. They are
  copied into one file each: of a file that is included the analyzer follows no path.
- What changed since the base (CHECK_BASE, or where this branch left main) comes first, newest first,
  and has all checks, the analyzer's too: libraries and programs, and what a unity build compiles
  alone, tests and the readers of command lines. 80 s after the beginning (SF_TIDY_CHANGED_SECONDS)
  no further one is begun; the libraries and programs among them are then looked at as the others.
- Then come the other libraries and programs, newest first, and last, for them, the analyzer, and all
  checks for the other sources. 120 s after the beginning (SF_TIDY_SECONDS) nothing more is begun.
How many were left out is said, of those that changed too; --all leaves out none.
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


def by_age(base):
    """What changed since base, and every file; both newest first."""
    new = not_committed()
    newest = list(dict.fromkeys(new + git('log', '--name-only', '--format=').splitlines()))
    age = {name: i for i, name in enumerate(newest)}
    changed = new + (git('diff', '--name-only', f'{base}..HEAD').splitlines() if base else [])
    return sorted(dict.fromkeys(changed), key=lambda name: age.get(name, len(age))), newest


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
    """The compiled files that show the changed ones: themselves, or for a header one that includes it.
    Each with the place in changed of the first that it shows, in the order of these places."""
    chosen = {}
    for place, name in enumerate(changed):
        if name in compiled:
            chosen.setdefault(name, place)
        elif name.endswith('.h'):
            stem = Path(name).stem
            twins = [c for c in compiled if Path(c).stem == stem]
            text = f'{stem}.h"'
            users = twins or [c for c in compiled if text in (ROOT / c).read_text(errors='replace')]
            if users:
                chosen.setdefault(users[0], place)
    return chosen


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
    """clang-tidy over files, several at a time, in the order asked for; what it says is printed."""

    def __init__(self, jobs, folder, build, budget):
        self.pool = ThreadPoolExecutor(jobs)
        self.folder, self.build, self.budget = folder, build, budget
        self.started = time.monotonic()
        self.asked, self.faulty, self.skipped, self.unseen = [], set(), set(), set()

    def _look(self, what, checks):
        if isinstance(what, Together):
            done = run_tidy(what.path, self.folder, [checks])
            said = what.with_places(done.stdout.strip() or done.stderr.strip())
        else:
            done = run_tidy(what, self.build)
            said = done.stdout.strip() or done.stderr.strip()
        if done.returncode != 0:
            self.faulty.add(what)
            print(said, flush=True)

    def _look_until(self, until, what, checks, else_checks):
        seconds = time.monotonic() - self.started
        if seconds <= until:
            self._look(what, checks)
            return
        self.skipped.add(what)
        if else_checks and seconds <= self.budget:
            self._look(what, else_checks)
        elif checks != ANALYZER:
            self.unseen.add(what)

    def at(self, what, checks=None, until=float('inf'), else_checks=None):
        """what: sources together, by checks, or after until by else_checks if any; or one alone."""
        self.asked.append(self.pool.submit(self._look_until, until, what, checks, else_checks))

    def wait(self):
        for one in self.asked:
            one.result()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--unity', default='build/clang-debug', help='a unity build, configured')
    parser.add_argument('--build', default='build/clang', help='a build of all sources, tests each alone')
    parser.add_argument('--jobs', type=int, default=os.cpu_count())
    parser.add_argument('--budget', type=float, default=os.environ.get('SF_TIDY_SECONDS', 120),
                        help='seconds after which nothing further is begun')
    parser.add_argument('--changed-budget', type=float,
                        default=os.environ.get('SF_TIDY_CHANGED_SECONDS', 80),
                        help='seconds after which nothing further that changed has all checks')
    parser.add_argument('--all', action='store_true', help='everything, however long it takes')
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
    changed, newest = by_age(base)
    age = {name: i for i, name in enumerate(newest)}
    changed_alone = sources_for(changed, alone)
    changed_shipped = sources_for(changed, sorted(shipped))
    whole = {part: min(changed_shipped[s] for s in part.sources if s in changed_shipped)
             for part in together if not changed_shipped.keys().isdisjoint(part.sources)}
    rest = sorted((part for part in together if part not in whole),
                  key=lambda part: min(age.get(source, len(age)) for source in part.sources))
    others = [c for c in dict.fromkeys([*sources_for(newest, alone), *alone]) if c not in changed_alone]

    forever = float('inf')
    until, until_changed = (forever, forever) if args.all else (args.budget, args.changed_budget)
    look = Look(args.jobs, str(folder), args.build, until)
    ranked = {**whole, **changed_alone}
    for what in sorted(ranked, key=ranked.get):
        part = isinstance(what, Together)
        look.at(what, TOGETHER, until_changed, else_checks=WITHOUT_ANALYZER if part else None)
    for part in rest:
        look.at(part, WITHOUT_ANALYZER, until)
    for part in rest:
        look.at(part, ANALYZER, until)
    for name in others:
        look.at(name, until=until)
    look.wait()

    skipped = look.skipped
    analyzed = sum(len(part.sources) for part in together if part not in skipped)
    left_out = len(skipped & changed_alone.keys()) + sum(
        len(changed_shipped.keys() & part.sources) for part in skipped & whole.keys())
    number = len(changed_alone) + len(changed_shipped)
    since = f', of {number} changed since {base[:9]} {left_out or "none"} left out' if base else ''
    seen = len(shipped) - sum(len(part.sources) for part in look.unseen & set(together))
    print(f'tidy: {seen} of {len(shipped)} sources of libraries and programs, {analyzed} with the '
          f'analyzer; {len(alone) - len(skipped & set(alone))} of {len(alone)} tests and command lines{since}; '
          f'{len(look.faulty)} with faults')
    return 1 if look.faulty else 0


if __name__ == '__main__':
    sys.exit(main())
