// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from 'vitest';
import { applyState, currentState, heightOf, movePanel, panels, setHeight, setTimelineHeight, takePlace, timelineHeight } from './store';
import { decodeState, encodeState } from './url';

const kinds = () => panels().map((panel) => panel.kind).join(' ');
const keyOf = (kind: string) => panels().find((panel) => panel.kind === kind)!.key;

describe('the order of panels', () => {
  beforeEach(() => applyState(decodeState('#1&p=images~A;inspector;plot~A~a;similar~A;map~A')));
  it('changes among those that stand together', () => {
    expect(movePanel(keyOf('images'), 1)).toBe(true);
    expect(kinds()).toBe('inspector plot images similar map');
    expect(movePanel(keyOf('similar'), 1)).toBe(false);
    expect(movePanel(keyOf('similar'), -1)).toBe(true);
    expect(kinds()).toBe('similar inspector plot images map');
  });
  it('lets one take the place of another', () => {
    takePlace(keyOf('map'), keyOf('images'));
    expect(kinds()).toBe('map images inspector plot similar');
    takePlace(keyOf('map'), keyOf('plot'));
    expect(kinds()).toBe('images inspector plot map similar');
    takePlace(keyOf('map'), 12345);
    expect(kinds()).toBe('images inspector plot map similar');
  });
});

describe('heights', () => {
  it('are in the address, and no part of what a panel asks by', () => {
    applyState(decodeState('#1&p=images~A;plot~A~a'));
    const before = panels();
    setHeight(keyOf('plot'), 333);
    setTimelineHeight(222);
    expect(panels()).toBe(before);
    const hash = encodeState(currentState());
    expect(hash).toContain('&h=222&p=images~A;plot~A~a~height.333');
    applyState(decodeState(hash));
    expect([heightOf(keyOf('images')), heightOf(keyOf('plot')), timelineHeight()]).toEqual([undefined, 333, 222]);
    setHeight(keyOf('plot'), null);
    expect(encodeState(currentState())).not.toContain('height');
  });
  it('of old and of broken links are those that a page can show', () => {
    applyState(decodeState('#1&h=9999&p=plot~A~a~height.1'));
    expect([heightOf(keyOf('plot')), timelineHeight()]).toEqual([120, 900]);
    applyState(decodeState('#1&p=plot~A~a'));
    expect([heightOf(keyOf('plot')), timelineHeight()]).toEqual([undefined, null]);
  });
});
