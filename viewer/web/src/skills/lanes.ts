// SPDX-License-Identifier: Apache-2.0
// Which lanes of the timeline have bars and marks in the place of counts, and what is in them.
import { nodeOf } from '../state/store';
import { parseId, shortName } from '../state/ids';
import type { Row } from '../timeline/layout';
import { chosenOf, eventOf, labelOf, linkOf, packed, requesterOf, textIn, type Execution, type Outcome, type SkillEvent, type Slot } from './executions';

/** What a mark looks like. */
export type Glyph = 'request' | 'stop' | 'enable' | 'disable' | 'refusal' | 'go' | 'again' | 'blocked' | 'arrived' | 'trapped' | 'failed';

export interface Mark {
  readonly id: string;
  readonly time: bigint;
  readonly glyph: Glyph;
  readonly what: string;
}

export interface EventLane {
  readonly executions: readonly Execution[];
  /** Where each execution lies. */
  readonly slots: readonly Slot[];
  readonly marks: readonly Mark[];
  /** Where there are more events than are asked for: what the pixels of a lane have. */
  readonly dense: readonly DenseLane[];
}

/** The outcomes of one skill per pixel of a stretch of time. */
export interface DenseLane {
  readonly from: bigint;
  readonly to: bigint;
  readonly outcomes: readonly (Outcome | undefined)[];
  /** Whether something runs behind the last event of a pixel. */
  readonly isRunning: readonly boolean[];
}

/** More rows than this in a lane would be too thin to see. */
const kMaxPacked = 4;

const kEvents = /^Skill\/Event(\/|$)/;
const kMarks = /^(Skill\/(Refusal|ExecutionRequest)|Navigation\/Event)\//;
export const isOfSkills = (id: string): boolean => kEvents.test(id) || /^Skill\/(Refusal|ExecutionRequest)\//.test(id);

/** The entities whose events a row shows: its own, or all below it while it is closed. */
export function entitiesOf(row: Pick<Row, 'id' | 'isEntity' | 'isOpen' | 'node'>): string[] {
  if (row.isEntity) return kEvents.test(row.id) || kMarks.test(row.id) ? [row.id] : [];
  if (row.isOpen || !kEvents.test(row.id)) return [];
  const below = (node: Row['node']): string[] => (node.level === 'entity' ? [node.id] : (node.children ?? []).flatMap(below));
  return below(row.node);
}

/** Where the refusals of a skill are. */
export const refusalsOf = (entity: string): string => entity.replace(/^Skill\/Event\//, 'Skill/Refusal/');
export const isExecuted = (entity: string): boolean => kEvents.test(entity);

/** Entities to ask for, with the refusals of skills, as far as there are such. */
export const askedFor = (entities: readonly string[]): string[] => [...new Set(entities.flatMap((id) => [id, ...(isExecuted(id) && nodeOf(refusalsOf(id)) ? [refusalsOf(id)] : [])]))];

const kWishes = ['request', 'stop', 'enable', 'disable'] as const;
const kWishWords = { request: 'asked for', stop: 'asked to stop', enable: 'switched on', disable: 'switched off' } as const;
const kDrives = ['go', 'again', 'blocked', 'arrived', 'refusal', 'trapped', 'stop', 'failed'] as const;
const kDriveWords = { go: 'started', again: 'planned again', blocked: 'blocked', arrived: 'arrived', refusal: 'refused', trapped: 'trapped', stop: 'stopped', failed: 'failed' } as const;

const withReason = (what: string, reason: string): string => (reason === '' ? what : `${what}: ${reason}`);

/** The mark of a snapshot of requests, refusals or drives. */
export function markOf(id: string, data: unknown): Mark | undefined {
  const { entity, time } = parseId(id);
  if (time === undefined || typeof data !== 'object' || data === null) return undefined;
  const dict = data as Record<string, unknown>;
  if (entity.startsWith('Skill/Refusal/')) return { id, time, glyph: 'refusal', what: withReason(`${shortName(entity)} refused`, textIn(data, 'reason')) };
  if (entity.startsWith('Skill/ExecutionRequest/')) {
    const wish = chosenOf(dict.wish, kWishes);
    return wish && { id, time, glyph: wish, what: `${labelOf(entity, textIn(data, 'parameters'))}: ${kWishWords[wish]} by ${requesterOf(id)}` };
  }
  const kind = chosenOf(dict.kind, kDrives);
  return kind && { id, time, glyph: kind, what: withReason(`${textIn(data, 'goal')}: ${kDriveWords[kind]}`, textIn(data, 'reason')) };
}

/** The mark where an execution, or what was refused, was asked for. */
export function requestMark(request: string, skill: string): Mark | undefined {
  const { time } = parseId(request);
  return time === undefined ? undefined : { id: request, time, glyph: 'request', what: `${skill}: asked for by ${requesterOf(request)}` };
}

export interface Snapshot {
  readonly id: string;
  readonly data: unknown;
}

export const eventsIn = (snapshots: readonly Snapshot[]): SkillEvent[] => snapshots.map((one) => eventOf(one.id, one.data)).filter((one) => one !== undefined);

/** What a row shows, from the snapshots of its entities; `executions` are those of its skills. */
export function laneOf(entities: readonly string[], snapshots: ReadonlyMap<string, readonly Snapshot[]>, executions: ReadonlyMap<string, readonly Execution[]>, dense: ReadonlyMap<string, DenseLane>): EventLane {
  const all = entities.flatMap((id) => executions.get(id) ?? []).sort((a, b) => (a.start < b.start ? -1 : a.start > b.start ? 1 : 0));
  const own = entities.flatMap((id) => (isExecuted(id) ? [] : [id])).flatMap((id) => snapshots.get(id) ?? []);
  const refused = entities.flatMap((id) => (isExecuted(id) ? snapshots.get(refusalsOf(id)) ?? [] : []));
  const asked = [...all.map((one) => requestMark(one.request, one.label)), ...refused.map((one) => requestMark(linkOf((one.data as Record<string, unknown> | null)?.request), shortName(parseId(one.id).entity)))];
  const marks = [...own, ...refused].map((one) => markOf(one.id, one.data)).concat(asked).filter((one) => one !== undefined);
  return { executions: all, slots: packed(all, kMaxPacked), marks: marks.sort((a, b) => (a.time < b.time ? -1 : a.time > b.time ? 1 : 0)), dense: entities.flatMap((id) => dense.get(id) ?? []) };
}
