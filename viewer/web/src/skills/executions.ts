// SPDX-License-Identifier: Apache-2.0
// What the skill memory keeps of executions (docs/skills.md), as bars: an event at the start, reports,
// and an event at the end become one execution.
import * as d from '../api/decode';
import { parseId, shortName, splitLevels, nameOf } from '../state/ids';

export const kOutcomes = ['running', 'success', 'failure', 'stopped', 'lost'] as const;
export type Outcome = (typeof kOutcomes)[number];
export type Stage = 'started' | 'report' | 'ended';
const kStages: readonly Stage[] = ['started', 'report', 'ended'];

export interface SkillEvent {
  /** Of the snapshot, without an instance. */
  readonly id: string;
  readonly time: bigint;
  readonly stage: Stage;
  readonly outcome: Outcome;
  readonly reason: string;
  /** When the execution began that this event is of. */
  readonly started: bigint;
  readonly request: string;
  readonly parameters: string;
  /** When the executions began that ran after this event. */
  readonly running: readonly bigint[];
}

export interface Execution {
  readonly entity: string;
  readonly start: bigint;
  /** Missing: it runs, or its end is not known here. */
  readonly end?: bigint;
  readonly outcome: Outcome;
  readonly label: string;
  readonly reason: string;
  readonly request: string;
}

type Dict = Record<string, unknown>;
const isDict = (value: unknown): value is Dict => typeof value === 'object' && value !== null && !Array.isArray(value);
export const textIn = (data: unknown, key: string): string => { const value = isDict(data) ? data[key] : undefined; return typeof value === 'string' ? value : ''; };

/** An integer as IDF's JSON writes it; undefined where it is none. */
export function integerOf(value: unknown): bigint | undefined {
  const plain = isDict(value) ? value.$int32 ?? value.$int64 : value;
  if (typeof plain === 'number' && Number.isSafeInteger(plain)) return BigInt(plain);
  return typeof plain === 'string' && /^-?\d{1,19}$/.test(plain) ? BigInt(plain) : undefined;
}
/** The place of an enumerator in its list. */
export const chosenOf = <T>(value: unknown, names: readonly T[]): T | undefined => { const at = integerOf(value); return at === undefined ? undefined : names[Number(at)]; };

/** The ID that a link has: queries tell it as a text, moments as a dict. */
export const linkOf = (value: unknown): string => (typeof value === 'string' ? value : isDict(value) && typeof value.$link === 'string' ? value.$link : '');
export const linksOf = (value: unknown): string[] => (Array.isArray(value) ? value.map(linkOf).filter((id) => id !== '') : []);

/** What `engram query --json` tells of snapshots. */
export const queryAnswer = d.object({
  entities: d.withDefault(d.list(d.object({
    id: d.string,
    snapshots: d.withDefault(d.list(d.object({ id: d.string, instances: d.withDefault(d.list(d.object({ data: d.anything })), []) })), []),
  })), []),
});

/** An event, unless a later version of the memory has told something that is not known here. */
export function eventOf(id: string, data: unknown): SkillEvent | undefined {
  const { time } = parseId(id);
  if (!isDict(data) || time === undefined) return undefined;
  const [stage, outcome] = [chosenOf(data.stage, kStages), chosenOf(data.outcome, kOutcomes)];
  const started = integerOf(data.started) ?? parseId(linkOf(data.execution)).time ?? time;
  if (stage === undefined || outcome === undefined) return undefined;
  const running = (Array.isArray(data.running) ? data.running : []).map(integerOf).filter((at) => at !== undefined);
  return { id, time, stage, outcome, started, running, reason: textIn(data, 'reason'), request: linkOf(data.request), parameters: textIn(data, 'parameters') };
}

/** Parameters as a dict; they are JSON in a text, because each skill has its own. */
export function parametersOf(text: string): readonly (readonly [string, unknown])[] {
  try {
    const parsed: unknown = JSON.parse(text);
    return isDict(parsed) ? Object.entries(parsed) : [];
  } catch {
    return [];
  }
}

const isId = (value: string): boolean => splitLevels(value).length >= 4;
/** The names of what was said are the same for all words. */
const isSpeech = (value: string): boolean => value.startsWith('Speech/');

/** `drive counter`: the skill and the texts that it was given, IDs by their last name. */
export function labelOf(entity: string, parameters: string): string {
  const words = parametersOf(parameters).map(([, value]) => value).filter((value): value is string => typeof value === 'string' && value !== '' && !isSpeech(value));
  return [shortName(entity), ...words.map((word) => (isId(word) ? shortName(parseId(word).entity) : word))].join(' ').slice(0, 60);
}

/** Executions from the events of one skill, in the order of their starts; those that ended before `from` are left out. */
export function executionsOf(entity: string, events: readonly SkillEvent[], from: bigint): Execution[] {
  const found = new Map<bigint, Execution>();
  const known = (start: bigint): Execution => found.get(start) ?? { entity, start, outcome: 'running', label: shortName(entity), reason: '', request: '' };
  for (const event of [...events].sort((a, b) => (a.time < b.time ? -1 : a.time > b.time ? 1 : 0))) {
    const before = known(event.started);
    found.set(event.started, {
      ...before, label: event.parameters === '' ? before.label : labelOf(entity, event.parameters), request: event.request || before.request, reason: event.reason || before.reason,
      ...(event.stage === 'ended' ? { end: event.time, outcome: event.outcome } : {}),
    });
    // What began before the first event that was asked for is told by those that run on.
    for (const start of event.running) if (!found.has(start)) found.set(start, known(start));
  }
  return [...found.values()].filter((one) => one.end === undefined || one.end >= from).sort((a, b) => (a.start < b.start ? -1 : a.start > b.start ? 1 : 0));
}

export interface Slot {
  readonly row: number;
  /** How many rows those have that overlap with it, directly or by others. */
  readonly of: number;
}

/** Puts executions that overlap into rows of their own; the last of at most `max` rows takes what fits nowhere. They come in the order of their starts. */
export function packed(executions: readonly Execution[], max: number): Slot[] {
  const slots: { row: number; of: number }[] = [];
  let group: { row: number; of: number }[] = [];
  // When each row of the group is free; null: never.
  let ends: (bigint | null)[] = [];
  for (const one of executions) {
    if (ends.every((end) => end !== null && end <= one.start)) [group, ends] = [[], []];
    let row = ends.findIndex((end) => end !== null && end <= one.start);
    if (row < 0) row = Math.min(ends.length, max - 1);
    const before = ends[row];
    ends[row] = before === null || one.end === undefined ? null : before !== undefined && before > one.end ? before : one.end;
    const slot = { row, of: 0 };
    group.push(slot);
    slots.push(slot);
    for (const other of group) other.of = ends.length;
  }
  return slots;
}

/** `planner` of `Skill/ExecutionRequest/planner/drive/...`: who asked. */
export const requesterOf = (id: string): string => nameOf(splitLevels(id)[2] ?? '');
