// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { decodeState, encodeState, type ViewState } from './url';

const state: ViewState = {
  memory: 2,
  cursor: 1767251528250000007n,
  view: { from: 1767250800000000001n, to: 1767252180000000003n },
  selection: { from: 1767250800000000005n, to: 1767250800000000009n },
  selected: 'Scene/Objects/tracker/cup\\/left',
  collapsed: ['Vision/RGB', 'A&B/x~y;z,1.2=(3)'],
  panels: [
    { kind: 'images', entity: 'Vision/RGB/head/stereo', paths: [], options: { m: 'blink', i: '1' } },
    { kind: 'plot', entity: 'Robot State/ü/a/b', paths: ['positions[3]', 'pose/position[0]', 'm[1,2]'], options: {} },
    { kind: 'plot', entity: 'A/B/C/D', paths: ['', '.'], options: {}, height: 412 },
    { kind: 'map', entity: 'A/B/C/D', paths: [], options: { colour: 'recording' } },
    { kind: 'query', entity: '', paths: [], options: { q: "?ids Vision/.* @ last:2s, latest ; 'x' ~ & = %" } },
  ],
  timeline: 250,
};

describe('the address', () => {
  it('gives back the whole view', () => {
    expect(decodeState(encodeState(state))).toEqual(state);
  });
  it('has nothing that a browser would change', () => {
    const hash = encodeState(state);
    expect(new URL(`http://127.0.0.1:1/${hash}`).hash).toBe(hash);
  });
  it('keeps an empty list of panels apart from none', () => {
    expect(decodeState(encodeState({ panels: [] })).panels).toEqual([]);
    expect(decodeState(encodeState({ cursor: 1n })).panels).toBeUndefined();
  });
  it('leaves out what cannot be read', () => {
    expect(decodeState('#2&t=abc')).toEqual({});
    expect(decodeState('#1&t=ZZ&v=1.0&v=.&p=bomb~x;plot~%E0%A4%A~a')).toEqual({ panels: [{ kind: 'plot', entity: '', paths: ['a'], options: {} }] });
    expect(decodeState('#1&t=zzzzzzzzzzzzz')).toEqual({}); // more than 64 bits
    expect(decodeState('#1&h=tall&p=plot~A~a~height.1e3')).toEqual({ panels: [{ kind: 'plot', entity: 'A', paths: ['a'], options: {} }] });
    expect(decodeState('')).toEqual({});
    expect(decodeState('#1&&&==&p')).toMatchObject({});
  });
  it('is short', () => {
    expect(encodeState({ cursor: state.cursor!, view: state.view! }).length).toBeLessThan(50);
  });
});
