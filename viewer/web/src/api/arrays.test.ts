// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { arrayOf } from './arrays';

const base64 = (bytes: Uint8Array) => btoa(String.fromCharCode(...bytes));

describe('arrays', () => {
  it('are read as lists and as bytes', () => {
    expect(arrayOf({ $ndarray: { type: 'float64', shape: [2, 1], data: [1.5, -2] } })).toEqual({ shape: [2, 1], data: [1.5, -2] });
    expect(Array.from(arrayOf({ $ndarray: { type: 'uint8', shape: [1, 3], base64: base64(Uint8Array.of(0, 254, 255)) } })!.data)).toEqual([0, 254, 255]);
    expect(Array.from(arrayOf({ $ndarray: { type: 'float64', shape: [2], base64: base64(new Uint8Array(Float64Array.of(0.1, 9).buffer)) } })!.data)).toEqual([0.1, 9]);
  });
  it('that have another size than their shape, or are none, are not', () => {
    for (const odd of [
      null, [], { $ndarray: 5 }, { $array: { shape: [2] } }, { $ndarray: { type: 'uint8', shape: [2], data: [1] } }, { $ndarray: { type: 'uint8', shape: [2], base64: '%%' } },
      { $ndarray: { type: 'uint8', shape: [1e9, 1e9], base64: 'AAAA' } }, { $ndarray: { type: 'complex', shape: [3], base64: 'AAAA' } }, { $ndarray: { type: 'uint8', shape: [-3], base64: 'AAAA' } }, { $ndarray: { type: 'float64', shape: [1], data: ['nan'] } },
    ]) expect(arrayOf(odd)).toBeUndefined();
  });
});
