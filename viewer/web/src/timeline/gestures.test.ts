// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { listen } from './gestures';

function surface() {
  const element = Object.assign(new EventTarget(), { getBoundingClientRect: () => ({ left: 0, top: 0 }), setPointerCapture: () => {}, focus: () => {} });
  const calls: string[] = [];
  const note = (name: string) => (...numbers: unknown[]) => { calls.push(`${name} ${numbers.map(Number).join(' ')}`); };
  listen(element as unknown as HTMLElement, { zoom: note('zoom'), pan: note('pan'), hover: note('hover'), pick: note('pick'), scrub: note('scrub'), select: note('select'), isScrubbing: (y) => y < 20 });
  const send = (type: string, pointerId: number, x: number, y = 50) => element.dispatchEvent(Object.assign(new Event(type), { pointerId, clientX: x, clientY: y, button: 0, shiftKey: false }));
  return { calls, send };
}

describe('gestures', () => {
  it('click where nothing moves, and drag where something does', () => {
    const { calls, send } = surface();
    send('pointerdown', 1, 10); send('pointerup', 1, 10);
    expect(calls).toEqual(['pick 10 50']);
    send('pointerdown', 1, 10); send('pointermove', 1, 30); send('pointerup', 1, 30);
    expect(calls.slice(1)).toEqual(['pan -20 0']);
  });
  it('do nothing where the browser takes them over', () => {
    const { calls, send } = surface();
    send('pointerdown', 1, 10); send('pointercancel', 1, 10);
    expect(calls).toEqual([]);
  });
  it('with two fingers end when the first is lifted', () => {
    const thrown: unknown[] = [];
    const onThrown = (error: unknown) => thrown.push(error);
    // Errors of listeners are told there, a turn later.
    process.once('uncaughtException', onThrown);
    const { calls, send } = surface();
    send('pointerdown', 1, 100); send('pointerdown', 2, 200); send('pointermove', 2, 300);
    expect(calls).toEqual(['zoom 200 0.5', 'pan -50 0']);
    send('pointerup', 1, 100); send('pointermove', 2, 350); send('pointerup', 2, 350);
    return new Promise((done) => setTimeout(done)).then(() => {
      process.off('uncaughtException', onThrown);
      expect([thrown, calls.length]).toEqual([[], 2]);
    });
  });
});
