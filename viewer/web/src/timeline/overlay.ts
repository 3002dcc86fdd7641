// SPDX-License-Identifier: Apache-2.0
// Draws what moves with the hand: axis, cursors, selection, marks and links. It is a canvas of its own,
// so that moving the cursor draws no lane again.
import { formatClock, formatDuration } from '../time/format';
import { lengthOf, xOf, type Span } from '../time/span';
import { ticksOf } from '../time/ticks';
import { kFont, type Pen } from '../ui/svg';
import type { Theme } from '../ui/theme';

export const kAxisHeight = 26;

export interface Overlay {
  readonly span: Span;
  readonly width: number;
  readonly height: number;
  readonly cursor: bigint;
  readonly hover: bigint | null;
  readonly selection: Span | null;
  readonly last: bigint;
  readonly marks: readonly bigint[];
  /** Links of the chosen snapshot: from its lane to others; y in pixels below the axis. */
  readonly links: readonly { readonly fromY: number; readonly toY: number; readonly from: bigint; readonly to: bigint }[];
}

function label(c: Pen, text: string, x: number, y: number, width: number, fill: string, ink: string): void {
  const w = c.measureText(text).width + 10;
  const left = Math.max(1, Math.min(width - w - 1, x - w / 2));
  c.fillStyle = fill;
  c.beginPath();
  c.roundRect(left, y, w, 16, 3);
  c.fill();
  c.fillStyle = ink;
  c.fillText(text, left + 5, y + 8.5);
}

/** As many digits as a pixel can tell apart. */
export function digitsFor(span: Span, width: number): number {
  const perPixel = Number(lengthOf(span)) / Math.max(1, width);
  return perPixel < 1e3 ? 9 : perPixel < 1e6 ? 6 : 3;
}

export function drawOverlay(c: Pen, view: Overlay, theme: Theme): void {
  const { span, width, height } = view;
  const x = (time: bigint) => xOf(time, span, width);
  c.font = kFont;
  c.textBaseline = 'middle';
  c.fillStyle = theme.line;
  c.fillRect(0, kAxisHeight - 1, width, 1);
  for (const tick of ticksOf(span, width)) {
    const at = Math.round(x(tick.time));
    c.fillStyle = theme.dim;
    c.fillRect(at, kAxisHeight - 6, 1, 5);
    c.fillStyle = tick.isMajor ? theme.ink : theme.dim;
    c.fillText(tick.label, at + 4, kAxisHeight - 10);
  }
  if (view.selection) {
    const from = x(view.selection.from);
    const to = x(view.selection.to);
    c.fillStyle = theme.accent;
    c.globalAlpha = 0.14;
    c.fillRect(from, 0, Math.max(1, to - from), height);
    c.globalAlpha = 1;
    c.fillRect(from, 0, 1, height);
    c.fillRect(to, 0, 1, height);
  }
  drawMarks(c, view, theme, x);
  drawLinks(c, view, theme, x);
  const digits = digitsFor(span, width);
  if (view.hover !== null && view.hover !== view.cursor) {
    const at = x(view.hover);
    c.fillStyle = theme.hover;
    c.fillRect(at - 0.5, 0, 1, height);
    label(c, formatClock(view.hover, digits), at, 5, width, theme.hover, theme.panel);
  }
  const at = x(view.cursor);
  if (at < -1 || at > width + 1) return;
  const isFuture = view.cursor > view.last;
  const colour = isFuture ? theme.predicted : theme.accent;
  c.fillStyle = colour;
  c.fillRect(at - 0.75, 0, 1.5, height);
  const text = isFuture ? `+${formatDuration(view.cursor - view.last)} predicted` : formatClock(view.cursor, digits);
  label(c, text, at, 5, width, colour, theme.panel);
}

function drawMarks(c: Pen, view: Overlay, theme: Theme, x: (time: bigint) => number): void {
  c.fillStyle = theme.mark;
  for (const mark of view.marks) {
    const at = x(mark);
    if (at < -6 || at > view.width + 6) continue;
    c.beginPath();
    c.moveTo(at, kAxisHeight + 1);
    c.lineTo(at - 5, kAxisHeight - 7);
    c.lineTo(at + 5, kAxisHeight - 7);
    c.fill();
    c.globalAlpha = 0.22;
    c.fillRect(at - 0.5, kAxisHeight, 1, view.height - kAxisHeight);
    c.globalAlpha = 1;
  }
}

function drawLinks(c: Pen, view: Overlay, theme: Theme, x: (time: bigint) => number): void {
  c.strokeStyle = theme.ink;
  c.fillStyle = theme.ink;
  c.lineWidth = 1.2;
  // Lanes that are scrolled away lie behind the axis.
  c.save();
  c.beginPath();
  c.rect(0, kAxisHeight, view.width, view.height - kAxisHeight);
  c.clip();
  for (const link of view.links) {
    const from = { x: x(link.from), y: link.fromY };
    const to = { x: x(link.to), y: link.toY };
    if (Math.min(from.x, to.x) > view.width || Math.max(from.x, to.x) < 0) continue;
    // A bow from lane to lane where the snapshot is, then along the lane to the time that is linked to:
    // straight lines across the whole life would cross everything.
    const bow = 12 + Math.min(26, Math.abs(to.y - from.y) / 6);
    c.globalAlpha = 0.5;
    c.beginPath();
    c.moveTo(from.x, from.y);
    c.bezierCurveTo(from.x - bow, from.y, from.x - bow, to.y, from.x, to.y);
    c.stroke();
    c.globalAlpha = 0.45;
    c.setLineDash([2, 3]);
    c.beginPath();
    c.moveTo(from.x, to.y);
    c.lineTo(to.x, to.y);
    c.stroke();
    c.setLineDash([]);
    c.globalAlpha = 1;
    c.beginPath();
    c.arc(to.x, to.y, 3, 0, 7);
    c.fill();
  }
  c.restore();
}
