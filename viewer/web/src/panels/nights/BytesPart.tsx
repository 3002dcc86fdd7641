// SPDX-License-Identifier: Apache-2.0
import { createMemo, For, Show } from 'solid-js';
import type { Nights } from '../../api/nightTypes';
import type { Request } from '../../state/request';
import { selected, setSelected } from '../../state/store';
import { formatBytes, formatCount } from '../../time/format';
import { Empty } from '../../ui/PanelFrame';
import { QualityPart } from './QualityPart';

type Row = Nights['entities'][number];

/** What each entity takes: plain, recorded, as latents, and the models. */
export function BytesPart(props: { asked: Request<Nights> }) {
  const rows = createMemo(() => [...(props.asked.data()?.entities ?? [])].sort((a, b) => b.raw_bytes - a.raw_bytes));
  const kept = (row: Row) => row.stored_bytes + row.latent_bytes + row.model_bytes;
  const largest = createMemo(() => rows().reduce((size, row) => Math.max(size, kept(row)), 1));
  // Only what is kept in both forms can be compared.
  const compared = createMemo(() => { const row = rows().find((one) => one.id === selected()); return row && row.stored_bytes > 0 && row.latent_bytes > 0 ? row.id : ''; });
  const sum = (of: (row: Row) => number) => rows().reduce((total, row) => total + of(row), 0);
  return (
    <Show when={props.asked.data()} fallback={<Show when={!props.asked.error()}><div class="skeleton tall" /></Show>}>
      <Show when={rows().length > 0} fallback={<Empty title="Nothing is stored yet">Record something, and let engram consolidate work on it.</Empty>}>
        <p class="sums"><b>{formatBytes(sum((row) => row.raw_bytes))}</b> plain, kept in <b>{formatBytes(sum(kept))}</b> <span class="muted">({Math.round(sum((row) => row.raw_bytes) / Math.max(1, sum(kept)))} to 1)</span></p>
        <div class="nights-body">
          <div class="series-table" tabindex="0" role="region" aria-label="Bytes of each entity">
            <table class="bytes">
              <thead><tr><th scope="col">entity</th><th scope="col">snapshots</th><th scope="col">plain</th><th scope="col">kept</th><th scope="col">recorded, latents, models</th><th scope="col">PSNR</th></tr></thead>
              <tbody><For each={rows()}>{(row) => (
                <tr>
                  <th scope="row"><button onClick={() => setSelected(row.id)} title={row.id}>{row.id}</button></th>
                  <td>{formatCount(row.snapshots)}</td><td>{formatBytes(row.raw_bytes)}</td><td>{formatBytes(kept(row))}</td>
                  <td class="bar-cell" title={`recorded ${formatBytes(row.stored_bytes)}, latents ${formatBytes(row.latent_bytes)}, models ${formatBytes(row.model_bytes)}`}>
                    <span class="stack">
                      <i class="recorded" style={{ width: `${(row.stored_bytes / largest()) * 100}%` }} /><i class="latent" style={{ width: `${(row.latent_bytes / largest()) * 100}%` }} /><i class="augmented" style={{ width: `${(row.model_bytes / largest()) * 100}%` }} />
                    </span>
                  </td>
                  <td><Show when={row.psnr} fallback={row.psnr_mean_over_images_db === undefined ? '' : `${row.psnr_mean_over_images_db.toFixed(1)} dB`}><Histogram psnr={row.psnr!} /></Show></td>
                </tr>
              )}</For></tbody>
            </table>
          </div>
          <Show when={compared() !== ''}><QualityPart entity={compared()} /></Show>
        </div>
      </Show>
    </Show>
  );
}

function Histogram(props: { psnr: NonNullable<Row['psnr']> }) {
  const highest = () => Math.max(1, ...props.psnr.counts);
  const text = () => `${props.psnr.mean?.toFixed(1) ?? '?'} dB on average`;
  return (
    <span class="histogram" role="img" aria-label={text()} title={text()}>
      <For each={props.psnr.counts.slice(0, 24)}>{(count) => <i style={{ height: `${Math.max(1, (count / highest()) * 16)}px` }} />}</For>
      <span>{props.psnr.mean?.toFixed(1)} dB</span>
    </span>
  );
}
