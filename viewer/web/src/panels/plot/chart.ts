// SPDX-License-Identifier: Apache-2.0
// One uPlot, set up for Engram: times are BigInt outside and seconds since a base inside.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { formatNumber } from '../../time/format';
import { xOf, type Span } from '../../time/span';
import { ticksOf } from '../../time/ticks';
import { hatching } from '../../timeline/draw';
import { kFont, type Theme } from '../../ui/theme';
import { rangeOf, type Plotted } from './data';
import type { Foreseen } from './future';

export interface Shown {
  readonly plotted: Plotted;
  readonly view: Span;
  readonly last: bigint;
  readonly foreseen: Foreseen | null;
  readonly isShown: (path: string) => boolean;
}

export const styleOf = (i: number, theme: Theme): { colour: string; dash: number[] } => ({ colour: theme.series[i % 8]!, dash: i < 8 ? [] : [7, 4] });

const seconds = (time: bigint, base: bigint): number => Number(time - base) / 1e9;

/** Dashed lines of what is predicted, in a band that holds nine of ten. */
function drawForeseen(u: uPlot, shown: Shown, theme: Theme): void {
  const { foreseen, plotted } = shown;
  if (!foreseen) return;
  const c = u.ctx;
  const ratio = devicePixelRatio;
  const x = (time: bigint) => u.valToPos(seconds(time, plotted.span.from), 'x', true);
  const y = (value: number) => u.valToPos(value, 'y', true);
  c.save();
  c.beginPath();
  c.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  c.clip();
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

function drawBehind(u: uPlot, shown: Shown, theme: Theme): void {
  const x = Math.max(u.bbox.left, u.valToPos(seconds(shown.last, shown.plotted.span.from), 'x', true));
  const right = u.bbox.left + u.bbox.width;
  if (x >= right) return;
  u.ctx.save();
  u.ctx.globalAlpha = 0.35;
  u.ctx.fillStyle = hatching(u.ctx, theme.predicted);
  u.ctx.fillRect(x, u.bbox.top, right - x, u.bbox.height);
  u.ctx.restore();
}

/** Makes a chart in `element`; `shown()` is asked again for every drawing. */
export function createChart(element: HTMLElement, width: number, height: number, shown: () => Shown, theme: Theme): uPlot {
  const base = () => shown().plotted.span.from;
  const ticks = () => ticksOf(shown().view, width, 84);
  const axis: uPlot.Axis = { font: kFont, stroke: theme.dim, grid: { stroke: theme.stripe, width: 1 }, ticks: { stroke: theme.line, width: 1, size: 4 } };
  const values = () => {
    const { foreseen, plotted } = shown();
    return foreseen ? plotted.paths.flatMap((path, i) => (shown().isShown(path) ? (foreseen.values[i] ?? []).filter(Number.isFinite) : [])) : [];
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
      y: { auto: false, range: () => rangeOf(visible(), shown().view, values()) ?? [0, 1] },
    },
    axes: [
      { ...axis, size: 24, gap: 3, splits: () => ticks().map((tick) => seconds(tick.time, base())), values: () => ticks().map((tick) => tick.label) },
      { ...axis, size: 54, gap: 4, values: (_, splits) => splits.map(formatNumber) },
    ],
    series: [{}, ...shown().plotted.paths.map((path, i) => {
      const { colour, dash } = styleOf(i, theme);
      return { label: path, stroke: colour, width: 1.4, dash, points: { show: false }, spanGaps: false, show: shown().isShown(path) };
    })],
    hooks: { drawClear: [(u) => drawBehind(u, shown(), theme)], draw: [(u) => drawForeseen(u, shown(), theme)] },
  }, dataOf(shown().plotted), element);
}

export const dataOf = (plotted: Plotted): uPlot.AlignedData => [plotted.x, ...plotted.y] as unknown as uPlot.AlignedData;

/** Where the cursor's line lies, in pixels of the plotting area; null if outside. */
export function lineAt(time: bigint | null, view: Span, width: number): number | null {
  if (time === null || time < view.from || time > view.to) return null;
  return xOf(time, view, width);
}
