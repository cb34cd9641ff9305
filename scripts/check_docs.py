#!/usr/bin/env python3
"""Checks that the documents tell the truth where a machine can tell.

- A relative link or picture of a Markdown file leads to a file of the repository.
- A path in backticks that begins with a folder of the repository exists.
- An option that a document gives ./play, ./check or ./bench is in that command's --help; one that it
  gives a program of ours, in a command or in a table headed "option of `PROGRAM`", is in its source.
- A code block after "<!-- source: FILE -->" is that file, letter for letter; a block in FILE may be
  marked by "// begin: NAME" and "// end: NAME" and is then asked for as FILE#NAME.
- Each check switched off in a .clang-tidy has its reason there.
"""
import re
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r'!?\[[^\]]*\]\(([^)\s]+)\)')
IMAGE = re.compile(r'<img[^>]*src="([^"]+)"')
TICKED = re.compile(r'`([^`\s]+)`')
COMMAND = re.compile(r'(?<![\w/])\./(play|check|bench)\b([^`|;&\n#]*)')
SOURCE = re.compile(r'<!-- source: (\S+) -->\s*```\w*\n(.*?)```', re.S)
PROGRAMS = {
    'space-foosball': 'client/src/app/options.cpp',
    'vphysics-sandbox': 'sandbox/src/app/options.cpp',
}
# What ./play --sandbox is given is the sandbox's.
PROGRAM = re.compile(r'(?:(?<![\w/`-])(?:build/\w+/bin/)?(vphysics-sandbox|space-foosball)(?![\w-])'
                     r'|\./play --(sandbox)\b)([^`|;&\n#]*)')
TABLE = re.compile(r'^\| option of `([^`]+)` \|.*\n\|[ -|]*\n((?:\|.*\n)+)', re.M)
OPTION = re.compile(r'(?<!\S)--[a-z][\w-]*')
MADE = ('build/', 'out/')  # exist only after a run


def ours(name):
    return sorted(p for p in ROOT.rglob(name)
                  if not any(part in ('build', 'out', '.git') for part in p.relative_to(ROOT).parts))


def documents():
    return ours('*.md')


def line_of(text, position):
    return text.count('\n', 0, position) + 1


def help_of(command, cache={}):
    if command not in cache:
        cache[command] = subprocess.run([f'./{command}', '--help'], cwd=ROOT, capture_output=True,
                                        text=True, stdin=subprocess.DEVNULL).stdout
    return cache[command]


def named_source(name):
    path, _, block = name.partition('#')
    text = (ROOT / path).read_text()
    if block:
        found = re.search(rf'^[^\n]*// begin: {block}\n(.*?)^[^\n]*// end: {block}', text, re.S | re.M)
        if not found:
            return None
        text = textwrap.dedent(found.group(1))
    return text


def exists(path):
    path = path.split('#')[0].rstrip('/')
    return any(ROOT.glob(path)) if '*' in path else (ROOT / path).exists()


def has_option(program, option):
    """Whether the program takes it: a script says so in its help, a program where it is read."""
    if program.startswith('./'):
        return re.search(rf'{option}\b', help_of(program[2:]))
    return option == '--help' or re.search(rf'[",]{option}[",]', (ROOT / PROGRAMS[program]).read_text())


def options_in(text):
    """Of programs, and in tables of options: where, whose, which."""
    for match in PROGRAM.finditer(text):
        for option in OPTION.findall(match.group(3)):
            yield match.start(), match.group(1) or 'vphysics-sandbox', option
    for match in TABLE.finditer(text):
        for row in re.finditer(r'^\| (.*?) \|', match.group(2), re.M):
            for option in re.findall(r'`(--[a-z][\w-]*)', row.group(1)):
                yield match.start(2) + row.start(), match.group(1), option


def faults_in(document):
    text = document.read_text()
    folders = {p.name for p in ROOT.iterdir() if p.is_dir() and not p.name.startswith('.')}
    for match in list(LINK.finditer(text)) + list(IMAGE.finditer(text)):
        target = match.group(1).split('#')[0]
        if target and '://' not in target and not target.startswith('mailto:'):
            if not (document.parent / target).exists():
                yield line_of(text, match.start()), f'the link leads nowhere: {target}'
    for match in TICKED.finditer(text):
        path = match.group(1)
        if path.split('/')[0] in folders and '/' in path and not path.startswith(MADE):
            if not re.search(r'[<>{}$|,:]|\.\.\.|NNNN|NAME', path) and not exists(path):
                yield line_of(text, match.start()), f'no such path: {path}'
    for match in COMMAND.finditer(text):
        words = match.group(2).split('--sandbox')[0]
        for option in OPTION.findall(words):
            if not re.search(rf'{option}\b', help_of(match.group(1))):
                yield line_of(text, match.start()), f'./{match.group(1)} has no option {option}'
    for position, program, option in options_in(text):
        if program not in PROGRAMS and not program.startswith('./'):
            yield line_of(text, position), f'options of an unknown program: {program}'
        elif not has_option(program, option):
            yield line_of(text, position), f'{program} has no option {option}'
    for match in SOURCE.finditer(text):
        if not (ROOT / match.group(1).split('#')[0]).exists():
            yield line_of(text, match.start()), f'no such source: {match.group(1)}'
        elif named_source(match.group(1)) != match.group(2):
            yield line_of(text, match.start()), f'the code differs from {match.group(1)}'


def tidy_faults():
    for path in ours('.clang-tidy'):
        text = path.read_text()
        for name in re.findall(r'^\s+-([a-z][\w.-]+)', text, re.M):
            if not re.search(rf'^# {re.escape(name)}: \S', text, re.M):
                yield f'{path.relative_to(ROOT)}: {name} is off without a reason'


def main():
    faults, found = [], documents()
    for document in found:
        faults += [f'{document.relative_to(ROOT)}:{line}: {what}' for line, what in faults_in(document)]
    faults += tidy_faults()
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f'docs: {len(found)} documents, {len(faults)} faults')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
