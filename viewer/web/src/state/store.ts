// SPDX-License-Identifier: Apache-2.0
// What the person looks at: one cursor for everything, one stretch of time, one chosen entity.
// Panels read these signals; only the functions here write them.
import { batch, createMemo as createOwnedMemo, createRoot, createSignal } from 'solid-js';
import { askedMemory } from '../api/client';
import type { Info, TreeNode } from '../api/types';
import { clampTime, homeOf, limitsOf, showing, within, type Span } from '../time/span';
import type { PanelKind, PanelState, ViewState } from './url';

export interface Panel extends Omit<PanelState, 'height'> {
  /** Names the panel while the page lives, whatever its place. */
  readonly key: number;
}

/** These live as long as the page, so nobody else owns them. */
const createMemo = <T>(compute: () => T): (() => T) => createRoot(() => createOwnedMemo(compute));

const kNoSpan: Span = { from: 0n, to: 1_000_000_000n };

const [info, setInfo] = createSignal<Info>();
const [roots, setRoots] = createSignal<TreeNode[]>([]);
const [view, setViewSignal] = createSignal<Span>(kNoSpan);
const [cursor, setCursorSignal] = createSignal(0n);
const [hover, setHover] = createSignal<bigint | null>(null);
const [selection, setSelection] = createSignal<Span | null>(null);
const [selected, setSelected] = createSignal('');
const [collapsed, setCollapsed] = createSignal<ReadonlySet<string>>(new Set());
const [panels, setPanels] = createSignal<readonly Panel[]>([]);
const [marks, setMarks] = createSignal<readonly bigint[]>([]);
const [liveLast, setLiveLast] = createSignal<bigint | null>(null);
const [notice, setNotice] = createSignal('');

export { collapsed, cursor, hover, info, liveLast, marks, notice, panels, roots, selected, selection, setHover, setInfo, setLiveLast, setMarks, setRoots, setSelected, setSelection, view };

/** The time of the last snapshot of the memory: behind it everything is prediction. */
export const last = createMemo(() => {
  const told = info()?.last ?? kNoSpan.to;
  const live = liveLast();
  return live !== null && live > told ? live : told;
});

export const limits = createMemo<Span>(() => {
  const known = info();
  return known ? limitsOf(known.first, last(), known.max_horizon_ns) : kNoSpan;
});

export const home = createMemo<Span>(() => homeOf(info()?.first ?? 0n, last(), limits()));

export const isFuture = createMemo(() => cursor() > last());

export const setView = (next: Span): void => { setViewSignal(within(next, limits())); };

/** Moves the pinned cursor; `reveal` brings it onto the screen. */
export function setCursor(time: bigint, reveal = true): void {
  batch(() => {
    const at = clampTime(time, limits());
    setCursorSignal(at);
    if (reveal) setViewSignal(showing(view(), at, limits()));
  });
}

export function toggleCollapsed(id: string): void {
  const next = new Set(collapsed());
  if (!next.delete(id)) next.add(id);
  setCollapsed(next);
}

const index = createMemo(() => {
  const all = new Map<string, TreeNode>();
  const visit = (node: TreeNode): void => {
    all.set(node.id, node);
    node.children?.forEach(visit);
  };
  roots().forEach(visit);
  return all;
});

export const nodeOf = (id: string): TreeNode | undefined => index().get(id);

/** The newest snapshots that a live memory told of, by entity. */
const [told, setTold] = createSignal<ReadonlyMap<string, bigint>>(new Map());
export const setLiveLasts = (newest: ReadonlyMap<string, bigint>): void => { setTold(new Map([...told(), ...newest])); };

/** How often commits were not told: too many came at once, or the server was lost for a while. */
const [gaps, setGaps] = createSignal(0);
export const noteGap = (): void => { setGaps(gaps() + 1); };

/** Changes when an entity may have snapshots that were not there before. */
export const newsOf = (entity: string): string => `${gaps()} ${told().get(entity) ?? ''}`;

/** The time of the last snapshot of an entity; that of the memory where nobody told it. */
export function ownLast(entity: string): bigint {
  const [live, known] = [told().get(entity), nodeOf(entity)?.last];
  return live !== undefined && (known === undefined || live > known) ? live : known ?? last();
}
export const entities = createMemo(() => [...index().values()].filter((node) => node.level === 'entity'));

/** Puts children that were asked for later into the tree. */
export function setChildren(id: string, children: TreeNode[]): void {
  const replace = (node: TreeNode): TreeNode =>
    node.id === id ? { ...node, children } : node.children ? { ...node, children: node.children.map(replace) } : node;
  setRoots(roots().map(replace));
}

let nextKey = 1;
const [revealed, setRevealed] = createSignal({ key: 0 });
/** The panel that was asked for last; it is brought onto the screen. */
export { revealed };

