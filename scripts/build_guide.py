#!/usr/bin/env python3
"""Writes what the build guide (docs/build/) can take from data: tables with sums, pins, rods, screens.

In a page, what stands between

    <!-- guide: NAME ARGUMENT -->    and    <!-- end of guide -->

is made from docs/build/*.csv, docs/build/pins.json, the game's table and the firmware's pins; the wiring
is drawn to docs/build/pictures/wiring-*.svg (scripts/wiring_svg.py). Bills of materials above their bound
and pins that the firmware does not have are faults. With --check it changes nothing and fails where a
page or a drawing is out of date. With --self-test it checks itself.
"""
import argparse
import csv
import io
import json
import math
import re
import sys
from decimal import Decimal, InvalidOperation
from pathlib import Path

import wiring_svg

ROOT = Path(__file__).resolve().parent.parent
GUIDE = ROOT / 'docs/build'
PAGES = [*sorted(GUIDE.glob('*.md')), ROOT / 'docs/wiring.md']
BLOCK = re.compile(r'(<!-- guide: ([\w -]+?) -->\n)(.*?)(<!-- end of guide -->)', re.S)

# What a bill of materials may cost [USD], and what it is for.
BOUNDS = {
    'afternoon': (None, 'one rod: a mouse and a broomstick'),
    'pair': (200, 'a table-top pair of rods'),
    'cabinet': (2000, 'a full cabinet of eight rods, with screen and PC'),
}
# Bills of what may be added to another, whose bound holds with all that may be.
EXTRAS = {'marks': 'cabinet', 'motors': 'cabinet'}
COLUMNS = ['part', 'quantity', 'unit_usd', 'for', 'alternatives']
SCREENS_INCH = [65, 55, 43, 32]

# Of a rod, from the handle inwards [mm]: in the handle; handle to index ring; index ring; collar;
# travel; outer face of the wall to inner face of the inner bearing; collar; beyond it. Those of
# printed parts are in cabinet/parts/dimensions.scad.
IN_HANDLE, FREE, SPAN, BEYOND = 70, 30, 180, 10
STEEL_KG_PER_MM = math.pi / 4 * 16**2 * 7.85e-6


# --- bills of materials ---

def parts_of(text, name):
    """Rows with exact numbers. Raises ValueError with the line."""
    rows = list(csv.reader(io.StringIO(text)))
    if rows[0] != COLUMNS:
        raise ValueError(f'{name}: the columns are not {",".join(COLUMNS)}')
    parts = []
    for line, row in enumerate(rows[1:], 2):
        if len(row) != len(COLUMNS) or not row[0]:
            raise ValueError(f'{name}:{line}: not {len(COLUMNS)} columns with a part')
        try:
            part = dict(zip(COLUMNS, row), quantity=int(row[1]), unit_usd=Decimal(row[2]))
        except (ValueError, InvalidOperation):
            raise ValueError(f'{name}:{line}: quantity or price is no number') from None
        if part['quantity'] <= 0 or part['unit_usd'] <= 0:
            raise ValueError(f'{name}:{line}: quantity or price is not positive')
        parts.append(part)
    return parts


def sum_of(parts):
    return sum((p['quantity'] * p['unit_usd'] for p in parts), Decimal(0))


def bill(name):
    return parts_of((GUIDE / f'{name}.csv').read_text(), f'{name}.csv')


def bill_table(name):
    parts, bound = bill(name), BOUNDS[name][0] if name in BOUNDS else None
    lines = ['| part | quantity | USD each | USD | for | instead |', '| --- | ---: | ---: | ---: | --- | --- |']
    lines += [f'| {p["part"]} | {p["quantity"]} | {p["unit_usd"]:.2f} | {p["quantity"] * p["unit_usd"]:.2f} | '
              f'{p["for"]} | {p["alternatives"]} |'.replace(' |  |', ' | |') for p in parts]
    lines.append(f'| **sum** | | | **{sum_of(parts):.2f}** | {f"bound: {bound}" if bound else ""} | |'.replace('  ', ' '))
    return [*lines, '', 'Typical retail price, 2026, without shipping.']


