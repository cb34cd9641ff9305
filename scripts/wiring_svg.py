"""The wiring of the cabinet's controllers as SVG, from docs/build/pins.json: build_guide.py writes it.

A small writer of our own: lines, boxes and words at whole coordinates, so that the same description
gives the same bytes. Schematics read from left to right: sensors, pull-ups, controller, PC.
"""
from xml.sax.saxutils import escape

RODS = 8
COLOURS = {'+5 V': '#b3261e', 'ground': '#222222', 'clock': '#1a56b0', 'data': '#0b7a3b', 'SCK': '#1a56b0',
           'MOSI': '#0b7a3b', 'MISO': '#8a4b08', 'select': '#6a2c91', 'SDA': '#0b7a3b', 'SCL': '#1a56b0',
           'button': '#555555', 'EN': '#6a2c91'}


class Svg:
    def __init__(self, width, height, title):
        self.size, self.title, self.parts = (width, height), title, []

    def add(self, element):
        self.parts.append(element)

    def line(self, points, colour, width=2):
        path = ' '.join(f'{x},{y}' for x, y in points)
        self.add(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"/>')

    def dot(self, x, y, colour):
        self.add(f'<circle cx="{x}" cy="{y}" r="4" fill="{colour}"/>')

    def box(self, x, y, width, height, fill='#f4f6f8'):
        self.add(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="4" fill="{fill}" '
                 'stroke="#333333" stroke-width="1.5"/>')

    def words(self, x, y, text, size=14, anchor='start', colour='#111111', bold=False):
        weight = ' font-weight="bold"' if bold else ''
        self.add(f'<text x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}" fill="{colour}"{weight}>'
                 f'{escape(text)}</text>')

    def resistor(self, x, top, bottom, colour='#333333'):
        """Upright, between two wires."""
        body = 16
        y = (top + bottom - body) // 2
        self.line([(x, top), (x, y)], colour, 1.5)
        self.line([(x, y + body), (x, bottom)], colour, 1.5)
        self.add(f'<rect x="{x - 4}" y="{y}" width="8" height="{body}" fill="#ffffff" stroke="{colour}" '
                 'stroke-width="1.5"/>')

    def text(self):
        width, height = self.size
        return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
                f'height="{height}" font-family="DejaVu Sans, Verdana, sans-serif">\n'
                f'<title>{escape(self.title)}</title>\n<rect width="{width}" height="{height}" fill="#ffffff"/>\n'
                + '\n'.join(self.parts) + '\n</svg>\n')


