#!/usr/bin/env python3
"""Installs the engine from a build folder, then builds and runs a user's project with what was
installed: by find_package, and by pkg-config and the compiler alone.

  check_package.py BUILD_FOLDER COMPILER

What the user's program costs to compile is measured and bounded as well.
"""
import os
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CONSUMER = Path(__file__).resolve().parent / 'consumer'
# A level rod of length l falls with 3 g / (2 l), and the ball for a second with g.
DYNAMICS = 'rod 14.715000 rad/s^2\nball -9.810000 m/s\n'
ROBOT = 'hinge 14.715000 rad/s^2\n'
BATCH = 'level 14.715000 rad/s^2\nhanging 0.000000 rad/s^2\n'
MAX_SECONDS, MAX_MEGABYTES = 5.0, 500.0  # of one compiler's run; 1.6 to 2.4 s and 175 MB were measured


def run(*command, **more):
    print('+', shlex.join(map(str, command)), flush=True)
    return subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE, **more).stdout


def expect(wanted, *command):
    said = run(*command)
    if said != wanted:
        sys.exit(f'{command[0]} said "{said}", not "{wanted}"')


def by_cmake(compiler, prefix, folder):
    run('cmake', '-S', CONSUMER, '-B', folder, '-G', 'Ninja', f'-DCMAKE_PREFIX_PATH={prefix}',
        f'-DCMAKE_CXX_COMPILER={compiler}', '-DCMAKE_BUILD_TYPE=Release')
    run('cmake', '--build', folder)
    expect(DYNAMICS, folder / 'dynamics')
    expect(ROBOT, folder / 'robot')
    expect(BATCH, folder / 'batch')
    refused = subprocess.run(
        ['cmake', '-S', CONSUMER, '-B', folder / 'none', '-G', 'Ninja',
         '-DCMAKE_DISABLE_FIND_PACKAGE_urdfdom=ON', f'-DCMAKE_PREFIX_PATH={prefix}'],
        text=True, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    if refused.returncode == 0 or 'the component urdf needs' not in refused.stderr:
        sys.exit(f'without urdfdom the component urdf is not refused as it should be: {refused.stderr}')


def by_pkg_config(compiler, prefix, libraries, folder):
    os.environ['PKG_CONFIG_PATH'] = f'{prefix}/{libraries}/pkgconfig'
    os.environ['CCACHE_DISABLE'] = '1'
    for name, package, wanted in (('dynamics', 'vphysics', DYNAMICS), ('batch', 'vphysics_packs', BATCH),
                                  ('robot', 'vphysics_urdf', ROBOT)):
        flags = shlex.split(run('pkg-config', '--cflags', package))
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        run(compiler, '-std=c++20', '-O2', '-Wall', '-Wextra', '-Werror', '-c', CONSUMER / f'{name}.cpp', '-o',
            folder / f'{name}.o', *flags)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds, megabytes = after.ru_utime - before, after.ru_maxrss / 1024
        print(f'{name}.cpp: {seconds:.2f} s, at most {megabytes:.0f} MB')
        if seconds > MAX_SECONDS or megabytes > MAX_MEGABYTES:
            sys.exit(f'that is more than {MAX_SECONDS} s or {MAX_MEGABYTES} MB')
        run(compiler, folder / f'{name}.o', '-o', folder / f'{name}-pkg',
            *shlex.split(run('pkg-config', '--libs', package)))
        expect(wanted, folder / f'{name}-pkg')


def main():
    build, compiler = Path(sys.argv[1]), sys.argv[2]
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        first, prefix = scratch / 'first', scratch / 'moved'
        run('cmake', '--install', build, '--prefix', first)
        shutil.move(first, prefix)  # nothing in it may know where it was
        private = {'.cpp'} & {p.suffix for p in prefix.rglob('*')}
        packages = list(prefix.rglob('vphysics.pc'))
        if private or len(packages) != 1:
            sys.exit(f'installed: sources {private}, packages {packages}')
        libraries = packages[0].parent.parent.relative_to(prefix)
        run('cmake', '-S', CONSUMER.parents[2], '-B', scratch / 'alone', '-G', 'Ninja')  # configures by itself
        by_pkg_config(compiler, prefix, libraries, scratch)
        by_cmake(compiler, prefix, scratch / 'consumer')


if __name__ == '__main__':
    main()
