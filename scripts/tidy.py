#!/usr/bin/env python3
"""Runs clang-tidy on the sources that a change touches, newest first, until the time is up.

With a base (CHECK_BASE, or where this branch left main) the sources changed since are looked at; on
main itself, where there is no base, all of them in the order of their last change. A run has 100 s
(SF_TIDY_SECONDS), since one source takes 5 to 20; what was left out is said. --all takes its time.
"""
import argparse
import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


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


def newest_first():
    return list(dict.fromkeys(not_committed() + git('log', '--name-only', '--format=').split()))


def sources_for(changed, compiled):
    """The compiled files that show the changed ones: themselves, or for a header those that include it."""
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


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--build', default='build/clang', help='the folder with compile_commands.json')
    parser.add_argument('--jobs', type=int, default=os.cpu_count())
    parser.add_argument('--budget', type=float, default=os.environ.get('SF_TIDY_SECONDS', 100),
                        help='seconds after which no further source is begun')
    parser.add_argument('--all', action='store_true', help='every source, however long it takes')
    args = parser.parse_args()

    commands = json.loads((ROOT / args.build / 'compile_commands.json').read_text())
    compiled = {os.path.relpath(os.path.join(c['directory'], c['file']), ROOT) for c in commands}
    compiled = sorted(c for c in compiled if not c.startswith(('..', 'build/')))
    base = base_commit()
    if args.all:
        files, budget = compiled, float('inf')
    elif base:
        changed = git('diff', '--name-only', f'{base}..HEAD').splitlines() + not_committed()
        files, budget = sources_for(changed, compiled), args.budget
    else:
        files, budget = sources_for(newest_first(), compiled), args.budget

    files.sort(key=lambda name: '/tests/' in name or name.startswith('tests/'))  # what ships comes first
    started = time.monotonic()
    skipped, faulty = [], []

    def look(name):
        if time.monotonic() - started > budget:
            skipped.append(name)
            return
        done = subprocess.run(['clang-tidy', '--quiet', '-p', args.build, name], cwd=ROOT,
                              capture_output=True, text=True)
        if done.returncode != 0:
            faulty.append(name)
            print(done.stdout.strip() or done.stderr.strip(), flush=True)

    with ThreadPoolExecutor(args.jobs) as pool:
        list(pool.map(look, files))
    looked = len(files) - len(skipped)
    since = f'changed since {base[:9]}' if base and not args.all else 'newest first'
    left = f'; time was up for {len(skipped)} more' if skipped else ''
    print(f'tidy: {looked} of {len(compiled)} sources ({since}), {len(faulty)} with faults{left}')
    return 1 if faulty else 0


if __name__ == '__main__':
    sys.exit(main())
