// SPDX-License-Identifier: Apache-2.0
import { createEffect, createSignal, onCleanup } from 'solid-js';
import { kTimelineRange, setTimelineHeight, timelineHeight } from '../state/store';

/** A handle below something that changes its height; by drag, or by arrow keys. Home gives back the height that it has by itself. */
export function HeightHandle(props: { class: string; label: string; height: number; range: { readonly min: number; readonly max: number }; onHeight: (height: number | null) => void }) {
  let from: { y: number; height: number } | null = null;
  const set = (value: number) => props.onHeight(Math.max(props.range.min, Math.min(props.range.max, Math.round(value))));
  return (
    <div class={props.class} role="separator" tabindex="0" aria-orientation="horizontal" aria-label={props.label} aria-valuemin={props.range.min} aria-valuemax={props.range.max} aria-valuenow={props.height} title={`${props.label}: drag, or use arrow keys; a double click or Home makes it automatic`}
      onPointerDown={(event) => { if (event.button !== 0) return; event.currentTarget.setPointerCapture(event.pointerId); from = { y: event.clientY, height: props.height }; }}
      onPointerMove={(event) => { if (from && event.clientY !== from.y) set(from.height + event.clientY - from.y); }} onPointerUp={() => { from = null; }} onPointerCancel={() => { from = null; }}
      onDblClick={() => props.onHeight(null)}
      onKeyDown={(event) => {
        if (event.altKey || event.ctrlKey || event.metaKey) return;
        const by = (event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0) * (event.shiftKey ? 100 : 10);
        if (by !== 0) set(props.height + by);
        else if (event.key === 'Home') props.onHeight(null);
        else return;
        event.preventDefault();
        event.stopPropagation();
      }} />
  );
}

/** Divides the height between timeline and panels. */
export function Splitter() {
  const [screen, setScreen] = createSignal(innerHeight);
  const onResize = () => setScreen(innerHeight);
  addEventListener('resize', onResize);
  onCleanup(() => removeEventListener('resize', onResize));
  const height = () => timelineHeight() ?? Math.round(Math.max(kTimelineRange.min, Math.min(330, screen() * 0.36)));
  createEffect(() => document.documentElement.style.setProperty('--timeline-height', `${height()}px`));
  return <HeightHandle class="splitter" label="Height of the timeline" height={height()} range={kTimelineRange} onHeight={setTimelineHeight} />;
}
