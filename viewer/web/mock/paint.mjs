// SPDX-License-Identifier: Apache-2.0
// Paints what the cameras of the imagined robot see: 128 x 128 pixels, RGB.
import { kThings, platform, reach, thing, carried } from './motion.mjs';

export const kSide = 128;

const kColours = [[196, 148, 66], [226, 230, 236], [210, 210, 214], [74, 122, 82], [178, 64, 58], [108, 150, 190], [190, 52, 44], [222, 196, 72], [58, 96, 120]];

function canvas() {
  const pixels = new Uint8Array(kSide * kSide * 3);
  const put = (x, y, colour, light) => {
    const at = (y * kSide + x) * 3;
    for (let c = 0; c < 3; ++c) pixels[at + c] = Math.max(0, Math.min(255, colour[c] * light));
  };
  const box = (x0, y0, x1, y1, shade) => {
    for (let y = Math.max(0, Math.round(y0)); y < Math.min(kSide, Math.round(y1)); ++y)
      for (let x = Math.max(0, Math.round(x0)); x < Math.min(kSide, Math.round(x1)); ++x) {
        const [colour, light] = shade(x, y);
        put(x, y, colour, light);
      }
  };
  const disc = (cx, cy, rx, ry, colour, light) => {
    for (let y = Math.max(0, Math.floor(cy - ry)); y < Math.min(kSide, cy + ry); ++y)
      for (let x = Math.max(0, Math.floor(cx - rx)); x < Math.min(kSide, cx + rx); ++x) {
        const u = (x - cx) / rx;
        const v = (y - cy) / ry;
        if (u * u + v * v < 1) put(x, y, colour, light * (1 - 0.35 * (u * 0.6 + v * 0.8)));
      }
  };
  return { pixels, box, disc };
}

/** Tiles, window and furniture, as they lie when the head looks `pan` pixels to the side. */
function room(paint, pan, day) {
  paint.box(0, 0, kSide, 72, (x, y) => {
    const isJoint = (x + pan + 4000) % 16 < 1 || y % 16 < 1;
    return [[206, 202, 190], (isJoint ? 0.8 : 0.94) * day * (1 - y / 400)];
  });
  paint.box(64 - pan, 8, 112 - pan, 48, (x, y) => [y < 30 ? [178, 206, 232] : [120, 160, 104], day * (1.02 - (y - 8) / 200)]);
  paint.box(62 - pan, 6, 114 - pan, 9, () => [[240, 238, 232], day]);
  paint.box(62 - pan, 47, 114 - pan, 50, () => [[240, 238, 232], day * 0.9]);
  paint.box(87 - pan, 8, 89 - pan, 48, () => [[240, 238, 232], day * 0.95]);
  paint.box(0, 72, kSide, kSide, (x, y) => [[150, 112, 78], day * (0.78 + 0.3 * ((y - 72) / 56) + 0.05 * Math.sin((x + pan) * 0.7 + Math.sin(y) * 0.4))]);
  paint.box(0, 70, kSide, 74, () => [[98, 70, 48], day]);
}

/** What one camera sees; `eye` shifts it to the side, as the second eye of a stereo pair is. */
export function scene(t, eye = 0) {
  const paint = canvas();
  const base = platform(t);
  const pan = Math.round(60 * (base.heading + 1.4) / 2.2 + 24 * base.x) + eye;
  const day = 0.86 + 0.12 * Math.sin(t / 400);
  room(paint, pan, day);
  const order = kThings.map((_, i) => ({ i, at: thing(i, t) })).sort((a, b) => b.at.y - a.at.y);
  for (const { i, at } of order) {
    const depth = Math.max(0.35, at.y - base.y + 0.2);
    const x = 64 + 62 * (at.x - base.x) / depth - eye * 0.5;
    const foot = 74 + 26 * (1.15 - depth) - 60 * (at.z - (carried(t) === i ? 0.93 : at.z)) + 12;
    const size = 9 / depth;
    if (i % 3 === 0) paint.box(x - size * 0.7, foot - size * 2.4, x + size * 0.7, foot, (px, py) => [kColours[i], day * (px > x + size * 0.3 ? 0.7 : py % 9 < 2 ? 1.15 : 1)]);
    else paint.disc(x, foot - size, size * 0.8, size * (i % 3 === 1 ? 1.5 : 0.9), kColours[i], day);
  }
  const stretch = reach(t);
  paint.box(92 - 22 * stretch, 118 - 34 * stretch, 104 - 18 * stretch, kSide, (x) => [[84, 88, 96], day * (0.7 + (x % 12) / 30)]);
  paint.disc(96 - 22 * stretch, 116 - 36 * stretch, 9, 8, [66, 70, 78], day * 1.1);
  return grain(paint.pixels, t);
}

/** The noise of a sensor, by a small generator of its own. */
function grain(pixels, t) {
  let state = (Math.round(t * 1000) * 2654435761) >>> 0;
  for (let i = 0; i < pixels.length; ++i) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    pixels[i] = Math.max(0, Math.min(255, pixels[i] + (state >>> 29) - 4));
  }
  return pixels;
}

/** What an autoencoder gives back: without grain, a little soft. */
export function reconstruct(pixels, strength = 1) {
  const out = new Uint8Array(pixels.length);
  for (let y = 0; y < kSide; ++y)
    for (let x = 0; x < kSide; ++x)
      for (let c = 0; c < 3; ++c) {
        let sum = 0;
        let count = 0;
        for (let v = Math.max(0, y - strength); v <= Math.min(kSide - 1, y + strength); ++v)
          for (let u = Math.max(0, x - strength); u <= Math.min(kSide - 1, x + strength); ++u, ++count) sum += pixels[(v * kSide + u) * 3 + c];
        out[(y * kSide + x) * 3 + c] = (Math.round(sum / count) & 0xfc) + 2;
      }
  return out;
}

export function psnr(a, b) {
  let sum = 0;
  for (let i = 0; i < a.length; ++i) sum += (a[i] - b[i]) ** 2;
  return 10 * Math.log10((255 * 255) / Math.max(1e-9, sum / a.length));
}

/** |a - b| times a gain, from black over violet and orange to white: readable in grey as well. */
export function errorMap(a, b, gain) {
  const stops = [[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]];
  const out = new Uint8Array(a.length);
  for (let i = 0; i < a.length; i += 3) {
    const error = Math.min(1, (gain * (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]))) / 3 / 255);
    const at = error * (stops.length - 1);
    const low = Math.min(stops.length - 2, Math.floor(at));
    for (let c = 0; c < 3; ++c) out[i + c] = stops[low][c] + (stops[low + 1][c] - stops[low][c]) * (at - low);
  }
  return out;
}

/** Depth in grey: near is bright. */
export function depthOf(pixels) {
  const out = new Uint8Array(pixels.length);
  for (let y = 0; y < kSide; ++y)
    for (let x = 0; x < kSide; ++x) {
      const at = (y * kSide + x) * 3;
      const near = Math.max(0, Math.min(255, 40 + Math.max(0, y - 60) * 2.6 + pixels[at] * 0.15));
      out.fill(near, at, at + 3);
    }
  return out;
}