def sums_table():
    lines = ['| what | USD | bound |', '| --- | ---: | ---: |']
    for name, (bound, what) in BOUNDS.items():
        lines.append(f'| [{what}]({name}.md) | {sum_of(bill(name)):.0f} | {bound or "-"} |')
    return [*lines, '', 'Typical retail price, 2026, without shipping.']


def bill_faults():
    for name, (bound, _) in BOUNDS.items():
        try:
            total = sum_of(bill(name)) + sum(sum_of(bill(extra)) for extra, to in EXTRAS.items() if to == name)
        except ValueError as error:
            yield str(error)
            continue
        if bound and total >= bound:
            yield f'{name}.csv: {total} USD with all that may be added, not below {bound}'
        yield from (f'{name}.csv: {fault}' for fault in spares_faults(bill(name)))
    for name in BOUNDS:
        yield from (f'{name}.csv: {fault}' for fault in bumper_faults(bill(name)))
    total = sum(rod['length'] for rod in rods())
    metres = next(p['quantity'] for p in bill('cabinet') if 'by the metre' in p['part'] and 'steel' in p['part'])
    if metres * 1000 < total:
        yield f'cabinet.csv: {metres} m of steel bar are less than the {total} mm of the rods'


def spares_faults(parts):
    for part in parts:
        if part['for'] == 'a tenth of the rest':
            cost = part['quantity'] * part['unit_usd']
            share = cost / (sum_of(parts) - cost)
            if not Decimal('0.095') <= share <= Decimal('0.105'):
                yield f'{part["part"]}: {100 * share:.1f} % of the rest, not a tenth'


def bumper_faults(parts):
    """The rubber rings that are bought fit the collar that is printed."""
    for part in parts:
        if size := re.fullmatch(r'rubber ring, (\d+) x \d+ x (\d+) mm', part['part']):
            printed = printed_mm('bumper_inside'), printed_mm('bumper_thickness')
            if printed != tuple(map(float, size.groups())):
                yield f'{part["part"]}: the collar is printed for {printed[0]:g} mm inside and {printed[1]:g} mm thick'


def size_faults(text):
    """What a page says of its walls, in its bill and beside it, is one size."""
    sizes = sorted(set(re.findall(r'[Tt]wo walls of (\d+ x \d+ mm)', text)))
    if len(sizes) > 1:
        yield f'two walls of {" and of ".join(sizes)}'


# --- rods and screens, of the game's own table ---

def table_source():
    """Of foosball/src/table.cpp: metres as the game has them."""
    text = (ROOT / 'foosball/src/table.cpp').read_text()

    def number(name):
        words = re.search(rf'constexpr double {name} = ([\d.]+(?: \+ [\d.]+)*);', text).group(1)
        return sum(map(float, words.split('+')))

    def plan(name):
        row = re.search(rf'constexpr TeamPlan {name}\{{\{{(.*?)\}}\}};', text).group(1)
        return [(int(men), float(spacing)) for men, spacing in re.findall(r'\{(\d+), ([\d.]+)\}', row)]

    posts = re.findall(r'\{(\d), Line::(\w+)\}', text)
    return {'pitch': number('kRodPitch'), 'length': number('kLength'), 'width': number('kWidth'),
            'clearance': number('kWallClearance'), 'lone': number('kLoneGoalieLimit'),
            'tournament': plan('kTournament'), 'paper': plan('kPaper'),
            'posts': [(int(team), line) for team, line in posts]}


def travel_mm(table, layout, line):
    men, spacing = table[layout][['goalie', 'defence', 'midfield', 'attack'].index(line)]
    limit = table['lone'] if men == 1 else table['width'] / 2 - (men - 1) / 2 * spacing - table['clearance']
    return round(2000 * limit)


def printed_mm(name):
    text = (ROOT / 'cabinet/parts/dimensions.scad').read_text() + (ROOT / 'cabinet/parts/index_ring.scad').read_text()
    return float(re.search(rf'^{name} = ([\d.]+);', text, re.M).group(1))


