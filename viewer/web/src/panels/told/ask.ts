// SPDX-License-Identifier: Apache-2.0
// What is known of an execution: its start, its reports, its end, its request, and why.
import { ApiError, getJson } from '../../api/client';
import { Turns } from '../../api/turns';
import { links as linksDecoder, moment as momentDecoder, type Moment } from '../../api/types';
import { parseId } from '../../state/ids';
import type { ExecutionKey } from '../../state/executions';
import { eventOf, linkOf, linksOf, textIn, type SkillEvent } from '../../skills/executions';
import { followCauses, type Step } from './why';

/** Reports of an execution that are read; of more, the last ones. */
const kMaxReports = 60;

export interface ToldEvent extends SkillEvent {
  readonly result: string;
  readonly results: readonly string[];
  readonly stoppedBy: readonly string[];
}

export interface Told {
  readonly key: ExecutionKey;
  /** The start where it is known, reports, and the end if there is one, in the order of time. */
  readonly events: readonly ToldEvent[];
  readonly omitted: number;
  readonly why: readonly Step[];
}

/** What was forgotten meanwhile is told as gone; all other errors are those of the whole question. */
const ifGone = <T>(value: T) => (error: unknown): T => { if (error instanceof ApiError && error.code === 'not found') return value; throw error; };

export function loaderOf(signal: AbortSignal): (id: string) => Promise<Moment | null> {
  const turns = new Turns(4);
  return (id) => turns.run(async () => {
    const { entity, time } = parseId(id);
    if (time === undefined) return null;
    return getJson('moment', { entity, at: time, which: 'exact' }, momentDecoder, signal).catch(ifGone(null));
  }, signal);
}

function toldOf(moment: Moment | null): ToldEvent | undefined {
  const data = moment?.instances[0]?.data as Record<string, unknown> | undefined;
  const event = moment && data ? eventOf(moment.id, data) : undefined;
  return event && { ...event, result: textIn(data, 'result'), results: linksOf(data!.results), stoppedBy: linksOf(data!.stopped_by) };
}

/** The execution that an event is of. */
export function executionIn(moment: Moment): ExecutionKey | null {
  const { entity } = parseId(moment.id);
  const event = entity.startsWith('Skill/Event/') && moment.source !== 'predicted' ? eventOf(moment.id, moment.instances[0]?.data) : undefined;
  return event ? { entity, start: event.started } : null;
}

export async function askExecution(key: ExecutionKey, signal: AbortSignal): Promise<Told> {
  const load = loaderOf(signal);
  const startId = `${key.entity}/${key.start}`;
  const own = (await getJson('links', { id: startId }, linksDecoder, signal).catch(ifGone({ from: [] as string[] }))).from
    .filter((id) => parseId(id).entity === key.entity).sort((a, b) => (parseId(a).time! < parseId(b).time! ? -1 : 1));
  const shown = own.slice(-kMaxReports);
  const events = (await Promise.all([startId, ...shown].map(load))).map(toldOf).filter((one) => one !== undefined && one.started === key.start) as ToldEvent[];
  const request = events.map((one) => one.request).find((id) => id !== '');
  return { key, events, omitted: own.length - shown.length, why: request ? await followCauses([request], load) : [] };
}

/** Why a request, a refusal or a drive: from the links of its own value. */
export async function askWhy(moment: Moment, signal: AbortSignal): Promise<Step[]> {
  const data = moment.instances[0]?.data as Record<string, unknown> | undefined;
  const causes = ['request', 'plan', 'cause'].map((key) => linkOf(data?.[key])).concat(linksOf(data?.causes));
  return followCauses(causes, loaderOf(signal));
}
