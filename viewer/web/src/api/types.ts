// SPDX-License-Identifier: Apache-2.0
// What the gateway answers, as types and as the checks that make them.
import * as d from './decode';

export const info = d.object({
  name: d.string,
  version: d.string,
  stores: d.list(d.object({ name: d.string, path: d.optional(d.string) })),
  // Absent of a memory without snapshots.
  first: d.withDefault(d.time, 0n),
  last: d.withDefault(d.time, 1_000_000_000n),
  entities: d.number,
  // Absent of a server, which would have to list them all.
  snapshots: d.optional(d.number),
  is_live: d.withDefault(d.bool, false),
  max_horizon_ns: d.withDefault(d.time, 60_000_000_000n),
});
export type Info = d.Of<typeof info>;

const nodeShape = {
  name: d.string,
  id: d.string,
  level: d.oneOf('memory', 'core', 'provider', 'entity'),
  entities: d.withDefault(d.number, 1),
  snapshots: d.optional(d.number),
  first: d.optional(d.time),
  last: d.optional(d.time),
  // Absent of a server, which tells names alone.
  kinds: d.optional(d.list(d.string)),
  raw_bytes: d.optional(d.number),
  stored_bytes: d.optional(d.number),
  latent_bytes: d.optional(d.number),
  models: d.optional(d.number),
};
const plainNode = d.object(nodeShape);
export type TreeNode = d.Of<typeof plainNode> & { children?: TreeNode[] };

export const treeNode: d.Decoder<TreeNode> = (value, path) => {
  const node: TreeNode = plainNode(value, path);
  const children = (value as { children?: unknown }).children;
  if (children !== undefined) node.children = d.list(treeNode)(children, `${path}.children`);
  return node;
};
export const treeLevel = d.object({ under: d.withDefault(d.string, ''), children: d.list(treeNode) });

export const member = d.object({
  path: d.string,
  kind: d.string,
  shape: d.withDefault(d.list(d.number), []),
  unit: d.optional(d.string),
  name: d.optional(d.string),
  min: d.optional(d.number),
  max: d.optional(d.number),
});
export type Member = d.Of<typeof member>;
export const members = d.object({ members: d.list(member) });
export const isImage = (kinds: string | readonly string[]): boolean => [kinds].flat().some((kind) => kind === 'image' || kind === 'depth');

const memberError = d.object({
  path: d.string,
  engine: d.optional(d.string),
  expected_error: d.optional(d.number),
  bound: d.optional(d.number),
});

export const moment = d.object({
  id: d.string,
  time: d.time,
  source: d.string,
  engine: d.optional(d.string),
  model: d.optional(d.string),
  /** The forms that this snapshot is kept in; absent where the gateway does not say. */
  forms: d.optional(d.list(d.string)),
  from: d.optional(d.time),
  horizon: d.optional(d.time),
  expected_error: d.optional(d.number),
  bound: d.optional(d.number),
  members: d.withDefault(d.list(memberError), []),
  instances: d.list(d.object({ index: d.number, metadata: d.withDefault(d.anything, {}), data: d.anything })),
  previous: d.optional(d.time),
  next: d.optional(d.time),
});
export type Moment = d.Of<typeof moment>;
export const moments = d.list(moment);

export const similar = d.object({ found: d.list(d.object({ id: d.string, time: d.time, distance: d.number })) });
export type Similar = d.Of<typeof similar>['found'][number];

export const links = d.object({
  to: d.withDefault(d.list(d.object({ path: d.string, id: d.string })), []),
  from: d.withDefault(d.list(d.string), []),
});
export type Links = d.Of<typeof links>;

const plainMap = d.object({
  space: d.withDefault(d.string, ''),
  coded_by: d.withDefault(d.string, ''),
  /** How many moments have a code, of which these are some. */
  known: d.optional(d.number),
  times: d.list(d.time),
  x: d.list(d.number),
  y: d.list(d.number),
  recordings: d.withDefault(d.list(d.number), []),
  explained: d.optional(d.number),
});
export type MemoryMap = d.Of<typeof plainMap>;

/** Moments and their places, in the order of time. */
export const memoryMap: d.Decoder<MemoryMap> = (value, path) => {
  const map = plainMap(value, path);
  const count = map.times.length;
  if (map.x.length !== count || map.y.length !== count || (map.recordings.length !== 0 && map.recordings.length !== count)) throw new d.DecodeError('x, y, recordings', map.x, `as many numbers as there are times (${count})`);
  const order = map.times.map((_, i) => i).sort((a, b) => (map.times[a]! < map.times[b]! ? -1 : map.times[a]! > map.times[b]! ? 1 : 0));
  const sorted = <T>(list: readonly T[]) => (list.length === 0 ? [] : order.map((i) => list[i]!));
  return { ...map, times: sorted(map.times), x: sorted(map.x), y: sorted(map.y), recordings: sorted(map.recordings) };
};

export const found = d.object({ found: d.list(d.string), more: d.withDefault(d.bool, false) });
export const step = d.object({ time: d.time });

const plainQuality = d.object({
  low: d.number,
  step: d.number,
  counts: d.list(d.number),
  unknown: d.withDefault(d.number, 0),
  compared: d.withDefault(d.number, 0),
  /** What was to be compared, as far as there was time. */
  asked: d.optional(d.number),
  worst: d.withDefault(d.list(d.object({ id: d.string, psnr: d.number })), []),
});
export type Quality = d.Of<typeof plainQuality>;

export const quality: d.Decoder<Quality> = (value, path) => {
  const found = plainQuality(value, path);
  if (!(found.step > 0)) throw new d.DecodeError('step', found.step, 'a number above 0');
  return found;
};

/** What the gateway shows, in its order. */
export const memories = d.object({ memories: d.list(d.object({ name: d.string, path: d.optional(d.string), is_live: d.optional(d.bool) })) });

export const liveFrame = d.object({
  kind: d.string,
  memory: d.withDefault(d.number, 0),
  ids: d.withDefault(d.list(d.string), []),
  count: d.withDefault(d.number, 0),
  message: d.withDefault(d.string, ''),
});
