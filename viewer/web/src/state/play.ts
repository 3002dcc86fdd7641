// SPDX-License-Identifier: Apache-2.0
// Moves the cursor as time goes by, at a speed.
import { createEffect, createSignal, onCleanup } from 'solid-js';
import { cursor, last, limits, setCursor } from './store';

export const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 5, 10, 60] as const;
export const [isPlaying, setPlaying] = createSignal(false);
export const [speed, setSpeed] = createSignal(1);

export const togglePlay = (): void => {
  if (!isPlaying() && cursor() >= last()) setCursor(limits().from);
  setPlaying(!isPlaying());
};

/** Call once, below a root of Solid. */
export function watchPlay(): void {
  createEffect(() => {
    if (!isPlaying()) return;
    const rate = speed();
    let before = performance.now();
    let handle = 0;
    const tick = (now: number): void => {
      // At most a quarter of a second: a page that was hidden must not jump ahead.
      const elapsed = Math.min(250, now - before);
      before = now;
      const next = cursor() + BigInt(Math.round(elapsed * rate * 1e6));
      setCursor(next);
      if (next >= last()) return void setPlaying(false);
      handle = requestAnimationFrame(tick);
    };
    handle = requestAnimationFrame(tick);
    onCleanup(() => cancelAnimationFrame(handle));
  });
}
