// SPDX-License-Identifier: Apache-2.0
// Memory IDs as text: levels joined by '/', a '/' inside a name written '\/'.

export function splitLevels(id: string): string[] {
  const levels: string[] = [];
  let level = '';
  for (let i = 0; i < id.length; ++i) {
    if (id[i] === '\\' && i + 1 < id.length) level += id[i]! + id[++i]!;
    else if (id[i] === '/') {
      levels.push(level);
      level = '';
    } else level += id[i];
  }
  return id === '' ? [] : [...levels, level];
}

export const nameOf = (level: string): string => level.replace(/\\(.)/g, '$1');

export interface IdParts {
  readonly entity: string;
  readonly time?: bigint;
  readonly instance?: number;
}

const kTimeText = /^(\d{4}-\d\d-\d\d)[ T](\d\d:\d\d:\d\d)(?:\.(\d{1,9}))?Z?$/;

function readTime(text: string): bigint | undefined {
  if (/^-?\d{1,19}$/.test(text)) return BigInt(text);
  const match = kTimeText.exec(text);
  if (!match) return undefined;
  const ms = Date.parse(`${match[1]}T${match[2]}Z`);
  return Number.isNaN(ms) ? undefined : BigInt(ms) * 1_000_000n + BigInt((match[3] ?? '').padEnd(9, '0'));
}

/** Splits an ID of any level; a time may be nanoseconds or as Engram prints it. */
export function parseId(id: string): IdParts {
  const levels = splitLevels(id);
  const time = levels[4] === undefined ? undefined : readTime(levels[4]);
  const instance = levels[5] !== undefined && /^\d+$/.test(levels[5]) ? Number(levels[5]) : undefined;
  return { entity: levels.slice(0, 4).join('/'), time, instance };
}

/** The last name of an ID, which suffices where the row above tells the rest. */
export const shortName = (id: string): string => nameOf(splitLevels(id).at(-1) ?? id);

/** Names as a query takes them: what would be a regular expression or end them is escaped (docs/query.md). */
export const queryNames = (id: string): string => id.replace(/[.*+?()[\]{}|^$;@]|^ | $/g, '\\$&');
