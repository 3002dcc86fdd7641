// SPDX-License-Identifier: Apache-2.0
// What was predicted beside what came: numbers, and whether the bound held.
import type { Moment } from '../../api/types';
import { arrayPath } from '../../state/paths';
import { describe, numberAt } from '../values';

/** The bound of a number: its own, or that of its array, or that of the whole moment; NaN where none was given. */
export const boundOf = (moment: Moment, path: string): number =>
  (moment.members.find((member) => member.path === path) ?? moment.members.find((member) => member.path === arrayPath(path)) ?? moment).bound ?? NaN;

export interface Compared {
  readonly path: string;
  readonly instance: number;
  readonly predicted: number;
  readonly real: number;
  readonly error: number;
  /** NaN: there was none. */
  readonly bound: number;
  readonly isWithin: boolean;
}

const kMaxDepth = 12;

/** Paths of all numbers of a value, those of short arrays included. */
export function numberPaths(value: unknown, path = '', depth = 0): string[] {
  const { kind, children } = describe(value, path);
  if (children.length > 0) return depth >= kMaxDepth ? [] : children.flatMap((part) => numberPaths(part.value, part.path, depth + 1));
  return kind === 'number' ? [path] : [];
}

/** How far an error is outside of its bound; errors without a bound come last. */
const excess = (row: Compared): number => (Number.isNaN(row.bound) ? -1 : row.bound === 0 ? (row.error > 0 ? Infinity : 0) : row.error / row.bound);

/** Numbers that are in both, the worst first. */
export function compare(predicted: Moment, real: Moment): Compared[] {
  const rows = real.instances.flatMap((instance) => {
    const before = predicted.instances.find((one) => one.index === instance.index);
    if (!before) return [];
    return numberPaths(instance.data).flatMap((path): Compared[] => {
      const [told, came] = [numberAt(before.data, path), numberAt(instance.data, path)];
      if (!Number.isFinite(told) || !Number.isFinite(came)) return [];
      const error = Math.abs(told - came);
      const bound = boundOf(predicted, path);
      return [{ path, instance: instance.index, predicted: told, real: came, error, bound, isWithin: error <= bound }];
    });
  });
  return rows.sort((a, b) => { const [x, y] = [excess(a), excess(b)]; return x === y ? b.error - a.error : y > x ? 1 : -1; });
}

export function summaryOf(rows: readonly Compared[]): string {
  const bounded = rows.filter((row) => !Number.isNaN(row.bound));
  if (rows.length === 0) return 'There is no number to compare.';
  if (bounded.length === 0) return `${rows.length} numbers, for which no bound was given.`;
  return `${bounded.filter((row) => row.isWithin).length} of ${bounded.length} numbers within the bound (90 %).`;
}
