// SPDX-License-Identifier: Apache-2.0
// Why something was done: from a request, along links, up to the words that somebody said.
import type { Moment } from '../../api/types';
import { parseId, shortName } from '../../state/ids';
import { linkOf, linksOf, requesterOf, textIn } from '../../skills/executions';

export interface Step {
  readonly id: string;
  readonly what: string;
  /** What somebody said. */
  readonly quote?: string;
}

/** Members that lead to the cause of a snapshot. */
const kCauses = ['request', 'plan', 'causes', 'cause', 'command', 'execution'] as const;
const kMaxSteps = 12;

/** Identifies an instance whatever the form of its time. */
export const keyOfLink = (id: string): string => { const { entity, time } = parseId(id); return `${entity} ${time ?? ''}`; };

const dataOf = (moment: Moment | null, id: string): unknown => moment?.instances.find((one) => one.index === (parseId(id).instance ?? 0))?.data ?? moment?.instances[0]?.data;

export function stepOf(id: string, data: unknown): Step {
  const { entity } = parseId(id);
  const [said, goal] = [textIn(data, 'text'), textIn(data, 'goal')];
  if (said !== '') return { id, what: textIn(data, 'speaker') || shortName(entity), quote: said };
  if (entity.startsWith('Skill/ExecutionRequest/'))
    return { id, what: requesterOf(id) === 'conditions' ? `its condition, which starts ${textIn(data, 'skill')}` : `${requesterOf(id)} asked for ${textIn(data, 'skill')}` };
  if (entity.startsWith('Skill/Event/')) return { id, what: `the execution of ${textIn(data, 'skill')}` };
  if (goal !== '') return { id, what: `a plan: ${goal}` };
  return { id, what: shortName(entity) };
}

/** Follows causes, the nearest first; what was said ends a chain. `load` gives null where a snapshot is gone. */
export async function followCauses(links: readonly string[], load: (id: string) => Promise<Moment | null>): Promise<Step[]> {
  const steps: Step[] = [];
  const seen = new Set<string>();
  let level = [...links];
  while (level.length > 0 && steps.length < kMaxSteps) {
    const fresh = level.filter((id) => id !== '' && !seen.has(keyOfLink(id)) && seen.add(keyOfLink(id))).slice(0, kMaxSteps - steps.length);
    const found = await Promise.all(fresh.map(async (id) => ({ id, data: dataOf(await load(id), id) })));
    steps.push(...found.map(({ id, data }) => (data === undefined ? { id, what: `${shortName(parseId(id).entity)}, which is gone` } : stepOf(id, data))));
    level = found.flatMap(({ data }) => kCauses.flatMap((key) => { const value = (data as Record<string, unknown> | undefined)?.[key]; return Array.isArray(value) ? linksOf(value) : [linkOf(value)]; }));
  }
  return steps;
}
