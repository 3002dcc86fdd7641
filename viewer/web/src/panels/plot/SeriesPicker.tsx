// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, Show } from 'solid-js';
import type { Member } from '../../api/types';
import { updatePanel, type Panel } from '../../state/store';
import { visibleRows } from '../../timeline/layout';

const kMaxSeries = 32;

/** Finds members among thousands; only those on the screen exist. */
export function SeriesPicker(props: { panel: Panel; members: readonly Member[]; onClose: () => void }) {
  const [text, setText] = createSignal('');
  const [scrollTop, setScrollTop] = createSignal(0);
  let list!: HTMLDivElement;
  const found = createMemo(() => {
    const words = text().toLowerCase().split(/\s+/).filter((word) => word !== '');
    return props.members.filter((member) => words.every((word) => `${member.path} ${member.name ?? ''} ${member.unit ?? ''}`.toLowerCase().includes(word)));
  });
  const shown = createMemo(() => visibleRows(found().length, scrollTop(), 200));
  const toggle = (path: string) => {
    const { paths } = props.panel;
    if (paths.includes(path)) updatePanel(props.panel.key, { paths: paths.filter((other) => other !== path) });
    else if (paths.length < kMaxSeries) updatePanel(props.panel.key, { paths: [...paths, path] });
  };
  return (
    <div class="picker" onKeyDown={(event) => { if (event.key === 'Escape') { event.stopPropagation(); props.onClose(); } }}>
      <input type="search" ref={(input) => queueMicrotask(() => input.focus())} placeholder={`Search ${props.members.length} series`} aria-label="Search series" value={text()} onInput={(event) => { setText(event.currentTarget.value); list.scrollTop = 0; }} />
      <div class="picker-list" ref={list} role="group" aria-label="Series" tabindex="0" style={{ height: `${Math.max(22, Math.min(154, found().length * 22))}px` }} onScroll={(event) => setScrollTop(event.currentTarget.scrollTop)}>
        <div class="picker-all" style={{ height: `${found().length * 22}px` }}>
          <For each={found().slice(shown().first, shown().end)}>{(member, i) => (
            <label class="picker-row" style={{ top: `${(i() + shown().first) * 22}px` }}>
              <input type="checkbox" checked={props.panel.paths.includes(member.path)} onChange={() => toggle(member.path)} />
              <span class="key">{member.path || 'value'}</span><span class="muted">{member.name}</span><span class="unit">{member.unit}</span>
            </label>
          )}</For>
        </div>
        <Show when={found().length === 0}><p class="muted">No series is called so.</p></Show>
      </div>
    </div>
  );
}
