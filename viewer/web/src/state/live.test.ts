// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { newestOf } from './live';

describe('frames of a live memory', () => {
  it('tell the newest time', () => {
    expect(newestOf('{"kind":"commit","ids":["A/B/C/D/5","A/B/C/E/9","A/B/C/D/7/0"]}').newest).toBe(9n);
    expect(newestOf('{"kind":"commit","ids":["A/B/C/D/5","A/B/C/E/9","A/B/C/D/7/0","A/B/C/D/6"]}').ofEach).toEqual(new Map([['A/B/C/D', 7n], ['A/B/C/E', 9n]]));
  });
  it('tell what was dropped and interrupted', () => {
    expect(newestOf('{"kind":"dropped","count":3}').dropped).toBe(3);
    expect(newestOf('{"kind":"interrupted","message":"gone"}').message).toBe('gone');
  });
  it('that cannot be read change nothing', () => {
    for (const text of ['', '{', '[]', '{"kind":5}', '{"kind":"commit","ids":[7]}', '{"kind":"commit","ids":["A/B"]}']) expect(newestOf(text).newest).toBeUndefined();
  });
});
