// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { withoutForeignTimes } from './start';

const known = { first: 1000n, last: 2000n, max_horizon_ns: 100n };

describe('times of another memory', () => {
  it('stay where the memory has them, or can predict them', () => {
    const state = { cursor: 2100n, view: { from: 0n, to: 1000n }, selected: 'A/B/C/D' };
    expect(withoutForeignTimes(state, known)).toEqual(state);
  });
  it('go where it has nothing of them, and nothing else goes', () => {
    expect(withoutForeignTimes({ cursor: 999n, view: { from: 1500n, to: 1600n } }, known)).toEqual({ view: { from: 1500n, to: 1600n } });
    expect(withoutForeignTimes({ cursor: 2101n, view: { from: 2101n, to: 3000n }, selected: 'A/B/C/D', memory: 1 }, known)).toEqual({ selected: 'A/B/C/D', memory: 1 });
  });
});
