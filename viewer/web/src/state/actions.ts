// SPDX-License-Identifier: Apache-2.0
// What buttons and keys do. Both call the same functions.
import { getJson } from '../api/client';
import { step } from '../api/types';
import { formatTime } from '../time/format';
import { zoom, type Span } from '../time/span';
import { parseId, queryNames } from './ids';
import { currentState, cursor, home, info, last, limits, ownLast, roots, say, selected, selection, setCursor, setSelected, setSelection, setView, view } from './store';
import { pythonIndex } from './paths';
import { messageOf } from './request';
import { encodeState } from './url';

/** Copies a text and says so; where the browser forbids it, the text is shown instead. */
export async function copy(text: string, what: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    say(`Copied ${what}.`);
  } catch {
    say(`The browser does not allow copying; ${what}: ${text}`);
  }
}

let stepping = false;

/** Goes to the snapshot of the chosen entity `by` snapshots away. */
export async function stepBy(by: number): Promise<void> {
  const entity = selected();
  if (entity === '' || stepping) return;
  stepping = true;
  try {
    // Past the last snapshot steps are of 100 ms, because there are no snapshots to step by.
    if (cursor() > last() || (by > 0 && cursor() >= ownLast(entity))) {
      setCursor(cursor() + BigInt(by) * 100_000_000n);
    } else setCursor((await getJson('step', { entity, at: cursor(), by }, step)).time);
  } catch (error) {
    say(messageOf(error));
  } finally {
    stepping = false;
  }
}

export const zoomBy = (factor: number): void => {
  const here = view();
  const share = Number(cursor() - here.from) / Number(here.to - here.from);
  setView(zoom(here, (share >= 0 && share <= 1 ? share : 0.5) * 1000, 1000, factor, limits()));
};

export const showAll = (): void => setView(home());
export const goFirst = (): void => setCursor(info()?.first ?? 0n);
export const goLast = (): void => setCursor(last());
export const goFuture = (): void => setCursor(last() + 400_000_000n);

/** Follows a link: chooses the entity, and goes to its time if it has one. */
export function follow(id: string): void {
  const parts = parseId(id);
  setSelected(parts.entity);
  if (parts.time !== undefined) setCursor(parts.time);
}

export function selectSpan(span: Span | null): void {
  setSelection(span && span.to < span.from ? { from: span.to, to: span.from } : span);
}

/** Begins or ends the selection at the cursor. */
export function selectFrom(edge: 'from' | 'to'): void {
  const here = selection() ?? view();
  const next = { ...here, [edge]: cursor() };
  if (next.to > next.from) selectSpan(next);
  else selectSpan(edge === 'from' ? { from: cursor(), to: view().to > cursor() ? view().to : cursor() + 1n } : { from: view().from < cursor() ? view().from : cursor() - 1n, to: cursor() });
}

const quote = (text: string): string => `'${text.replace(/'/g, `'\\''`)}'`;
/** As a shell takes it, without quotes where it needs none. */
export const word = (text: string): string => quote(text).replace(/^'([\w./:-]+)'$/, '$1');

/** The query of the chosen entity (or everything) in the selection. */
export function selectionQuery(): string {
  const span = selection() ?? view();
  const names = selected() === '' ? roots().map((root) => queryNames(root.id)).join('|') : queryNames(selected());
  return `${names} @ ${formatTime(span.from)}..${formatTime(span.to)}`;
}

export function exportCommand(): string {
  const store = info()?.stores[0];
  // Only a store can be exported; a server is queried for the same.
  if (store && store.path === undefined) return `engram query --server ${word(store.name)} ${quote(selectionQuery())} --json`;
  return `engram export ${word(store?.path ?? 'STORE')} ${quote(selectionQuery())} --to jsonl -o exported`;
}
export const copyExport = (): Promise<void> => copy(exportCommand(), 'the command');
export const copyLink = (): Promise<void> => copy(`${location.origin}${location.pathname}${encodeState(currentState())}`, 'a link to this view');

export const momentQuery = (entity: string, time: bigint): string => `${queryNames(entity)} @ ${formatTime(time)}`;

export function pythonLine(entity: string, time: bigint, path = ''): string {
  const store = info()?.stores[0];
  const memory = store && store.path === undefined ? `engram.connect(${JSON.stringify(store.name)})` : `engram.open(${JSON.stringify(store?.path ?? 'STORE')})`;
  return `${memory}[${JSON.stringify(entity)}].at(${time}).value${pythonIndex(path)}`;
}
