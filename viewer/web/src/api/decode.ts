// SPDX-License-Identifier: Apache-2.0
// Checks what the gateway answers before the page believes it. A member that is missing or of another
// kind is an error that names it, never an undefined that crashes something later.

export class DecodeError extends Error {
  constructor(path: string, found: unknown, needed: string) {
    const kind = found === null ? 'null' : Array.isArray(found) ? 'a list' : typeof found;
    super(`the answer has ${kind} at '${path || '.'}', ${needed} was needed`);
    this.name = 'DecodeError';
  }
}

export type Decoder<T> = (value: unknown, path: string) => T;

export const string: Decoder<string> = (value, path) => {
  if (typeof value !== 'string') throw new DecodeError(path, value, 'a text');
  return value;
};

export const number: Decoder<number> = (value, path) => {
  if (typeof value !== 'number' || !Number.isFinite(value)) throw new DecodeError(path, value, 'a number');
  return value;
};

export const bool: Decoder<boolean> = (value, path) => {
  if (typeof value !== 'boolean') throw new DecodeError(path, value, 'true or false');
  return value;
};

/** A decimal text of int64 nanoseconds. */
export const time: Decoder<bigint> = (value, path) => {
  if (typeof value !== 'string' || !/^-?\d{1,19}$/.test(value)) throw new DecodeError(path, value, 'a text of nanoseconds');
  const ns = BigInt(value);
  if (BigInt.asIntN(64, ns) !== ns) throw new DecodeError(path, value, 'nanoseconds of 64 bits');
  return ns;
};

/** Keeps what it is given: for IDF trees, which are looked at when they are drawn. */
export const anything: Decoder<unknown> = (value) => value;

export const list = <T>(item: Decoder<T>): Decoder<T[]> => (value, path) => {
  if (!Array.isArray(value)) throw new DecodeError(path, value, 'a list');
  return value.map((part, i) => item(part, `${path}[${i}]`));
};

export const oneOf = <T extends string>(...names: T[]): Decoder<T> => (value, path) => {
  if (!names.includes(value as T)) throw new DecodeError(path, value, `one of ${names.join(', ')}`);
  return value as T;
};

/** undefined where the member is absent or null. */
export const optional = <T>(item: Decoder<T>): Decoder<T | undefined> => (value, path) =>
  value === undefined || value === null ? undefined : item(value, path);

export const withDefault = <T>(item: Decoder<T>, fallback: T): Decoder<T> => (value, path) =>
  value === undefined || value === null ? fallback : item(value, path);

type Shape = Record<string, Decoder<unknown>>;
export type Of<D> = D extends Decoder<infer T> ? T : never;
type Decoded<S extends Shape> = { [K in keyof S]: Of<S[K]> };

/** A dict with at least these members; others are ignored, so that a newer gateway may say more. */
export const object = <S extends Shape>(shape: S): Decoder<Decoded<S>> => (value, path) => {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw new DecodeError(path, value, 'a dict');
  const record = value as Record<string, unknown>;
  const out: Record<string, unknown> = {};
  for (const key of Object.keys(shape)) {
    const found = Object.hasOwn(record, key) ? record[key] : undefined;
    out[key] = shape[key]!(found, path ? `${path}.${key}` : key);
  }
  return out as Decoded<S>;
};
