// SPDX-License-Identifier: Apache-2.0
import { For, Show } from 'solid-js';
import { selected, setSelected } from '../state/store';
import { formatCount } from '../time/format';
import { Icon } from '../ui/Icon';
import { kRowHeight, neighbour, type Row } from './layout';

/** The names of the lanes: a tree that the keyboard walks through. Only rows on the screen exist. */
export function Names(props: { rows: readonly Row[]; shown: { first: number; end: number }; onToggle: (row: Row) => void }) {
  const focusRow = (id: string) => queueMicrotask(() => document.getElementById(`row-${id}`)?.focus({ preventScroll: true }));
  const choose = (row: Row | undefined) => {
    if (!row) return;
    // A level is walked over; what is chosen is an entity.
    if (row.isEntity) setSelected(row.id);
    focusRow(row.id);
  };
  const onKey = (event: KeyboardEvent, row: Row) => {
    const by = event.shiftKey ? 10 : 1;
    if (event.key === 'ArrowDown') choose(neighbour(props.rows, row.id, by));
    else if (event.key === 'ArrowUp') choose(neighbour(props.rows, row.id, -by));
    else if (event.key === 'Enter' && !row.isEntity) {
      props.onToggle(row);
      focusRow(row.id);
    }
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const isTabStop = (row: Row, i: number) => row.id === selected() || (i === 0 && !props.rows.some((other) => other.id === selected()));
  return (
    <div class="names" role="tree" aria-label="Entities" style={{ height: `${props.rows.length * kRowHeight}px` }}>
      <For each={props.rows.slice(props.shown.first, props.shown.end)}>{(row, i) => (
        <div id={`row-${row.id}`} class="name" classList={{ chosen: row.id === selected(), group: !row.isEntity }} role="treeitem" tabindex={isTabStop(row, i() + props.shown.first) ? 0 : -1}
          aria-level={row.depth + 1} aria-selected={row.id === selected()} aria-expanded={row.isEntity ? undefined : row.isOpen}
          title={row.node.snapshots === undefined ? row.id : `${row.id}\n${formatCount(row.node.snapshots)} snapshots`}
          style={{ top: `${(i() + props.shown.first) * kRowHeight}px`, 'padding-left': `${6 + row.depth * 13}px` }}
          onClick={() => { if (row.isEntity) setSelected(row.id); else props.onToggle(row); }} onKeyDown={(event) => onKey(event, row)}>
          <span class="twist" aria-hidden="true"><Show when={!row.isEntity}><Icon name={row.isOpen ? 'chevron-down' : 'chevron-right'} /></Show></span>
          <span class="label">{row.label}</span>
          <span class="count">{row.node.snapshots === undefined ? '' : formatCount(row.node.snapshots)}</span>
        </div>
      )}</For>
    </div>
  );
}
