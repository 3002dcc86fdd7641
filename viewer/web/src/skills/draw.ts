// SPDX-License-Identifier: Apache-2.0
// Draws a lane of executions: a bar for each, its outcome as colour, as sign and as outline, and marks
// for what was asked and refused.
import { hatching } from '../timeline/hatching';
import { xOf, type Span } from '../time/span';
import { kFont, type Pen } from '../ui/svg';
import type { Theme } from '../ui/theme';
import type { Execution, Outcome, Slot } from './executions';
import { drawMark, drawOutcome } from './glyphs';
import type { DenseLane, EventLane, Mark } from './lanes';

export interface LanePlace {
  readonly span: Span;
  readonly width: number;
  readonly y: number;
  readonly height: number;
  /** The last snapshot of the memory: until then runs what has no end. */
  readonly last: bigint;
}

export interface ChosenExecution {
  readonly entity: string;
  readonly start: bigint;
}
export const isSame = (one: ChosenExecution | null, other: ChosenExecution): boolean => one?.entity === other.entity && one.start === other.start;

/** From where to where a bar goes, in pixels; at least so wide that it can be seen and clicked. */
export function reachOf(one: Execution, { span, width, last }: LanePlace): { readonly from: number; readonly to: number } {
  const from = xOf(one.start, span, width);
  return { from, to: Math.max(from + 3, xOf(one.end ?? (last > one.start ? last : one.start), span, width)) };
}

/** Of a lane's height, where a thin bar is filled: outcomes differ in this where there is no room for a sign. */
const kProfiles: Record<Outcome, readonly (readonly [number, number])[]> = {
  success: [[0, 1]], failure: [[0, 0.38], [0.62, 1]], stopped: [[0.3, 1]], lost: [[0, 0.2], [0.4, 0.6], [0.8, 1]], running: [[0.6, 1]],
};
/** Above and below bars. */
const kInset = 3;
const kSignWidth = 15;
const kTextHeight = 11;
/** Fewer letters than fit here would be a riddle. */
const kMinText = 26;

function fillProfile(c: Pen, outcome: Outcome, x: number, width: number, y: number, height: number): void {
  for (const [top, bottom] of kProfiles[outcome]) c.fillRect(x, y + height * top, width, height * (bottom - top));
}

function drawBar(c: Pen, one: Execution, isChosen: boolean, place: LanePlace, y: number, height: number, theme: Theme): void {
  const reach = reachOf(one, place);
  if (reach.to < -2 || reach.from > place.width + 2) return;
  const [from, to] = [Math.max(-4, reach.from), Math.min(place.width + 4, reach.to)];
  const colour = theme[one.outcome];
  if (to - from < kSignWidth || height < 7) {
    c.fillStyle = colour;
    fillProfile(c, one.outcome, from, to - from, y, height);
  } else {
    const isLost = one.outcome === 'lost';
    c.globalAlpha = isLost ? 0.1 : 0.26;
    c.fillStyle = colour;
    c.fillRect(from, y, to - from, height);
    if (one.outcome === 'failure') {
      c.globalAlpha = 0.55;
      c.fillStyle = hatching(c, colour);
      c.fillRect(from, y, to - from, height);
    }
    c.globalAlpha = 1;
    c.strokeStyle = colour;
    c.lineWidth = 1.4;
    c.setLineDash(isLost ? [4, 3] : []);
    c.beginPath();
    // What runs is open at its end.
    const edge = to - (one.outcome === 'running' ? 0 : 0.7);
    c.moveTo(edge, y + 0.7);
    c.lineTo(from + 0.7, y + 0.7);
    c.lineTo(from + 0.7, y + height - 0.7);
    c.lineTo(edge, y + height - 0.7);
    if (one.outcome !== 'running') c.closePath();
    c.stroke();
    c.setLineDash([]);
    drawLabel(c, one, Math.max(0, from), Math.min(place.width, to), y, height, theme);
  }
  if (!isChosen) return;
  c.strokeStyle = theme.ink;
  c.lineWidth = 2;
  c.strokeRect(from - 1, y - 1, to - from + 2, height + 2);
}

