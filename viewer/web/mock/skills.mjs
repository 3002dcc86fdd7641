// SPDX-License-Identifier: Apache-2.0
// Skills and drives beside the imagined kitchen: a gateway that has them, too, for tests that need them.
//   visit({ intercept: withSkills() })
import { answer } from './handler.mjs';
import { kStart } from './world.mjs';

const ns = (seconds) => kStart + BigInt(Math.round(seconds * 1e3)) * 1_000_000n;
const int32 = (value) => ({ $int32: value });
const int64 = (value) => ({ $int64: `${value}` });
const array = (type, shape, data) => ({ $ndarray: { type, shape, data } });

const kSpeech = 'Speech/Commands/human/text';

/** Executions as the skill memory tells them; times in seconds, `end` may be missing. */
export const kExecutions = [
  { skill: 'kitchen/drive', by: 'planner', start: 700, end: 706, outcome: 1, reason: "stands at 'counter'", given: { to: 'counter' } },
  { skill: 'kitchen/pick', by: 'planner', start: 707, end: 711, outcome: 3, reason: 'its condition does not hold any more', given: { object: 'Objects/Instances/kitchen/salt_1', hand: 'right' }, stopped: true },
  { skill: 'kitchen/pick', by: 'planner', start: 713, end: 718, outcome: 2, reason: 'it slipped', given: { object: 'Objects/Instances/kitchen/salt_1', hand: 'right' } },
  { skill: 'kitchen/drive', by: 'planner', start: 720, end: 731, outcome: 4, reason: 'its provider went away', given: { to: 'table' } },
  { skill: 'kitchen/drive', by: 'planner', start: 722, end: 728, outcome: 1, reason: 'beside it', given: { to: 'window' } },
  { skill: 'planner/bring', by: 'conditions', start: 699, given: { command: `${kSpeech}/${ns(698)}` }, reports: [[706, 'the drive is done'], [718, 'the pick failed']] },
];
const kRefusals = [{ skill: 'kitchen/pick', by: 'ada', at: 698.5, reason: "parameters: 'hand': found 'up', needs one of left, right", unmet: ['Hand: closed (found open)'] }];

const idOf = (entity, at) => `${entity}/${ns(at)}/0`;
const requestOf = (skill, by) => `Skill/ExecutionRequest/${by}/${skill.split('/')[1]}`;

/** Snapshots of all that is kept of these executions, by entity. */
function snapshotsOf(executions, more) {
  const all = new Map();
  const add = (entity, at, data) => all.set(entity, [...(all.get(entity) ?? []), { time: ns(at), data }]);
  const open = (skill, at) => executions.filter((one) => one.skill === skill && one.start <= at && !(one.end <= at)).map((one) => int64(ns(one.start)));
  for (const one of executions) {
    const entity = `Skill/Event/${one.skill}`;
    const request = idOf(requestOf(one.skill, one.by), one.start - 0.2);
    const common = { skill: one.skill, started: int64(ns(one.start)), request, executable: '', parameters: JSON.stringify(one.given), inputs: [], result: '{}', results: [], stopped_by: [] };
    const event = (stage, at, rest) => add(entity, at, { ...common, stage: int32(stage), outcome: int32(0), reason: '', execution: stage === 0 ? null : idOf(entity, one.start), running: open(one.skill, at), ...rest });
    event(0, one.start, {});
    for (const [at, reason] of one.reports ?? []) event(1, at, { reason, result: JSON.stringify({ step: reason }) });
    if (one.end !== undefined) event(2, one.end, { outcome: int32(one.outcome), reason: one.reason, ended: int64(ns(one.end)), stopped_by: one.stopped ? [`${kSpeech}/${ns(698)}/0`] : [] });
    add(requestOf(one.skill, one.by), one.start - 0.2, { skill: one.skill, wish: int32(0), parameters: JSON.stringify(one.given), wait: 0, version: '', execution: null, causes: [`${kSpeech}/${ns(698)}/0`] });
  }
  for (const one of kRefusals) {
    add(requestOf(one.skill, one.by), one.at - 0.1, { skill: one.skill, wish: int32(0), parameters: '{}', wait: 0, version: '', execution: null, causes: [] });
    add(`Skill/Refusal/${one.skill}`, one.at, { skill: one.skill, request: idOf(requestOf(one.skill, one.by), one.at - 0.1), reason: one.reason, unmet: one.unmet, found: [] });
  }
  for (const [entity, at, data] of more) add(entity, at, data);
  for (const list of all.values()) list.sort((a, b) => (a.time < b.time ? -1 : 1));
  return all;
}

