// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { isTyping, keyOf, type Key } from './keys';

const table: Key[] = [
  { keys: [' '], shown: 'space', what: '', run: () => {} },
  { keys: ['ArrowRight'], shown: '→', what: '', run: () => {} },
  { keys: ['/'], shown: '/', what: '', run: () => {} },
  { keys: ['?'], shown: '?', what: '', run: () => {} },
  { keys: ['p'], shown: 'p', what: '', run: () => {} },
];
const press = (key: string, target: object | null = { tagName: 'BODY' }, more = {}) =>
  keyOf(table, { key, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, target: target as EventTarget, ...more })?.shown;

describe('keys', () => {
  it('mean what the table says, with shift too', () => {
    expect(press('ArrowRight', undefined, { shiftKey: true })).toBe('→');
    expect(press('?', undefined, { shiftKey: true })).toBe('?');
    expect(press('P', undefined, { shiftKey: true })).toBe('p');
    expect(press('z')).toBeUndefined();
  });
  it('write in text fields, and belong to the browser with ctrl', () => {
    expect(press('p', { tagName: 'INPUT', type: 'search' })).toBeUndefined();
    expect(press('p', { tagName: 'SELECT' })).toBeUndefined();
    expect(press('p', undefined, { ctrlKey: true })).toBeUndefined();
    expect(press('p', { tagName: 'INPUT', type: 'checkbox' })).toBe('p');
    expect(isTyping({ tagName: 'DIV', isContentEditable: true } as unknown as EventTarget)).toBe(true);
    expect(isTyping(null)).toBe(false);
  });
  it('press the button that has the focus', () => {
    expect(press(' ', { tagName: 'BUTTON' })).toBeUndefined();
    expect(press('ArrowRight', { tagName: 'BUTTON' })).toBe('→');
  });
});
