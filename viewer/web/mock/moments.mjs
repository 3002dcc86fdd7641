// SPDX-License-Identifier: Apache-2.0
// Snapshots, predictions, links and likeness of the imagined memory.
import { formOf, isRecorded, kEntities, kHorizonNs, kStart, lowerBound, recordingAt } from './world.mjs';
import { continued, membersOf, valueOf } from './values.mjs';
import { platform, reach, task } from './motion.mjs';

export class Refusal extends Error {
  constructor(status, code, message) {
    super(message);
    this.status = status;
    this.code = code;
  }
}

export function entityOf(id) {
  const entity = kEntities.get(id);
  if (!entity) throw new Refusal(404, 'not found', `no entity '${id}' in this memory`);
  return entity;
}

/** Splits `A/B/C/D/time/instance` into its parts. */
export function splitId(id) {
  const parts = id.split('/');
  return { entity: entityOf(parts.slice(0, 4).join('/')), time: parts[4] === undefined ? undefined : BigInt(parts[4]), instance: Number(parts[5] ?? 0) };
}

const instancesOf = (entity) => (entity.kind === 'camera' ? 2 : 1);

/** The ID of the last snapshot of an entity at a time, as links name them. */
function idAt(id, t) {
  const entity = kEntities.get(id);
  const index = Math.max(0, lowerBound(entity.times, t * 1e9 + 1) - 1);
  return `${id}/${kStart + BigInt(entity.times[index])}`;
}

const rootOf = (entity, horizon) => (entity.kind.includes('camera') ? 0.05 : 0.0025) * (1 + horizon / 2e8);

function instances(entity, offset, value, source) {
  const created = kStart + BigInt(offset);
  return Array.from({ length: instancesOf(entity) }, (_, index) => ({
    index,
    metadata: { created: `${created}`, sent: `${created + 1_200_000n}`, arrived: `${created + 2_350_000n}`, provider: entity.id.split('/')[2], confidence: source === 'predicted' ? 0.7 : 1 },
    data: value,
  }));
}

export function snapshotAt(entity, index) {
  const offset = entity.times[index];
  const form = formOf(entity, offset);
  const source = form === 2 ? 'augmented' : isRecorded(entity, offset) ? 'recorded' : 'reconstructed';
  const near = (i) => (i >= 0 && i < entity.times.length ? `${kStart + BigInt(entity.times[i])}` : null);
  return {
    id: `${entity.id}/${kStart + BigInt(offset)}`, entity: entity.id, time: `${kStart + BigInt(offset)}`, source,
    forms: [...(isRecorded(entity, offset) ? ['recorded'] : []), ...(form === 1 ? ['latent'] : [])],
    ...(source === 'reconstructed' ? { model: `${entity.kind}-0007`, expected_error: 0.0009, bound: 0.0021 } : {}),
    instances: instances(entity, offset, valueOf(entity, offset / 1e9, idAt), source),
    previous: near(index - 1), next: near(index + 1),
  };
}

/** Continues an entity from a snapshot of its by a horizon in nanoseconds. */
export function predicted(entity, index, horizon) {
  if (horizon > kHorizonNs) throw new Refusal(400, 'invalid argument', `a prediction of ${horizon / 1e9} s asked for, at most ${kHorizonNs / 1e9} s are possible`);
  const from = entity.times[index];
  const step = 0.04;
  const value = continued(valueOf(entity, from / 1e9 - step, idAt), valueOf(entity, from / 1e9, idAt), Math.min(horizon / 1e9, 0.8) / step);
  const error = rootOf(entity, horizon);
  return {
    id: `${entity.id}/${kStart + BigInt(from + horizon)}`, entity: entity.id, time: `${kStart + BigInt(from + horizon)}`, source: 'predicted',
    engine: entity.kind === 'joints' ? 'related' : entity.kind.includes('camera') ? 'deep' : 'damped-line',
    horizon: `${horizon}`, from: `${kStart + BigInt(from)}`, expected_error: error, bound: 1.9 * error,
    members: membersOf(entity).filter((member) => member.kind === 'number').slice(0, 60).map((member, i) => ({ path: member.path, engine: i % 3 === 0 ? 'related' : 'line', expected_error: error * (1 + (i % 5) / 4), bound: 1.9 * error * (1 + (i % 5) / 4) })),
    instances: instances(entity, from + horizon, value, 'predicted'), previous: `${kStart + BigInt(from)}`, next: null,
  };
}

