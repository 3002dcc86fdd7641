// SPDX-License-Identifier: Apache-2.0
// One uPlot, set up for Engram: times are BigInt outside and seconds since a base inside.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { formatNumber } from '../../time/format';
import { xOf, type Span } from '../../time/span';
import { ticksOf } from '../../time/ticks';
import { hatching } from '../../timeline/hatching';
import { kFont, type Pen } from '../../ui/svg';
import type { Theme } from '../../ui/theme';
import { rangeOf, splitsOf, type Plotted } from './data';
import type { Foreseen } from './future';

export interface Shown {
  readonly plotted: Plotted;
  readonly view: Span;
  readonly last: bigint;
  readonly foreseen: Foreseen | null;
  readonly isShown: (path: string) => boolean;
}

/** Title and names above a chart that is saved. */
export const kTitleHeight = 40;

export const styleOf = (i: number, theme: Theme): { colour: string; dash: number[] } => ({ colour: theme.series[i % 8]!, dash: i < 8 ? [] : [7, 4] });

const seconds = (time: bigint, base: bigint): number => Number(time - base) / 1e9;

/** Where a plot is drawn: on the canvas of uPlot in pixels of the screen, in a file in those of the page. */
interface Field {
  readonly left: number; readonly top: number; readonly width: number; readonly height: number;
  readonly ratio: number;
  readonly x: (seconds: number) => number;
  readonly y: (value: number) => number;
}

function onCanvas(u: uPlot): Field {
  return { ...u.bbox, ratio: devicePixelRatio, x: (at) => u.valToPos(at, 'x', true), y: (value) => u.valToPos(value, 'y', true) };
}

function inFile(u: uPlot): Field {
  const [left, top, width, height] = [u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height].map((size) => size / devicePixelRatio) as [number, number, number, number];
  return { left, top, width, height, ratio: 1, x: (at) => left + u.valToPos(at, 'x'), y: (value) => top + u.valToPos(value, 'y') };
}

function clipTo(c: Pen, { left, top, width, height }: Field): void {
  c.save();
  c.beginPath();
  c.rect(left, top, width, height);
  c.clip();
}

/** Dashed lines of what is predicted, in a band that holds nine of ten. */
function drawForeseen(c: Pen, field: Field, shown: Shown, theme: Theme): void {
  const { foreseen, plotted } = shown;
  if (!foreseen) return;
  const { ratio, y } = field;
  const x = (time: bigint) => field.x(seconds(time, plotted.span.from));
  clipTo(c, field);
  plotted.paths.forEach((path, i) => {
    if (!shown.isShown(path)) return;
    const values = foreseen.values[i] ?? [];
    const bounds = foreseen.bounds[i] ?? [];
    const points = foreseen.times.map((time, j) => ({ time, value: values[j] ?? NaN, bound: bounds[j] ?? NaN })).filter((point) => Number.isFinite(point.value));
    if (points.length === 0) return;
    c.fillStyle = c.strokeStyle = styleOf(i, theme).colour;
    const sure = points.filter((point) => Number.isFinite(point.bound));
    if (sure.length > 1) {
      c.globalAlpha = 0.16;
      c.beginPath();
      sure.forEach((point, j) => (j === 0 ? c.moveTo(x(point.time), y(point.value + point.bound)) : c.lineTo(x(point.time), y(point.value + point.bound))));
      [...sure].reverse().forEach((point) => c.lineTo(x(point.time), y(point.value - point.bound)));
      c.fill();
    }
    c.globalAlpha = 1;
    c.lineWidth = 1.6 * ratio;
    c.setLineDash([5 * ratio, 4 * ratio]);
    c.beginPath();
    points.forEach((point, j) => (j === 0 ? c.moveTo(x(point.time), y(point.value)) : c.lineTo(x(point.time), y(point.value))));
    c.stroke();
    c.setLineDash([]);
  });
  c.restore();
}

function drawBehind(c: Pen, field: Field, shown: Shown, theme: Theme): void {
  const x = Math.max(field.left, field.x(seconds(shown.last, shown.plotted.span.from)));
  const right = field.left + field.width;
  if (x >= right) return;
  c.save();
  c.globalAlpha = 0.35;
  c.fillStyle = hatching(c, theme.predicted);
  c.fillRect(x, field.top, right - x, field.height);
  c.restore();
}

function drawAxes(c: Pen, field: Field, u: uPlot, shown: Shown, theme: Theme): void {
  const { left, top, width, height } = field;
  c.font = kFont;
  c.textBaseline = 'middle';
  for (const tick of ticksOf(shown.view, width, 84)) {
    const x = field.x(seconds(tick.time, shown.plotted.span.from));
    c.fillStyle = theme.stripe;
    c.fillRect(x - 0.5, top, 1, height);
    c.fillStyle = theme.dim;
    c.textAlign = 'center';
    c.fillText(tick.label, x, top + height + 13);
  }
  c.textAlign = 'end';
  for (const value of splitsOf(u.scales.y!.min ?? 0, u.scales.y!.max ?? 1, height / 46)) {
    c.fillStyle = theme.stripe;
    c.fillRect(left, field.y(value) - 0.5, width, 1);
    c.fillStyle = theme.dim;
    c.fillText(formatNumber(value), left - 8, field.y(value));
  }
  c.textAlign = 'start';
}

