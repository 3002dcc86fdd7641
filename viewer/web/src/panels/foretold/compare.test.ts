// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { moment } from '../../api/types';
import { compare, numberPaths, summaryOf } from './compare';

const of = (data: unknown, more: object = {}) => moment({ id: 'A/B/C/D/5', time: '5', source: 'recorded', instances: [{ index: 0, data }], ...more }, '');
const array = (...data: number[]) => ({ $ndarray: { type: 'float64', shape: [data.length], data } });

const predicted = of({ positions: array(1, 2), x: 0.5, name: 'a', flag: true, gone: 3 }, {
  source: 'predicted', bound: 0.1, members: [{ path: 'positions', bound: 0.05 }, { path: 'positions[1]', bound: 0.4 }],
});
const real = of({ positions: array(1.2, 2.3), x: 0.45, name: 'b', flag: false, count: { $int64: '7' } });

describe('what was predicted', () => {
  it('is compared by number, those that are farthest outside first', () => {
    const rows = compare(predicted, real);
    expect(rows.map((row) => [row.path, row.isWithin])).toEqual([['positions[0]', false], ['positions[1]', true], ['x', true]]);
    expect(rows[0]).toMatchObject({ predicted: 1, real: 1.2, bound: 0.05 });
    expect(rows[0]!.error).toBeCloseTo(0.2);
    expect(summaryOf(rows)).toBe('2 of 3 numbers within the bound (90 %).');
  });

  it('without bounds or numbers is said so', () => {
    expect(summaryOf(compare({ ...predicted, bound: undefined, members: [] }, real))).toBe('3 numbers, for which no bound was given.');
    expect(summaryOf(compare(of({ name: 'a' }), of({ name: 'b' })))).toBe('There is no number to compare.');
    expect(compare(predicted, { ...real, instances: [{ ...real.instances[0]!, index: 4 }] })).toEqual([]);
  });

  it('of numbers that are not finite is left out', () => {
    expect(compare(of({ x: { $float64: 'nan' }, y: 1 }), of({ x: 1, y: { $float64: 'inf' } }))).toEqual([]);
  });

  it('has the paths that plots have', () => {
    expect(numberPaths({ a: { b: array(1, 2) }, c: [1, { d: 2 }], e: 'x' })).toEqual(['a/b[0]', 'a/b[1]', 'c/0', 'c/1/d']);
    expect(numberPaths(21.5)).toEqual(['']);
  });
});
