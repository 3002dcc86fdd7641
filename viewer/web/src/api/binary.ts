// SPDX-License-Identifier: Apache-2.0
// The two binary answers: counts of snapshots and min/max/last of numbers, per pixel.
import { ApiError } from './client';

const isLittleEndian = new Uint8Array(Uint32Array.of(1).buffer)[0] === 1;

function need(buffer: ArrayBuffer, bytes: number, what: string): void {
  if (!isLittleEndian) throw new ApiError('unimplemented', 'This browser is big endian, which the viewer cannot read.');
  if (buffer.byteLength !== bytes) throw new ApiError('data loss', `/api/${what}: ${buffer.byteLength} bytes came, ${bytes} were needed.`);
}

/** Counts of one lane; all three have one number per pixel. */
export interface Density {
  readonly recorded: Uint32Array;
  readonly latent: Uint32Array;
  readonly augmented: Uint32Array;
}

export function decodeDensity(buffer: ArrayBuffer, lanes: number, pixels: number): Density[] {
  need(buffer, lanes * 3 * pixels * 4, 'density');
  const part = (lane: number, form: number) => new Uint32Array(buffer, (lane * 3 + form) * pixels * 4, pixels);
  return Array.from({ length: lanes }, (_, lane) => ({ recorded: part(lane, 0), latent: part(lane, 1), augmented: part(lane, 2) }));
}

/** One series; NaN where a pixel has no snapshot. */
export interface Series {
  readonly min: Float32Array;
  readonly max: Float32Array;
  readonly last: Float32Array;
}

export function decodeSeries(buffer: ArrayBuffer, paths: number, pixels: number): Series[] {
  need(buffer, paths * 3 * pixels * 4, 'series');
  const part = (path: number, which: number) => new Float32Array(buffer, (path * 3 + which) * pixels * 4, pixels);
  return Array.from({ length: paths }, (_, path) => ({ min: part(path, 0), max: part(path, 1), last: part(path, 2) }));
}