function drawLines(c: Pen, field: Field, shown: Shown, theme: Theme): void {
  const { plotted } = shown;
  const [from, to] = [shown.view.from, shown.view.to].map((time) => seconds(time, plotted.span.from)) as [number, number];
  const pixel = (to - from) / Math.max(1, field.width);
  clipTo(c, field);
  plotted.paths.forEach((path, i) => {
    if (!shown.isShown(path)) return;
    const { colour, dash } = styleOf(i, theme);
    c.strokeStyle = colour;
    c.lineWidth = 1.4;
    c.setLineDash(dash);
    c.beginPath();
    let isOn = false;
    plotted.y[i]!.forEach((value, j) => {
      const at = plotted.x[j]!;
      if (value === null) isOn = false;
      if (value === null || value === undefined || at < from - 4 * pixel || at > to + 4 * pixel) return;
      if (isOn) c.lineTo(field.x(at), field.y(value));
      else c.moveTo(field.x(at), field.y(value));
      isOn = true;
    });
    c.stroke();
  });
  c.setLineDash([]);
  c.restore();
}

/** Draws what a chart shows as a picture of its own, with the names of its series above it. */
export function drawChart(c: Pen, u: uPlot, shown: Shown, labels: readonly string[], title: string, theme: Theme): void {
  c.fillStyle = theme.panel;
  c.fillRect(0, 0, u.width, u.height + kTitleHeight);
  c.textBaseline = 'middle';
  c.font = `600 ${kFont}`;
  c.fillStyle = theme.ink;
  c.fillText(title, 8, 11);
  c.font = kFont;
  let x = 8;
  shown.plotted.paths.forEach((path, i) => {
    if (!shown.isShown(path)) return;
    c.fillStyle = styleOf(i, theme).colour;
    c.fillRect(x, 26.5, 12, 3);
    c.fillStyle = theme.ink;
    c.fillText(labels[i] ?? path, x + 17, 28);
    x += 32 + c.measureText(labels[i] ?? path).width;
  });
  const field = inFile(u);
  c.save();
  c.translate(0, kTitleHeight);
  drawAxes(c, field, u, shown, theme);
  drawBehind(c, field, shown, theme);
  drawLines(c, field, shown, theme);
  drawForeseen(c, field, shown, theme);
  c.restore();
}

/** Makes a chart in `element`; `shown()` is asked again for every drawing. */
export function createChart(element: HTMLElement, width: number, height: number, shown: () => Shown, theme: Theme): uPlot {
  const base = () => shown().plotted.span.from;
  const ticks = () => ticksOf(shown().view, width, 84);
  const axis: uPlot.Axis = { font: kFont, stroke: theme.dim, grid: { stroke: theme.stripe, width: 1 }, ticks: { stroke: theme.line, width: 1, size: 4 } };
  // What is predicted out of sight would press flat what is seen.
  const values = () => {
    const { foreseen, plotted, view, isShown } = shown();
    if (!foreseen) return [];
    const isSeen = (_: number, i: number) => foreseen.times[i]! >= view.from && foreseen.times[i]! <= view.to;
    return plotted.paths.flatMap((path, i) => (isShown(path) ? (foreseen.values[i] ?? []).filter(isSeen).filter(Number.isFinite) : []));
  };
  const visible = (): Plotted => {
    const { plotted, isShown } = shown();
    return { ...plotted, series: plotted.series.filter((_, i) => isShown(plotted.paths[i]!)) };
  };
  return new uPlot({
    width, height, padding: [8, 8, 0, 0], legend: { show: false }, pxAlign: 0,
    cursor: { x: false, y: false, drag: { x: false, y: false, setScale: false }, points: { show: false } },
    scales: {
      x: { time: false, auto: false, range: () => [seconds(shown().view.from, base()), seconds(shown().view.to, base())] },
      y: { auto: true, range: () => rangeOf(visible(), shown().view, values()) ?? [0, 1] },
    },
    axes: [
      { ...axis, size: 24, gap: 3, splits: () => ticks().map((tick) => seconds(tick.time, base())), values: () => ticks().map((tick) => tick.label) },
      { ...axis, size: 54, gap: 4, values: (_, splits) => splits.map(formatNumber) },
    ],
    series: [{}, ...shown().plotted.paths.map((path, i) => {
      const { colour, dash } = styleOf(i, theme);
      return { label: path, stroke: colour, width: 1.4, dash, points: { show: false }, spanGaps: false, show: shown().isShown(path) };
    })],
    hooks: { drawClear: [(u) => drawBehind(u.ctx, onCanvas(u), shown(), theme)], draw: [(u) => drawForeseen(u.ctx, onCanvas(u), shown(), theme)] },
  }, dataOf(shown().plotted), element);
}

export const dataOf = (plotted: Plotted): uPlot.AlignedData => [plotted.x, ...plotted.y] as unknown as uPlot.AlignedData;

/** Where the cursor's line lies, in pixels of the plotting area; null if outside. */
export function lineAt(time: bigint | null, view: Span, width: number): number | null {
  if (time === null || time < view.from || time > view.to) return null;
  return xOf(time, view, width);
}
