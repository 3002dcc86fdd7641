// SPDX-License-Identifier: Apache-2.0
// Draws lanes: which snapshots there are, and in which form.
import type { Density } from '../api/binary';
import { drawEvents, type ChosenExecution } from '../skills/draw';
import type { EventLane } from '../skills/lanes';
import type { Pen } from '../ui/svg';
import type { Theme } from '../ui/theme';
import { xOf, type Span } from '../time/span';
import { ticksOf } from '../time/ticks';
import type { Densities } from './density';
import { hatching } from './hatching';
import { kRowHeight, type Row } from './layout';

const kForms = ['recorded', 'latent', 'augmented'] as const;
/** Forms differ in colour and in height, so that nobody needs to tell the colours apart. */
const kTops = { recorded: 0, latent: 0.34, augmented: 0.62 } as const;

interface Bars {
  readonly x0: number;
  readonly perPixel: number;
  readonly width: number;
}

function place(densities: Densities, span: Span, width: number): Bars {
  const x0 = xOf(densities.span.from, span, width);
  return { x0, perPixel: (xOf(densities.span.to, span, width) - x0) / densities.pixels, width };
}

/** One lane: runs of pixels with the same form become one rectangle each. */
export function drawLane(c: Pen, density: Density, bars: Bars, y: number, height: number, theme: Theme, pixels: number): void {
  const first = Math.max(0, Math.floor(-bars.x0 / bars.perPixel));
  const end = Math.min(pixels, Math.ceil((bars.width - bars.x0) / bars.perPixel));
  for (const form of kForms) {
    const counts = density[form];
    const top = y + height * kTops[form];
    c.fillStyle = theme[form];
    c.beginPath();
    for (let i = first; i < end; ++i) {
      if (counts[i] === 0) continue;
      let stop = i + 1;
      while (stop < end && counts[stop]! > 0) stop += 1;
      const x = bars.x0 + i * bars.perPixel;
      const w = Math.max(1.5, (stop - i) * bars.perPixel);
      c.rect(x, top, w, y + height - top);
      i = stop;
    }
    c.fill();
  }
}

/** Hatches everything behind the last snapshot. */
export function drawFuture(c: Pen, last: bigint, span: Span, width: number, height: number, theme: Theme): void {
  const x = Math.max(0, xOf(last, span, width));
  if (x >= width) return;
  c.globalAlpha = 0.45;
  c.fillStyle = hatching(c, theme.predicted);
  c.fillRect(x, 0, width - x, height);
  c.globalAlpha = 1;
  c.fillStyle = theme.predicted;
  c.fillRect(x - 0.5, 0, 1, height);
}

export interface LaneView {
  readonly rows: readonly Row[];
  readonly first: number;
  readonly scrollTop: number;
  readonly width: number;
  readonly height: number;
  readonly span: Span;
  readonly last: bigint;
  readonly selected: string;
  readonly densities: Densities | undefined;
  /** What rows of skills and drives show in the place of counts. */
  readonly events: ReadonlyMap<string, EventLane>;
  readonly execution: ChosenExecution | null;
}

export function drawLanes(c: Pen, view: LaneView, theme: Theme): void {
  const bars = view.densities ? place(view.densities, view.span, view.width) : null;
  const full = view.rows.length;
  drawGrid(c, view, theme);
  for (let i = view.first; i < full; ++i) {
    const row = view.rows[i]!;
    const y = i * kRowHeight - view.scrollTop;
    if (y > view.height) break;
    if (row.id === view.selected) {
      c.fillStyle = theme.select;
      c.fillRect(0, y, view.width, kRowHeight);
    }
    c.fillStyle = theme.line;
    c.fillRect(0, y + kRowHeight - 1, view.width, 1);
    const events = view.events.get(row.id);
    if (events) {
      drawEvents(c, events, view.execution, { span: view.span, width: view.width, y, height: kRowHeight - 1, last: view.last }, theme);
      continue;
    }
    const density = view.densities?.lanes.get(row.id);
    if (!density || !bars) continue;
    // Groups are thin and quiet: their entities below tell the same in full.
    const inset = row.isEntity || !row.isOpen ? 4 : 8;
    c.globalAlpha = row.isEntity ? 1 : row.isOpen ? 0.45 : 0.8;
    drawLane(c, density, bars, y + inset, kRowHeight - 2 * inset, theme, view.densities!.pixels);
    c.globalAlpha = 1;
  }
  drawFuture(c, view.last, view.span, view.width, view.height, theme);
}

function drawGrid(c: Pen, view: LaneView, theme: Theme): void {
  c.fillStyle = theme.stripe;
  for (const tick of ticksOf(view.span, view.width)) c.fillRect(Math.round(xOf(tick.time, view.span, view.width)), 0, 1, view.height);
}

export function drawMinimap(c: Pen, densities: Densities | undefined, span: Span, life: Span, last: bigint, width: number, height: number, theme: Theme): void {
  if (densities) {
    const bars = place(densities, life, width);
    const lanes = [...densities.lanes.values()];
    const each = (height - 8) / Math.max(1, lanes.length);
    lanes.forEach((lane, i) => drawLane(c, lane, bars, 4 + i * each, Math.max(1, each - 0.6), theme, densities.pixels));
  }
  drawFuture(c, last, life, width, height, theme);
  const from = xOf(span.from, life, width);
  const to = Math.max(from + 3, xOf(span.to, life, width));
  c.fillStyle = theme.panel;
  c.globalAlpha = 0.66;
  c.fillRect(0, 0, from, height);
  c.fillRect(to, 0, width - to, height);
  c.globalAlpha = 1;
  c.strokeStyle = theme.accent;
  c.lineWidth = 1.5;
  c.strokeRect(from + 0.75, 0.75, to - from - 1.5, height - 1.5);
}
