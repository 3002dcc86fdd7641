// SPDX-License-Identifier: Apache-2.0
// IDF trees in the JSON form of the contract: what a value is, how it is written, where a path leads.
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

/** The payload of a dict such as {"$ndarray": ...}; both spellings of the contract are read. */
function tagged(value: unknown, name: string): unknown {
  if (!isDict(value)) return undefined;
  const keys = Object.keys(value);
  return keys.length === 1 && (keys[0] === `$${name}` || keys[0] === name) ? value[keys[0]] : undefined;
}

const shapeText = (shape: unknown): string => (Array.isArray(shape) ? `[${shape.map(String).join(' x ')}]` : '[?]');
const plain = (kind: Kind, type: string, text: string): Value => ({ kind, type, text, children: [] });
const shorten = (text: string): string => (text.length > 400 ? `${text.slice(0, 400)}...` : text);

function numberOf(value: unknown): number | undefined {
  if (typeof value === 'number') return value;
  for (const name of ['int32', 'float32', 'float64']) {
    const found = isDict(value) ? value[`$${name}`] : undefined;
    if (typeof found === 'number') return found;
    if (found === 'nan') return NaN;
  }
  return undefined;
}

function arrayOf(value: Dict, path: string): Value {
  const type = `${typeof value.type === 'string' ? value.type : value.dtype ?? 'ndarray'} ${shapeText(value.shape)}`;
  const data = Array.isArray(value.data) ? value.data : null;
  if (!data) return plain('summary', type, 'values are not sent');
  const text = data.slice(0, 6).map((part) => (typeof part === 'number' ? formatNumber(part) : String(part))).join(', ');
  return { kind: 'array', type, text: data.length > 6 ? `${text}, ...` : text, children: data.map((part, i) => ({ key: `[${i}]`, path: `${path}[${i}]`, value: part })) };
}

/** `{shape, dtype, summary}` of the contract, or the same below `$summary`. */
function summaryOf(value: Dict): Value | undefined {
  const inner = isDict(value.$summary) ? value.$summary : isDict(value.summary) && 'shape' in value ? { ...value, ...value.summary } : undefined;
  if (!inner) return undefined;
  const told = ['min', 'max', 'mean'].filter((name) => typeof inner[name] === 'number').map((name) => `${name} ${formatNumber(inner[name] as number)}`);
  return plain('summary', `${typeof inner.dtype === 'string' ? inner.dtype : 'ndarray'} ${shapeText(inner.shape)}`, told.join(', '));
}

export function describe(value: unknown, path: string): Value {
  if (value === null || value === undefined) return plain('none', 'none', 'absent');
  if (typeof value === 'boolean') return plain('bool', 'bool', String(value));
  if (typeof value === 'number') return plain('number', 'float64', formatNumber(value));
  if (typeof value === 'string') return plain('text', 'string', shorten(value));
  if (Array.isArray(value)) return { kind: 'list', type: `list [${value.length}]`, text: '', children: value.map((part, i) => ({ key: `[${i}]`, path: `${path}[${i}]`, value: part })) };
  const dict = value as Dict;
  const link = tagged(dict, 'link');
  if (typeof link === 'string') return { kind: 'link', type: 'link', text: link, children: [], link };
  const image = tagged(dict, 'image');
  if (isDict(image) && 'width' in image) return plain('image', 'image', `${image.width} x ${image.height} x ${image.channels}`);
  const array = dict.$ndarray;
  if (isDict(array)) return arrayOf(array, path);
  const summary = summaryOf(dict);
  if (summary) return summary;
  const number = numberOf(dict);
  if (number !== undefined) return plain('number', Object.keys(dict)[0]!.slice(1), formatNumber(number));
  if (typeof dict.$int64 === 'string') return plain('number', 'int64', dict.$int64);
  const keys = Object.keys(dict);
  return {
    kind: 'dict', type: `dict [${keys.length}]`, text: '',
    // A key that begins with '$' has a second one in front in the JSON form.
    children: keys.map((key) => { const name = key.replace(/^\$\$/, '$'); return { key: name, path: path ? `${path}.${name}` : name, value: dict[key] }; }),
  };
}

/** The number at a path such as `pose.position[2]`; NaN where there is none. */
export function numberAt(tree: unknown, path: string): number {
  let value = tree;
  for (const [, key, index] of path.matchAll(/([^.[\]]+)|\[(\d+)\]/g)) {
    if (key !== undefined) value = isDict(value) && Object.hasOwn(value, key) ? value[key] : undefined;
    else {
      const list = isDict(value) && isDict(value.$ndarray) ? value.$ndarray.data : value;
      value = Array.isArray(list) ? list[Number(index)] : undefined;
    }
  }
  return numberOf(value) ?? NaN;
}