export function openPanel(kind: PanelKind, entity: string, paths: readonly string[] = [], options: Record<string, string> = {}): Panel {
  const there = panels().find((panel) => panel.kind === kind && panel.entity === entity && paths.every((path) => panel.paths.includes(path)));
  const panel = there ?? { key: nextKey++, kind, entity, paths, options };
  if (!there) setPanels([...panels(), panel]);
  setRevealed({ key: panel.key });
  return panel;
}

export const closePanel = (key: number): void => { setPanels(panels().filter((panel) => panel.key !== key)); };

export function updatePanel(key: number, change: Partial<PanelState>): void {
  setPanels(panels().map((panel) => (panel.key === key ? { ...panel, ...change } : panel)));
}

export const setOption = (panel: Panel, key: string, value: string): void => updatePanel(panel.key, { options: { ...panel.options, [key]: value } });

/** Several options at once; those that are empty are taken out of the address. */
export const setOptions = (panel: Panel, options: Readonly<Record<string, string>>): void => updatePanel(panel.key, { options: Object.fromEntries(Object.entries({ ...panel.options, ...options }).filter(([, value]) => value !== '')) });

/** The inspector and similar moments stand beside the other panels. */
export const isSide = (kind: PanelKind): boolean => kind === 'inspector' || kind === 'similar';

/** The panels that one can change places with, itself included. */
export function neighboursOf(key: number): readonly Panel[] {
  const own = panels().find((panel) => panel.key === key);
  return own ? panels().filter((panel) => isSide(panel.kind) === isSide(own.kind)) : [];
}

/** Moves a panel to the place of another one, which moves on towards where it came from. */
export function takePlace(key: number, target: number): void {
  const next = [...panels()];
  const [from, to] = [key, target].map((one) => next.findIndex((panel) => panel.key === one)) as [number, number];
  if (from < 0 || to < 0) return;
  next.splice(to, 0, ...next.splice(from, 1));
  setPanels(next);
}

/** Moves a panel `by` places forward or back; false if it stands at the end. */
export function movePanel(key: number, by: number): boolean {
  const all = neighboursOf(key);
  const target = all[all.findIndex((panel) => panel.key === key) + by];
  if (target) takePlace(key, target.key);
  return target !== undefined;
}

/** Heights that a person gave to panels, by their keys. They are apart, so that no panel asks again for them. */
const [heights, setHeights] = createSignal<ReadonlyMap<number, number>>(new Map());
export const kPanelRange = { min: 120, max: 2000 } as const;
export const kTimelineRange = { min: 140, max: 900 } as const;
export const heightOf = (key: number): number | undefined => heights().get(key);

/** Null gives back the height that a panel has by itself. */
export function setHeight(key: number, height: number | null): void {
  const next = new Map(heights());
  if (height === null) next.delete(key);
  else next.set(key, height);
  setHeights(next);
}

/** Null: a part of the window. */
export const [timelineHeight, setTimelineHeight] = createSignal<number | null>(null);

let noticeTimer: ReturnType<typeof setTimeout> | undefined;

/** Says something for some seconds, at the foot of the page and to screen readers. */
export function say(text: string): void {
  clearTimeout(noticeTimer);
  setNotice(text);
  noticeTimer = setTimeout(() => setNotice(''), 5000);
}

export const currentState = (): ViewState => ({
  ...(askedMemory() > 0 ? { memory: askedMemory() } : {}),
  cursor: cursor(), view: view(), ...(selection() ? { selection: selection()! } : {}), selected: selected(), collapsed: [...collapsed()],
  panels: panels().map(({ key, kind, entity, paths, options }) => ({ kind, entity, paths, options, ...(heights().has(key) ? { height: heights().get(key)! } : {}) })),
  ...(timelineHeight() === null ? {} : { timeline: timelineHeight()! }),
});

export function applyState(state: ViewState): void {
  batch(() => {
    if (state.view) setView(state.view);
    if (state.cursor !== undefined) setCursor(state.cursor, false);
    setSelection(state.selection ?? null);
    if (state.selected !== undefined) setSelected(state.selected);
    if (state.collapsed) setCollapsed(new Set(state.collapsed));
    const inRange = (height: number, range: { min: number; max: number }) => Math.max(range.min, Math.min(range.max, height));
    setTimelineHeight(state.timeline === undefined ? null : inRange(state.timeline, kTimelineRange));
    if (!state.panels) return;
    const opened = state.panels.map(({ height, ...panel }) => ({ panel: { ...panel, key: nextKey++ }, height }));
    setHeights(new Map(opened.flatMap(({ panel, height }) => (height === undefined ? [] : [[panel.key, inRange(height, kPanelRange)] as const]))));
    setPanels(opened.map(({ panel }) => panel));
  });
}
