// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { coloursOf, depthQuery, mayHavePoints } from './clouds';
import { reachOf } from './pointCloud';

const lens = { fx: 2, fy: 2, cx: 0.5, cy: 0.5 };

describe('points of a depth image', () => {
  it('are asked for with how the camera sees, or with a guess', () => {
    const value = { depth: { $image: { width: 100, height: 50, channels: 1, dtype: 'uint16' } }, other: 1 };
    expect(depthQuery(value, 'depth', lens)).toEqual({ ...lens, unit: 0.001 });
    const guessed = depthQuery({ depth: { $image: { width: 132, height: 50, channels: 1, dtype: 'float32' } } }, 'depth', undefined)!;
    expect(guessed).toEqual({ fx: 100, fy: 100, cx: 65.5, cy: 24.5, unit: 1 });
    expect(depthQuery(value, 'other', lens)).toBeUndefined();
    expect(depthQuery(value, 'none/at/all', lens)).toBeUndefined();
  });
  it('are looked for where a value may have some', () => {
    expect(mayHavePoints({ depth: { $image: { channels: 1, dtype: 'uint16' } } })).toBe(true);
    expect(mayHavePoints({ parts: [{ cloud: { $array: { shape: [6072, 3] } } }] })).toBe(true);
    for (const value of [null, 'text', { image: { $image: { channels: 3, dtype: 'uint8' } } }, { mask: { $image: { channels: 1, dtype: 'uint8' } } }, { q: { $ndarray: { shape: [43] } } }]) expect(mayHavePoints(value)).toBe(false);
  });
  it('have the colour of the pixel that they are seen at', () => {
    // Two by two pixels: black, white, red, blue; and the same twice as large.
    const small = Uint8ClampedArray.from([0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 255, 0, 0, 255, 255]);
    const points = Float32Array.of(-0.5, -0.5, 2, 0.5, -0.5, 2, -0.25, 0.25, 1, 0.25, 0.25, 1);
    const expected = [0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 0, 255];
    expect([...coloursOf(points, lens, 1, 2, 2, small)]).toEqual(expected);
    const large = new Uint8ClampedArray(64);
    for (let y = 0; y < 4; ++y) for (let x = 0; x < 4; ++x) large.set(small.subarray(4 * (2 * (y >> 1) + (x >> 1)), 4 * (2 * (y >> 1) + (x >> 1)) + 4), 4 * (4 * y + x));
    expect([...coloursOf(points, lens, 2, 4, 4, large)]).toEqual(expected);
  });
  it('reach as far as most of them do', () => {
    expect(reachOf(Float32Array.from({ length: 300 }, (_, i) => (i % 3 === 2 ? (i - 2) / 3 : 0)))).toBe(94);
    expect(reachOf(new Float32Array(0))).toBe(1);
  });
});