const pose = (x, y, heading) => array('float64', [3], [x, y, heading]);
/** 40 x 60 cells: an obstacle in the middle, costs around it, and a stripe that nobody knows. */
function costs() {
  const bytes = Buffer.alloc(40 * 60);
  for (let row = 0; row < 40; ++row)
    for (let column = 0; column < 60; ++column) {
      const away = Math.hypot(row - 20, column - 30);
      bytes[row * 60 + column] = column < 2 ? 255 : away < 4 ? 254 : away < 8 ? 253 : away < 16 ? Math.round(252 * Math.exp(-(away - 8) / 4)) : 0;
    }
  return { $ndarray: { type: 'uint8', shape: [40, 60], base64: bytes.toString('base64') } };
}
const kPath = Array.from({ length: 30 }, (_, i) => [i / 10, 0.4 * Math.sin(i / 9), 0.2]);
const plan = (state, goal, reason, path) => ({
  robot: 'robot', state: int32(state), reason, goal, request: '', cause: '', location: '', cost_map: '', objects: [], blocked_by: [], length: state === 0 ? 3.05 : 0, planner: 'RRTConnect', seed: 1,
  pose_world_start: pose(0, 0, 0), pose_world_goal: pose(2.9, 0.1, 0.2), path: array('float64', [path.length, 3], path.flat()),
});
const drive = (kind, goal, reason, at) => ['Navigation/Event/robot/drive', at, { kind: int32(kind), robot: 'robot', reason, goal, plan: '', request: '', cause: '', cost_map: '', blocked_by: [], pose_world_robot: pose(0, 0, 0) }];
export const kNavigation = [
  ['Navigation/CostMap/kitchen/floor', 690, { version: 1, resolution: 0.05, pose_world_map: pose(-1, -1, 0), costs: costs(), inscribed_radius: 0.3, inflation_radius: 0.9, made_of: [], left_out: [{ snapshot: '', reason: "'vase_1' has no class" }] }],
  ['Navigation/Plan/robot/drive', 700.1, plan(0, 'counter', '', kPath)],
  drive(0, 'counter', "drives to 'counter'", 700.1), drive(2, 'counter', 'chair_1 is in the way', 702), drive(1, 'counter', 'goes round chair_1', 703), drive(3, 'counter', "stands at 'counter'", 706),
  ['Navigation/Plan/robot/drive', 720, plan(1, 'garden', 'no way leads there: the door is closed', [])], drive(4, 'garden', 'no way leads there', 720),
  ['Navigation/Location/people/ada', 650, { name: 'Ada', aliases: [], pose_world_location: pose(1.6, -1.4, -0.7), object: '', pose_object_location: null }],
  ['Navigation/Location/people/shelf', 650, { name: 'Shelf', aliases: [], pose_world_location: null, object: 'Objects/Surfaces/kitchen/table', pose_object_location: pose(0, -1, 1.5) }],
  [kSpeech, 698, { text: 'Bring me the salt.', speaker: 'Ada' }],
];

