// SPDX-License-Identifier: Apache-2.0
// Which lanes there are and where, from the tree and from what is collapsed.
import type { TreeNode } from '../api/types';
import { nameOf, splitLevels } from '../state/ids';

export const kRowHeight = 22;

export interface Row {
  readonly id: string;
  /** One name, or several joined where a level has a single child: `RGB / head / stereo`. */
  readonly label: string;
  readonly depth: number;
  readonly isEntity: boolean;
  readonly isOpen: boolean;
  readonly node: TreeNode;
  readonly parent: string;
}

const ownName = (node: TreeNode): string => nameOf(splitLevels(node.id).at(-1) ?? node.name);

/** Follows single children down, so that a chain of levels takes one row and not four. */
function squeeze(node: TreeNode): { node: TreeNode; label: string } {
  const names = [ownName(node)];
  let here = node;
  while (here.children?.length === 1) {
    here = here.children[0]!;
    names.push(ownName(here));
  }
  return { node: here, label: names.join(' / ') };
}

export function rowsOf(roots: readonly TreeNode[], collapsed: ReadonlySet<string>): Row[] {
  const rows: Row[] = [];
  const visit = (start: TreeNode, depth: number, parent: string): void => {
    const { node, label } = squeeze(start);
    const isEntity = node.level === 'entity';
    const isOpen = !isEntity && !collapsed.has(node.id) && node.children !== undefined;
    rows.push({ id: node.id, label, depth, isEntity, isOpen, node, parent });
    if (isOpen) node.children!.forEach((child) => visit(child, depth + 1, node.id));
  };
  roots.forEach((root) => visit(root, 0, ''));
  return rows;
}

/** The rows on the screen, with some beyond both edges: every row has the same height. */
export function visibleRows(count: number, scrollTop: number, height: number, beyond = 4): { first: number; end: number } {
  const first = Math.max(0, Math.min(count, Math.floor(scrollTop / kRowHeight) - beyond));
  return { first, end: Math.max(first, Math.min(count, Math.ceil((scrollTop + height) / kRowHeight) + beyond)) };
}

/** The row that an arrow key leads to. */
export function neighbour(rows: readonly Row[], id: string, by: number): Row | undefined {
  const here = rows.findIndex((row) => row.id === id);
  return rows[Math.max(0, Math.min(rows.length - 1, here < 0 ? 0 : here + by))];
}
