// SPDX-License-Identifier: Apache-2.0
// Whether the cursor is on its way. Moving pictures may be JPEG; those at rest are exact.
import { createEffect, createSignal, on } from 'solid-js';
import { cursor } from './store';

const kRestMs = 220;
const [isMoving, setMoving] = createSignal(false);
const [restCursor, setRestCursor] = createSignal(0n);
export { isMoving, restCursor };

/** Call once, below a root of Solid. */
export function watchMoving(): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  createEffect(on(cursor, (at) => {
    clearTimeout(timer);
    setMoving(true);
    timer = setTimeout(() => {
      setMoving(false);
      setRestCursor(at);
    }, kRestMs);
  }));
}
