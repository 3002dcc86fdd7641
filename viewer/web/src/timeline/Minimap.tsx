// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, onCleanup, onMount } from 'solid-js';
import { last, limits, roots, setView, view } from '../state/store';
import { lengthOf, pan, timeAt, zoom } from '../time/span';
import { createSize, perFrame } from '../ui/size';
import { sized, theme } from '../ui/theme';
import { createDensity } from './density';
import { drawMinimap } from './draw';
import { listen } from './gestures';

/** The whole life in one strip; the frame in it is what the lanes show. */
export function Minimap() {
  const [size, sizeRef] = createSize();
  let box!: HTMLDivElement;
  let canvas!: HTMLCanvasElement;
  const ids = createMemo(() => roots().map((root) => root.id).slice(0, 12));
  const density = createDensity(ids, limits, () => size().width, 10_000_000_000n);
  const paint = perFrame(() => {
    const { width, height } = size();
    if (width > 0) drawMinimap(sized(canvas, width, height), density.data(), view(), limits(), last(), width, height, theme());
  });
  createEffect(() => { size(); density.data(); view(); limits(); last(); theme(); paint(); });
  onMount(() => {
    const centre = (x: number) => {
      const time = timeAt(Math.max(0, Math.min(size().width, x)), limits(), size().width);
      const half = lengthOf(view()) / 2n;
      setView({ from: time - half, to: time - half + lengthOf(view()) });
    };
    onCleanup(listen(box, {
      zoom: (x, factor) => {
        const share = Number(timeAt(x, limits(), size().width) - view().from) / Number(lengthOf(view()));
        setView(zoom(view(), Math.max(0, Math.min(1, share)) * 1000, 1000, factor, limits()));
      },
      pan: (dx) => setView(pan(view(), dx, size().width, limits())),
      hover: () => {},
      pick: centre,
      scrub: centre,
      select: (from, to) => {
        const [a, b] = [timeAt(Math.min(from, to), limits(), size().width), timeAt(Math.max(from, to), limits(), size().width)];
        if (b > a) setView({ from: a, to: b });
      },
      isScrubbing: () => true,
    }));
  });
  return <div class="minimap" ref={(element) => { box = element; sizeRef(element); }}><canvas ref={canvas} role="img" aria-label="Overview of the whole memory" /></div>;
}