def ps2_wiring(board):
    """Eight mice at one AVR: each line has its pull-up, the supplies are two buses. Motors and LED beside it."""
    top, pitch, gap = 116, 120, 26
    low = top + RODS * pitch
    svg = Svg(1120, low + 190, f'Eight PS/2 mice at an {board["name"]}')
    svg.words(20, 34, f'Eight PS/2 mice at an {board["name"]}', 20, bold=True)
    svg.words(20, 60, 'Mini-DIN pins 2 and 6 stay free. Each resistor: 4.7 kOhm. A dot joins; lines that cross do not.', 14)
    plug_right, plus_x, ground_x, board_x = 200, 440, 500, 680
    svg.box(board_x, top - 34, 190, low - top + 54, '#e8f0e8')
    svg.words(board_x + 95, top - 8, board['name'].split(',')[0].split(' (')[0], 15, 'middle', bold=True)
    for rod in range(RODS):
        y = top + rod * pitch + 26
        svg.box(40, y - 18, plug_right - 40, 3 * gap + 30)
        svg.words(52, y + 2, f'rod {rod + 1}', 15, bold=True)
        svg.words(52, y + 22, 'mouse', 13)
        nets = [('data', '1'), ('+5 V', '4'), ('clock', '5'), ('ground', '3')]
        for i, (net, pin) in enumerate(nets):
            at, colour = y + i * gap, COLOURS[net]
            svg.words(plug_right - 6, at + 5, f'{net}  {pin}', 13, 'end', colour)
            if net in board:
                svg.line([(plug_right, at), (board_x, at)], colour)
                port = board[net][rod]
                printed = board['printed'].get(port)
                svg.words(board_x + 8, at + 5, port + (f'  = pin {printed}' if printed else ''), 14, colour=colour)
            else:
                bus = plus_x if net == '+5 V' else ground_x
                svg.line([(plug_right, at), (bus, at)], colour)
                svg.dot(bus, at, colour)
        svg.resistor(300, y, y + gap)
        svg.resistor(350, y + gap, y + 2 * gap)
        for x, at in [(300, y), (350, y + 2 * gap)]:
            svg.dot(x, at, COLOURS['data' if at == y else 'clock'])
        for x in (300, 350):
            svg.dot(x, y + gap, COLOURS['+5 V'])
    supply_y = low + 60
    svg.box(40, supply_y, 160, 84)
    svg.words(52, supply_y + 24, 'supply 5 V', 15, bold=True)
    svg.words(52, supply_y + 44, '1.5 A or more', 13)
    for net, at, bus in [('+5 V', supply_y + 24, plus_x), ('ground', supply_y + 62, ground_x)]:
        svg.words(plug_right - 6, at + 5, '+' if net == '+5 V' else '-', 16, 'end', COLOURS[net])
        svg.line([(plug_right, at), (bus, at)], COLOURS[net], 3)
        svg.line([(bus, at), (bus, top + 26 + (gap if net == '+5 V' else 3 * gap))], COLOURS[net], 3)
        svg.words(bus + 8, low + 24 if net == '+5 V' else low + 44, net, 13, colour=COLOURS[net])
    if 'serial' in board['link']:
        svg.words(40, supply_y + 104, 'One or two mice: from the board\'s 5V instead.', 13)
    ground_at = supply_y + 62
    svg.line([(ground_x, ground_at), (board_x + 40, ground_at), (board_x + 40, low + 20)], COLOURS['ground'], 3)
    svg.dot(ground_x, ground_at, COLOURS['ground'])
    svg.words(board_x + 26, low + 12, 'GND', 13, colour=COLOURS['ground'])
    svg.words(board_x + 56, ground_at - 8, 'Grounds are joined; the supply\'s', 13)
    svg.words(board_x + 56, ground_at + 10, '+5 V is not joined to USB\'s.', 13)
    avr_signals(svg, board, board_x + 190, top + 5 * pitch + 95)
    pc_y = top + 2 * pitch
    svg.box(980, pc_y, 90, 70, '#eef0fa')
    svg.words(1025, pc_y + 42, 'PC', 18, 'middle', bold=True)
    svg.line([(board_x + 190, pc_y + 35), (980, pc_y + 35)], '#555555', 5)
    svg.words(882, pc_y + 22, 'USB', 14)
    for i, part in enumerate(board['link'].split(', ')[1:]):
        svg.words(882, pc_y + 58 + 18 * i, part, 13)
    return svg.text()


def marks_wiring(svg, lines, x, y):
    """The index marks' expander, on the lines of the multiplexer: net -> where its line is and may be joined."""
    for i, (net, (at_x, at_y)) in enumerate(lines.items()):
        at = y + 66 + 22 * i
        svg.dot(at_x, at_y, COLOURS[net])
        svg.line([(at_x, at_y), (at_x, at), (x, at)], COLOURS[net])
    svg.box(x, y, 230, 120)
    svg.words(x + 115, y + 22, 'PCA8574, address 0x20', 14, 'middle', bold=True)
    svg.words(x + 115, y + 42, 'VDD 3.3 V, GND; A0 to A2 to ground', 11, 'middle')
    for i, (net, _) in enumerate(lines.items()):
        svg.words(x + 8, y + 71 + 22 * i, net, 13, colour=COLOURS[net])
    svg.words(x + 222, y + 71, 'P0 to P7', 13, 'end')
    svg.line([(x + 230, y + 66), (x + 300, y + 66)], COLOURS['data'], 4)
    svg.box(x + 300, y, 190, 120)
    svg.words(x + 395, y + 22, 'eight Hall switches', 14, 'middle', bold=True)
    svg.words(x + 395, y + 42, 'A3144: VCC 5 V, GND', 12, 'middle')
    svg.words(x + 308, y + 71, 'OUT of rod i at Pi', 13)
    svg.words(x, y + 142, 'Index marks, if wanted. OUT is an open collector: 10 kOhm', 13)
    svg.words(x, y + 160, 'from each of the eight lines to 3.3 V, none to 5 V.', 13)


