#!/usr/bin/env python3
"""Every sentence that the client translates is in every catalogue, and no catalogue has an empty one.

  client/tests/translations_test.py CLIENT_DIRECTORY
"""
import re
import sys
from pathlib import Path

client = Path(sys.argv[1])
sentences = set()
for source in [*(client / 'src').rglob('*.cpp'), *(client.parent / 'tools/watch').glob('*.cpp'),
               *(client.parent / 'tools/calibrate').glob('*.cpp')]:
    # Adjacent string literals are one sentence.
    for call in re.findall(r'\b(?:tr|N_)\(((?:\s*"(?:[^"\\]|\\.)*")+)\s*\)', source.read_text(encoding='utf-8')):
        sentences.add(''.join(re.findall(r'"((?:[^"\\]|\\.)*)"', call)))
# What the server says to people.
said = (client.parent / 'wire/include/wire/sentence.h').read_text(encoding='utf-8')
server = re.findall(r'^  X\(\w+, "((?:[^"\\]|\\.)*)"\)', said, re.M)
if len(server) != said.count('  X('):
    sys.exit('wire/sentence.h is written otherwise than this test reads it')
sentences.update(server)
# The panel shows what each tuning value means.
tuning = (client.parent / 'foosball/include/foosball/tuning.h').read_text(encoding='utf-8')
for meaning in re.findall(r'&Tuning::\w+, [^"]*?((?:"(?:[^"\\]|\\.)*"\s*)+)\}', tuning):
    sentences.add(''.join(re.findall(r'"((?:[^"\\]|\\.)*)"', meaning)))
# The characters that come with the game.
for character in sorted((client.parent / 'characters/data').glob('*.toml')):
    text = character.read_text(encoding='utf-8')
    sentences.update(re.findall(r'^(?:name|specialty) = "(.*)"$', text, re.M))
# The statements of the questionnaire are what the results' summary calls them.
asked = (client.parent / 'results/include/results/questionnaire.h').read_text(encoding='utf-8')
statements = re.findall(r'\{"\w+", "([^"]+)"\}', asked)
shown = re.search(r'kStatements\{(.*?)\};', (client / 'src/core/survey.cpp').read_text(encoding='utf-8'), re.S)
if not statements or statements != re.findall(r'N_\("([^"]+)"\)', shown.group(1)):
    sys.exit('the questionnaire asks something else than the results summarise')
if len(sentences) < 100:
    sys.exit(f'only {len(sentences)} sentences found: has the way they are marked changed?')
catalogues = sorted((client / 'po').glob('*.po'))
if len(catalogues) < 2:
    sys.exit('catalogues are missing')
bad = 0
for catalogue in catalogues:
    text = catalogue.read_text(encoding='utf-8')
    pairs = dict(re.findall(r'^msgid "((?:[^"\\]|\\.)*)"\nmsgstr "((?:[^"\\]|\\.)*)"', text, re.M))
    for sentence in sorted(sentences):
        if not pairs.get(sentence):
            print(f'{catalogue.name}: no translation of "{sentence}"')
            bad += 1
        elif sorted(re.findall(r'%\d', sentence)) != sorted(re.findall(r'%\d', pairs[sentence])):
            print(f'{catalogue.name}: other places in the translation of "{sentence}"')
            bad += 1
print(f'{len(sentences)} sentences, {bad} missing')
sys.exit(bad != 0)