export function momentAt(entity, at, which) {
  const offset = Number(at - kStart);
  const { times } = entity;
  const last = times.length - 1;
  if (which === 'predict' && offset > times[last]) return predicted(entity, last, offset - times[last]);
  let index = lowerBound(times, offset + 1) - 1;
  if (which === 'exact' && times[index] !== offset) throw new Refusal(404, 'not found', `entity '${entity.id}' has no snapshot at exactly ${at}`);
  if (which === 'nearest' && (index < 0 || (index < last && times[index + 1] - offset < offset - times[index]))) index += 1;
  if (index < 0) throw new Refusal(404, 'not found', `entity '${entity.id}' has no snapshot at or before ${at}; its first is at ${kStart + BigInt(times[0])}`);
  return snapshotAt(entity, index);
}

function linksIn(value, path, found) {
  if (value === null || typeof value !== 'object') return found;
  if (typeof value.$link === 'string') found.push({ path, id: value.$link });
  else for (const [key, part] of Object.entries(value)) linksIn(part, path ? `${path}/${key}` : key, found);
  return found;
}

export function linksOf(entity, at) {
  const snapshot = momentAt(entity, at, 'at-or-before');
  const from = [];
  // What links here: only the sparse entities are searched, which is enough to show chips.
  for (const other of kEntities.values()) {
    if (!['action', 'plan', 'thing'].includes(other.kind)) continue;
    const first = Math.max(0, lowerBound(other.times, Number(at - kStart)));
    for (let i = first; i < Math.min(other.times.length, first + 2) && from.length < 12; ++i) {
      const candidate = snapshotAt(other, i);
      if (linksIn(candidate.instances[0].data, '', []).some((one) => one.id === snapshot.id)) from.push(candidate.id);
    }
  }
  return { to: linksIn(snapshot.instances[0].data, '', []), from };
}

/** Moments in which the robot stood and reached as it does now, at most one per task. */
export function similarTo(entity, at, k) {
  const code = (t) => { const p = platform(t); return [p.x, p.y, p.heading, 2 * reach(t)]; };
  const here = code(Number(at - kStart) / 1e9);
  const best = new Map();
  const stride = Math.max(1, Math.floor(entity.times.length / 4000));
  for (let i = 0; i < entity.times.length; i += stride) {
    const t = entity.times[i] / 1e9;
    const there = code(t);
    const distance = Math.sqrt(there.reduce((sum, x, j) => sum + (x - here[j]) ** 2, 0)) / 2 + 0.02 + 0.05 * Math.abs(Math.sin(t));
    const episode = Math.floor(t / 30);
    if (Math.abs(t - Number(at - kStart) / 1e9) < 10) continue;
    if (!best.has(episode) || best.get(episode).distance > distance) best.set(episode, { time: kStart + BigInt(entity.times[i]), distance });
  }
  return [...best.values()].sort((a, b) => a.distance - b.distance).slice(0, k)
    .map(({ time, distance }) => ({ id: `${entity.id}/${time}`, time: `${time}`, distance }));
}

/** Codes in two dimensions: the robot goes to and fro between counter and table, and reaches at both. */
export function mapOf(entity, max) {
  const coded = entity.times.filter((offset) => formOf(entity, offset) === 1);
  if (coded.length === 0) throw new Refusal(409, 'failed precondition', `entity '${entity.id}' has no codes yet: no night came after it. Run engram consolidate`);
  const count = Math.min(max, coded.length);
  const offsets = Array.from({ length: count }, (_, i) => coded[Math.floor((i * coded.length) / count)]);
  const round = (x) => Math.round(x * 1e4) / 1e4;
  const code = (t) => {
    const p = platform(t);
    const blur = (k) => 0.06 * Math.sin(t * k) * Math.cos(t * 0.37 * k);
    return [round(1.1 * p.x + 0.3 * Math.sin(task(t).number * 1.9) + blur(31)), round(1.4 * reach(t) * Math.cos(p.x) + p.y + 0.02 * task(t).number + blur(47))];
  };
  const codes = offsets.map((offset) => code(offset / 1e9));
  return {
    entity: entity.id, known: coded.length, space: `${entity.kind}-0007`, coded_by: entity.kind.includes('camera') || entity.kind === 'depth' ? 'images' : 'numbers', times: offsets.map((offset) => `${kStart + BigInt(offset)}`),
    x: codes.map(([x]) => x), y: codes.map(([, y]) => y), recordings: offsets.map((offset) => recordingAt(offset / 1e9)), explained: 0.41,
  };
}
