// SPDX-License-Identifier: Apache-2.0
import { createMemo, For } from 'solid-js';
import { setCursor, view } from '../../state/store';
import { formatClock, formatNumber } from '../../time/format';
import { timeAt } from '../../time/span';
import { digitsFor } from '../../timeline/overlay';
import type { Plotted } from './data';

const kMaxRows = 100;

/** What the plot shows, as numbers; evenly thinned if there are many. */
export function SeriesTable(props: { plotted: Plotted; labels: readonly string[] }) {
  const rows = createMemo(() => {
    const { plotted } = props;
    const all: { time: bigint; i: number }[] = [];
    for (let i = 0; i < plotted.pixels; ++i) {
      const time = timeAt(i + 0.5, plotted.span, plotted.pixels);
      if (time >= view().from && time <= view().to && plotted.series.some((series) => !Number.isNaN(series.last[i]!))) all.push({ time, i });
    }
    const step = Math.max(1, all.length / kMaxRows);
    return { count: all.length, shown: Array.from({ length: Math.min(all.length, kMaxRows) }, (_, j) => all[Math.floor(j * step)]!) };
  });
  return (
    <div class="series-table" tabindex="0" role="region" aria-label="Values of the plot">
      <table>
        <caption>{rows().shown.length} of {rows().count} points on the screen; the last value of each pixel</caption>
        <thead><tr><th scope="col">time</th><For each={props.labels}>{(label) => <th scope="col">{label}</th>}</For></tr></thead>
        <tbody>
          <For each={rows().shown}>{(row) => (
            <tr><th scope="row"><button onClick={() => setCursor(row.time)}>{formatClock(row.time, digitsFor(view(), 1000))}</button></th>
              <For each={props.plotted.series}>{(series) => <td>{Number.isNaN(series.last[row.i]!) ? '' : formatNumber(series.last[row.i]!)}</td>}</For></tr>
          )}</For>
        </tbody>
      </table>
    </div>
  );
}
