// SPDX-License-Identifier: Apache-2.0
// Asks for what the lanes of skills show: events of the stretch of time on the screen where they can
// be told apart there, and outcomes per pixel of skills that have more.
import { createMemo, type Accessor } from 'solid-js';
import { decodeDensity, decodeSeries } from '../api/binary';
import { getBinary, getJson } from '../api/client';
import { links, moment } from '../api/types';
import { parseId, queryNames } from '../state/ids';
import { createRequest, type Request } from '../state/request';
import { newsOf, ownLast } from '../state/store';
import { formatTime } from '../time/format';
import { lengthOf, type Span } from '../time/span';
import { wider } from '../timeline/density';
import { eventOf, executionsOf, kOutcomes, queryAnswer, type Execution } from './executions';
import { askedFor, eventsIn, isExecuted, type DenseLane, type Snapshot } from './lanes';

/** Events of all lanes on the screen that are asked for one by one, about 1 kB each. */
const kMaxEvents = 1500;
/** Executions whose end lies behind the screen, for which it is looked for. */
const kMaxOpen = 16;

export interface AskedLanes {
  readonly snapshots: ReadonlyMap<string, readonly Snapshot[]>;
  readonly executions: ReadonlyMap<string, readonly Execution[]>;
  readonly dense: ReadonlyMap<string, DenseLane>;
}

/** Those with the fewest events come first, so that one busy skill does not hide all others. */
export function chosenFor(counts: ReadonlyMap<string, number>, max: number): Set<string> {
  let left = max;
  return new Set([...counts].sort((a, b) => a[1] - b[1]).filter(([, count]) => (left -= count) >= 0).map(([id]) => id));
}

/** The stretch that is asked for: it stays while the screen is in it and shows a good part of it. */
export function keptWindow(before: Span | undefined, view: Span): Span {
  const isEnough = before !== undefined && before.from <= view.from && before.to >= view.to && lengthOf(before) <= 4n * lengthOf(view);
  return isEnough ? before : wider(view);
}

/** Parts of a list: a question has at most 80 KiB, and a query at most 1,024 selectors. */
export const partsOf = <T>(list: readonly T[], size: number): T[][] => Array.from({ length: Math.ceil(list.length / size) }, (_, i) => list.slice(i * size, (i + 1) * size));
const kAskedAtOnce = 100;

async function countsOf(ids: readonly string[], { from, to }: Span, signal: AbortSignal): Promise<Map<string, number>> {
  const sum = (part: Uint32Array) => part.reduce((a, b) => a + b, 0);
  const parts = await Promise.all(partsOf(ids, kAskedAtOnce).map(async (part) => {
    const { buffer } = await getBinary('density', { entity: part, from, to, pixels: 2 }, signal);
    return decodeDensity(buffer, part.length, 2).map((lane, i) => [part[i]!, sum(lane.recorded) + sum(lane.latent) + sum(lane.augmented)] as const);
  }));
  return new Map(parts.flat());
}

async function snapshotsOf(ids: readonly string[], { from, to }: Span, signal: AbortSignal): Promise<Map<string, Snapshot[]>> {
  // The event before the first one on the screen tells what ran there.
  const branch = (id: string) => `${queryNames(id)} @ ${isExecuted(id) ? `at-or-before:${formatTime(from)}, ` : ''}${formatTime(from)}..${formatTime(to)}`;
  const answers = await Promise.all(partsOf(ids, kAskedAtOnce).map((part) => getJson('query', { q: part.map(branch).join(' ; ') }, queryAnswer, signal)));
  return new Map(answers.flatMap(({ entities }) => entities).map((entity) => [entity.id, entity.snapshots.map((one) => ({ id: one.id, data: one.instances[0]?.data }))]));
}

/** Outcomes of each pixel; where one has several, that of the highest number, so that no failure is hidden by a success. */
async function denseOf(id: string, span: Span, pixels: number, signal: AbortSignal): Promise<DenseLane> {
  const { buffer } = await getBinary('series', { entity: id, path: ['outcome', 'stage'], ...span, pixels }, signal);
  const [outcome, stage] = decodeSeries(buffer, 2, pixels);
  return { ...span, outcomes: Array.from(outcome!.max, (value) => kOutcomes[value]), isRunning: Array.from(stage!.last, (value) => value < 2) };
}

/** Looks for the end of an execution behind the screen: what links to its start is of it. */
async function endOf(one: Execution, signal: AbortSignal): Promise<Execution> {
  const { from } = await getJson('links', { id: `${one.entity}/${one.start}` }, links, signal);
  const times = from.map(parseId).filter((id) => id.entity === one.entity && id.time !== undefined).map((id) => id.time!);
  if (times.length === 0) return one;
  const found = await getJson('moment', { entity: one.entity, at: times.reduce((a, b) => (b > a ? b : a)), which: 'exact' }, moment, signal);
  const event = eventOf(found.id, found.instances[0]?.data);
  return event?.stage === 'ended' && event.started === one.start ? { ...one, end: event.time, outcome: event.outcome, reason: event.reason } : one;
}

async function askLanes(entities: readonly string[], span: Span, pixels: number, lasts: ReadonlyMap<string, bigint>, signal: AbortSignal): Promise<AskedLanes> {
  const ids = askedFor(entities);
  const counts = await countsOf(ids, span, signal);
  const few = chosenFor(counts, kMaxEvents);
  const [snapshots, crowds] = await Promise.all([
    snapshotsOf([...few], span, signal),
    Promise.all(entities.filter((id) => isExecuted(id) && !few.has(id)).map(async (id) => [id, await denseOf(id, span, pixels, signal)] as const)),
  ]);
  const executions = new Map<string, readonly Execution[]>();
  for (const id of entities.filter((one) => isExecuted(one) && few.has(one))) executions.set(id, executionsOf(id, eventsIn(snapshots.get(id) ?? []), span.from));
  let left = kMaxOpen;
  for (const [id, all] of executions) {
    if ((lasts.get(id) ?? span.to) <= span.to) continue;
    // Where its links cannot be read, an execution is drawn as one whose end is not known.
    executions.set(id, await Promise.all(all.map((one) => (one.end === undefined && left-- > 0 ? endOf(one, signal).catch(() => one) : one))));
  }
  return { snapshots, executions, dense: new Map(crowds) };
}

/** Asks anew when the screen leaves what was asked for, and when an entity has news. */
export function createLanes(entities: Accessor<readonly string[]>, view: Accessor<Span>, pixels: Accessor<number>): Request<AskedLanes> {
  const span = createMemo<Span | undefined>((before) => (entities().length === 0 ? undefined : keptWindow(before, view())), undefined, { equals: (a, b) => a?.from === b?.from && a?.to === b?.to });
  const news = createMemo(() => askedFor(entities()).map(newsOf).join());
  return createRequest(() => {
    const [here, ids] = [span(), entities()];
    const width = Math.min(4000, Math.round(pixels()));
    news();
    if (!here || ids.length === 0 || width < 2) return null;
    const lasts = new Map(ids.map((id) => [id, ownLast(id)]));
    return { group: 'skills', run: (signal) => askLanes(ids, here, width, lasts, signal) };
  });
}
