// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { decodeDensity, decodeSeries } from './binary';
import * as d from './decode';
import { info, moment, treeLevel } from './types';

describe('decoding', () => {
  const shape = d.object({ name: d.string, at: d.time, unit: d.optional(d.string), list: d.withDefault(d.list(d.number), []) });
  it('takes what it needs and ignores the rest', () => {
    expect(shape({ name: 'a', at: '5', more: 1 }, '')).toEqual({ name: 'a', at: 5n, unit: undefined, list: [] });
  });
  it('names what is missing or of another kind', () => {
    expect(() => shape({ at: '5' }, '')).toThrow("undefined at 'name', a text was needed");
    expect(() => shape({ name: 'a', at: 5 }, '')).toThrow("number at 'at'");
    expect(() => shape({ name: 'a', at: '5', list: [1, 'x'] }, '')).toThrow("'list[1]'");
    expect(() => shape(null, '')).toThrow('null');
    expect(() => shape([], '')).toThrow('a list');
  });
  it('refuses times beyond 64 bits', () => {
    expect(() => d.time('9223372036854775808', 't')).toThrow('64 bits');
    expect(d.time('-9223372036854775808', 't')).toBe(-(2n ** 63n));
    expect(() => d.time('1e9', 't')).toThrow();
  });
  it('does not take members from the prototype', () => {
    const hostile = d.object({ constructor: d.optional(d.anything), toString: d.optional(d.anything) });
    expect(hostile({}, '')).toEqual({ constructor: undefined, toString: undefined });
  });
  it('reads a moment of an older gateway and a tree with levels in it', () => {
    const read = moment({ id: 'A/B/C/D/5', time: '5', source: 'recorded', instances: [{ index: 0, data: { x: 1 } }], previous: null, next: null }, '');
    expect(read.previous).toBeUndefined();
    expect(read.members).toEqual([]);
    const tree = treeLevel({ children: [{ name: 'A', id: 'A', level: 'memory', first: null, children: [{ name: 'B', id: 'A/B', level: 'core' }] }] }, '');
    expect(tree.children[0]!.children![0]!.id).toBe('A/B');
    expect(() => treeLevel({ children: [{ name: 'A', id: 'A', level: 'planet' }] }, '')).toThrow('one of memory');
  });
  it('opens a memory without snapshots', () => {
    expect(info({ name: 'x', version: '1', stores: [], first: null, last: null, entities: 0, snapshots: 0 }, '').first).toBe(0n);
  });
});

describe('binary answers', () => {
  it('become counts of each lane, without copies', () => {
    const buffer = Uint32Array.from({ length: 12 }, (_, i) => i).buffer;
    const lanes = decodeDensity(buffer, 2, 2);
    expect([...lanes[1]!.latent]).toEqual([8, 9]);
    expect(lanes[1]!.latent.buffer).toBe(buffer);
  });
  it('become min, max and last of each path', () => {
    const [a, b] = decodeSeries(Float32Array.of(1, NaN, 3, NaN, 2, NaN, 4, 5, 6, 7, 8, 9).buffer, 2, 2);
    expect([a!.min[0], a!.max[0], a!.last[0]]).toEqual([1, 3, 2]);
    expect(b!.last[1]).toBe(9);
  });
  it('are refused where bytes are missing or too many', () => {
    expect(() => decodeDensity(new ArrayBuffer(8), 1, 2)).toThrow('8 bytes came, 24 were needed');
    expect(() => decodeSeries(new ArrayBuffer(25), 1, 2)).toThrow('25 bytes');
  });
});
