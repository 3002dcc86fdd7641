// SPDX-License-Identifier: Apache-2.0
// What nights and reflections say, in words.
import type { Finding, Night, NightEntity, Reflection } from '../../api/nightTypes';
import { formatBytes, formatCount, formatDuration } from '../../time/format';

const of = (count: number, one: string, several = `${one}s`): string => `${formatCount(count)} ${count === 1 ? one : several}`;
const sumOf = (night: Night, key: 'encoded' | 'dropped' | 'forgotten' | 'faded' | 'waiting'): number => night.entities.reduce((sum, entity) => sum + entity[key], 0);

/** What a night did, in a line: "1 204 snapshots encoded, 3 new models". */
export function nightText(night: Night): string {
  const parts: string[] = [];
  const encoded = sumOf(night, 'encoded');
  if (encoded > 0) parts.push(`${of(encoded, 'snapshot')} encoded`);
  const models = night.entities.reduce((sum, entity) => sum + entity.models_added.length, 0);
  if (models > 0) parts.push(of(models, 'new model'));
  for (const [key, what] of [['dropped', 'left as latents alone'], ['faded', 'faded'], ['forgotten', 'forgotten'], ['waiting', 'waiting']] as const) {
    const count = sumOf(night, key);
    if (count > 0) parts.push(`${formatCount(count)} ${what}`);
  }
  return parts.length > 0 ? parts.join(', ') : 'nothing was to be done';
}

export const changeText = (before: number, after: number): string => {
  if (before === after) return `${formatBytes(after)}, as before`;
  const share = before > 0 ? ` (${after > before ? '+' : '−'}${Math.round((Math.abs(after - before) / before) * 100)} %)` : '';
  return `${formatBytes(before)} → ${formatBytes(after)}${share}`;
};

export const lengthText = (night: Night): string => formatDuration(night.ended - night.began);

export const modelsText = (entity: NightEntity): string => [...entity.models_added.map((version) => `+v${version}`), ...entity.models_removed.map((version) => `−v${version}`)].join(' ');

/** The time until which a reflection belongs to a night: the begin of the next one that learned. */
export function untilOf(nights: readonly Night[], index: number): bigint | undefined {
  for (let i = index - 1; i >= 0; --i) if (nights[i]!.work === 'consolidate') return nights[i]!.began;
  return undefined;
}

const kKinds: Readonly<Record<string, string>> = {
  gap: 'Snapshots are missing', rate: 'Another rate than usual', 'out-of-bounds': 'Out of bounds', 'not-finite': 'No finite number', frozen: 'Stands still', duplicate: 'The same value again',
  spike: 'A spike', jump: 'A jump', drift: 'Drifts', 'clock-drift': 'Its clock drifts', 'dead-link': 'A link leads nowhere', 'foreign-link': 'A link leads out of the store', 'link-time': 'A link to an unusual time',
  'time-shift': 'Its motion is early or late', 'broken-action': 'An action without its end', unreadable: 'Cannot be read',
};
export const kindText = (kind: string): string => kKinds[kind] ?? kind;

/** What was found as a sentence: "found a pause of 55 s, expected 50 ms". */
export const findingText = (finding: Finding): string =>
  `${finding.member ? `${finding.member}: ` : ''}found ${finding.found}${finding.count > 1 ? ` (${formatCount(finding.count)} times)` : ''}, expected ${finding.expected}`;

export function findingsText(reflection: Reflection): string {
  const faults = reflection.findings.filter((one) => one.severity === 'fault').length;
  const notes = reflection.findings.length - faults;
  return reflection.findings.length === 0 ? 'nothing odd was found' : [faults > 0 ? of(faults, 'fault') : '', notes > 0 ? of(notes, 'note') : ''].filter((part) => part !== '').join(' and ');
}