/** Very many short executions, which no screen shows one by one. */
export const manyExecutions = (count) => Array.from({ length: count }, (_, i) => ({ skill: 'kitchen/look', by: 'planner', start: 100 + i * 0.2, end: 100.1 + i * 0.2, outcome: i % 100 === 7 ? 2 : 1, reason: 'in sight', given: {} }));

const json = (value) => ({ status: 200, type: 'application/json', headers: {}, body: JSON.stringify(value) });
const binary = (values) => ({ status: 200, type: 'application/octet-stream', headers: {}, body: new Uint8Array(values.buffer) });

function parseTime(text) {
  if (/^-?\d+$/.test(text)) return BigInt(text);
  const [, date, clock, fraction = ''] = /^(\S+) ([\d:]+)(?:\.(\d+))?$/.exec(text);
  return BigInt(Date.parse(`${date}T${clock}Z`)) * 1_000_000n + BigInt(fraction.padEnd(9, '0'));
}

/** Links as moments tell them, and arrays that are long as their summary. */
function shown(value) {
  if (typeof value === 'string' && /^\w+\/\w+\/\w+\/\w+\/\d{19}(\/\d+)?$/.test(value)) return { $link: value };
  if (Array.isArray(value)) return value.map(shown);
  if (value === null || typeof value !== 'object') return value;
  const part = value.$ndarray;
  if (part) return part.base64 || part.data.length > 64 ? { $array: { shape: part.shape, dtype: part.type, summary: { min: 0, max: 1, mean: 0.5 } } } : value;
  return Object.fromEntries(Object.entries(value).map(([key, inside]) => [key, shown(inside)]));
}

function linksIn(value, found = []) {
  if (typeof value === 'string' && /^\w+\/\w+\/\w+\/\w+\/\d{19}/.test(value)) found.push(value);
  else if (value !== null && typeof value === 'object') Object.values(value).forEach((part) => linksIn(part, found));
  return found;
}

/** Puts these entities into the tree of the kitchen. */
function treeWith(all) {
  const told = JSON.parse(answer(new URL('http://x/api/tree?depth=4')).body);
  for (const [id, list] of all) {
    const names = id.split('/');
    let level = told.children;
    names.forEach((name, i) => {
      const own = names.slice(0, i + 1).join('/');
      let node = level.find((one) => one.id === own);
      if (!node) level.push(node = { name, id: own, level: ['memory', 'core', 'provider', 'entity'][i], entities: 1, snapshots: 0, first: `${list[0].time}`, last: `${list.at(-1).time}`, ...(i < 3 ? { children: [] } : { kinds: ['number', 'text', 'link'] }) });
      node.snapshots += list.length;
      level = node.children;
    });
  }
  return told;
}

