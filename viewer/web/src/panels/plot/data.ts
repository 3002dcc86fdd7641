// SPDX-License-Identifier: Apache-2.0
// From what the gateway sends to what uPlot draws: at most two points per pixel and series.
import type { Series } from '../../api/binary';
import { decodeSeries } from '../../api/binary';
import { getBinary } from '../../api/client';
import { lengthOf, type Span } from '../../time/span';

export interface Plotted {
  readonly span: Span;
  readonly pixels: number;
  readonly paths: readonly string[];
  readonly series: readonly Series[];
  /** Which share of the snapshots was read; below 1 the gateway ran out of its time. */
  readonly share: number;
  /** Seconds since `span.from`, two for each pixel. */
  readonly x: Float64Array;
  /** One list per path. null is a gap; undefined is a pixel between two snapshots. */
  readonly y: readonly (number | null | undefined)[][];
}

/** A stretch without snapshots is a gap if it is this many times longer than usual ones. */
const kGapFactor = 6;

/** The usual number of pixels from one snapshot to the next. */
export function usualStep(values: Float32Array): number {
  const steps: number[] = [];
  let before = -1;
  for (let i = 0; i < values.length; ++i) {
    if (Number.isNaN(values[i]!)) continue;
    if (before >= 0) steps.push(i - before);
    before = i;
  }
  steps.sort((a, b) => a - b);
  return steps.length === 0 ? Infinity : steps[Math.floor((steps.length - 1) * 0.9)]!;
}

/**
 * Two points per pixel: the smallest and the largest value, in the order that ends nearer to the last
 * one. A line through them covers what a line through all snapshots would cover.
 */
export function pointsOf(series: Series): (number | null | undefined)[] {
  const { min, max, last } = series;
  const pixels = min.length;
  const out = new Array<number | null | undefined>(2 * pixels).fill(undefined);
  const limit = Math.max(3, kGapFactor * usualStep(last));
  let before = -1;
  for (let i = 0; i < pixels; ++i) {
    if (Number.isNaN(last[i]!)) continue;
    // uPlot leaves out what is null, and only that: a gap is null all along.
    if (before >= 0 && i - before > limit) out.fill(null, 2 * before + 2, 2 * i);
    // A value that float32 does not hold has no place on the screen.
    if (!Number.isFinite(min[i]!) || !Number.isFinite(max[i]!)) {
      out.fill(null, 2 * i, 2 * i + 2);
      before = i;
      continue;
    }
    const endsHigh = Math.abs(last[i]! - max[i]!) <= Math.abs(last[i]! - min[i]!);
    if (min[i] === max[i]) out[2 * i] = last[i]!;
    else {
      out[2 * i] = endsHigh ? min[i]! : max[i]!;
      out[2 * i + 1] = endsHigh ? max[i]! : min[i]!;
    }
    before = i;
  }
  return out;
}

export function abscissae(span: Span, pixels: number): Float64Array {
  const seconds = Number(lengthOf(span)) / 1e9;
  return Float64Array.from({ length: 2 * pixels }, (_, i) => ((i + 0.5) / (2 * pixels)) * seconds);
}

export async function askSeries(entity: string, paths: readonly string[], span: Span, pixels: number, signal: AbortSignal, budget?: number): Promise<Plotted> {
  const { buffer, headers } = await getBinary('series', { entity, path: paths, from: span.from, to: span.to, pixels, budget }, signal);
  const series = decodeSeries(buffer, paths.length, pixels);
  const [read, total] = ['Read', 'Total'].map((name) => Number.parseInt(headers.get(`X-Engram-${name}`) ?? '', 10)) as [number, number];
  return { span, pixels, paths, series, share: total > 0 && read < total ? read / total : 1, x: abscissae(span, pixels), y: series.map(pointsOf) };
}

/** The value of a series at or before a time; NaN where there is none in what was asked for. */
export function valueAt(plotted: Plotted, which: number, time: bigint): number {
  const series = plotted.series[which];
  if (!series || time < plotted.span.from || time > plotted.span.to) return NaN;
  let i = Math.min(plotted.pixels - 1, Math.floor((Number(time - plotted.span.from) / Number(lengthOf(plotted.span))) * plotted.pixels));
  for (; i >= 0; --i) if (!Number.isNaN(series.last[i]!)) return series.last[i]!;
  return NaN;
}

/** Smallest and largest value between two times, with some air; null if there is none. */
export function rangeOf(plotted: Plotted, visible: Span, more: readonly number[] = []): [number, number] | null {
  let low = Infinity;
  let high = -Infinity;
  const index = (time: bigint) => (Number(time - plotted.span.from) / Number(lengthOf(plotted.span))) * plotted.pixels;
  const first = Math.max(0, Math.floor(index(visible.from)));
  const end = Math.min(plotted.pixels, Math.ceil(index(visible.to)));
  for (const series of plotted.series)
    for (let i = first; i < end; ++i) {
      if (series.min[i]! < low && Number.isFinite(series.min[i]!)) low = series.min[i]!;
      if (series.max[i]! > high && Number.isFinite(series.max[i]!)) high = series.max[i]!;
    }
  for (const value of more) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return null;
  const air = (high - low || Math.abs(high) || 1) * 0.06;
  return [low - air, high + air];
}

/** Round values between two, about `count` of them. */
export function splitsOf(low: number, high: number, count: number): number[] {
  const rough = (high - low) / Math.max(1, count);
  if (!(rough > 0) || !Number.isFinite(rough)) return [];
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * ([1, 2, 5, 10].find((factor) => factor * unit >= rough) ?? 10);
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.max(0, Math.floor(high / step) - first + 1) }, (_, i) => (first + i) * step);
}