def avr_signals(svg, board, right, top):
    """What need not be there: the motors' multiplexer, and an LED. right: of the controller's box."""
    i2c = board['i2c']

    def pin(port, at, colour):
        printed = board['printed'].get(port)
        svg.words(right - 8, at + 5, (f'pin {printed} = ' if printed else '') + port, 14, 'end', colour)

    box_x = 950
    svg.box(box_x, top - 20, 120, 152)
    for i, words in enumerate(['TCA9548A and', 'eight DRV2605L:', 'as at the Pico,', 'all at +5 V']):
        svg.words(box_x + 60, top + 68 + 18 * i, words, 12, 'middle')
    for i, (net, port) in enumerate([('SDA', i2c['sda']), ('SCL', i2c['scl']), ('EN', board['motors_enable'])]):
        at, colour = top + 17 * i, COLOURS[net]
        pin(port, at, colour)
        svg.line([(right, at), (box_x, at)], colour)
        svg.words(box_x + 8, at + 5, net, 13, colour=colour)
    svg.words(right + 10, top - 48, '4.7 kOhm from SDA and SCL to +5 V,', 12)
    svg.words(right + 10, top - 32, '10 kOhm from EN to ground', 12)
    at = top - 108  # between the lines of two rods, as the three above
    pin(board['led'], at, '#555555')
    if board['led'] in board['printed']:
        svg.words(right + 10, at + 5, 'LED on the board', 12)
    else:
        svg.line([(right, at), (box_x, at)], '#555555')
        svg.words(box_x + 8, at + 5, 'LED, 1 kOhm, ground', 12)


