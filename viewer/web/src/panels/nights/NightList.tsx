// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, Show } from 'solid-js';
import type { Night, NightEntity, Nights } from '../../api/nightTypes';
import { createRequest, type Request } from '../../state/request';
import { setSelected } from '../../state/store';
import { formatBytes, formatClock, formatCount, formatDate, formatTime } from '../../time/format';
import { Empty } from '../../ui/PanelFrame';
import { Findings } from './Findings';
import { askReflection } from './ReflectionPart';
import { changeText, findingsText, lengthText, modelsText, nightText, untilOf } from './told';

/** What each night did, the newest first: bytes before and after, and on a click all of it. */
export function NightList(props: { asked: Request<Nights> }) {
  const nights = createMemo(() => props.asked.data()?.nights ?? []);
  const largest = createMemo(() => nights().reduce((size, night) => Math.max(size, night.bytes_before, night.bytes_after), 1));
  const [opened, setOpened] = createSignal('');
  const keyOf = (night: Night) => `${night.work} ${night.began}`;
  let list!: HTMLUListElement;
  const onKey = (event: KeyboardEvent) => {
    if (event.altKey || event.ctrlKey || event.metaKey || (event.key !== 'ArrowDown' && event.key !== 'ArrowUp')) return;
    const heads = [...list.querySelectorAll<HTMLButtonElement>('.night-head')];
    const next = heads[heads.indexOf(document.activeElement as HTMLButtonElement) + (event.key === 'ArrowDown' ? 1 : -1)];
    if (!heads.includes(document.activeElement as HTMLButtonElement)) return;
    next?.focus();
    event.preventDefault();
    event.stopPropagation();
  };
  const width = (bytes: number) => `${(bytes / largest()) * 100}%`;
  return (
    <Show when={props.asked.data()} fallback={<Show when={!props.asked.error()}><div class="skeleton tall" /></Show>}>
      <Show when={nights().length > 0} fallback={<Empty title="No night is written down yet">engram consolidate and engram forget write down what they do. What they did before that is not known.</Empty>}>
        <ul class="nights-list" ref={list} aria-label="Nights" onKeyDown={onKey}>
          <For each={nights()}>{(night, i) => (
            <li>
              <button class="night-head" aria-expanded={opened() === keyOf(night)} onClick={() => setOpened(opened() === keyOf(night) ? '' : keyOf(night))}>
                <span class="night-when"><b>{formatDate(night.began)}</b> {formatClock(night.began, 0)}</span>
                <span class="night-work" classList={{ forget: night.work === 'forget', failed: night.failure !== '' }}>{night.work === 'forget' ? 'forgot' : 'learned'}{night.failure !== '' ? ', ended early' : ''}</span>
                <span class="night-bars" aria-hidden="true"><i class="before" style={{ width: width(night.bytes_before) }} /><i class="after" style={{ width: width(night.bytes_after) }} /></span>
                <span class="night-bytes">{changeText(night.bytes_before, night.bytes_after)}</span>
                <span class="night-text">{nightText(night)}</span>
              </button>
              <Show when={opened() === keyOf(night)}><NightDetails night={night} until={untilOf(nights(), i())} /></Show>
            </li>
          )}</For>
        </ul>
        <Show when={props.asked.data()!.more || props.asked.data()!.unreadable > 0}>
          <p class="bar muted">{props.asked.data()!.more ? 'There are older nights, which are not shown. ' : ''}{props.asked.data()!.unreadable > 0 ? `${formatCount(props.asked.data()!.unreadable)} records of nights cannot be read.` : ''}</p>
        </Show>
      </Show>
    </Show>
  );
}

type Column = readonly [title: string, text: (entity: NightEntity) => string];
const counted = (key: 'learned' | 'encoded' | 'waiting' | 'dropped' | 'forgotten' | 'faded') => (entity: NightEntity) => (entity[key] === 0 ? '' : formatCount(entity[key]));
const decibels = (value: number | undefined) => (value === undefined ? '' : `${value.toFixed(1)} dB`);
const kColumns: readonly Column[] = [
  ['learned from', counted('learned')], ['encoded', counted('encoded')], ['waiting', counted('waiting')], ['latents alone', counted('dropped')], ['faded', counted('faded')], ['forgotten', counted('forgotten')],
  ['before', (entity) => formatBytes(entity.bytes_before)], ['after', (entity) => formatBytes(entity.bytes_after)], ['PSNR', (entity) => decibels(entity.psnr)], ['worst', (entity) => decibels(entity.min_psnr)],
  ['models', modelsText], ['why not', (entity) => entity.skipped],
];

function NightDetails(props: { night: Night; until: bigint | undefined }) {
  // Columns that would be empty are left out.
  const columns = createMemo(() => kColumns.filter(([, text]) => props.night.entities.some((entity) => text(entity) !== '')));
  const entities = createMemo(() => [...props.night.entities].sort((a, b) => Math.abs(b.bytes_before - b.bytes_after) - Math.abs(a.bytes_before - a.bytes_after)));
  const asked = createRequest(() => (props.night.work === 'forget' ? null : { group: String(props.night.began), run: (signal: AbortSignal) => askReflection(props.until === undefined ? {} : { at: props.until - 1n }, signal) }));
  /** Recorded after this night and before the next one. */
  const reflection = createMemo(() => { const answer = asked.data(); return answer && 'findings' in answer && answer.time >= props.night.began ? answer : undefined; });
  return (
    <div class="night-details">
      <p>From {formatTime(props.night.began)} on, for {lengthText(props.night)}.<Show when={props.night.failure !== ''}> <span class="night-failure">It ended early: {props.night.failure}</span></Show></p>
      <Show when={entities().length > 0} fallback={<p class="muted">No entity had anything new.</p>}>
        <div class="night-table" tabindex="0" role="region" aria-label={`What the night of ${formatTime(props.night.began)} did`}>
          <table>
            <thead><tr><th scope="col">entity</th><For each={columns()}>{([title]) => <th scope="col">{title}</th>}</For></tr></thead>
            <tbody><For each={entities()}>{(entity) => (
              <tr><th scope="row"><button title={`Choose ${entity.id}`} onClick={() => setSelected(entity.id)}>{entity.id}</button></th><For each={columns()}>{([, text]) => <td>{text(entity)}</td>}</For></tr>
            )}</For></tbody>
          </table>
        </div>
      </Show>
      <Show when={asked.error()}><p class="night-failure" role="alert">{asked.error()}</p></Show>
      <Show when={reflection()}>
        <h3>Reflection <span class="muted">of {formatTime(reflection()!.time)}: {findingsText(reflection()!)}</span></h3>
        <Findings findings={reflection()!.findings} />
      </Show>
      <Show when={props.night.work === 'consolidate' && asked.data() && !reflection()}><p class="muted">No reflection was recorded after this night: engram reflect --commit does.</p></Show>
    </div>
  );
}
