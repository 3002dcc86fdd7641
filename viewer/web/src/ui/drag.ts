// SPDX-License-Identifier: Apache-2.0
// Panels change their order by dragging title bars: a dragged panel takes the place of the one that
// it is dropped on. Pointer events, because those of HTML's own dragging do not come from fingers.
import { createSignal } from 'solid-js';
import { neighboursOf, panels, say, takePlace } from '../state/store';

const kDragPixels = 5;
const kEdgePixels = 36;

export interface Dragged {
  readonly key: number;
  /** The panel whose place it would take. */
  readonly over: number | null;
}

export const [dragged, setDragged] = createSignal<Dragged | null>(null);

/** Says where a panel stands now, to those who do not see it. */
export function tellPlace(key: number, title: string): void {
  const all = neighboursOf(key);
  say(`${title} is now ${all.findIndex((panel) => panel.key === key) + 1} of ${all.length}.`);
}

/** Where a dragged panel would go: before the aimed one, or behind it. */
export function dropSide(key: number): 'before' | 'after' | null {
  const drag = dragged();
  if (drag === null || drag.over !== key) return null;
  const place = (one: number) => panels().findIndex((panel) => panel.key === one);
  return place(drag.key) > place(key) ? 'before' : 'after';
}

function panelAt(x: number, y: number, key: number): number | null {
  const found = Number(document.elementFromPoint(x, y)?.closest<HTMLElement>('[data-key]')?.dataset.key);
  return found !== key && neighboursOf(key).some((panel) => panel.key === found) ? found : null;
}

/** Lists that are longer than the screen go on while something is held at their edge. */
function scrollAtEdge(region: Element | null, y: number): void {
  if (!region) return;
  const box = region.getBoundingClientRect();
  const [top, bottom] = [Math.max(0, box.top), Math.min(innerHeight, box.bottom)];
  const by = y < top + kEdgePixels ? -14 : y > bottom - kEdgePixels ? 14 : 0;
  region.scrollBy(0, by);
  if (by !== 0) document.scrollingElement?.scrollBy(0, by);
}

/** Follows a pointer that went down on a title bar until it goes up; Escape gives up. */
export function startDrag(event: PointerEvent & { currentTarget: HTMLElement }, key: number, title: string): void {
  if (event.button !== 0 || (event.target as Element).closest('button, select, input, label')) return;
  const bar = event.currentTarget;
  const region = bar.closest('.panels-main, .panels-side');
  const stop = new AbortController();
  const end = (drops: boolean) => {
    stop.abort();
    const over = dragged()?.over ?? null;
    setDragged(null);
    if (!drops || over === null) return;
    takePlace(key, over);
    tellPlace(key, title);
  };
  const onMove = (move: PointerEvent) => {
    if (move.pointerId !== event.pointerId) return;
    if (dragged() === null && Math.hypot(move.clientX - event.clientX, move.clientY - event.clientY) < kDragPixels) return;
    scrollAtEdge(region, move.clientY);
    setDragged({ key, over: panelAt(move.clientX, move.clientY, key) });
  };
  const onKey = (pressed: KeyboardEvent) => {
    if (pressed.key !== 'Escape' || dragged() === null) return;
    pressed.preventDefault();
    pressed.stopPropagation();
    end(false);
    say(`${title} stays where it was.`);
  };
  const { signal } = stop;
  // From the first pixel on, because a quick hand leaves the bar with its first move.
  bar.setPointerCapture(event.pointerId);
  bar.addEventListener('pointermove', onMove, { signal });
  bar.addEventListener('pointerup', () => end(true), { signal });
  for (const lost of ['pointercancel', 'lostpointercapture']) bar.addEventListener(lost, () => end(false), { signal });
  addEventListener('keydown', onKey, { signal, capture: true });
}
