// SPDX-License-Identifier: Apache-2.0
// Where a robot stands and how its joints are, as values of any memory may tell it.
import { numberAt } from '../values';
import type { Placed } from './poses';

type Dict = Record<string, unknown>;
const isDict = (value: unknown): value is Dict => typeof value === 'object' && value !== null && !Array.isArray(value);
const kMaxDepth = 6;

const kPositions = /^(q|(joint_?)?(positions?|angles?|values?))$/i;
const kNames = /^(names?|joints|joint_?names?)$/i;
/** Numbers by name that are no positions. */
const kOther = /vel|torque|effort|current|accel|temp|lower|upper|limit|goal|target/i;

const isTexts = (value: unknown): value is string[] => Array.isArray(value) && value.length > 0 && value.every((part) => typeof part === 'string');

/** The names of joints that a value lists: the longest list of names in it. */
export function namesIn(value: unknown): readonly string[] {
  let best: readonly string[] = [];
  const visit = (part: unknown, depth: number): void => {
    if (!isDict(part) || depth > kMaxDepth) return;
    for (const [key, child] of Object.entries(part)) {
      if (kNames.test(key) && isTexts(child) && child.length > best.length) best = child;
      visit(child, depth + 1);
    }
  };
  visit(value, 0);
  return best;
}

/** The numbers of an array or of a list; none where they were too many to send. */
function numbersOf(value: unknown): readonly number[] {
  if (Array.isArray(value)) return value.map((part) => numberAt(part, ''));
  const array = isDict(value) ? value.$ndarray : undefined;
  if (!isDict(array) || !Array.isArray(array.data)) return [];
  return array.data.map((_, i) => numberAt({ $ndarray: { ...array, shape: [(array.data as unknown[]).length] } }, `[${i}]`));
}

/**
 * The positions of joints in a value: numbers under the names of joints (`position/elbow`), or an
 * array beside a list of names, or an array as long as `names`, which another value lists.
 */
export function jointsIn(value: unknown, joints: ReadonlySet<string>, names: readonly string[]): Map<string, number> {
  let best = new Map<string, number>();
  const take = (found: readonly (readonly [string, number])[]): void => {
    const fitting = found.filter(([name, position]) => joints.has(name) && Number.isFinite(position));
    if (fitting.length > best.size) best = new Map(fitting);
  };
  const visit = (part: unknown, depth: number): void => {
    if (!isDict(part) || depth > kMaxDepth) return;
    const keys = Object.keys(part).filter((key) => !kOther.test(key));
    take(keys.map((key) => [key, numberAt(part[key], '')] as const));
    const listed = namesIn(Object.fromEntries(Object.entries(part).filter(([, child]) => isTexts(child))));
    for (const key of keys) {
      if (kPositions.test(key)) {
        const positions = numbersOf(part[key]);
        for (const known of [listed, names]) if (known.length === positions.length) take(known.map((name, i) => [name, positions[i]!] as const));
      }
      visit(part[key], depth + 1);
    }
  };
  visit(value, 0);
  return best;
}

const frameOf = (placed: Placed): string | undefined => /(?:^|\/)pose_[^_/]+_([^/]+)$/.exec(placed.path)?.[1];

/** The pose of a robot's root among those that values tell: that of its root link, or of a platform. */
export function baseAmong(places: readonly Placed[], root: string): Placed | undefined {
  return places.find((placed) => frameOf(placed) === root)
    ?? places.find((placed) => /^(platform|base|robot|root)(_link)?$/.test(frameOf(placed) ?? ''))
    ?? places.find((placed) => placed.path === '' && !placed.isCamera);
}
