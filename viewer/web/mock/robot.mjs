// SPDX-License-Identifier: Apache-2.0
// The imagined robot as a URDF: a cylinder on wheels, a torso that rises, a head, and two arms.
import { kJoints } from './motion.mjs';

const origin = (xyz, rpy = '0 0 0') => `<origin xyz="${xyz}" rpy="${rpy}"/>`;
const shape = (name, material, geometry, xyz = '0 0 0') => `<link name="${name}"><visual>${origin(xyz)}<geometry>${geometry}</geometry><material name="${material}"/></visual></link>`;
const joint = (name, type, parent, child, xyz, axis) => `<joint name="${name}" type="${type}">${origin(xyz)}<parent link="${parent}"/><child link="${child}"/><axis xyz="${axis}"/><limit lower="-3.2" upper="3.2" effort="0" velocity="0"/></joint>`;

function arm(side, left) {
  const parts = [];
  let parent = 'torso';
  ['clavicle', 'shoulder_1', 'shoulder_2', 'shoulder_3', 'elbow', 'forearm', 'wrist_1', 'wrist_2'].forEach((name, i) => {
    const child = i === 7 ? `hand_${side}` : `${side}_${name}`;
    parts.push(joint(`arm_${side}_${name}`, 'revolute', parent, child, i === 0 ? `0 ${0.2 * left} 0.35` : `0 0 ${-0.08}`, ['0 0 1', '0 1 0', '1 0 0'][i % 3]),
      shape(child, i === 7 ? 'accent' : 'shell', i === 7 ? '<box size="0.04 0.09 0.14"/>' : '<cylinder radius="0.045" length="0.08"/>', '0 0 -0.04'));
    parent = child;
  });
  for (const [i, name] of ['thumb', 'index', 'middle', 'ring', 'little'].entries())
    for (const bone of [1, 2])
      parts.push(joint(`hand_${side}_${name}_${bone}`, 'revolute', bone === 1 ? `hand_${side}` : `${side}_${name}_1`, `${side}_${name}_${bone}`, bone === 1 ? `0 ${0.02 * (i - 2)} -0.11` : '0 0 -0.035', '0 1 0'),
        shape(`${side}_${name}_${bone}`, 'shell', '<cylinder radius="0.009" length="0.035"/>', '0 0 -0.018'));
  return parts;
}

/** `extra` stands before the end, for tests of what may be in a URDF. */
export const urdfWith = (extra = '') => [
  '<?xml version="1.0"?><robot name="imagined">',
  '<material name="shell"><color rgba="0.85 0.86 0.88 1"/></material><material name="accent"><color rgba="0.1 0.5 0.46 1"/></material>',
  shape('platform', 'shell', '<cylinder radius="0.27" length="0.25"/>', '0 0 0.15'),
  joint('torso_lift', 'prismatic', 'platform', 'torso', '0 0 0.85', '0 0 1'), shape('torso', 'shell', '<box size="0.2 0.3 0.5"/>', '0 0 0.15'),
  joint('neck_yaw', 'revolute', 'torso', 'neck', '0 0 0.5', '0 0 1'), shape('neck', 'accent', '<cylinder radius="0.05" length="0.1"/>'),
  joint('neck_pitch', 'revolute', 'neck', 'skull', '0 0 0.07', '0 1 0'), '<link name="skull"/>',
  joint('neck_roll', 'revolute', 'skull', 'head', '0 0 0', '1 0 0'), shape('head', 'shell', '<sphere radius="0.11"/>', '0 0 0.08'),
  ...arm('left', 1), ...arm('right', -1),
  ...kJoints.filter((name) => name.startsWith('wheel')).flatMap((name, i) => [joint(name, 'continuous', 'platform', name, `${0.2 * Math.cos(2.1 * i)} ${0.2 * Math.sin(2.1 * i)} 0.05`, '0 1 0'), shape(name, 'accent', '<sphere radius="0.05"/>')]),
  extra, '</robot>',
].join('\n');
