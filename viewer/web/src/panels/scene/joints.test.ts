// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { baseAmong, jointsIn, namesIn } from './joints';
import { posesIn } from './poses';

const array = (data: unknown[]) => ({ $ndarray: { type: 'float32', shape: [data.length], data } });
const joints = new Set(['elbow', 'wrist']);

describe('positions of joints', () => {
  it('are named by the description', () => {
    expect(namesIn({ name: 'x', joint_names: ['elbow', 'wrist'], other: ['a', 'b', 'c'] })).toEqual(['elbow', 'wrist']);
    expect([...jointsIn({ positions: array([0.5, -1]), velocities: array([7, 8]) }, joints, ['elbow', 'wrist'])]).toEqual([['elbow', 0.5], ['wrist', -1]]);
  });
  it('are named beside them, as in ROS', () => {
    expect([...jointsIn({ name: ['wrist', 'wheel', 'elbow'], position: array([1, 2, 3]), effort: array([4, 5, 6]) }, joints, [])]).toEqual([['wrist', 1], ['elbow', 3]]);
  });
  it('are named by their keys, as in ArmarX', () => {
    expect([...jointsIn({ joints: { velocity: { elbow: 9, wrist: 9 }, position: { elbow: { $float32: 0.25 }, wrist: 1 } } }, joints, [])]).toEqual([['elbow', 0.25], ['wrist', 1]]);
  });
  it('are left out where they are none', () => {
    expect(jointsIn({ positions: array([1, 2, 3]) }, joints, ['elbow', 'wrist']).size).toBe(0);
    expect([...jointsIn({ positions: array(['nan', 2]) }, joints, ['elbow', 'wrist'])]).toEqual([['wrist', 2]]);
    expect(jointsIn({ positions: { $array: { shape: [90], dtype: 'float32' } } }, joints, ['elbow', 'wrist']).size).toBe(0);
    expect(jointsIn(null, joints, []).size).toBe(0);
  });
});

describe('the place of a robot', () => {
  it('is that of its root, or of a platform', () => {
    const pose = { position: array([1, 2, 3]), orientation: array([1, 0, 0, 0]) };
    const places = posesIn({ pose_world_base_link: pose, pose_world_torso: { ...pose, position: array([4, 5, 6]) } });
    expect(baseAmong(places, 'torso')!.position).toEqual([4, 5, 6]);
    expect(baseAmong(places, 'other')!.position).toEqual([1, 2, 3]);
    expect(baseAmong(posesIn({ pose_world_camera: pose }), 'torso')).toBeUndefined();
  });
  it('is told by x, y and heading, too', () => {
    const half = Math.PI / 4;
    for (const value of [{ pose_world_platform: array([1, 2, 2 * half]), velocity: array([0, 0, 0]) }, { x: 1, y: 2, heading: 2 * half }]) {
      const base = baseAmong(posesIn(value), 'platform')!;
      expect(base.position).toEqual([1, 2, 0]);
      expect(base.orientation[0]).toBeCloseTo(Math.cos(half));
      expect(base.orientation[3]).toBeCloseTo(Math.sin(half));
    }
  });
});
