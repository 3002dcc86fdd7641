// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, For, onCleanup, Show } from 'solid-js';
import { getJson } from '../api/client';
import { isImage, moment as momentDecoder, similar, type Similar } from '../api/types';
import { createMembers } from '../state/moment';
import { restCursor } from '../state/moving';
import { createRequest } from '../state/request';
import { info, last, nodeOf, setCursor, setMarks, setOption, setSelected, type Panel } from '../state/store';
import { formatClock, formatDuration, formatTime } from '../time/format';
import { Empty, PanelFrame } from '../ui/PanelFrame';
import { Thumb } from './images/Thumb';

const kCounts = ['6', '12', '24'];

/** When it was like this before: the nearest moments, one of each recording where there are several. */
export function SimilarPanel(props: { panel: Panel }) {
  const entity = () => props.panel.entity;
  const members = createMembers(entity);
  const path = createMemo(() => members.data()?.find((member) => isImage(member.kind))?.path);
  const count = () => (kCounts.includes(props.panel.options.k ?? '') ? props.panel.options.k! : '12');
  const found = createRequest<Similar[]>(() => {
    const at = restCursor();
    const k = count();
    if (!info() || at === 0n) return null;
    // A future moment has no code; the last one that was seen has.
    const time = at > last() ? last() : at;
    const first = nodeOf(entity())?.first;
    if (first !== undefined && time < first) return null;
    return {
      group: `${entity()} ${k}`,
      run: async (signal) => {
        const here = await getJson('moment', { entity: entity(), at: time }, momentDecoder, signal);
        const ask = async (more: { one_per?: string }) => (await getJson('similar', { id: here.id, k, ...more }, similar, signal)).found;
        const ofEach = await ask({ one_per: 'recording' });
        // Of a memory with one recording that would be one moment.
        return ofEach.length > 1 ? ofEach : ask({});
      },
    };
  });
  createEffect(() => setMarks((found.data() ?? []).map((one) => one.time)));
  onCleanup(() => setMarks([]));
  return (
    <PanelFrame panel={props.panel} icon="sparkles" title="Similar moments" isBusy={found.isBusy()} error={found.error()} onRetry={found.retry}
      actions={<label class="field">show<select aria-label="How many" onChange={(event) => setOption(props.panel, 'k', event.currentTarget.value)}><For each={kCounts}>{(k) => <option selected={k === count()}>{k}</option>}</For></select></label>}>
      <Show when={found.data()} fallback={<Show when={!found.error()}><div class="thumbs"><For each={[1, 2, 3, 4, 5, 6]}>{() => <div class="skeleton square" />}</For></div></Show>}>
        {(list) => (
          <Show when={list().length > 0} fallback={<Empty title="Nothing like it was found">A night makes the codes that moments are compared by: run engram consolidate.</Empty>}>
            <ul class="thumbs">
              <For each={list()}>{(one) => (
                <li><button class="thumb" title={`Go to ${formatTime(one.time)}`} onClick={() => { setSelected(entity()); setCursor(one.time); }}>
                  <Thumb id={one.id} path={path()} />
                  <span class="thumb-text"><b title="Distance: 0 is equal, 1 as different as any two moments">{one.distance.toFixed(2)}</b><span>{formatClock(one.time, 1)}</span><span class="muted">{away(one.time)}</span></span>
                </button></li>
              )}</For>
            </ul>
          </Show>
        )}
      </Show>
    </PanelFrame>
  );
}

function away(time: bigint): string {
  const from = restCursor();
  return time > from ? `${formatDuration(time - from)} later` : `${formatDuration(from - time)} ago`;
}
