#!/usr/bin/env python3
"""Shows doxygen our headers as it wants them: plain // comments become documentation.

The first block of a file describes the file. Any other block describes what follows it without an
empty line in between: the first declaration, and those after it that have no comment of their own, up
to a function that is defined there. A comment at the end of a line, and what goes on below it, describes that line. Indented lines, such as
equations, are shown as they stand. What is inside of functions stays as it is.

  doxygen_filter.py FILE        prints the header
  doxygen_filter.py --self-test
"""
import re
import sys
from pathlib import Path

FULL_LINE = re.compile(r'^(\s*)//(?: ?(.*))$')
TRAILING = re.compile(r'^(.*?\S)\s+// (.*)$')
SECTION = re.compile(r'^-{3,}')
SCOPE = re.compile(r'\b(namespace|struct|class|enum|union)\b')
LABEL = re.compile(r'^\s*(public|protected|private):\s*$')


def prose(text):
    """Nothing in our prose is a command, a tag or a link."""
    return re.sub(r'::|[\\@&$#<>%"]', lambda m: '\\' + m.group(), text)


def without_text(code):
    """Code without its strings, characters and comments, for looking at braces."""
    return re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])\'|//.*', '', code)


def opens_scope(statement):
    while True:
        shorter = re.sub(r'<[^<>]*>', '', statement)
        if shorter == statement:
            return bool(SCOPE.search(statement)) and '(' not in statement.split('struct')[0]
        statement = shorter


def described(texts):
    """The lines of one block of comments."""
    lines, verbatim = [], False
    for text in texts:
        indented = text.startswith('  ') or (verbatim and not text.strip())
        line = text if indented else prose(text)
        if indented and not verbatim:
            line = '\\verbatim ' + line
        elif verbatim and not indented:
            line = '\\endverbatim ' + line
        verbatim = indented
        lines.append(line)
    if verbatim:
        lines[-1] += ' \\endverbatim'
    return lines


class Filter:
    def __init__(self, text):
        self.lines = text.split('\n')
        self.out = []
        self.braces = []  # of each that is open: whether declarations stand in it
        self.statement = ''  # what has come since the last declaration ended
        self.again = None  # the text for the next declarations without one of their own

    def filtered(self):
        at = 0
        while at < len(self.lines):
            full = FULL_LINE.match(self.lines[at])
            if full and all(self.braces) and not self.statement.strip():
                at = self.block(at)
            else:
                at = self.code(at)
        return '\n'.join(self.out)

    def block(self, at):
        end, texts = at, []
        while end < len(self.lines) and (match := FULL_LINE.match(self.lines[end])):
            texts.append(match.group(2))
            end += 1
        follows = end < len(self.lines) and self.lines[end].strip() and self.lines[end][0] != '#'
        head = at == 0
        if SECTION.match(texts[0]) or not (head or follows):
            self.out += self.lines[at:end]
            self.again = None
            return end
        if head:
            self.out.append('/// \\file')
        self.out += ['/// ' + line for line in described(texts)]
        if not head:
            self.again = None
            opened = self.lines[end].rstrip().endswith('{')
            end = self.code(end)
            if not opened:
                self.again = ' '.join(prose(t) for t in texts if t.strip() and not t.startswith('  '))
        return end

    def code(self, at):
        line = self.lines[at]
        here = all(self.braces)
        first = here and not self.statement.strip()
        bare = without_text(line)
        if not bare.strip() or bare.lstrip().startswith('#') or LABEL.match(line):
            self.again = None
            self.out.append(line)
            return at + 1
        trailing = TRAILING.match(line)
        opened = len(self.braces)
        self.count(bare)
        if trailing and here and not bare.startswith('}') and len(self.braces) <= opened and not bare.rstrip().endswith('{'):
            return self.trailing(at, trailing)
        if first and self.again and bare.strip() not in ('}', '};'):
            line = f'/** {self.again} */ {line}'
        if bare.rstrip().endswith('{'):
            self.again = None  # what comes after all of a function is told anew
        self.out.append(line)
        return at + 1

    def trailing(self, at, match):
        column = self.lines[at].index('// ' + match.group(2), len(match.group(1)))
        texts = [match.group(2)]
        while at + 1 < len(self.lines):
            more = FULL_LINE.match(self.lines[at + 1])
            if not more or len(more.group(1)) < column:
                break
            texts.append(more.group(2))
            at += 1
        self.out.append(f'{match.group(1)}  ///< {" ".join(prose(t) for t in texts)}')
        return at + 1

    def count(self, bare):
        """Keeps braces and the statement as they are after this line."""
        for c in bare + ' ':
            if c == '{':
                self.braces.append(opens_scope(self.statement))
                self.statement = '' if self.braces[-1] else self.statement
            elif c == '}':
                declarations = self.braces.pop() if self.braces else True
                if declarations or all(self.braces):
                    self.statement = ''
            elif c == ';' and all(self.braces):
                self.statement = ''
            elif not self.braces or all(self.braces):
                self.statement += c
        if self.braces and all(self.braces) and self.statement.strip() == ',':
            self.statement = ''


SAMPLES = [
    ('// All of it.\n#pragma once\n', '/// \\file\n/// All of it.\n#pragma once\n'),
    ('\n// A <b>\n//\n//   x = y\n//\n// c.\nint f();\n',
     '\n/// A \\<b\\>\n/// \n/// \\verbatim   x = y\n/// \n/// \\endverbatim c.\nint f();\n'),
    ('\n// Both.\nint f();\nint g();\n\nint h();\n',
     '\n/// Both.\nint f();\n/** Both. */ int g();\n\nint h();\n'),
    ('\n// One.\nint f() {\n  return 1;\n}\nint g();\n', '\n/// One.\nint f() {\n  return 1;\n}\nint g();\n'),
    ('\nnamespace a {\nint f();\n}  // namespace a\n', '\nnamespace a {\nint f();\n}  // namespace a\n'),
    ('\n// Of the compiler.\n#pragma x\n', '\n// Of the compiler.\n#pragma x\n'),
    ('\nstruct A {\n  int a;  // [m]\n          // and more\n  int b;\n};\n',
     '\nstruct A {\n  int a;  ///< [m] and more\n  int b;\n};\n'),
    ('\nint f() {\n  // inside\n  return 1;  // of it\n}\n',
     '\nint f() {\n  // inside\n  return 1;  // of it\n}\n'),
    ('\n// --- part ---\nint f();\n', '\n// --- part ---\nint f();\n'),
    ('\n// Nothing follows.\n\nint f();\n', '\n// Nothing follows.\n\nint f();\n'),
]


def self_test():
    wrong = [(text, wanted, Filter(text).filtered()) for text, wanted in SAMPLES
             if Filter(text).filtered() != wanted]
    for text, wanted, got in wrong:
        print(f'{text!r}\n  became {got!r}\n  not    {wanted!r}', file=sys.stderr)
    print(f'doxygen filter, self-test: {len(SAMPLES)} texts, {len(wrong)} wrong')
    return 1 if wrong else 0


if __name__ == '__main__':
    if sys.argv[1] == '--self-test':
        sys.exit(self_test())
    sys.stdout.write(Filter(Path(sys.argv[1]).read_text(encoding='utf-8')).filtered())
