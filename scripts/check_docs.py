#!/usr/bin/env python3
"""Checks that the documents tell the truth where a machine can tell.

- A relative link or picture of a Markdown file leads to a file of the repository.
- A path in backticks that begins with a folder of the repository exists.
- An option that a document gives ./play, ./check or ./bench is in that command's --help.
- A code block after "<!-- source: FILE -->" is that file, letter for letter; a block in FILE may be
  marked by "// begin: NAME" and "// end: NAME" and is then asked for as FILE#NAME.
- Each check switched off in .clang-tidy has its reason there.
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
MADE = ('build/', 'out/')  # exist only after a run


def documents():
    return sorted(p for p in ROOT.rglob('*.md')
                  if not any(part in ('build', 'out', '.git') for part in p.relative_to(ROOT).parts))


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
        for option in re.findall(r'(?<!\S)--[a-z][\w-]*', match.group(2)):
            if not re.search(rf'{option}\b', help_of(match.group(1))):
                yield line_of(text, match.start()), f'./{match.group(1)} has no option {option}'
    for match in SOURCE.finditer(text):
        if not (ROOT / match.group(1).split('#')[0]).exists():
            yield line_of(text, match.start()), f'no such source: {match.group(1)}'
        elif named_source(match.group(1)) != match.group(2):
            yield line_of(text, match.start()), f'the code differs from {match.group(1)}'


def tidy_faults():
    text = (ROOT / '.clang-tidy').read_text()
    for name in re.findall(r'^\s+-([a-z][\w.-]+)', text, re.M):
        if not re.search(rf'^# {re.escape(name)}: \S', text, re.M):
            yield f'.clang-tidy: {name} is off without a reason'


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
