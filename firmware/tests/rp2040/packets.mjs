// wire/device_frame.h and wire/device_command.h once more, in another language.
export function crc16(bytes) {
  let crc = 0xffff;
  for (const byte of bytes) {
    crc ^= byte << 8;
    for (let bit = 0; bit < 8; ++bit) crc = ((crc << 1) ^ (crc & 0x8000 ? 0x1021 : 0)) & 0xffff;
  }
  return crc;
}

// undefined: no frame.
export function decodeFrame(report) {
  const view = new DataView(report.buffer, report.byteOffset, report.length);
  if (report.length !== 64 || report[0] !== 2) return undefined;
  if (view.getUint16(44, true) !== crc16(report.subarray(0, 44))) return undefined;
  if (report.subarray(46).some((byte) => byte !== 0)) return undefined;
  const rods = [0, 1, 2, 3, 4, 5, 6, 7];
  return {
    flags: report[1],
    sequence: view.getUint16(2, true),
    timeUs: view.getUint32(4, true),
    slide: rods.map((rod) => view.getUint16(8 + 4 * rod, true)),
    spin: rods.map((rod) => view.getUint16(10 + 4 * rod, true)),
    present: report[40],
    overflow: report[41],
    quality: report[42],
    index: report[43],
  };
}

export function encodeCommand({ kind, sequence = 0, rod = 0, amplitude = 0, durationMs = 0, resolution = 0,
  brightness = 0, ps2 = 0, switches = 0, travel = 0, turn = 0, reversed = 0 }) {
  const bytes = new Uint8Array(16);
  const view = new DataView(bytes.buffer);
  bytes.set([1, kind]);
  view.setUint16(2, sequence, true);
  bytes.set([rod, amplitude], 4);
  view.setUint16(6, durationMs, true);
  if (kind === 4) {
    bytes[5] = reversed;
    view.setUint16(8, travel, true);
    view.setUint16(10, turn, true);
  } else {
    bytes.set([resolution, brightness, ps2, switches], 8);
  }
  view.setUint16(14, crc16(bytes.subarray(0, 14)), true);
  return bytes;
}