def rods():
    table, collar, ring = table_source(), printed_mm('collar_width'), printed_mm('ring_width')
    for index, (team, line) in enumerate(table['posts']):
        travel = travel_mm(table, 'tournament', line)
        length = round(IN_HANDLE + FREE + ring + collar + travel + SPAN + collar + BEYOND)
        yield {'index': index, 'team': team, 'line': line, 'travel': travel,
               'paper': travel_mm(table, 'paper', line), 'length': length,
               'inside': round(SPAN + travel + collar + BEYOND), 'kg': length * STEEL_KG_PER_MM}


def rods_table():
    lines = ['| rod | team | line | travel, 1-2-5-3 | travel, paper | length of bar | reach inside | bar |',
             '| ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: |']
    lines += [f'| {r["index"] + 1} | {r["team"]} | {r["line"]} | {r["travel"]} mm | {r["paper"]} mm | {r["length"]} mm | '
              f'{r["inside"]} mm | {r["kg"]:.2f} kg |' for r in rods()]
    all_rods = list(rods())
    return [*lines, '', f'Together {sum(r["length"] for r in all_rods) / 1000:.2f} m and '
            f'{sum(r["kg"] for r in all_rods):.1f} kg. `reach inside` is from the outer face of the wall with the '
            'handle pushed in.']


def screens_table():
    table = table_source()
    mouth = float(re.search(r'kGoalMouth = ([\d.]+)f', (ROOT / 'client/src/render/camera.h').read_text()).group(1))
    shown = 1000 * (table['length'] + 2 * mouth)  # the view from above, goal to goal [mm]
    lines = ['| screen, 16:9 | picture | scale | field on it | pitch of the rods |', '| ---: | ---: | ---: | ---: | ---: |']
    for inch in SCREENS_INCH:
        width = inch * 25.4 * 16 / math.hypot(16, 9)
        scale = width / shown
        lines.append(f'| {inch} inch | {width:.0f} x {width * 9 / 16:.0f} mm | {scale:.2f} | '
                     f'{scale * 1000 * table["length"]:.0f} x {scale * 1000 * table["width"]:.0f} mm | '
                     f'{scale * 1000 * table["pitch"]:.1f} mm |')
    return [*lines, '', f'`--view above` shows {shown:.0f} mm of the table, the goals\' mouths with it: so much is the '
            'picture\'s width. A set sold as 55 inch has 54.6 to 55: measure the picture, and divide its width by '
            f'{shown:.0f} mm.']


# --- pins ---

def pins():
    return json.loads((GUIDE / 'pins.json').read_text())


def ports_in(source, define):
    """The letters of the clock's and the data's port in the firmware's table of pins."""
    block = re.search(rf'defined\({define}\)\n(.*?)#(?:elif|else|endif)', source, re.S)
    if not block:
        return None
    found = dict(re.findall(r'#define BOARD_(CLOCK|DATA)_(?:PIN|PORT|DDR) (?:PIN|PORT|DDR)([A-L])\b', block.group(1)))
    letters = re.findall(r'#define BOARD_(CLOCK|DATA)_(PIN|PORT|DDR) (PIN|PORT|DDR)([A-L])\b', block.group(1))
    sound = len(letters) == 6 and all(a == b and found[role] == port for role, a, b, port in letters)
    return (found['CLOCK'], found['DATA']) if sound else None


def signals_of(board):
    """Those of an AVR board besides the rods' lines, by the name of the firmware's table."""
    return {'I2C_DATA': board['i2c']['sda'], 'I2C_CLOCK': board['i2c']['scl'], 'MOTORS': board['motors_enable'],
            'LED': board['led']}


