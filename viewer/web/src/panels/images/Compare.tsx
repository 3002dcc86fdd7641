// SPDX-License-Identifier: Apache-2.0
import { createEffect, createSignal, onCleanup, Show } from 'solid-js';
import { prefersStill } from '../../ui/theme';
import type { Tile } from './load';
import { Bitmap, captionOf } from './PictureTile';

/** Two pictures in one place, by turns or with a line between them that can be dragged. */
export function Compare(props: { first: Tile; second: Tile; mode: 'blink' | 'slide' }) {
  const [isSecond, setSecond] = createSignal(false);
  const [share, setShare] = createSignal(50);
  // Who asked for reduced motion turns the pictures over by hand.
  createEffect(() => {
    if (props.mode !== 'blink' || prefersStill()) return;
    const timer = setInterval(() => setSecond((is) => !is), 600);
    onCleanup(() => clearInterval(timer));
  });
  const both = () => (props.first.picture && props.second.picture ? { first: props.first.picture, second: props.second.picture } : null);
  const clip = () => (props.mode === 'slide' ? `inset(0 0 0 ${share()}%)` : isSecond() ? 'none' : 'inset(0 0 0 100%)');
  return (
    <Show when={both()} fallback={<p class="missing">{props.first.missing ?? props.second.missing ?? 'There is only one form of this moment, so there is nothing to compare.'}</p>}>
      {(pictures) => (
        <figure class="compare">
          <div class="compare-stack">
            <Bitmap bitmap={pictures().first.bitmap} label={`${props.first.title} ${captionOf(props.first)}`} />
            <div class="compare-over" style={{ 'clip-path': clip() }}><Bitmap bitmap={pictures().second.bitmap} label={`${props.second.title} ${captionOf(props.second)}`} /></div>
          </div>
          <figcaption>
            <Show when={props.mode === 'slide'} fallback={<button class="swap" onClick={() => setSecond(!isSecond())} aria-pressed={isSecond()}>{isSecond() ? props.second.title : props.first.title}</button>}>
              <label class="slide-label"><span>{props.first.title}</span><input type="range" min="0" max="100" value={share()} aria-label={`Line between ${props.first.title} and ${props.second.title}`} onInput={(event) => setShare(Number(event.currentTarget.value))} /><span>{props.second.title}</span></label>
            </Show>
            <span class="muted">{captionOf(props.second)}</span>
          </figcaption>
        </figure>
      )}
    </Show>
  );
}
