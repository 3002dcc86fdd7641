// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { homeOf, kMinSpanNs, lengthOf, limitsOf, pan, showing, timeAt, within, xOf, zoom, type Span } from './span';

const first = 1767250800000000000n;
const life: Span = { from: first, to: first + 1_380_000_000_000n };

describe('spans of time', () => {
  it('place a nanosecond exactly, seventy years after the epoch', () => {
    const span = { from: first + 7n, to: first + 1007n };
    for (let ns = 0; ns <= 1000; ++ns) {
      expect(xOf(span.from + BigInt(ns), span, 1000)).toBe(ns);
      expect(timeAt(ns, span, 1000)).toBe(span.from + BigInt(ns));
    }
  });
  it('keep both ends exact whatever their length', () => {
    for (const length of [20_000n, 1_000_000_007n, 31_536_000_000_000_000n]) {
      const span = { from: first, to: first + length };
      expect(timeAt(0, span, 1333)).toBe(span.from);
      expect(timeAt(1333, span, 1333)).toBe(span.to);
    }
  });
  it('keep the time below the pointer when zooming', () => {
    let span = life;
    const x = 417;
    const anchor = timeAt(x, span, 1100);
    for (let i = 0; i < 40; ++i) {
      span = zoom(span, x, 1100, 0.7, life);
      expect(Math.abs(xOf(anchor, span, 1100) - x)).toBeLessThan(0.1);
    }
  });
  it('zoom from a life to the smallest stretch and back', () => {
    let span = life;
    for (let i = 0; i < 100; ++i) span = zoom(span, 500, 1000, 0.5, life);
    expect(lengthOf(span)).toBe(kMinSpanNs);
    for (let i = 0; i < 100; ++i) span = zoom(span, 500, 1000, 2, life);
    expect(span).toEqual(life);
  });
  it('stay within the limits when moved', () => {
    const span = { from: first, to: first + 10_000_000_000n };
    expect(pan(span, -500, 1000, life)).toEqual(span);
    expect(pan(span, 1000, 1000, life).from).toBe(first + 10_000_000_000n);
    expect(pan(span, 1e9, 1000, life).to).toBe(life.to);
  });
  it('are pushed into limits, and cut where they are longer', () => {
    expect(within({ from: first - 5n, to: first + 5n }, life)).toEqual({ from: first, to: first + 10n });
    expect(within({ from: 0n, to: 2n * life.to }, life)).toBe(life);
  });
  it('follow a cursor that leaves them, and rest while it is inside', () => {
    const span = { from: first, to: first + 1_000_000_000n };
    expect(showing(span, first + 500_000_000n, life)).toBe(span);
    const moved = showing(span, first + 60_000_000_000n, life);
    expect(lengthOf(moved)).toBe(lengthOf(span));
    expect(moved.from + lengthOf(moved) / 2n).toBe(first + 60_000_000_000n);
  });
  it('show all that was at first, and little of what is to come', () => {
    const limits = limitsOf(first, first + 20_000_000_000n, 60_000_000_000n);
    const home = homeOf(first, first + 20_000_000_000n, limits);
    expect(home.from).toBe(limits.from);
    expect(Number(home.to - first) / 1e9).toBeCloseTo(21.3, 1);
  });
  it('leave room for the future behind the last snapshot', () => {
    expect(limitsOf(first, first + 1000n, 60n).to).toBeGreaterThan(first + 1060n);
    expect(limitsOf(first, first, 0n).to).toBeGreaterThan(first);
    expect(limitsOf(-(2n ** 63n), 2n ** 63n - 1n, 60n)).toEqual({ from: -(2n ** 63n) + 1n, to: 2n ** 63n - 1n });
  });
});
