// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, Show } from 'solid-js';
import { getJson } from '../api/client';
import * as d from '../api/decode';
import { follow } from '../state/actions';
import { parseId } from '../state/ids';
import { createRequest } from '../state/request';
import { setOption, type Panel } from '../state/store';
import { formatTime } from '../time/format';
import { Empty, PanelFrame } from '../ui/PanelFrame';
import { SourceTag } from '../ui/SourceTag';

// Times come as numbers there, which JavaScript cannot hold; the IDs have them as text.
const answer = d.object({
  /** With `?ids` in front. */
  ids: d.withDefault(d.list(d.string), []),
  entities: d.withDefault(d.list(d.object({ id: d.string, snapshots: d.withDefault(d.list(d.object({ id: d.string, source: d.withDefault(d.string, '') })), []) })), []),
});
const kMaxRows = 500;

/** The language of queries as it is: docs/query.md. */
export function QueryPanel(props: { panel: Panel }) {
  const query = () => props.panel.options.q ?? '';
  const [text, setText] = createSignal(query());
  const asked = createRequest(() => (query() === '' ? null : { group: query(), run: (signal: AbortSignal) => getJson('query', { q: query() }, answer, signal) }));
  const rows = createMemo(() => [
    ...(asked.data()?.entities ?? []).flatMap((entity) => entity.snapshots),
    ...(asked.data()?.ids ?? []).map((id) => ({ id, source: '' })),
  ]);
  const shown = createMemo(() => rows().slice(0, kMaxRows).map((row) => ({ ...row, ...parseId(row.id) })));
  return (
    <PanelFrame panel={props.panel} icon="terminal" title="Query" isBusy={asked.isBusy()} error={asked.error()} onRetry={asked.retry}>
      <form class="bar" onSubmit={(event) => { event.preventDefault(); setOption(props.panel, 'q', text().trim()); }}>
        <input class="grow mono" aria-label="Query" spellcheck={false} placeholder="?ids Vision/RGB @ last:2s" value={text()} onInput={(event) => setText(event.currentTarget.value)} />
        <button type="submit">Ask</button>
      </form>
      <Show when={asked.data()} fallback={<Show when={!asked.isBusy() && !asked.error()}><Empty title="Ask the memory">Names, then @ and a selector: latest, last:2s, T1..T2, +400ms. ?ids in front asks for IDs alone.</Empty></Show>}>
        <div class="series-table" tabindex="0" role="region" aria-label="Answer">
          <table>
            <caption>{shown().length} of {rows().length} snapshots</caption>
            <thead><tr><th scope="col">entity</th><th scope="col">time</th><th scope="col">source</th></tr></thead>
            <tbody><For each={shown()}>{(row) => (
              <tr><th scope="row"><button onClick={() => follow(row.id)}>{row.entity}</button></th><td>{row.time === undefined ? '' : formatTime(row.time)}</td><td><Show when={row.source}><SourceTag source={row.source} /></Show></td></tr>
            )}</For></tbody>
          </table>
        </div>
      </Show>
    </PanelFrame>
  );
}
