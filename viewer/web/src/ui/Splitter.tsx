// SPDX-License-Identifier: Apache-2.0
import { createEffect, createSignal } from 'solid-js';

const kLeast = 140;
const kMost = 900;

/** Divides the height between timeline and panels; by drag, or by arrow keys. */
export function Splitter() {
  const [height, setHeight] = createSignal(Math.round(Math.max(kLeast, Math.min(330, innerHeight * 0.36))));
  let from: { y: number; height: number } | null = null;
  const set = (value: number) => setHeight(Math.max(kLeast, Math.min(kMost, Math.round(value))));
  createEffect(() => document.documentElement.style.setProperty('--timeline-height', `${height()}px`));
  return (
    <div class="splitter" role="separator" tabindex="0" aria-orientation="horizontal" aria-label="Height of the timeline" aria-valuemin={kLeast} aria-valuemax={kMost} aria-valuenow={height()}
      onPointerDown={(event) => { event.currentTarget.setPointerCapture(event.pointerId); from = { y: event.clientY, height: height() }; }}
      onPointerMove={(event) => { if (from) set(from.height + event.clientY - from.y); }} onPointerUp={() => { from = null; }}
      onKeyDown={(event) => {
        const by = (event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0) * (event.shiftKey ? 100 : 10);
        if (by === 0) return;
        event.preventDefault();
        event.stopPropagation();
        set(height() + by);
      }} />
  );
}
