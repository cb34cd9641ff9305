#!/usr/bin/env python3
"""Makes a .uf2 for the RP2040 from an .elf: make_uf2.py IN.elf OUT.uf2

The loadable segments by their addresses in flash; the CRC of the second stage, which the boot ROM
checks, is computed into bytes 252..255. The UF2 format: 512-byte blocks with 256 bytes of payload
each, for addresses that are multiples of 256.
"""
import struct
import sys
from pathlib import Path

FLASH, FLASH_BYTES = 0x10000000, 2 << 20
PAGE = 256
MAGIC_FIRST, MAGIC_SECOND, MAGIC_LAST = 0x0A324655, 0x9E5D5157, 0x0AB16F30
FAMILY_PRESENT, FAMILY_RP2040 = 0x2000, 0xE48BFF56


def segments(elf):
    """(address, bytes) of each loadable segment that has bytes in the file."""
    if elf[:6] != b'\x7fELF\x01\x01':
        raise ValueError('no little-endian 32-bit ELF file')
    table, = struct.unpack_from('<I', elf, 28)
    size, count = struct.unpack_from('<HH', elf, 42)
    for i in range(count):
        kind, offset, _, physical, filled = struct.unpack_from('<IIIII', elf, table + i * size)
        if kind == 1 and filled:
            yield physical, elf[offset:offset + filled]


def flash_image(elf):
    image = bytearray()
    for address, data in segments(elf):
        start = address - FLASH
        if start < 0 or start + len(data) > FLASH_BYTES:
            raise ValueError(f'a segment at {address:#x} is not in flash')
        image.extend(b'\xff' * max(0, start + len(data) - len(image)))
        image[start:start + len(data)] = data
    image.extend(b'\xff' * (-len(image) % PAGE))
    return image


def boot_crc(data):
    """CRC-32 with 0x04C11DB7, most significant bit first, from all ones, not inverted."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1 ^ (0x04C11DB7 if crc & 0x80000000 else 0)) & 0xFFFFFFFF
    return crc


def blocks(image):
    count = len(image) // PAGE
    for i in range(count):
        head = struct.pack('<8I', MAGIC_FIRST, MAGIC_SECOND, FAMILY_PRESENT, FLASH + i * PAGE, PAGE, i, count,
                           FAMILY_RP2040)
        yield head + bytes(image[i * PAGE:(i + 1) * PAGE]) + bytes(476 - PAGE) + struct.pack('<I', MAGIC_LAST)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0])
    image = flash_image(Path(sys.argv[1]).read_bytes())
    struct.pack_into('<I', image, 252, boot_crc(image[:252]))
    Path(sys.argv[2]).write_bytes(b''.join(blocks(image)))
    print(f'{sys.argv[2]}: {len(image)} bytes of flash')


if __name__ == '__main__':
    main()