def signals_in(source, define):
    """The pins of signals_of() in the firmware's table of pins; None where it has none."""
    block = re.search(rf'defined\({define}\)\n(.*?)#(?:elif|else|endif)', source, re.S)
    text = block.group(1) if block else ''
    ports = dict(re.findall(r'#define BOARD_(I2C|MOTORS|LED)_DDR DDR([A-L])\b', text))
    bits = dict(re.findall(r'#define BOARD_(I2C_DATA|I2C_CLOCK|MOTORS|LED)_BIT ([0-7])\b', text))
    registers = re.findall(r'#define BOARD_(I2C|MOTORS)_(PIN|PORT|DDR) (PIN|PORT|DDR)([A-L])\b', text)
    sound = all(a == b and ports.get(role) == port for role, a, b, port in registers) and len(registers) == 5
    found = {name: f'P{ports.get(name.split("_")[0])}{bit}' for name, bit in bits.items()}
    return found if sound and len(found) == 4 and len(ports) == 3 else None


def pin_faults():
    for name, board in pins().items():
        if name == 'about':
            continue
        if board['sensors'] == 'ps2':
            ports = ports_in((ROOT / board['source']).read_text(), board['define'])
            if ports is None:
                yield f'pins.json: {board["source"]} has no table of pins for {board["define"]}'
                continue
            for role, port in zip(('clock', 'data'), ports):
                if board[role] != [f'P{port}{bit}' for bit in range(8)]:
                    yield f'pins.json: {name}: the firmware has {role} at P{port}0 to P{port}7'
            signals = signals_of(board)
            if signals_in((ROOT / board['source']).read_text(), board['define']) != signals:
                yield f'pins.json: {name}: the firmware has other pins for bus, motors and LED than {signals}'
            used = [*board['clock'], *board['data'], *signals.values()]
            if len(set(used)) != len(used):
                yield f'pins.json: {name}: a pin is used twice'
            unknown = set(board['printed']) - set(used)
            if unknown:
                yield f'pins.json: {name}: printed names of pins that are not used: {sorted(unknown)}'
        else:
            yield from spi_faults(name, board, pico_source())


def spi_faults(name, board, source=None):
    """What the RP2040 can do (its data sheet, "GPIO functions"), and what its firmware does: source."""
    used = {'kSensorClock': board['spi']['sck'], 'kSensorData': board['spi']['mosi'], 'kI2cData': board['i2c']['sda'],
            'kI2cClock': board['i2c']['scl'], 'kMotorsEnable': board['motors_enable'], 'kButton': board['button'],
            'kLed': board['led']}
    for role, first in (('data', 'kFirstData'), ('select', 'kFirstSelect')):
        used[first] = board[role][0]
        if board[role] != [board[role][0] + rod for rod in range(8)]:
            yield f'pins.json: {name}: the {role} lines are not eight pins side by side'
    numbers = [*board['data'], *board['select'], *(n for key, n in used.items() if 'First' not in key)]
    if len(set(numbers)) != len(numbers):
        yield f'pins.json: {name}: a pin is used twice'
    for role, at in [('sda', 0), ('scl', 1)]:
        if board['i2c'][role] % 2 != at or board['i2c'][role] // 2 % 2 != board['i2c']['unit']:
            yield f'pins.json: {name}: GP{board["i2c"][role]} cannot be {role} of I2C{board["i2c"]["unit"]}'
    for number in numbers:
        if number != board['led'] and not (0 <= number <= 22 or 26 <= number <= 28):
            yield f'pins.json: {name}: GP{number} is not at the Pico\'s edge'
    if source is not None:
        there = {key: int(n) for key, n in re.findall(r'\b(k\w+) = (\d+)\b', source)}
        for key, number in used.items():
            if there.get(key) != number:
                yield f'pins.json: {name}: {key} is {number}, in the firmware {there.get(key)}'


def pico_source():
    """None while this version has no firmware for the Pico."""
    file = ROOT / pins()['pico']['source']
    return file.read_text() if file.exists() else None


def pins_table():
    small, mega = pins()['32u4'], pins()['2560']
    lines = ['| rod | clock, 32U4 | data, 32U4 | clock, Mega 2560 | data, Mega 2560 |', '|---|---|---|---|---|']
    for rod in range(8):
        cells = [small['clock'][rod], small['data'][rod]]
        cells += [f'{pin}, pin {mega["printed"][pin]}' for pin in (mega['clock'][rod], mega['data'][rod])]
        lines.append(f'| {rod + 1} | ' + ' | '.join(cells) + ' |')
    return lines


