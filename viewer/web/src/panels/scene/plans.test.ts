// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { colourOfCost, coloursOfCosts, costMapIn } from './costMap';
import { stretchesOf } from './floor';
import { composed, driveEventIn, endOf, headingOf, isPathMissing, placeIn, planIn } from './plans';
import { rolesOf } from './sources';

const array = (shape: number[], data: number[]) => ({ $ndarray: { type: 'float64', shape, data } });
const plan = (state: number, path: number[][]) => ({ state: { $int32: state }, goal: 'table', reason: '', robot: 'robot', length: 2, pose_world_start: array([3], [0, 0, 0]), pose_world_goal: array([3], [2, 1, 3]), path: array([path.length, 3], path.flat()) });
const kPlan = 'Navigation/Plan/robot/drive/100';
const kEvent = 'Navigation/Event/robot/drive';

describe('a plan', () => {
  it('has its path; a refused one leads straight from start to goal', () => {
    expect(planIn(kPlan, plan(0, [[0, 0, 0], [1, 0, 0], [2, 1, 3]]))!.path).toHaveLength(3);
    expect(planIn(kPlan, plan(1, []))).toMatchObject({ isRefused: true, path: [[0, 0, 0], [2, 1, 3]] });
    expect(planIn(kPlan, plan(0, []))!.path).toEqual([]);
    expect(planIn(kPlan, plan(0, [[0, 0, 0], [NaN, 0, 0], [2, 1, 3]]))!.path).toHaveLength(2);
    expect(isPathMissing({ path: { $array: { shape: [99, 3] } } })).toBe(true);
    for (const odd of [null, 'x', {}, plan(2, [])]) expect(planIn(kPlan, odd)).toBeUndefined();
  });
  it('holds until its drive ends', () => {
    const [holding, refused] = [planIn(kPlan, plan(0, []))!, planIn(kPlan, plan(1, []))!];
    const at = (time: number, kind: number) => driveEventIn(`${kEvent}/${time}`, { kind: { $int32: kind }, reason: 'r' });
    expect(endOf(holding, undefined)).toBeUndefined();
    for (const kind of [0, 1, 2]) expect(endOf(holding, at(150, kind))).toBeUndefined();
    for (const kind of [3, 5, 6, 7]) expect(endOf(holding, at(150, kind))!.time).toBe(150n);
    // The drive before this one ended before.
    expect(endOf(holding, at(90, 3))).toBeUndefined();
    expect(endOf(refused, at(150, 7))).toBeUndefined();
  });
  it('is drawn as one way, or in dashes that go on behind a corner', () => {
    const path = [[0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 1, 0]] as const;
    expect(stretchesOf(path, false)).toHaveLength(2);
    const dashes = stretchesOf(path, true);
    const length = dashes.reduce((sum, [a, b]) => sum + Math.hypot(b[0] - a[0], b[1] - a[1]), 0);
    expect(length).toBeGreaterThan(1);
    expect(length).toBeLessThan(1.3);
    expect(dashes.every(([a, b]) => a[0] === b[0] || a[1] === b[1])).toBe(true);
    expect(stretchesOf([[0, 0, 0]], true)).toEqual([]);
    expect(stretchesOf([[0, 0, 0], [1e9, 0, 0]], true).length).toBeLessThanOrEqual(5_000);
  });
});

describe('a place', () => {
  it('has a pose in the world, or moves with an object', () => {
    expect(placeIn({ name: 'Ada', object: '', pose_world_location: array([3], [1, 2, 3]), pose_object_location: null })).toEqual({ name: 'Ada', object: '', pose: [1, 2, 3] });
    expect(placeIn({ name: 'Shelf', object: { $link: 'Objects/Surfaces/kitchen/table' }, pose_object_location: array([3], [1, 0, 0]) })).toMatchObject({ object: 'Objects/Surfaces/kitchen/table', poseInObject: [1, 0, 0] });
    expect(placeIn({ name: 'Nowhere', object: '', pose_object_location: array([3], [1, 0, 0]) })).toBeUndefined();
  });
  it('beside an object turns with it', () => {
    const [x, y, heading] = composed([1, 1, Math.PI / 2], [2, 0, 0.5]);
    expect([x, y, heading].map((one) => Math.round(one * 1e6) / 1e6)).toEqual([1, 3, 2.070796]);
    expect(headingOf([Math.cos(0.4), 0, 0, Math.sin(0.4)])).toBeCloseTo(0.8, 9);
  });
});

describe('a cost map', () => {
  const map = (more: object = {}) => ({ resolution: 0.05, pose_world_map: array([3], [-1, -2, 0.5]), costs: { $ndarray: { type: 'uint8', shape: [2, 3], data: [0, 1, 252, 253, 254, 255] } }, left_out: [{ reason: 'no class' }, 5], ...more });
  it('tells its cells, its corner and what it left out', () => {
    expect(costMapIn(map())).toMatchObject({ rows: 2, columns: 3, resolution: 0.05, corner: [-1, -2, 0.5], leftOut: ['no class'] });
  });
  it('that cannot be drawn says why', () => {
    expect(costMapIn(null)).toMatch(/no costs/);
    expect(costMapIn(map({ costs: { $array: { shape: [2, 3] } } }))).toMatch(/no costs/);
    expect(costMapIn(map({ resolution: 0 }))).toMatch(/how large/);
    expect(costMapIn(map({ costs: { $ndarray: { type: 'uint8', shape: [0, 0], data: [] } } }))).toMatch(/no cells/);
    expect(costMapIn(map({ costs: { $ndarray: { type: 'uint8', shape: [1, 4097], data: new Array(4097).fill(0) } } }))).toMatch(/at most 4096/);
  });
  it('has the colours of RViz', () => {
    expect(colourOfCost(0)[3]).toBe(0);
    expect([1, 252, 253, 254, 255].map((cost) => colourOfCost(cost).slice(0, 3))).toEqual([[0, 0, 255], [255, 0, 0], [0, 255, 255], [255, 0, 255], [112, 137, 134]]);
    expect([...coloursOfCosts([254, 0])].slice(0, 4)).toEqual([...colourOfCost(254)]);
  });
});

describe('entities of navigation', () => {
  it('are drawn as what they mean, and not as things or points', () => {
    expect(['CostMap/k/floor', 'Plan/r/drive', 'Event/r/drive', 'Location/p/ada'].map((id) => rolesOf({ id: `Navigation/${id}`, kinds: undefined }))).toEqual([['floor'], ['plan'], ['drive'], ['location']]);
    expect(rolesOf({ id: 'Other/Plan/r/drive', kinds: ['pose'] })).toEqual(['place']);
  });
});
