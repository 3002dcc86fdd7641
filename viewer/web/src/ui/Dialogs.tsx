// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, onMount, Show, type JSX } from 'solid-js';
import { getJson } from '../api/client';
import { found as foundDecoder, isImage } from '../api/types';
import { createRequest } from '../state/request';
import { cursor, entities, openPanel, setCursor, setSelected } from '../state/store';
import { formatTime, parseTime } from '../time/format';
import type { Key } from './keys';
import { IconButton } from './Icon';

/** The browser's own dialog: it keeps the focus inside and closes on Escape. */
function Dialog(props: { title: string; onClose: () => void; children: JSX.Element }) {
  let element!: HTMLDialogElement;
  onMount(() => element.showModal());
  // In a search field, browsers take the first Escape to empty it.
  const onKey = (event: KeyboardEvent) => {
    if (event.key !== 'Escape') return;
    event.preventDefault();
    element.close();
  };
  return (
    <dialog ref={element} aria-label={props.title} onKeyDown={onKey} onClose={() => props.onClose()} onClick={(event) => { if (event.target === element) element.close(); }}>
      <div class="dialog-body">
        <header><h2>{props.title}</h2><IconButton icon="x" label="Close" onClick={() => element.close()} /></header>
        {props.children}
      </div>
    </dialog>
  );
}

export function HelpDialog(props: { keys: readonly Key[]; onClose: () => void }) {
  return (
    <Dialog title="Keys and gestures" onClose={props.onClose}>
      <div class="help">
        <dl><For each={props.keys}>{(key) => <><dt><kbd>{key.shown}</kbd></dt><dd>{key.what}</dd></>}</For></dl>
        <dl>
          <dt>wheel, pinch</dt><dd>zoom at the pointer</dd>
          <dt>drag</dt><dd>move in time; on the axis: move the cursor</dd>
          <dt>shift + drag</dt><dd>select a stretch of time</dd>
          <dt>shift + wheel</dt><dd>move in time</dd>
          <dt>alt + wheel</dt><dd>scroll the lanes</dd>
          <dt>click</dt><dd>put the cursor there and choose the lane</dd>
          <dt>drag a title bar</dt><dd>change the order of panels; on a title bar that has the focus, alt + shift + arrow does it, too</dd>
          <dt>drag a lower edge</dt><dd>change the height of a panel or of the timeline; arrow keys do it, too, and a double click undoes it</dd>
          <dt>behind the end</dt><dd>the hatched part is the future: a cursor there predicts</dd>
        </dl>
      </div>
    </Dialog>
  );
}

export function SearchDialog(props: { onClose: () => void }) {
  const [text, setText] = createSignal('');
  const [place, setPlace] = createSignal(0);
  // The tree may be known in part only, so the gateway is asked as well.
  const asked = createRequest(() => (text().trim() === '' ? null : { group: 'find', run: (signal: AbortSignal) => getJson('find', { text: text().trim(), max: 40 }, foundDecoder, signal) }));
  const list = createMemo(() => {
    const words = text().toLowerCase().split(/\s+/);
    const known = entities().map((node) => node.id).filter((id) => words.every((word) => id.toLowerCase().includes(word)));
    return [...new Set([...known, ...(asked.data()?.found ?? [])])].slice(0, 40);
  });
  const choose = (id: string | undefined, open = false) => {
    if (!id) return;
    setSelected(id);
    if (open) openPanel(isImage(entities().find((node) => node.id === id)?.kinds ?? []) ? 'images' : 'plot', id);
    props.onClose();
  };
  const onKey = (event: KeyboardEvent) => {
    const by = event.shiftKey ? 10 : 1;
    if (event.key === 'ArrowDown') setPlace(Math.min(list().length - 1, place() + by));
    else if (event.key === 'ArrowUp') setPlace(Math.max(0, place() - by));
    else if (event.key === 'Enter') choose(list()[place()], event.shiftKey);
    else return;
    event.preventDefault();
  };
  return (
    <Dialog title="Search entities" onClose={props.onClose}>
      <input type="search" autofocus role="combobox" aria-expanded="true" aria-controls="found" aria-activedescendant={list().length > 0 ? `found-${place()}` : undefined} aria-label="Name of an entity" placeholder="stereo, joints, cereal ..." value={text()} onInput={(event) => { setText(event.currentTarget.value); setPlace(0); }} onKeyDown={onKey} />
      <ul id="found" class="found" role="listbox" aria-label="Entities found">
        <For each={list()}>{(id, i) => <li id={`found-${i()}`} role="option" aria-selected={i() === place()} onClick={() => choose(id)}>{id}</li>}</For>
      </ul>
      <Show when={list().length === 0}><p class="muted">{asked.isBusy() ? 'Searching ...' : asked.error() || 'No entity has such a name.'}</p></Show>
      <p class="muted">Enter chooses, shift + Enter opens a panel as well.</p>
    </Dialog>
  );
}

export function TimeDialog(props: { onClose: () => void }) {
  const [text, setText] = createSignal(formatTime(cursor()));
  const time = () => parseTime(text(), cursor());
  return (
    <Dialog title="Go to a time" onClose={props.onClose}>
      <form onSubmit={(event) => { event.preventDefault(); const to = time(); if (to !== undefined) { setCursor(to); props.onClose(); } }}>
        <input autofocus class="mono grow" aria-label="Time" aria-invalid={time() === undefined} value={text()} onInput={(event) => setText(event.currentTarget.value)} onFocus={(event) => event.currentTarget.select()} />
        <p class="muted">{time() === undefined ? 'A time looks like 2026-01-01 07:12:30.5, 07:12:30 or 1767251550000000000 (UTC).' : `${formatTime(time()!)} UTC`}</p>
        <button type="submit" disabled={time() === undefined}>Go</button>
      </form>
    </Dialog>
  );
}
