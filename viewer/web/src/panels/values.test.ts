// SPDX-License-Identifier: Apache-2.0
import { describe as suite, expect, it } from 'vitest';
import { posesIn } from './scene/poses';
import { describe, numberAt } from './values';

const tree = {
  pose: { position: { $ndarray: { type: 'float32', shape: [3], data: [1, 2, 3] } }, orientation: { $ndarray: { type: 'float32', shape: [4], data: [1, 0, 0, 0] } } },
  m: { $ndarray: { type: 'float64', shape: [2, 3], data: [0, 1, 2, 3, 4, 5] } },
  n: { $int32: 7 }, big: { $int64: '9007199254740993' }, nan: { $float64: 'nan' }, list: [5, { x: 6 }], 'a/b': 8, $$odd: 9,
  camera: { $link: 'A/B/C/D/5' }, image: { $image: { path: 'image', width: 4, height: 3, channels: 3, dtype: 'uint8' } },
  cloud: { $array: { shape: [100, 3], dtype: 'float32', summary: { min: -1, max: 2, mean: null } } },
};
const kindOf = (value: unknown) => describe(value, '').kind;

suite('values', () => {
  it('are told apart by their markers', () => {
    expect([tree.m, tree.n, tree.big, tree.list, tree.camera, tree.image, tree.cloud, null, true, 'x', {}].map(kindOf)).toEqual(
      ['array', 'number', 'number', 'list', 'link', 'image', 'summary', 'none', 'bool', 'text', 'dict']);
    expect(describe(tree.big, '').text).toBe('9007199254740993');
    expect(describe(tree.cloud, '').text).toBe('min -1, max 2');
  });
  it('have paths as Engram writes them', () => {
    const keys = describe(tree, '').children;
    expect(keys.find((child) => child.key === 'a/b')!.path).toBe('a\\/b');
    expect(keys.find((child) => child.key === '$odd')!.path).toBe('$odd');
    expect(describe(tree.m, 'm').children[4]!.path).toBe('m[1,1]');
    expect(describe(tree.list, 'list').children[1]!.path).toBe('list/1');
  });
  it('are found by these paths', () => {
    expect(['pose/position[2]', 'm[1,1]', 'n', 'list/0', 'list/1/x', 'a\\/b', '$odd'].map((path) => numberAt(tree, path))).toEqual([3, 4, 7, 5, 6, 8, 9]);
    for (const path of ['', 'nothing', 'm', 'm[9,9]', 'm[0]', 'pose/position[7]', 'constructor', 'list/9', 'nan']) expect(numberAt(tree, path)).toBeNaN();
  });
  it('that are no finite numbers are numbers all the same', () => {
    for (const [value, text] of [['inf', 'Infinity'], ['-inf', '-Infinity'], ['nan', 'NaN'], ['nan:7fc00001', 'NaN']] as const) {
      expect(describe({ $float64: value }, '')).toMatchObject({ kind: 'number', text, type: 'float64' });
      expect(describe(describe({ $ndarray: { type: 'float32', shape: [1], data: [value] } }, 'a').children[0]!.value, 'a[0]')).toMatchObject({ kind: 'number', text });
    }
    expect(numberAt({ x: { $ndarray: { type: 'float32', shape: [2], data: [1, '-inf'] } } }, 'x[1]')).toBe(-Infinity);
  });
  it('keep all digits of integers', () => {
    for (const value of [1_234_567, 2_147_483_647, 9_007_199_254_740_991]) expect(describe(value, '').text).toBe(String(value));
    expect(describe({ $int32: -12_345_678 }, '').text).toBe('-12345678');
  });
  it('that are hostile give words and no crash', () => {
    for (const value of [{ $ndarray: 5 }, { $ndarray: { data: 'x' } }, { $ndarray: { data: [{}], shape: 'x' } }, { $image: null }, { $link: 3 }, { $array: null }, { $more: 'x' }, undefined]) expect(() => describe(value, 'p')).not.toThrow();
    expect(describe('x'.repeat(1e6), '').text.length).toBeLessThan(500);
  });
});

suite('poses', () => {
  it('are found wherever they lie', () => {
    expect(posesIn({ ...tree, pose_world_camera: tree.pose, size: { $ndarray: { type: 'float32', shape: [3], data: [1, 1, 2] } } })).toMatchObject([
      { path: 'pose', position: [1, 2, 3], size: [1, 1, 2], isCamera: false }, { path: 'pose_world_camera', isCamera: true },
    ]);
    expect(posesIn({ x: 1, y: 2, heading: 0 })).toMatchObject([{ position: [1, 2, 0] }]);
    expect(posesIn({ pose: { position: tree.pose.position } })).toEqual([]);
  });
});