def signals_table():
    small, mega = pins()['32u4'], pins()['2560']
    rows = [('SDA of the multiplexer and the expander', 'I2C_DATA'), ('SCL of both', 'I2C_CLOCK'), ('EN of all drivers', 'MOTORS'),
            ('LED, by 1 kOhm to ground', 'LED')]
    lines = ['| signal | 32U4 | Mega 2560 |', '|---|---|---|']
    for what, name in rows:
        pin = signals_of(mega)[name]
        own = ', the board\'s own' if name == 'LED' else ''
        lines.append(f'| {what} | {signals_of(small)[name]} | {pin}, pin {mega["printed"][pin]}{own} |')
    return lines


def pico_table():
    board, pin = pins()['pico'], wiring_svg.pico_pin
    lines = ['| rod | data (MISO) | select (NCS) |', '| ---: | --- | --- |']
    lines += [f'| {rod + 1} | GP{data}, pin {pin(data)} | GP{select}, pin {pin(select)} |'
              for rod, (data, select) in enumerate(zip(board['data'], board['select']))]
    rows = [('SCLK of all sensors', board['spi']['sck']), ('MOSI of all sensors', board['spi']['mosi']),
            (f'SDA of the multiplexer and the expander (I2C{board["i2c"]["unit"]})', board['i2c']['sda']),
            ('SCL of both', board['i2c']['scl']), ('EN of all drivers', board['motors_enable']),
            ('button, to ground', board['button'])]
    return [*lines, '', '| signal | pin |', '| --- | --- |',
            *(f'| {what} | GP{number}, pin {pin(number)} |' for what, number in rows)]


def pico_state():
    if pico_source() is None:
        return ['This version has no firmware for the Pico: its wiring is what the firmware is planned with.']
    return ['The firmware for the Pico is `space-foosball-rp2040`.']


def drawings():
    """Of the wiring: path, text."""
    for name, board in pins().items():
        if name != 'about':
            draw = wiring_svg.ps2_wiring if board['sensors'] == 'ps2' else wiring_svg.spi_wiring
            yield GUIDE / f'pictures/wiring-{name}.svg', draw(board)


# --- pages ---

MAKERS = {'bill': bill_table, 'sums': sums_table, 'rods': rods_table, 'screens': screens_table, 'pins': pins_table, 'signals': signals_table,
          'pico-pins': pico_table, 'pico-state': pico_state}


def filled(text):
    def block(match):
        name, *arguments = match.group(2).split()
        return match.group(1) + '\n'.join(MAKERS[name](*arguments)) + '\n' + match.group(4)
    return BLOCK.sub(block, text)