/** An `intercept` for a memory that has skills; `change` may replace its executions while somebody looks. */
export function withSkills({ executions = kExecutions, more = kNavigation } = {}) {
  let all = snapshotsOf(executions, more);
  const intercept = (url) => {
    const query = url.searchParams;
    const entity = query.get('entity');
    const own = (id) => (id?.startsWith('Skill/') || id?.startsWith('Navigation/') ? all.get(id) : undefined);
    const idIn = (id) => id.split('/').slice(0, 4).join('/');
    switch (url.pathname) {
      case '/api/tree': return json(treeWith(all));
      case '/api/density': {
        const ids = query.getAll('entity');
        const pixels = Number(query.get('pixels'));
        const [from, to] = [BigInt(query.get('from')), BigInt(query.get('to'))];
        const out = new Uint32Array(ids.length * 3 * pixels);
        ids.forEach((id, row) => {
          const below = [...all].filter(([key]) => key === id || key.startsWith(`${id}/`));
          if (below.length === 0) {
            const one = new URL(url);
            one.searchParams.delete('entity');
            one.searchParams.append('entity', id);
            out.set(new Uint32Array(Uint8Array.from(answer(one).body).buffer), row * 3 * pixels);
          } else for (const { time } of below.flatMap(([, list]) => list)) if (time >= from && time < to) out[row * 3 * pixels + Number(((time - from) * BigInt(pixels)) / (to - from))] += 1;
        });
        return binary(out);
      }
      case '/api/query': {
        const entities = query.get('q').split(' ; ').flatMap((branch) => {
          const [id, selectors = 'latest'] = branch.split(' @ ');
          const list = all.get(id) ?? [];
          const found = new Set();
          for (const selector of selectors.split(', ')) {
            if (selector.startsWith('at-or-before:')) { const before = list.filter(({ time }) => time <= parseTime(selector.slice(13))).at(-1); if (before) found.add(before); }
            else { const [from, to = from] = selector.split('..').map(parseTime); for (const one of list) if (one.time >= from && one.time <= to) found.add(one); }
          }
          const snapshots = list.filter((one) => found.has(one)).map((one) => ({ id: `${id}/${one.time}`, source: 'recorded', instances: [{ data: one.data }] }));
          return snapshots.length > 0 ? [{ id, snapshots }] : [];
        });
        return json({ entities });
      }
      case '/api/series': {
        const list = own(entity);
        if (!list) return null;
        const pixels = Number(query.get('pixels'));
        const [from, to] = [BigInt(query.get('from')), BigInt(query.get('to'))];
        const paths = query.getAll('path');
        const out = new Float32Array(paths.length * 3 * pixels).fill(NaN);
        for (const { time, data } of list) {
          if (time < from || time >= to) continue;
          const pixel = Number(((time - from) * BigInt(pixels)) / (to - from));
          paths.forEach((path, p) => {
            const value = data[path]?.$int32 ?? NaN;
            const at = p * 3 * pixels + pixel;
            if (!(out[at] <= value)) out[at] = value;
            if (!(out[at + pixels] >= value)) out[at + pixels] = value;
            out[at + 2 * pixels] = value;
          });
        }
        return binary(out);
      }
      case '/api/moment': {
        const list = own(entity) ?? (entity === kSpeech && query.get('at') === `${ns(698)}` ? all.get(kSpeech) : undefined);
        if (!list) return null;
        const at = BigInt(query.get('at'));
        const index = list.findLastIndex(({ time }) => time <= at);
        if (index < 0 || (query.get('which') === 'exact' && list[index].time !== at)) return { ...json({ error: { code: 'not found', message: 'no snapshot' } }), status: 404 };
        const { time, data } = list[index];
        return json({ id: `${entity}/${time}`, time: `${time}`, source: 'recorded', instances: [{ index: 0, metadata: {}, data: shown(data) }], previous: index > 0 ? `${list[index - 1].time}` : null, next: list[index + 1] ? `${list[index + 1].time}` : null });
      }
      case '/api/links': {
        const id = query.get('id').split('/').slice(0, 5).join('/');
        if (!own(idIn(id)) && idIn(id) !== kSpeech) return null;
        const data = all.get(idIn(id))?.find(({ time }) => `${idIn(id)}/${time}` === id)?.data;
        const from = [...all].flatMap(([key, list]) => list.filter((one) => linksIn(one.data).some((link) => link.startsWith(id))).map(({ time }) => `${key}/${time}`));
        return json({ to: linksIn(data).map((link) => ({ path: '', id: link })), from, more: false });
      }
      case '/api/step': {
        const list = own(entity);
        if (!list) return null;
        const [at, by] = [BigInt(query.get('at')), Number(query.get('by'))];
        const index = by > 0 ? list.findIndex(({ time }) => time > at) + by - 1 : list.findLastIndex(({ time }) => time < at) + by + 1;
        return json({ time: `${list[Math.max(0, Math.min(list.length - 1, index))].time}` });
      }
      case '/api/members': return own(entity) ? json({ instances: 1, members: [] }) : null;
      default: return null;
    }
  };
  intercept.change = (next) => { all = snapshotsOf(next, more); };
  return intercept;
}
