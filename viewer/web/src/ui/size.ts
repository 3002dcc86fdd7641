// SPDX-License-Identifier: Apache-2.0
import { createSignal, onCleanup, type Accessor } from 'solid-js';

export interface Size {
  readonly width: number;
  readonly height: number;
}

/** The size of an element as it changes; give the function to `ref`. */
export function createSize(): [Accessor<Size>, (element: HTMLElement) => void] {
  const [size, setSize] = createSignal<Size>({ width: 0, height: 0 }, { equals: (a, b) => a.width === b.width && a.height === b.height });
  const observer = new ResizeObserver(([entry]) => {
    const box = entry!.contentRect;
    // A panel that is hidden for a while keeps the size that it will have again.
    if (box.width > 0) setSize({ width: Math.floor(box.width), height: Math.floor(box.height) });
  });
  onCleanup(() => observer.disconnect());
  return [size, (element) => observer.observe(element)];
}

/** Runs `draw` at most once per frame, however often it is asked to. */
export function perFrame(draw: () => void): () => void {
  let handle = 0;
  onCleanup(() => cancelAnimationFrame(handle));
  return () => {
    if (handle === 0) handle = requestAnimationFrame(() => { handle = 0; draw(); });
  };
}
