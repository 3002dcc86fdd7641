// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { parseId, queryNames, shortName, splitLevels } from './ids';
import { arrayPath, joinPath, parsePath, pythonIndex } from './paths';

describe('IDs', () => {
  it('split at slashes that are not escaped', () => {
    expect(splitLevels('Scene/Objects/tracker/cup\\/left')).toEqual(['Scene', 'Objects', 'tracker', 'cup\\/left']);
    expect(splitLevels('')).toEqual([]);
    expect(shortName('Scene/Objects/tracker/cup\\/left')).toBe('cup/left');
  });
  it('tell time and instance in either form of the time', () => {
    expect(parseId('A/B/C/D/1645189616492182001/1')).toEqual({ entity: 'A/B/C/D', time: 1645189616492182001n, instance: 1 });
    expect(parseId('A/B/C/D/2022-02-18 13:06:56.492182').time).toBe(1645189616492182000n);
    expect(parseId('A/B').time).toBeUndefined();
    expect(parseId('A/B/C/D/soon').time).toBeUndefined();
  });
  it('become names of a query', () => {
    expect(queryNames('A/B/cam.1/x (2)')).toBe('A/B/cam\\.1/x \\(2\\)');
    expect(queryNames(' A/B;C/D @ latest/\\/x ')).toBe('\\ A/B\\;C/D \\@ latest/\\/x\\ ');
  });
});

describe('paths', () => {
  it('split into keys and an element', () => {
    expect(parsePath('pose/position[2]')).toEqual({ keys: ['pose', 'position'], indices: [2] });
    expect(parsePath('m[1,20]')).toEqual({ keys: ['m'], indices: [1, 20] });
    expect(parsePath('a\\/b/\\e/c\\\\')).toEqual({ keys: ['a/b', '', 'c\\'], indices: [] });
    expect(parsePath('[3]')).toEqual({ keys: [], indices: [3] });
  });
  it('join what they split', () => {
    for (const keys of [['a/b', '', 'c\\'], ['x.y'], ['\\e']]) expect(parsePath(keys.reduce(joinPath, '')).keys).toEqual(keys);
  });
  it('lead to the array of an element, and are Python', () => {
    expect(arrayPath('positions[3]')).toBe('positions');
    expect(pythonIndex('pose/history/0/m[1,2]')).toBe('["pose"]["history"][0]["m"][1, 2]');
  });
});
