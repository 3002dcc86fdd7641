// SPDX-License-Identifier: Apache-2.0
// How the imagined kitchen robot moves. Everything is a pure function of the time in seconds, so
// that any moment can be asked for and two runs of the tests see the same world.

export const kTaskSeconds = 30;

export const kThings = ['cereal_box_1', 'milk_1', 'salt_1', 'tea_box_1', 'mug_1', 'bowl_1', 'apple_1', 'sponge_1', 'bottle_1'];

export const kJoints = [
  'torso_lift', 'neck_yaw', 'neck_pitch', 'neck_roll',
  ...['left', 'right'].flatMap((side) => [
    ...['clavicle', 'shoulder_1', 'shoulder_2', 'shoulder_3', 'elbow', 'forearm', 'wrist_1', 'wrist_2'].map((name) => `arm_${side}_${name}`),
    ...['thumb', 'index', 'middle', 'ring', 'little'].flatMap((name) => [`hand_${side}_${name}_1`, `hand_${side}_${name}_2`]),
  ]),
  'wheel_front', 'wheel_left', 'wheel_right',
];

const smooth = (x) => { const c = Math.min(1, Math.max(0, x)); return c * c * c * (10 - 15 * c + 6 * c * c); };

/** The task of a time: its number and the seconds since its begin. */
export function task(t) {
  const number = Math.floor(t / kTaskSeconds);
  return { number, phase: t - number * kTaskSeconds };
}

/** 0 at the counter, 1 at the table. */
export function way(t) {
  const { phase } = task(t);
  return smooth((phase - 12) / 7) * (1 - smooth((phase - 25) / 4));
}

/** 0 with the arm at rest, 1 stretched out. */
export function reach(t) {
  const { phase } = task(t);
  const pick = smooth((phase - 7) / 2) * (1 - smooth((phase - 10.5) / 1.5));
  const place = smooth((phase - 19.5) / 2) * (1 - smooth((phase - 23) / 1.5));
  return Math.max(pick, place);
}

export function platform(t) {
  const s = way(t);
  return { x: -0.4 + 2.1 * s, y: 0.3 + 0.5 * Math.sin(Math.PI * s), heading: -1.4 + 2.2 * s };
}

export function joint(index, t) {
  const amplitude = 0.15 + 0.6 * Math.abs(Math.sin(index * 2.3));
  const rest = Math.sin(index * 1.7) * 0.8;
  const side = task(t).number % 2 === 0 ? 'left' : 'right';
  const moves = kJoints[index].includes(side) ? 1 : 0.12;
  const sway = 0.012 * Math.sin(t * (0.9 + 0.13 * index));
  return rest + amplitude * moves * reach(t) * Math.cos(index) + 0.25 * amplitude * way(t) * Math.sin(index * 0.9) + sway;
}

/** Which thing the robot carries, or -1. */
export function carried(t) {
  const { number, phase } = task(t);
  return phase > 9.5 && phase < 22 ? number % kThings.length : -1;
}

export function thing(index, t) {
  const { number, phase } = task(t);
  const trips = Math.floor((number - index) / kThings.length) + 1;
  const isAtTable = trips > 0 && (number % kThings.length !== index || phase >= 22) && trips % 2 === 1;
  const home = { x: -0.9 + 0.22 * index, y: 1.25 + 0.06 * Math.sin(index * 5), z: 0.93 };
  const away = { x: 1.2 + 0.16 * index, y: 1.2 + 0.08 * Math.cos(index * 3), z: 0.78 };
  if (carried(t) === index) {
    const base = platform(t);
    return { x: base.x + 0.35, y: base.y + 0.6 + 0.1 * reach(t), z: 1.02 + 0.08 * reach(t), yaw: base.heading };
  }
  return { ...(isAtTable ? away : home), yaw: 0.4 * index };
}

export const battery = (t) => 51.8 - 0.0021 * t - 0.25 * reach(t) - 0.15 * Math.abs(Math.sin(t / 9)) * way(t);