def spi_wiring(board):
    """Eight SPI sensors, a motor a rod behind an I2C multiplexer and index marks beside it, at one Pico."""
    top, pitch, gap = 130, 126, 17
    low = top + RODS * pitch
    spi, i2c = board['spi'], board['i2c']
    svg = Svg(1500, low + 410, f'Eight SPI sensors and eight motors at a {board["name"]}')
    svg.words(20, 34, f'Eight SPI sensors and eight motors at a {board["name"]}', 20, bold=True)
    svg.words(20, 60, 'Sensor: PMW3360 class on a breakout board with a regulator of its own; VIN is 5 V or 3.3 V, as '
              'the board asks. A dot joins; lines that cross do not.', 14)
    svg.words(20, 80, '100 Ohm in series in SCK and MOSI at the Pico. 10 kOhm from each select line to 3.3 V, and '
              'from the drivers\' EN to ground: nothing listens or shakes while the Pico starts.', 14)
    right, board_x, board_w = 190, 640, 210
    buses = {'SCK': 340, 'MOSI': 390, '+5 V': 240, 'ground': 290}
    spi_pins = {'SCK': spi['sck'], 'MOSI': spi['mosi']}
    svg.box(board_x, top - 30, board_w, low - top + 160, '#e8f0e8')
    svg.words(board_x + board_w // 2, top - 6, 'Raspberry Pi Pico', 16, 'middle', bold=True)
    for rod in range(RODS):
        y = top + rod * pitch + 20
        svg.box(40, y - 16, right - 40, 5 * gap + 30)
        svg.words(50, y + 4, f'rod {rod + 1}', 15, bold=True)
        svg.words(50, y + 24, 'sensor', 13)
        for i, (net, pin) in enumerate([('select', 'NCS'), ('MISO', 'MISO'), ('SCK', 'SCLK'), ('MOSI', 'MOSI'),
                                        ('+5 V', 'VIN'), ('ground', 'GND')]):
            at, colour = y + i * gap, COLOURS[net]
            svg.words(right - 6, at + 5, pin, 12, 'end', colour)
            if net in ('select', 'MISO'):
                svg.line([(right, at), (board_x, at)], colour)
                number = board['select' if net == 'select' else 'data'][rod]
                svg.words(board_x + 8, at + 5, f'GP{number}  pin {pico_pin(number)}', 14, colour=colour)
            else:
                svg.line([(right, at), (buses[net], at)], colour)
                svg.dot(buses[net], at, colour)
    for i, (net, number) in enumerate(spi_pins.items()):
        at = low + 20 + 28 * i
        first = top + 20 + gap * (2 + i)
        svg.line([(buses[net], first), (buses[net], at), (board_x, at)], COLOURS[net])
        svg.words(board_x + 8, at + 5, f'GP{number}  pin {pico_pin(number)}  {net}', 14, colour=COLOURS[net])
        svg.words(480, at - 5, net, 12, colour=COLOURS[net])
    # Supply and ground.
    supply_y = low + 120
    svg.box(40, supply_y, 150, 84)
    svg.words(50, supply_y + 24, 'supply 5 V', 15, bold=True)
    svg.words(50, supply_y + 44, '2 A or more', 13)
    for net, at in [('+5 V', supply_y + 24), ('ground', supply_y + 62)]:
        svg.words(right - 6, at + 5, '+' if net == '+5 V' else '-', 16, 'end', COLOURS[net])
        svg.line([(right, at), (buses[net], at), (buses[net], top + 20 + gap * (4 if net == '+5 V' else 5))], COLOURS[net], 3)
    ground_at = supply_y + 62
    mux_x, drive_x = 1000, 1240
    svg.line([(buses['ground'], ground_at), (mux_x + 60, ground_at)], COLOURS['ground'], 3)
    svg.line([(board_x + 60, ground_at), (board_x + 60, low + 130)], COLOURS['ground'], 3)
    for x in (board_x + 60, buses['ground']):
        svg.dot(x, ground_at, COLOURS['ground'])
    svg.words(board_x + 48, low + 122, 'GND  pin 38', 13)
    # The multiplexer and its drivers.
    mux_y, mux_h = top - 30, low - top + 30
    svg.box(mux_x, mux_y, 120, mux_h)
    svg.words(mux_x + 60, mux_y + 22, 'TCA9548A', 15, 'middle', bold=True)
    svg.words(mux_x + 60, mux_y + 40, 'address 0x70', 12, 'middle')
    for i, (net, number) in enumerate([('SDA', i2c['sda']), ('SCL', i2c['scl'])]):
        at = top + 2 * pitch + 24 + 54 * i
        svg.line([(board_x + board_w, at), (mux_x, at)], COLOURS[net])
        svg.words(board_x + board_w - 8, at + 5, f'pin {pico_pin(number)}  GP{number}', 14, 'end', COLOURS[net])
        svg.words(mux_x + 8, at + 5, net, 13, colour=COLOURS[net])
        x = 885 + 40 * i
        svg.resistor(x, at - 42, at)
        svg.dot(x, at, COLOURS[net])
        svg.words(x + 8, at - 30, '3.3 V', 11, colour=COLOURS['+5 V'])
    svg.words(880, top + 2 * pitch + 104, '4.7 kOhm each', 12)
    at = top + 3 * pitch + 60
    svg.line([(board_x + board_w, at), (mux_x, at)], COLOURS['+5 V'])
    svg.words(board_x + board_w - 8, at + 5, 'pin 36  3V3', 14, 'end', COLOURS['+5 V'])
    svg.words(mux_x + 8, at + 5, 'VIN', 13, colour=COLOURS['+5 V'])
    svg.line([(mux_x + 60, ground_at), (mux_x + 60, mux_y + mux_h)], COLOURS['ground'], 3)
    svg.words(mux_x + 48, mux_y + mux_h - 8, 'GND', 13)
    for rod in range(RODS):
        y = top + rod * pitch + 32
        svg.box(drive_x, y - 12, 130, 92)
        svg.words(drive_x + 65, y + 8, 'DRV2605L', 14, 'middle', bold=True)
        svg.words(drive_x + 65, y + 26, f'rod {rod + 1}, 0x5A', 12, 'middle')
        svg.words(drive_x + 122, y + 70, 'VIN 5 V, GND', 11, 'end')
        for i, net in enumerate(['SDA', 'SCL']):
            at = y + 2 + 24 * i
            svg.line([(mux_x + 120, at), (drive_x, at)], COLOURS[net])
            svg.words(mux_x + 112, at + 5, ('SD' if net == 'SDA' else 'SC') + str(rod), 13, 'end', COLOURS[net])
            svg.words(mux_x + 150, at - 5, net, 11, colour=COLOURS[net])
        for at in (y + 16, y + 44):
            svg.line([(drive_x + 130, at), (1410, at)], '#555555')
        svg.add(f'<circle cx="1428" cy="{y + 30}" r="23" fill="#f4f6f8" stroke="#333333" stroke-width="1.5"/>')
        svg.words(1428, y + 36, 'M', 16, 'middle', bold=True)
    # EN of all drivers, round the multiplexer.
    en_y, en_x = low + 80, 1216
    number = board['motors_enable']
    svg.words(board_x + board_w - 8, en_y + 5, f'pin {pico_pin(number)}  GP{number}', 14, 'end', COLOURS['EN'])
    svg.line([(board_x + board_w, en_y), (en_x, en_y), (en_x, top + 80)], COLOURS['EN'])
    svg.words(1076, en_y - 6, 'EN of all drivers', 12, colour=COLOURS['EN'])
    for rod in range(RODS):
        y = top + rod * pitch + 80
        svg.line([(en_x, y), (drive_x, y)], COLOURS['EN'])
        svg.dot(en_x, y, COLOURS['EN'])
        svg.words(drive_x + 6, y + 5, 'EN', 12, colour=COLOURS['EN'])
    # Index marks, on the multiplexer's lines, down between the resistors and the multiplexer.
    marks_wiring(svg, {net: (x, top + 2 * pitch + 24 + 54 * i) for i, (net, x) in
                       enumerate([('SDA', 976), ('SCL', 988)])}, 1000, low + 230)
    # Button and PC.
    at = top + 5 * pitch + 40
    svg.line([(board_x + board_w, at), (900, at)], COLOURS['button'])
    svg.words(board_x + board_w - 8, at + 5, f'pin {pico_pin(board["button"])}  GP{board["button"]}', 14, 'end')
    svg.line([(900, at), (918, at - 12)], COLOURS['button'])
    svg.line([(922, at), (945, at), (945, at + 24)], COLOURS['button'])
    svg.line([(933, at + 24), (957, at + 24)], COLOURS['ground'], 3)
    svg.words(880, at - 22, 'button', 13)
    at = top + 6 * pitch + 50
    svg.line([(board_x + board_w, at), (900, at)], '#555555', 5)
    svg.words(board_x + board_w - 8, at + 5, 'USB', 14, 'end')
    svg.box(900, at - 25, 70, 50, '#eef0fa')
    svg.words(935, at + 6, 'PC', 16, 'middle', bold=True)
    return svg.text()


def pico_pin(number):
    """The pin of the Pico's edge that GP number is: data sheet, "Pico pinout"."""
    left = [0, 1, None, 2, 3, 4, 5, None, 6, 7, 8, 9, None, 10, 11, 12, 13, None, 14, 15]
    right = [16, 17, None, 18, 19, 20, 21, None, 22, None, 26, 27, None, 28]
    return (left + right).index(number) + 1
