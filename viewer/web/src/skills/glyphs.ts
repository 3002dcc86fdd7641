// SPDX-License-Identifier: Apache-2.0
// Small signs for outcomes and marks, drawn as shapes: each differs in form, so that nobody needs to
// tell colours apart.
import type { Pen } from '../ui/svg';
import type { Theme } from '../ui/theme';
import type { Outcome } from './executions';
import type { Glyph } from './lanes';

/** Strokes from -1 to 1 in x and y; a closed one is filled. */
interface Shape {
  readonly lines: readonly (readonly (readonly [number, number])[])[];
  readonly isFilled: boolean;
}

const open = (...lines: Shape['lines'][number][]): Shape => ({ lines, isFilled: false });
const filled = (...lines: Shape['lines'][number][]): Shape => ({ lines, isFilled: true });

const kCross = open([[-0.8, -0.8], [0.8, 0.8]], [[0.8, -0.8], [-0.8, 0.8]]);
const kSquare = filled([[-0.75, -0.75], [0.75, -0.75], [0.75, 0.75], [-0.75, 0.75]]);
const kTriangle = filled([[-0.6, -0.9], [0.9, 0], [-0.6, 0.9]]);
const kCheck = open([[-0.9, 0], [-0.2, 0.75], [0.9, -0.75]]);

const kOutcomeShapes: Record<Outcome, Shape> = {
  running: kTriangle, success: kCheck, failure: kCross, stopped: kSquare,
  lost: open([[-0.6, -0.5], [0, -0.9], [0.6, -0.5], [0.5, -0.1], [0, 0.2], [0, 0.4]], [[0, 0.8], [0, 1]]),
};
const kGlyphShapes: Record<Glyph, Shape> = {
  request: filled([[-0.9, -0.9], [0.9, -0.9], [0, 0.7]]), stop: kSquare, refusal: kCross, go: kTriangle, arrived: kCheck, failed: kCross,
  enable: open([[0, -0.9], [0, 0.9]]), disable: open([[-0.9, 0], [0.9, 0]]),
  again: open([[-0.9, 0.3], [-0.6, -0.6], [0.3, -0.8], [0.9, -0.1]], [[0.9, -0.9], [0.9, -0.1], [0.1, -0.1]]),
  blocked: open([[-0.5, -0.9], [-0.5, 0.9]], [[0.5, -0.9], [0.5, 0.9]]),
  trapped: open([[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9], [-0.9, -0.9]], [[-0.5, -0.5], [0.5, 0.5]], [[0.5, -0.5], [-0.5, 0.5]]),
};

function drawShape(c: Pen, { lines, isFilled }: Shape, x: number, y: number, r: number, colour: string): void {
  c.fillStyle = colour;
  c.strokeStyle = colour;
  c.lineWidth = 1.6;
  c.beginPath();
  for (const line of lines) line.forEach(([dx, dy], i) => (i === 0 ? c.moveTo(x + r * dx, y + r * dy) : c.lineTo(x + r * dx, y + r * dy)));
  if (isFilled) c.fill();
  else c.stroke();
}

export const drawOutcome = (c: Pen, outcome: Outcome, x: number, y: number, r: number, colour: string): void => drawShape(c, kOutcomeShapes[outcome], x, y, r, colour);

const colourOf = (glyph: Glyph, theme: Theme): string => {
  if (glyph === 'refusal' || glyph === 'failed' || glyph === 'trapped') return theme.failure;
  if (glyph === 'stop' || glyph === 'disable' || glyph === 'blocked') return theme.stopped;
  return glyph === 'arrived' || glyph === 'enable' ? theme.success : glyph === 'go' || glyph === 'again' ? theme.running : theme.ink;
};

/** A mark with a rim in the colour of the lane, so that it is seen on bars, too. */
export function drawMark(c: Pen, glyph: Glyph, x: number, y: number, r: number, theme: Theme): void {
  c.fillStyle = theme.panel;
  c.globalAlpha = 0.8;
  c.beginPath();
  c.arc(x, y, r + 2, 0, 7);
  c.fill();
  c.globalAlpha = 1;
  drawShape(c, kGlyphShapes[glyph], x, y, r, colourOf(glyph, theme));
}

/** A sign of a legend as the path of an SVG of 12 by 12. */
export function pathOf(outcome: Outcome): { readonly d: string; readonly isFilled: boolean } {
  const { lines, isFilled } = kOutcomeShapes[outcome];
  return { d: lines.map((line) => line.map(([x, y], i) => `${i === 0 ? 'M' : 'L'}${6 + 4 * x} ${6 + 4 * y}`).join('')).join('') + (isFilled ? 'Z' : ''), isFilled };
}
