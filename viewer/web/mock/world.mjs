// SPDX-License-Identifier: Apache-2.0
// What the imagined memory holds: 32 entities, the times of their snapshots, and in which form each
// snapshot is kept. Times are float64 offsets in nanoseconds from kStart, which are exact here.
import { kTaskSeconds, kThings } from './motion.mjs';

export const kStart = 1767250800000000000n; // 2026-01-01 07:00 UTC
export const kSeconds = 23 * 60;
export const kHorizonNs = 60_000_000_000;
// The robot was off twice: that is what gaps look like.
const kPauses = [[497, 552], [961.5, 975]];
// Nights have turned what is older than this into latents; the last part of it is still recorded as well.
const kLatentUntil = 840;
const kRecordedFrom = 610;

/** Which recording a time belongs to: the robot was off between them. */
export const recordingAt = (seconds) => kPauses.filter(([, to]) => seconds >= to).length;

const isOff = (seconds) => kPauses.some(([from, to]) => seconds >= from && seconds < to);
const noise = (i) => { const x = Math.sin(i * 12.9898 + 4.1) * 43758.5453; return x - Math.floor(x); };

/** Regular snapshots with the jitter that real sensors have, and now and then a lost one. */
function regular(hz, loss = 0.002) {
  const times = [];
  for (let i = 0; i < kSeconds * hz; ++i) {
    const seconds = (i + 0.25 * noise(i * hz)) / hz;
    if (!isOff(seconds) && noise(i * 7 + hz) > loss) times.push(Math.round(seconds * 1e9));
  }
  return Float64Array.from(times);
}

/** Snapshots at some seconds of every task. */
function atPhases(phases, every = 1, which = 0) {
  const times = [];
  for (let task = 0; task * kTaskSeconds < kSeconds; ++task)
    for (const phase of phases) {
      const seconds = task * kTaskSeconds + phase + 0.31 * noise(task + phase);
      if (task % every === which && seconds < kSeconds && !isOff(seconds)) times.push(Math.round(seconds * 1e9));
    }
  return Float64Array.from(times);
}

const once = () => Float64Array.of(120_000_000);

const entities = [
  ['Vision/RGB/head/stereo', 'camera', regular(20), 49152 * 2],
  ['Vision/RGB/hand/left', 'hand_camera', regular(10), 49152],
  ['Vision/RGB/hand/right', 'hand_camera', regular(10), 49152],
  ['Vision/Depth/head/left', 'depth', regular(5), 32768],
  ['Vision/Calibration/head/left', 'calibration', once(), 412],
  ['Vision/Calibration/head/right', 'calibration', once(), 412],
  ['RobotState/Proprioception/robot/joints', 'joints', regular(50), 1032],
  ['RobotState/Proprioception/robot/battery', 'battery', regular(1), 24],
  ['RobotState/Localization/robot/platform', 'platform', regular(50), 96],
  ['RobotState/Description/robot/body', 'description', once(), 18230],
  ...kThings.map((name) => [`Objects/Instances/kitchen/${name}`, 'thing', regular(5, 0.01), 310]),
  ['Objects/Surfaces/kitchen/counter', 'surface', once(), 120],
  ['Objects/Surfaces/kitchen/table', 'surface', once(), 120],
  ...['cereal_box', 'milk', 'mug'].map((name) => [`Objects/Classes/kitchen/${name}`, 'class', once(), 260]),
  ['Speech/Commands/human/text', 'speech', atPhases([0.8]), 88],
  ['Speech/Utterances/robot/text', 'utterance', atPhases([2.1, 24.6]), 74],
  ['Tasks/Plans/robot/plan', 'plan', atPhases([2.4]), 640],
  ['Skills/Actions/robot/look', 'action', atPhases([3, 5]), 420],
  ['Skills/Actions/robot/navigate', 'action', atPhases([12, 19, 25, 29]), 420],
  ['Skills/Actions/robot/pick', 'action', atPhases([7, 11.2]), 420],
  ['Skills/Actions/robot/place', 'action', atPhases([19.5, 23.4], 1, 0), 420],
  ['Simulation/Recording/kitchen/options', 'options', once(), 180],
].map(([id, kind, times, bytes]) => ({ id, kind, times, bytes, hasModel: times.length > 2000 }));

export const kEntities = new Map(entities.map((entity) => [entity.id, entity]));

/** 0 recorded alone, 1 latent (perhaps recorded as well), 2 augmented. */
export function formOf(entity, offset) {
  const seconds = offset / 1e9;
  if (entity.kind === 'joints' && seconds > 180 && seconds < 232) return 2;
  return entity.hasModel && seconds < kLatentUntil ? 1 : 0;
}

export const isRecorded = (entity, offset) => formOf(entity, offset) !== 1 || offset / 1e9 >= kRecordedFrom;

/** The index of the first snapshot at or after an offset. */
export function lowerBound(times, offset) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < offset) low = middle + 1;
    else high = middle;
  }
  return low;
}

export const kFirst = kStart + BigInt(Math.min(...entities.map((entity) => entity.times[0])));
export const kLast = kStart + BigInt(Math.max(...entities.map((entity) => entity.times[entity.times.length - 1])));
