// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { checkNumbers, checkTree, isUrdf, kMaxLinks, kMaxLinksInRow, urdfIn, type UrdfJoint } from './urdf';

const joint = (parent: string, child: string, follows?: string): UrdfJoint => ({ name: `${parent}-${child}`, parent, child, ...(follows ? { follows } : {}) });
const row = (count: number) => Array.from({ length: count }, (_, i) => `l${i}`);
const rowJoints = (links: readonly string[]) => links.slice(1).map((link, i) => joint(links[i]!, link));

describe('a URDF', () => {
  it('is told by its root element', () => {
    expect(isUrdf('<robot name="a"/>')).toBe(true);
    expect(isUrdf('<?xml version="1.0"?>\n<!-- <mujoco> -->\n<!DOCTYPE robot>\n<robot>')).toBe(true);
    for (const text of ['', 'robot', '<robots/>', '<mujoco><robot/></mujoco>', '<!-- <robot>', '<?xml', ' '.repeat(1e6)]) expect(isUrdf(text)).toBe(false);
  });
  it('is found wherever it lies in a value', () => {
    expect(urdfIn({ name: 'a', parts: [{ urdf: '<robot name="b"/>' }] })).toBe('<robot name="b"/>');
    expect(urdfIn({ name: 'a', $ndarray: { data: [1] } })).toBeUndefined();
    expect(urdfIn(null)).toBeUndefined();
  });
  it('is one tree', () => {
    expect(checkTree(['c', 'a', 'b'], [joint('b', 'c'), joint('a', 'b')])).toBe('a');
    expect(checkTree(['a'], [])).toBe('a');
    expect(checkTree(row(kMaxLinksInRow), rowJoints(row(kMaxLinksInRow)))).toBe('l0');
  });
  it('is refused where it is none', () => {
    const refused = (links: readonly string[], joints: readonly UrdfJoint[], why: RegExp) => expect(() => checkTree(links, joints)).toThrow(why);
    refused([], [], /no links/);
    refused(['a', 'b'], [joint('a', 'b'), joint('b', 'a')], /circle/);
    refused(['r', 'a', 'b'], [joint('a', 'b'), joint('b', 'a')], /circle/);
    refused(['a', 'b', 'c'], [joint('a', 'c'), joint('b', 'c')], /two joints/);
    refused(['a', 'b'], [], /2 pieces/);
    refused(['a'], [joint('a', 'x')], /'x' that is not there/);
    refused(['a', 'a'], [], /two links named 'a'/);
    refused(['__proto__'], [], /no name/);
    refused(['a"]'], [], /no name/);
    refused([''], [], /has no name/);
    refused(row(kMaxLinksInRow + 1), rowJoints(row(kMaxLinksInRow + 1)), /in a row/);
    refused(row(kMaxLinks + 1), [], /at most 1000/);
  });
  it('has no joints that follow each other', () => {
    const links = ['a', 'b', 'c'];
    expect(checkTree(links, [joint('a', 'b'), joint('b', 'c', 'a-b')])).toBe('a');
    expect(() => checkTree(links, [joint('a', 'b', 'b-c'), joint('b', 'c', 'a-b')])).toThrow(/follows another/);
    expect(() => checkTree(links, [joint('a', 'b'), joint('b', 'c', 'b-c')])).toThrow(/follows another/);
    expect(() => checkTree(links, [joint('a', 'b'), joint('b', 'c', 'x')])).toThrow(/not there/);
  });
  it('has finite numbers', () => {
    checkNumbers(' 1 -2.5\n3e-3 ', 3, 'xyz');
    for (const bad of ['nan', '1 2', '1 2 nan', '1 2 Infinity', '1 2 1e30', '1 2 x', '', '1 2 3 4']) expect(() => checkNumbers(bad, 3, "xyz of joint 'a'")).toThrow(/xyz of joint 'a'; 3 numbers/);
  });
});
