// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { abscissae, pointsOf, rangeOf, usualStep, valueAt, type Plotted, splitsOf } from './data';
import { horizonsUpTo } from './future';

const series = (last: number[], min = last, max = last) => ({ min: Float32Array.from(min), max: Float32Array.from(max), last: Float32Array.from(last) });
const plotted = (last: number[], min = last, max = last): Plotted => {
  const span = { from: 0n, to: BigInt(last.length) * 1_000_000_000n };
  const one = series(last, min, max);
  return { span, pixels: last.length, paths: ['x'], series: [one], share: 1, x: abscissae(span, last.length), y: [pointsOf(one)] };
};

describe('points of a plot', () => {
  it('are at most two for each pixel, and end near the last value', () => {
    expect(pointsOf(series([3, 1], [1, 1], [3, 4]))).toEqual([1, 3, 4, 1]);
    expect(pointsOf(series([2], [2], [2]))).toEqual([2, undefined]);
  });
  it('are joined across pixels between two snapshots, and not across a gap', () => {
    const sparse = pointsOf(series([1, NaN, 2, NaN, 3, NaN, 4]));
    expect(sparse.filter((point) => point === null)).toEqual([]);
    const last = [1, 2, 3, ...new Array<number>(20).fill(NaN), 4, 5, 6];
    const gap = pointsOf(series(last));
    expect(gap.slice(6, 46).every((point) => point === null)).toBe(true);
    expect(gap[46]).toBe(4);
  });
  it('leave out what is infinite, and keep the range of the others', () => {
    const data = plotted([1, 2, 3], [1, -Infinity, 3], [1, Infinity, 3]);
    expect(pointsOf(data.series[0]!)).toEqual([1, undefined, null, null, 3, undefined]);
    expect(rangeOf(data, data.span)!.map((edge) => Math.round(edge))).toEqual([1, 3]);
    expect(rangeOf(plotted([Infinity]), { from: 0n, to: 1_000_000_000n })).toBeNull();
  });
  it('know the usual step', () => {
    expect(usualStep(Float32Array.of(1, NaN, NaN, 2, NaN, NaN, 3))).toBe(3);
    expect(usualStep(Float32Array.of(NaN, 1))).toBe(Infinity);
  });
  it('tell the value at or before a time', () => {
    const data = plotted([1, NaN, 3]);
    expect(valueAt(data, 0, 1_500_000_000n)).toBe(1);
    expect(valueAt(data, 0, 2_500_000_000n)).toBe(3);
    expect(valueAt(data, 0, 9_000_000_000n)).toBeNaN();
    expect(valueAt(data, 5, 0n)).toBeNaN();
  });
  it('have a range of what is on the screen, predictions included', () => {
    const data = plotted([0, 10, 0], [0, -10, 0], [0, 10, 0]);
    expect(rangeOf(data, { from: 1_000_000_000n, to: 2_000_000_000n })).toEqual([-11.2, 11.2]);
    expect(rangeOf(data, { from: 2_000_000_000n, to: 3_000_000_000n }, [5])![1]).toBeCloseTo(5.3);
    expect(rangeOf(plotted([NaN, NaN]), { from: 0n, to: 1n })).toBeNull();
  });
  it('of the future have even steps up to the horizon', () => {
    expect(horizonsUpTo(900n, 3)).toEqual([300n, 600n, 900n]);
    expect(horizonsUpTo(2n, 4)).toEqual([1n, 1n, 2n]);
  });
});

describe('values on an axis', () => {
  it('are round and inside', () => {
    expect(splitsOf(-0.07, 1.02, 8)).toEqual([0, 0.2, 0.4, 0.6000000000000001, 0.8, 1]);
    expect(splitsOf(99, 401, 3)).toEqual([200, 400]);
    expect(splitsOf(1, 1, 5)).toEqual([]);
    expect(splitsOf(NaN, 1, 5)).toEqual([]);
  });
});
