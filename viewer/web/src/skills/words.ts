// SPDX-License-Identifier: Apache-2.0
// Executions in words, for who does not see bars and for who wants to know.
import { formatDuration } from '../time/format';
import type { Execution, Outcome } from './executions';
import type { Hit } from './draw';

export const kOutcomeWords: Record<Outcome, string> = { running: 'runs', success: 'success', failure: 'failure', stopped: 'stopped', lost: 'lost' };

/** `drive counter: success after 6.2 s: stands at 'counter'`. */
export function describeExecution(one: Execution): string {
  const took = one.end === undefined ? '' : ` after ${formatDuration(one.end - one.start)}`;
  return `${one.label}: ${kOutcomeWords[one.outcome]}${took}${one.reason === '' ? '' : `: ${one.reason}`}`;
}

export const describeHit = (hit: Hit): string => ('mark' in hit ? hit.mark.what : describeExecution(hit.execution));
