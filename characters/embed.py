#!/usr/bin/env python3
"""Writes the characters that come with the game as C++: embed.py OUTPUT.cpp FILE.toml...

The files are those of characters/data, in their order. Nothing is checked here: a test reads them
with the reader that players' files go through, and compares (character_file_test.cpp).
"""
import sys
import tomllib

HEAD = '''// Made by characters/embed.py from characters/data. Do not edit.
#include "foosball/character.h"

namespace foosball {

const Characters& built_in_characters() {
  static const Characters characters{
'''
TAIL = '''  };
  return characters;
}

}  // namespace foosball
'''


def text(value):
    return '"' + value.replace('\\', '\\\\').replace('"', '\\"') + '"'


def colour(value):
    return '{' + ', '.join(f'0x{value[i:i + 2]}' for i in (1, 3, 5)) + '}'


def numbers(values):
    return '{' + ', '.join(f'.{name} = {float(value)!r}' for name, value in values.items()) + '}'


def character(c):
    look = c['look']
    return (f"    {{{text(c['name'])},\n     {text(c['specialty'])},\n     {numbers(c['body'])},\n"
            f"     {{{colour(look['skin'])}, {colour(look['accent'])}, Headgear::{look['headgear']}, "
            f"Face::{look['face']}}},\n     {numbers(c['voice'])}}},\n")


def main():
    output, *files = sys.argv[1:]
    parts = []
    for file in files:
        with open(file, 'rb') as f:
            parts.append(character(tomllib.load(f)))
    with open(output, 'w', encoding='utf-8') as f:
        f.write(HEAD + ''.join(parts) + TAIL)


main()
