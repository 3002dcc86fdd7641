// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { quality } from '../../api/types';
import { barsOf, nextBar } from './bars';

const answer = quality({ entity: 'A/B/C/D', low: 28, step: 0.5, counts: [2, 0, 5, 1], unknown: 1, compared: 8, worst: [{ id: 'b', psnr: 28.4 }, { id: 'a', psnr: 28.1 }, { id: 'c', psnr: 29.0 }] }, '');

describe('bars of quality', () => {
  it('lead to the worst snapshot in them, or else to the worst of all', () => {
    expect(barsOf(answer).map((bar) => [bar.low, bar.high, bar.count, bar.goal?.id, bar.isOwn])).toEqual([[28, 28.5, 2, 'a', true], [28.5, 29, 0, 'a', false], [29, 29.5, 5, 'c', true], [29.5, 30, 1, 'a', false]]);
  });
  it('lead nowhere where no snapshot is named', () => {
    expect(barsOf({ ...answer, worst: [] }).every((bar) => bar.goal === undefined)).toBe(true);
  });
  it('are walked by keys, over those that are empty', () => {
    const bars = barsOf(answer);
    expect([nextBar(bars, 0, 1), nextBar(bars, 2, -1), nextBar(bars, 3, 1), nextBar(bars, 0, -1)]).toEqual([2, 0, 3, 0]);
  });
});

describe('an answer of quality', () => {
  it('without steps is refused', () => {
    expect(() => quality({ low: 1, step: 0, counts: [1], worst: [] }, '')).toThrow(/above 0/);
  });
});
