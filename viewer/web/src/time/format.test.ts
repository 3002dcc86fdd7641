// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { formatBytes, formatClock, formatDuration, formatNumber, formatTime, parseTime } from './format';
import { stepFor, ticksOf } from './ticks';

describe('times', () => {
  it('are printed as Engram prints them', () => {
    expect(formatTime(1645189616492182000n)).toBe('2022-02-18 13:06:56.492182');
    expect(formatTime(1645189616492182001n)).toBe('2022-02-18 13:06:56.492182001');
    expect(formatTime(-1n)).toBe('1969-12-31 23:59:59.999999999');
  });
  it('read back to the same nanosecond', () => {
    for (const time of [0n, 1645189616492182001n, 1767250800000000007n]) expect(parseTime(formatTime(time), 0n)).toBe(time);
    expect(parseTime('1767250800000000007', 0n)).toBe(1767250800000000007n);
  });
  it('are of the day at hand if no day is given', () => {
    expect(parseTime('07:12:08.25', 1767250800000000000n)).toBe(1767251528250000000n);
    expect(parseTime('soon', 0n)).toBeUndefined();
    expect(parseTime('2026-13-40 00:00:00', 0n)).toBeUndefined();
  });
  it('have the digits that are asked for', () => {
    expect(formatClock(1645189616492182001n, 0)).toBe('13:06:56');
    expect(formatClock(1645189616492182001n, 9)).toBe('13:06:56.492182001');
  });
  it('outside of what a calendar holds are nanoseconds', () => {
    expect(formatClock(2n ** 63n - 1n, 3)).toMatch(/^\d\d:\d\d:\d\d|ns$/);
  });
});

describe('durations, bytes and numbers', () => {
  it('are written in the unit that reads best', () => {
    expect(formatDuration(400_000_000n)).toBe('400 ms');
    expect(formatDuration(-2_500_000_000n)).toBe('-2.5 s');
    expect(formatDuration(200_000_000_000n)).toBe('3 min 20 s');
    expect(formatDuration(12n)).toBe('12 ns');
    expect(formatBytes(412)).toBe('412 B');
    expect(formatBytes(1_420_000)).toBe('1.42 MB');
    expect(formatNumber(0.1 + 0.2)).toBe('0.3');
    expect(formatNumber(NaN)).toBe('NaN');
  });
});

describe('ticks', () => {
  const from = 1767250800000000000n;
  it('stand at round times, apart enough to be read', () => {
    for (const length of [20_000n, 1_000_000n, 3_000_000_000n, 1_380_000_000_000n, 86_400_000_000_000n * 400n]) {
      const span = { from: from + 3n, to: from + 3n + length };
      const ticks = ticksOf(span, 1100);
      const step = stepFor(span, 1100, 92);
      expect(ticks.length).toBeGreaterThan(1);
      expect(ticks.length).toBeLessThan(14);
      for (const tick of ticks) expect(tick.time % step).toBe(0n);
    }
  });
  it('say the second at full seconds and the fraction between', () => {
    const labels = ticksOf({ from, to: from + 1_200_000_000n }, 1100).map((tick) => tick.label);
    expect(labels).toContain('07:00:00');
    expect(labels).toContain('.200');
  });
});
