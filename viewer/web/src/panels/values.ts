// SPDX-License-Identifier: Apache-2.0
// IDF trees in the JSON form of the contract: what a value is, how it is written, where a path leads.
import { joinPath, parsePath } from '../state/paths';
import { formatNumber } from '../time/format';

export type Kind = 'none' | 'bool' | 'number' | 'text' | 'array' | 'summary' | 'image' | 'link' | 'list' | 'dict';

export interface Value {
  readonly kind: Kind;
  /** The value in a line. */
  readonly text: string;
  /** The type as IDF calls it: `float64`, `float32 [3]`. */
  readonly type: string;
  readonly children: readonly { readonly key: string; readonly path: string; readonly value: unknown }[];
  readonly link?: string;
}

type Dict = Record<string, unknown>;
const isDict = (value: unknown): value is Dict => typeof value === 'object' && value !== null && !Array.isArray(value);

const shapeText = (shape: unknown): string => (Array.isArray(shape) ? `[${shape.map(String).join(' x ')}]` : '[?]');
const plain = (kind: Kind, type: string, text: string): Value => ({ kind, type, text, children: [] });
const shorten = (text: string): string => (text.length > 400 ? `${text.slice(0, 400)}...` : text);

/** A number as IDF's JSON has it; that has no NaN and no infinity, so they are texts. */
function finiteOrNot(value: unknown): number | undefined {
  if (typeof value === 'number') return value;
  if (value === 'inf') return Infinity;
  if (value === '-inf') return -Infinity;
  return typeof value === 'string' && /^nan(:[0-9a-f]+)?$/.test(value) ? NaN : undefined;
}

function numberOf(value: unknown): number | undefined {
  if (typeof value === 'number') return value;
  for (const name of ['int32', 'float32', 'float64']) {
    const found = isDict(value) ? finiteOrNot(value[`$${name}`]) : undefined;
    if (found !== undefined) return found;
  }
  return undefined;
}

/** All digits of integers: a count that is rounded is another count. */
const written = (value: number): string => (Number.isSafeInteger(value) ? String(value) : formatNumber(value));

/** `[1,2]` for element 5 of shape [2, 3]. */
function indexText(element: number, shape: readonly number[]): string {
  const indices: number[] = [];
  let rest = element;
  for (const size of [...shape].reverse()) {
    indices.unshift(rest % size);
    rest = Math.floor(rest / size);
  }
  return `[${indices.join(',')}]`;
}

const shapeOf = (value: Dict, count: number): number[] =>
  Array.isArray(value.shape) && value.shape.every((size) => Number.isInteger(size) && (size as number) > 0) ? (value.shape as number[]) : [count];

function arrayOf(value: Dict, path: string): Value {
  const type = `${typeof value.type === 'string' ? value.type : value.dtype ?? 'ndarray'} ${shapeText(value.shape)}`;
  const data = Array.isArray(value.data) ? value.data.map((part) => finiteOrNot(part) ?? part) : null;
  if (!data) return plain('summary', type, 'too many to send');
  const shape = shapeOf(value, data.length);
  const text = data.slice(0, 6).map((part) => (typeof part === 'number' ? written(part) : String(part))).join(', ');
  return {
    kind: 'array', type, text: data.length > 6 ? `${text}, ...` : text,
    children: data.map((part, i) => ({ key: indexText(i, shape), path: path + indexText(i, shape), value: part })),
  };
}

/** What is sent of arrays of more than 64 numbers. */
function summaryOf(value: Dict): Value | undefined {
  const array = value.$array;
  if (!isDict(array)) return undefined;
  const summary = isDict(array.summary) ? array.summary : {};
  const told = ['min', 'max', 'mean'].filter((name) => typeof summary[name] === 'number').map((name) => `${name} ${formatNumber(summary[name] as number)}`);
  return plain('summary', `${typeof array.dtype === 'string' ? array.dtype : 'ndarray'} ${shapeText(array.shape)}`, told.join(', '));
}

export function describe(value: unknown, path: string): Value {
  if (value === null || value === undefined) return plain('none', 'none', 'absent');
  if (typeof value === 'boolean') return plain('bool', 'bool', String(value));
  // JSON tells no int64 from a float64 that is an integer.
  if (typeof value === 'number') return plain('number', Number.isInteger(value) ? 'number' : 'float64', written(value));
  if (typeof value === 'string') return plain('text', 'string', shorten(value));
  if (Array.isArray(value)) return { kind: 'list', type: `list [${value.length}]`, text: '', children: value.map((part, i) => ({ key: String(i), path: joinPath(path, String(i)), value: part })) };
  const dict = value as Dict;
  const { $link: link, $image: image } = dict;
  if (typeof link === 'string') return { kind: 'link', type: 'link', text: link, children: [], link };
  if (isDict(image)) return plain('image', `image${typeof image.dtype === 'string' ? ` ${image.dtype}` : ''}`, `${image.width} x ${image.height} x ${image.channels}`);
  if (typeof dict.$more === 'number') return plain('none', '', `and ${dict.$more} more`);
  const array = dict.$ndarray;
  if (isDict(array)) return arrayOf(array, path);
  const summary = summaryOf(dict);
  if (summary) return summary;
  const number = numberOf(dict);
  if (number !== undefined) return plain('number', Object.keys(dict)[0]!.slice(1), written(number));
  if (typeof dict.$int64 === 'string') return plain('number', 'int64', dict.$int64);
  const keys = Object.keys(dict);
  return {
    kind: 'dict', type: `dict [${keys.length}]`, text: '',
    // A key that begins with '$' has a second one in front in the JSON form.
    children: keys.map((key) => { const name = key.replace(/^\$\$/, '$'); return { key: name, path: joinPath(path, name), value: dict[key] }; }),
  };
}

/** The number at a path such as `pose/position[2]`; NaN where there is none. */
export function numberAt(tree: unknown, path: string): number {
  const { keys, indices } = parsePath(path);
  let value = tree;
  for (const key of keys) {
    const name = key.startsWith('$') ? `$${key}` : key;
    if (Array.isArray(value)) value = value[Number(key)];
    else value = isDict(value) && Object.hasOwn(value, name) ? value[name] : undefined;
  }
  if (indices.length === 0) return numberOf(value) ?? NaN;
  const array = isDict(value) && isDict(value.$ndarray) ? value.$ndarray : undefined;
  if (!array || !Array.isArray(array.data)) return NaN;
  const shape = shapeOf(array, array.data.length);
  const element = shape.length === indices.length ? indices.reduce((at, index, axis) => at * shape[axis]! + index, 0) : -1;
  return finiteOrNot(array.data[element]) ?? NaN;
}
