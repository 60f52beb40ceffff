// Reads and writes the image files that the tests exchange with the program `umbrage`.
import { readFileSync, writeFileSync } from "node:fs";
import { inflateSync } from "node:zlib";

/** Returns {width, height, planes: name to Float32Array, row 0 at the top} of an EXR file of floats, compressed by ZIP. */
export function readExr(path) {
  const bytes = readFileSync(path);
  let at = 8, channels = [], box = [];
  const word = () => bytes.toString("latin1", at, at = bytes.indexOf(0, at)) + (at++, "");
  for (let name = word(); name; name = word()) {
    const type = word(), size = bytes.readInt32LE(at), end = (at += 4) + size;
    if (type == "chlist") for (let channel = word(); channel; channel = word()) channels.push(channel), at += 16;
    if (name == "dataWindow") box = [0, 4, 8, 12].map((k) => bytes.readInt32LE(at + k));
    at = end;
  }
  const width = box[2] - box[0] + 1, height = box[3] - box[1] + 1, planes = {};
  for (const channel of channels) planes[channel] = new Float32Array(width * height);
  at += 8 * Math.ceil(height / 16);
  while (at < bytes.length) {
    const first = bytes.readInt32LE(at) - box[1], size = bytes.readInt32LE(at + 4), rows = Math.min(16, height - first);
    const whole = 4 * width * rows * channels.length, stored = bytes.subarray(at + 8, at + 8 + size), data = Buffer.alloc(whole);
    at += 8 + size;
    if (size == whole) stored.copy(data);
    else {
      const packed = inflateSync(stored), half = (whole + 1) >> 1;
      for (let k = 1; k < whole; ++k) packed[k] = packed[k] + packed[k - 1] - 128;
      for (let k = 0; k < whole; ++k) data[k] = packed[(k >> 1) + (k & 1) * half];
    }
    for (let y = 0, from = 0; y < rows; ++y)
      for (const channel of channels)
        for (let x = 0; x < width; ++x, from += 4) planes[channel][(first + y) * width + x] = data.readFloatLE(from);
  }
  return { width, height, planes };
}

/** Writes one or three floats a pixel, row 0 at the bottom, as a PFM file. */
export function writePfm(path, width, height, data) {
  const channels = data.length / (width * height);
  writeFileSync(path, Buffer.concat([Buffer.from(`${channels == 3 ? "PF" : "Pf"}\n${width} ${height}\n-1.0\n`), Buffer.from(new Float32Array(data).buffer)]));
}
