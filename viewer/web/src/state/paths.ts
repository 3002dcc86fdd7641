// SPDX-License-Identifier: Apache-2.0
// Paths into values, as Engram writes them (docs/idf.md): keys joined by '/', with `[i]` or `[i,j]`
// behind them for an element of an array. In a key, '/' is `\/`, a backslash `\\`, an empty key `\e`.

export interface Path {
  readonly keys: readonly string[];
  /** Indices of an element of an array; empty: the whole. */
  readonly indices: readonly number[];
}

const unescapeKey = (key: string): string => key.replace(/\\(.)/g, (_, c: string) => (c === 'e' ? '' : c));
export const escapeKey = (key: string): string => (key === '' ? '\\e' : key.replace(/[\\/]/g, '\\$&'));
export const joinPath = (path: string, key: string): string => (path === '' ? escapeKey(key) : `${path}/${escapeKey(key)}`);

export function parsePath(path: string): Path {
  const match = /^(.*)\[(\d+(?:,\d+)*)?\]$/s.exec(path);
  const whole = match ? match[1]! : path;
  const keys = whole === '' ? [] : (whole.match(/(?:\\.|[^\\/])+/gs) ?? []).map(unescapeKey);
  return { keys, indices: match?.[2] ? match[2].split(',').map(Number) : [] };
}

/** The path of the array that an element is of. */
export const arrayPath = (path: string): string => path.replace(/\[[\d,]*\]$/, '');

/** `["pose"]["position"][2]`, as Python takes it. */
export function pythonIndex(path: string): string {
  const { keys, indices } = parsePath(path);
  return keys.map((key) => `[${/^\d+$/.test(key) ? key : JSON.stringify(key)}]`).join('') + (indices.length > 0 ? `[${indices.join(', ')}]` : '');
}
