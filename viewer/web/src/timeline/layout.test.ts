// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { treeLevel, type TreeNode } from '../api/types';
import { kRowHeight, neighbour, rowsOf, visibleRows } from './layout';

const node = (id: string, children?: unknown[]) => ({ id, name: id, level: ['memory', 'core', 'provider', 'entity'][id.split('/').length - 1], ...(children ? { children } : {}) });
const roots: TreeNode[] = treeLevel({
  children: [
    node('V', [node('V/RGB', [node('V/RGB/head', [node('V/RGB/head/stereo')]), node('V/RGB/hand', [node('V/RGB/hand/left'), node('V/RGB/hand/right')])])]),
    node('S', [node('S/T', [node('S/T/human', [node('S/T/human/text')])])]),
    node('Later'),
  ],
}, '').children;

describe('lanes', () => {
  it('take one row for a chain of single children', () => {
    expect(rowsOf(roots, new Set()).map((row) => `${'  '.repeat(row.depth)}${row.label}`)).toEqual([
      'V / RGB', '  head / stereo', '  hand', '    left', '    right', 'S / T / human / text', 'Later',
    ]);
  });
  it('hide what is below a collapsed level', () => {
    const rows = rowsOf(roots, new Set(['V/RGB']));
    expect(rows.map((row) => row.id)).toEqual(['V/RGB', 'S/T/human/text', 'Later']);
    expect(rows[0]!.isOpen).toBe(false);
  });
  it('are closed where the children are not known yet', () => {
    expect(rowsOf(roots, new Set()).at(-1)).toMatchObject({ id: 'Later', isOpen: false, isEntity: false });
  });
  it('exist only on the screen, however many there are', () => {
    const { first, end } = visibleRows(5000, 2000 * kRowHeight, 300);
    expect(first).toBe(1996);
    expect(end - first).toBeLessThan(24);
    expect(visibleRows(3, 0, 300)).toEqual({ first: 0, end: 3 });
    expect(visibleRows(0, 0, 300)).toEqual({ first: 0, end: 0 });
  });
  it('lead to their neighbours, and stop at the ends', () => {
    const rows = rowsOf(roots, new Set());
    expect(neighbour(rows, 'V/RGB/hand/left', 1)!.id).toBe('V/RGB/hand/right');
    expect(neighbour(rows, 'V/RGB/hand/left', -10)!.id).toBe('V/RGB');
    expect(neighbour(rows, 'unknown', 0)!.id).toBe('V/RGB');
    expect(neighbour([], 'x', 1)).toBeUndefined();
  });
});
