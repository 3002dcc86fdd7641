// SPDX-License-Identifier: Apache-2.0
// The IDF values of the imagined memory, in the JSON form of the contract, and their members.
import { urdfWith } from './robot.mjs';
import { battery, carried, joint, kJoints, kThings, platform, reach, task, thing } from './motion.mjs';

const array = (type, data) => ({ $ndarray: { type, shape: [data.length], data } });
const image = (path, channels = 3) => ({ $image: { path, width: 128, height: 128, channels, dtype: channels === 1 ? 'uint16' : 'uint8' } });
const link = (id) => ({ $link: id });
const turn = (yaw) => array('float32', [Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)]);
const pose = (x, y, z, yaw) => ({ position: array('float32', [x, y, z]), orientation: turn(yaw) });

/** A camera that looks ahead: x right, y down, z forward. */
const looking = (x, y, z, yaw) => {
  const [c, s] = [Math.cos(yaw / 2) / 2, Math.sin(yaw / 2) / 2];
  return { position: array('float32', [x, y, z]), orientation: array('float32', [c + s, -c - s, c - s, s - c]) };
};

const nearestAction = (t) => {
  const { phase } = task(t);
  return phase < 6 ? 'look' : phase < 12 ? 'pick' : phase < 19.5 ? 'navigate' : 'place';
};

/** Velocities are differences, so that predictions of them are wrong by as much as they should be. */
const velocity = (index, t) => (joint(index, t + 0.005) - joint(index, t - 0.005)) / 0.01;

export function valueOf(entity, t, idAt) {
  const base = platform(t);
  switch (entity.kind) {
    case 'camera':
    case 'hand_camera':
      return {
        image: image('image'),
        pose_world_camera: looking(base.x, base.y + 0.1, entity.kind === 'camera' ? 1.46 : 1.05, base.heading),
        calibration: link(idAt('Vision/Calibration/head/left', t)),
        joints: link(idAt('RobotState/Proprioception/robot/joints', t)),
        platform: link(idAt('RobotState/Localization/robot/platform', t)),
        exposure_ms: 8.3 + Math.sin(t / 40),
      };
    case 'depth':
      return { image: image('image', 1), of: link(idAt('Vision/RGB/head/stereo', t)) };
    case 'calibration':
      return { fx: 96.5, fy: 96.5, cx: 63.5, cy: 63.5, width: { $int32: 128 }, height: { $int32: 128 } };
    case 'joints':
      return {
        positions: array('float64', kJoints.map((_, i) => joint(i, t))),
        velocities: array('float64', kJoints.map((_, i) => velocity(i, t))),
        is_calibrated: true,
      };
    case 'battery':
      return { voltage: battery(t), current: 4.1 + 6 * reach(t), temperature: 31 + t / 300, is_charging: false };
    case 'platform':
      return { x: base.x, y: base.y, heading: base.heading, frame_id: 'world' };
    case 'description':
      return { name: 'robot', joints: kJoints, mass: 86.5, urdf: urdfWith(), cloud: { $array: { dtype: 'float32', shape: [6072, 3], summary: { min: -0.41, max: 1.72, mean: 0.58 } } } };
    case 'thing': {
      const index = kThings.indexOf(entity.id.split('/')[3]);
      const at = thing(index, t);
      return {
        pose_world_object: pose(at.x, at.y, at.z, at.yaw),
        is_visible: Math.abs(at.x - base.x) < 1.4,
        held_by: carried(t) === index ? (task(t).number % 2 === 0 ? 'hand_left' : 'hand_right') : null,
        confidence: 0.82 + 0.15 * Math.sin(t + index),
        size: array('float32', [0.08 + 0.01 * index, 0.06, 0.12 + 0.02 * (index % 4)]),
        image: link(idAt('Vision/RGB/head/stereo', t)),
        joints: link(idAt('RobotState/Proprioception/robot/joints', t)),
      };
    }
    case 'surface':
      return entity.id.endsWith('table')
        ? { pose_world_surface: pose(1.9, 1.2, 0.38, 0), size: array('float32', [1.6, 0.8, 0.76]) }
        : { pose_world_surface: pose(0, 1.3, 0.45, 0), size: array('float32', [2.4, 0.6, 0.9]) };
    case 'class':
      return { name: entity.id.split('/')[3], mass: 0.42, size: array('float32', [0.19, 0.07, 0.3]), grasps: ['side', 'top'] };
    case 'speech':
      return { text: `Bring the ${kThings[task(t).number % kThings.length].replace(/_1$/, '').replace('_', ' ')} to the table, please.`, speaker: 'human', language: 'en' };
    case 'utterance':
      return { text: task(t).phase < 10 ? 'I am on my way.' : 'Done. Anything else?', speaker: 'robot' };
    case 'plan':
      return { goal: `at(${kThings[task(t).number % kThings.length]}, table)`, steps: ['look', 'pick', 'navigate', 'place'], command: link(idAt('Speech/Commands/human/text', t)) };
    case 'action': {
      const failed = task(t).number % 7 === 3 && entity.id.endsWith('pick');
      const object = kThings[task(t).number % kThings.length];
      return {
        name: entity.id.split('/')[3],
        outcome: { $int32: failed ? 2 : task(t).phase % 2 < 1 ? 0 : 1 },
        measured: { distance: failed ? 0.07 : 0.008, duration: 3.4 },
        plan: link(idAt('Tasks/Plans/robot/plan', t)),
        object: link(idAt(`Objects/Instances/kitchen/${object}`, t)),
        image: link(idAt('Vision/RGB/head/stereo', t)),
        joints: link(idAt('RobotState/Proprioception/robot/joints', t)),
        next: nearestAction(t),
      };
    }
    default:
      return { seed: { $int64: '9007199254740993' }, size: array('int32', [128, 128]), daylight: 0.86, preset: 'plain' };
  }
}

