// SPDX-License-Identifier: Apache-2.0
// Arrays in the JSON of IDF: short ones as a list of numbers, long ones as bytes in base64 (docs/idf.md).

export interface NumberArray {
  readonly shape: readonly number[];
  readonly data: ArrayLike<number>;
}

const kViews = { uint8: Uint8Array, int16: Int16Array, int32: Int32Array, float32: Float32Array, float64: Float64Array } as const;

const isDict = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null && !Array.isArray(value);

function bytesOf(text: string): Uint8Array | undefined {
  try {
    return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  } catch {
    return undefined;
  }
}

/** The numbers of an array, as many as its shape says; undefined where it is none, or only its summary was sent. */
export function arrayOf(value: unknown): NumberArray | undefined {
  const array = isDict(value) && isDict(value.$ndarray) ? value.$ndarray : undefined;
  const shape = array?.shape;
  if (!array || !Array.isArray(shape) || !shape.every((size) => Number.isSafeInteger(size) && size >= 0)) return undefined;
  const count = shape.reduce((a: number, b: number) => a * b, 1);
  if (Array.isArray(array.data)) return array.data.length === count && array.data.every((one) => typeof one === 'number') ? { shape, data: array.data as number[] } : undefined;
  const View = kViews[String(array.type) as keyof typeof kViews];
  const bytes = typeof array.base64 === 'string' && View ? bytesOf(array.base64) : undefined;
  return bytes && bytes.length === count * View.BYTES_PER_ELEMENT ? { shape, data: new View(bytes.buffer as ArrayBuffer) } : undefined;
}