def self_test():
    good = ','.join(COLUMNS) + '\nbar,2,1.25,rod,\n"a, b",1,0.10,,x\n'
    assert sum_of(parts_of(good, 'x')) == Decimal('2.60')
    for bad in ['bar,2,1.25,rod', 'bar,two,1,,', 'bar,2,x,,', 'bar,0,1,,', 'bar,1,-1,,', ',1,1,,']:
        try:
            parts_of(','.join(COLUMNS) + '\n' + bad + '\n', 'x')
        except ValueError as error:
            assert 'x:2' in str(error)
        else:
            raise AssertionError(bad)
    spares = parts_of(','.join(COLUMNS) + '\nbar,1,100,,\nspares,1,7.6,a tenth of the rest,\n', 'x')
    assert list(spares_faults(spares)) == ['spares: 7.6 % of the rest, not a tenth']
    assert not list(spares_faults([spares[0], {**spares[1], 'unit_usd': Decimal(10)}]))
    assert list(size_faults('| two walls of 300 x 110 mm |\n- Two walls of 350 x 110 mm')) and not list(size_faults('x'))
    ring = {**spares[0], 'part': 'rubber ring, 30 x 40 x 5 mm'}
    assert not list(bumper_faults([ring])) and list(bumper_faults([{**ring, 'part': 'rubber ring, 28 x 40 x 5 mm'}]))
    head = '#if defined(M)\n'
    six = ''.join(f'#define BOARD_{role}_{k} {k}{port}\n' for role, port in [('CLOCK', 'B'), ('DATA', 'D')]
                  for k in ('PIN', 'PORT', 'DDR'))
    assert ports_in(head + six + '#endif', 'M') == ('B', 'D')
    assert ports_in(head + six.replace('DDRD', 'DDRC') + '#endif', 'M') is None
    assert ports_in(head + six.replace('BOARD_DATA_PIN PIND', 'BOARD_DATA_PIN DDRD') + '#endif', 'M') is None
    assert ports_in(head + six + '#endif', 'N') is None
    more = ('#define BOARD_I2C_PIN PINF\n#define BOARD_I2C_PORT PORTF\n#define BOARD_I2C_DDR DDRF\n#define BOARD_I2C_DATA_BIT 0\n'
            '#define BOARD_I2C_CLOCK_BIT 1\n#define BOARD_MOTORS_PORT PORTC\n#define BOARD_MOTORS_DDR DDRC\n'
            '#define BOARD_MOTORS_BIT 6\n#define BOARD_LED_DDR DDRC  // x\n#define BOARD_LED_BIT 7\n')
    assert signals_in(head + six + more + '#endif', 'M') == {'I2C_DATA': 'PF0', 'I2C_CLOCK': 'PF1', 'MOTORS': 'PC6', 'LED': 'PC7'}
    assert signals_in(head + six + more.replace('PORTF', 'PORTD') + '#endif', 'M') is None
    assert signals_in(head + six + '#endif', 'M') is None
    assert ports_in(head + six + more + '#endif', 'M') == ('B', 'D')
    pico = {'data': list(range(8)), 'select': list(range(8, 16)), 'spi': {'sck': 18, 'mosi': 19},
            'i2c': {'unit': 0, 'sda': 20, 'scl': 21}, 'motors_enable': 17, 'button': 22, 'led': 25}
    firmware = ('constexpr unsigned kFirstData = 0, kFirstSelect = 8;\nconstexpr unsigned kMotorsEnable = 17, '
                'kSensorClock = 18, kSensorData = 19, kI2cData = 20,\n kI2cClock = 21, kButton = 22, kLed = 25;')
    assert not list(spi_faults('p', pico)) and not list(spi_faults('p', pico, firmware))
    assert list(spi_faults('p', pico, firmware.replace('19', '16')))
    assert list(spi_faults('p', {**pico, 'button': 6})) and list(spi_faults('p', {**pico, 'button': 24}))
    assert list(spi_faults('p', {**pico, 'i2c': {**pico['i2c'], 'sda': 26}}))  # of I2C1
    assert filled('a\n<!-- guide: sums -->\nold\n<!-- end of guide -->\nb').count('\n') > 5
    assert [r['travel'] for r in rods()][:2] == [540, 393]
    print('build_guide: self-test passed')


def main():
    cli = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    cli.add_argument('--check', action='store_true', help='change nothing, fail where a page is out of date')
    cli.add_argument('--self-test', action='store_true')
    options = cli.parse_args()
    if options.self_test:
        return self_test()
    faults = [*bill_faults(), *pin_faults()]
    wanted = [(page, filled(page.read_text())) for page in PAGES] + list(drawings())
    faults += [f'{page.relative_to(ROOT)}: {fault}' for page, text in wanted if page in PAGES for fault in size_faults(text)]
    for path, text in wanted:
        if path.exists() and path.read_text() == text:
            continue
        if options.check:
            faults.append(f'{path.relative_to(ROOT)} is out of date: python3 scripts/build_guide.py')
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            print(f'written {path.relative_to(ROOT)}')
    print(*faults, sep='\n', end='\n' if faults else '', file=sys.stderr)
    sums = ', '.join(f'{name} {sum_of(bill(name)):.2f} USD' for name in BOUNDS) if not faults else ''
    print(f'build_guide: {len(wanted)} files, {len(faults)} faults' + (f'; {sums}' if sums else ''))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