const number = (path, unit, min, max) => ({ path, kind: 'number', shape: [], ...(unit ? { unit } : {}), ...(min !== undefined ? { min, max } : {}) });
const poseMembers = (path) => [{ path, kind: 'pose', shape: [] }, ...[0, 1, 2].map((i) => number(`${path}/position[${i}]`, 'm')), ...[0, 1, 2, 3].map((i) => number(`${path}/orientation[${i}]`, ''))];
const other = (path, kind) => ({ path, kind, shape: [] });

export function membersOf(entity) {
  switch (entity.kind) {
    case 'camera':
    case 'hand_camera':
      return [{ path: 'image', kind: 'image', shape: [128, 128, 3] }, ...poseMembers('pose_world_camera'), other('calibration', 'link'), other('joints', 'link'), other('platform', 'link'), number('exposure_ms', 'ms')];
    case 'depth': return [{ path: 'image', kind: 'depth', shape: [128, 128, 1], unit: 'mm' }, other('of', 'link')];
    case 'joints':
      return [...kJoints.map((name, i) => ({ ...number(`positions[${i}]`, 'rad', -3.15, 3.15), name })), ...kJoints.map((name, i) => ({ ...number(`velocities[${i}]`, 'rad/s'), name })), other('is_calibrated', 'bool')];
    case 'battery': return [number('voltage', 'V', 40, 56), number('current', 'A'), number('temperature', '°C'), other('is_charging', 'bool')];
    case 'platform': return [number('x', 'm'), number('y', 'm'), number('heading', 'rad'), other('frame_id', 'text')];
    case 'thing': return [...poseMembers('pose_world_object'), other('is_visible', 'bool'), other('held_by', 'text'), number('confidence', '', 0, 1), ...[0, 1, 2].map((i) => number(`size[${i}]`, 'm')), other('image', 'link'), other('joints', 'link')];
    case 'speech':
    case 'utterance': return [other('text', 'text'), other('speaker', 'text')];
    case 'plan': return [other('goal', 'text'), other('steps', 'list'), other('command', 'link')];
    case 'action': return [other('name', 'text'), number('outcome', ''), number('measured/distance', 'm'), number('measured/duration', 's'), other('plan', 'link'), other('object', 'link'), other('image', 'link'), other('joints', 'link')];
    case 'calibration': return ['fx', 'fy', 'cx', 'cy', 'width', 'height'].map((path) => number(path, 'px'));
    case 'surface': return [...poseMembers('pose_world_surface'), ...[0, 1, 2].map((i) => number(`size[${i}]`, 'm'))];
    case 'class': return [other('name', 'text'), number('mass', 'kg')];
    case 'description': return [other('name', 'text'), number('mass', 'kg'), other('urdf', 'text')];
    default: return [number('daylight', '')];
  }
}

/** The number at a path such as `pose/position[2]`, or NaN. */
export function numberAt(tree, path) {
  let value = tree;
  for (const [, key, index] of path.matchAll(/([^/[\]]+)|\[(\d+)\]/g)) {
    if (value === null || typeof value !== 'object') return NaN;
    value = key !== undefined ? value[key] : (value.$ndarray?.data ?? value)[Number(index)];
  }
  if (value !== null && typeof value === 'object') value = value.$int32 ?? value.$float32;
  return typeof value === 'number' ? value : NaN;
}

/** A number of an entity at a time; those that plots ask for by the thousand are made alone. */
export function seriesValue(entity, path, t) {
  if (entity.kind === 'platform' && path !== 'frame_id') return platform(t)[path] ?? NaN;
  const match = entity.kind === 'joints' && /^(positions|velocities)\[(\d+)\]$/.exec(path);
  if (match && Number(match[2]) < kJoints.length) return match[1] === 'positions' ? joint(Number(match[2]), t) : velocity(Number(match[2]), t);
  return numberAt(valueOf(entity, t, () => ''), path);
}

/** Continues every number of a value by how it moved until then: what a simple engine would do. */
export function continued(before, now, steps) {
  if (typeof now === 'number' && typeof before === 'number') return now + (now - before) * steps;
  if (Array.isArray(now)) return now.map((part, i) => continued(before?.[i], part, steps));
  if (now !== null && typeof now === 'object') {
    if (now.$ndarray?.data === undefined && Object.keys(now)[0]?.startsWith('$')) return now;
    return Object.fromEntries(Object.entries(now).map(([key, part]) => [key, key === 'shape' ? part : continued(before?.[key], part, steps)]));
  }
  return now;
}
