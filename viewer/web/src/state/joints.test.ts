// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Member } from '../api/types';
import { jointsOfRobot, withJoints } from './joints';

const member = (path: string, more: Partial<Member> = {}): Member => ({ path, kind: 'number', shape: [], unit: undefined, name: undefined, min: undefined, max: undefined, ...more });
const urdf = '<robot name="r"><joint name="lift" type="prismatic"><parent link="a"/></joint><joint type=\'revolute\'\n name=\'yaw\'/><joint name="long" type="continuous"/></robot>';
const joints = jointsOfRobot({ joint_names: ['lift', 'yaw'], urdf })!;

describe('joints', () => {
  it('of a description have names, and slide or turn', () => {
    expect(joints.names).toEqual(['lift', 'yaw']);
    expect([...joints.sliding]).toEqual(['lift']);
    for (const odd of [null, { urdf }, { joint_names: ['lift'] }, { joint_names: ['lift'], urdf: 'text' }]) expect(jointsOfRobot(odd)).toBeUndefined();
  });
  it('give names and units to arrays that are as long', () => {
    const told = withJoints(['positions[0]', 'positions[1]', 'velocities[0]', 'velocities[1]', 'state/torques[0]', 'state/torques[1]'].map((path) => member(path)), joints);
    expect(told.map(({ name, unit }) => `${name} ${unit}`)).toEqual(['lift m', 'yaw rad', 'lift m/s', 'yaw rad/s', 'lift N', 'yaw N m']);
  });
  it('give units to numbers under their names', () => {
    expect(withJoints([member('position/lift'), member('velocity/yaw'), member('lift')], joints).map(({ unit }) => unit)).toEqual(['m', 'rad/s', undefined]);
  });
  it('leave alone what a type tells, what has another length, and what is no quantity of theirs', () => {
    const others = [member('positions[0]', { unit: 'deg', name: 'own' }), member('positions[1]'), member('gains[0]'), member('gains[1]'), member('short_positions[0]'), member('temperature/yaw'), member('positions', { kind: 'array' })];
    expect(withJoints(others, joints).map(({ name, unit }) => [name, unit])).toEqual([['own', 'deg'], ['yaw', 'rad'], [undefined, undefined], [undefined, undefined], [undefined, undefined], [undefined, undefined], [undefined, undefined]]);
  });
  it('of a description that is no XML slide nowhere', () => {
    expect(jointsOfRobot({ joint_names: ['a'], urdf: `<robot>${'<joint '.repeat(500_000)}` })!.sliding.size).toBe(0);
  });
});