/** The sign of the outcome and as much of the name as fits; at the left edge of the screen where the bar began before. */
function drawLabel(c: Pen, one: Execution, from: number, to: number, y: number, height: number, theme: Theme): void {
  const middle = y + height / 2;
  c.save();
  c.beginPath();
  c.rect(from, y, to - from, height);
  c.clip();
  const r = Math.min(4, height / 2 - 2);
  c.fillStyle = theme.panel;
  c.globalAlpha = 0.85;
  c.fillRect(from + 2, y + 2, 2 * r + 3, height - 4);
  c.globalAlpha = 1;
  drawOutcome(c, one.outcome, from + r + 3.5, middle, r, theme[one.outcome]);
  if (height >= kTextHeight && to - from > kSignWidth + kMinText) {
    c.font = kFont;
    c.textBaseline = 'middle';
    c.fillStyle = theme.ink;
    c.fillText(one.label, from + kSignWidth + 1, middle + 0.5);
  }
  c.restore();
}

function drawDense(c: Pen, lane: DenseLane, place: LanePlace, y: number, height: number, theme: Theme): void {
  const x0 = xOf(lane.from, place.span, place.width);
  const each = (xOf(lane.to, place.span, place.width) - x0) / lane.outcomes.length;
  let runsFrom: number | undefined;
  lane.outcomes.forEach((outcome, i) => {
    if (outcome === undefined) return;
    const x = x0 + i * each;
    if (runsFrom !== undefined && x > 0 && runsFrom < place.width) {
      c.globalAlpha = 0.4;
      c.fillStyle = theme[outcome];
      c.fillRect(runsFrom, y, x - runsFrom, height);
      c.globalAlpha = 1;
    }
    runsFrom = lane.isRunning[i] ? x + each : undefined;
    if (x < -each || x > place.width) return;
    c.fillStyle = theme[outcome];
    fillProfile(c, outcome, x, Math.max(1, each), y, height);
  });
}

const kMarkRadius = 3.5;
/** Marks of one kind that are nearer than this are one. */
const kMarkGap = 3;

function drawMarks(c: Pen, marks: readonly Mark[], place: LanePlace, theme: Theme, isAlone: boolean): void {
  const before = new Map<string, number>();
  for (const mark of marks) {
    const x = xOf(mark.time, place.span, place.width);
    if (x < -8 || x > place.width + 8 || x - (before.get(mark.glyph) ?? -Infinity) < kMarkGap) continue;
    before.set(mark.glyph, x);
    // Where there are bars, requests lie at their upper edge and all else at the lower one.
    const y = isAlone ? place.y + place.height / 2 : mark.glyph === 'request' ? place.y + kMarkRadius : place.y + place.height - kMarkRadius - 1;
    drawMark(c, mark.glyph, x, y, isAlone ? kMarkRadius : 2.5, theme);
  }
}

/** One lane; `place` is where it lies. */
export function drawEvents(c: Pen, lane: EventLane, chosen: ChosenExecution | null, place: LanePlace, theme: Theme): void {
  const height = place.height - 2 * kInset;
  for (const dense of lane.dense) drawDense(c, dense, place, place.y + kInset, height, theme);
  lane.executions.forEach((one, i) => {
    const { row, of } = lane.slots[i]!;
    const each = height / of;
    drawBar(c, one, isSame(chosen, one), place, place.y + kInset + row * each, Math.max(2, each - (of > 1 ? 1 : 0)), theme);
  });
  drawMarks(c, lane.marks, place, theme, lane.executions.length === 0 && lane.dense.length === 0);
}

export type Hit = { readonly execution: Execution } | { readonly mark: Mark };

/** What lies at a place of a lane: a mark within 5 pixels, else the bar. */
export function hitAt(lane: EventLane, x: number, y: number, place: LanePlace): Hit | undefined {
  const near = lane.marks.map((mark) => ({ mark, away: Math.abs(xOf(mark.time, place.span, place.width) - x) })).filter(({ away }) => away <= 5).sort((a, b) => a.away - b.away)[0]?.mark;
  const down = (y - place.y - kInset) / (place.height - 2 * kInset);
  const isIn = ({ row, of }: Slot) => row === Math.max(0, Math.min(of - 1, Math.floor(down * of)));
  const bars = lane.executions.filter((one, i) => { const { from, to } = reachOf(one, place); return isIn(lane.slots[i]!) && x >= from - 2 && x <= to + 2; });
  // A request lies where its bar begins: there, the upper part of the lane is its own.
  if (near && (bars.length === 0 || near.glyph !== 'request' || y - place.y < 8)) return { mark: near };
  return bars.length > 0 ? { execution: bars.at(-1)! } : undefined;
}
